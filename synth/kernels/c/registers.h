/* What is known of the boxes that are tightened together, in WIDE registers. As many on every processor: what a subtree
   comes back with must not depend on it. */

#define BLOCK 32
#define WIDE (BLOCK / LANES)

/* What holds over the whole question. */
typedef struct {
    vd RL[MOST_NODES], RH[MOST_NODES], B[MOST_LIMITS];
} Whole;

typedef struct {
    vd C[MOST_GOALS], F[MOST_GOALS], V[MOST_N][2], T[MOST_TABLES][2];
    vd goals[MOST_GOALS], scores[MOST_N];
    vi undecided[MOST_LIMITS];
} Registers;
