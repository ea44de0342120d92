/* What is known of the boxes that are tightened together, BLOCK of them in WIDE registers. The sizes of a question, or
   those there is room for, stand before it: MOST_N and so on. */

#define WIDE 4
#define BLOCK (WIDE * LANES)

/* What holds over the whole question. */
typedef struct {
    vd RL[MOST_NODES], RH[MOST_NODES], B[MOST_LIMITS];
} Whole;

typedef struct {
    vd C[MOST_GOALS], F[MOST_GOALS], V[MOST_N][2], T[MOST_TABLES][2];
    vd goals[MOST_GOALS], scores[MOST_N];
    vi undecided[MOST_LIMITS];
} Registers;
