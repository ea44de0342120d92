/* The tightening of boxes instruction by instruction, from a list: one code for all formulas there are. It stands at the
   place of the function of the same name that is generated for a question, and does the same steps in the same order.
   SIZES, CASES and RULES are filled in. */

/*SIZES*/

/* Numbers and addresses of eight bytes each. Registers of a file: first what stays, then what boxes bring, then the rest. */
typedef struct {
    long long n, limits, goals, tables, nodes, moved, registers, literals, constants;
    long long literals_at, constants_at, right_sides_at, cutoffs_at, floors_at, tables_at, variables_at, open_at, goals_at;
    const double *literal;
    const int *variable, *factor, *row_width, *row_place, *first, *later, *last;
} Shape;

#define SHAPE ((const Shape *)b->shape)
#define N (SHAPE->n)
#define LIMITS (SHAPE->limits)
#define GOALS (SHAPE->goals)
#define TABLES (SHAPE->tables)
#define NODES (SHAPE->nodes)
#define REGISTERS (WIDE * SHAPE->registers)

/*REGISTERS_OF_BOXES*/

/*RULES*/

static void begin_file(const Batch *b, vd *file) {
    const Shape *const s = SHAPE;
    vd (*const f)[WIDE] = (vd (*)[WIDE])file;
    memset(file, 0, s->registers * sizeof f[0]);
    for (int w = 0; w < WIDE; w++) {
        for (long long k = 0; k < s->literals; k++) f[s->literals_at + k][w] = all(s->literal[k]);
        for (long long k = 0; k < s->constants; k++)
            f[s->constants_at + 2 * k][w] = f[s->constants_at + 2 * k + 1][w] = all(b->constants[k]);
        for (long long j = 0; j < s->limits; j++) f[s->right_sides_at + j][w] = all(b->right_sides[j]);
    }
}

INLINE void load_tables(const Batch *b, const int *cell, vd T[][2], int l) {
    const Shape *const s = SHAPE;
    for (long long i = 0; i < s->tables; i++) {
        const int f = s->factor[i];
        const double *const row = b->rows[f] + s->row_width[i] * (long long)cell[f] + s->row_place[i];
        T[i][0][l] = row[0];
        T[i][1][l] = row[1];
    }
}

/* Not unrolled: it would take the compiler twice as long. */
#define EACH_REGISTER _Pragma("GCC unroll 1") for (int w = 0; w < WIDE; w++)

/* Carries out one list for a block, each register of the file WIDE times; 0 where no box is alive any more. */
static int carried_out(const int *code, vd (*f)[WIDE], const Whole *whole, vi *dead) {
    for (;; code += WIDTH) {
        vd *const target = f[code[1]], *const target_1 = f[code[1] + 1];
        switch (code[0]) {
        case END: return 1;
        case END_IF_DEAD: {
            vi living = all_i(0);
            EACH_REGISTER living |= ~dead[w];
            if (!any(living)) return 0;
            break;
        }
        case HOLD: {
            const vd low = whole->RL[code[2]], high = whole->RH[code[2]];
            EACH_REGISTER { target[w] = v_fmax(target[w], low); target_1[w] = v_fmin(target_1[w], high); }
            break;
        }
        case IN_ORDER:
            EACH_REGISTER {
                const vd low = target[w], high = target_1[w];
                const vi crossed = low > high;
                target[w] = choose(crossed, high, low);
                target_1[w] = choose(crossed, low, high);
            }
            break;
/*CASES*/
        }
    }
}

static void tighten(const Batch *b, const Whole *whole, vd *file, Registers *block, int wide, vi *dead) {
    const Shape *const s = SHAPE;
    vd (*const f)[WIDE] = (vd (*)[WIDE])file;
    EACH_REGISTER {
        const Registers *const r = block + (w < wide ? w : wide - 1);
        for (long long i = 0; i < s->tables; i++)
            for (int end = 0; end < 2; end++) f[s->tables_at + 2 * i + end][w] = r->T[i][end];
        for (long long j = 0; j < s->goals; j++) {
            f[s->cutoffs_at + j][w] = r->C[j];
            f[s->floors_at + j][w] = r->F[j];
        }
        for (long long i = 0; i < s->moved; i++)
            for (int end = 0; end < 2; end++) f[s->variables_at + 2 * i + end][w] = r->V[s->variable[i]][end];
    }
    EACH_REGISTER dead[w] = all_i(0);
    if (!carried_out(s->first, f, whole, dead)) return;
    for (long long sweep = 1; sweep < b->passes; sweep++)
        if (!carried_out(s->later, f, whole, dead)) return;
    carried_out(s->last, f, whole, dead);
    for (int w = 0; w < wide; w++) {
        Registers *const r = block + w;
        for (long long i = 0; i < s->moved; i++)
            for (int end = 0; end < 2; end++) r->V[s->variable[i]][end] = f[s->variables_at + 2 * i + end][w];
        for (long long j = 0; j < s->goals; j++) r->goals[j] = f[s->goals_at + j][w];
        for (long long j = 0; j < s->limits; j++) r->undecided[j] = (vi)f[s->open_at + j][w];
    }
}
