/* The tightening of boxes instruction by instruction, from a list. */

/* Numbers and addresses of eight bytes each. Registers of a file: first what stays, then what boxes bring, then the rest. */
typedef struct {
    long long n, limits, goals, tables, nodes, moved, registers, literals, constants;
    long long literals_at, constants_at, right_sides_at, cutoffs_at, floors_at, tables_at, variables_at, open_at, goals_at, scratch_at;
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

#include "registers.h"

#include "box_rules.h"

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

#define EACH_REGISTER for (int w = 0; w < wide; w++)
#define GO target = f[code[1]], target_1 = f[code[1] + 1]; goto *LABEL[code[0]]
#define NEXT code += WIDTH, GO
/* The operands of an instruction: both ends of a node, or a single register. */
#define ENDS(name, k) const vd *const name = f[code[k]], *const name##_1 = f[code[k] + 1]
#define ONE(name, k) const vd *const name = f[code[k]]

#define BACK(low_of_y, high_of_y, low_of_x, high_of_x) \
    EACH_REGISTER { \
        const vd s = low_of_y, t = high_of_y; \
        const vd low = v_fmax(target[w], low_of_x), high = v_fmin(target_1[w], high_of_x); \
        target[w] = low; \
        target_1[w] = high; \
        y[w] = v_fmax(y[w], s); \
        y_1[w] = v_fmin(y_1[w], t); \
    } \
    NEXT
#define OTHER(k) vd *const y = f[code[k]], *const y_1 = f[code[k] + 1]
#define CARRIED_OUT carried_out_in_part
#include "box_sweeps.h"
#undef CARRIED_OUT
#undef EACH_REGISTER
#define EACH_REGISTER for (int w = 0; w < WIDE; w++)
#define CARRIED_OUT carried_out_in_whole
#include "box_sweeps.h"
#undef CARRIED_OUT
#undef EACH_REGISTER
#define EACH_REGISTER for (int w = 0; w < wide; w++)

static int carried_out(const int *code, vd (*f)[WIDE], const Whole *whole, vi *dead, int wide) {
    return wide == WIDE ? carried_out_in_whole(code, f, whole, dead, wide) : carried_out_in_part(code, f, whole, dead, wide);
}

/* Brings living boxes to the front of a block, and all that is known of them; returns how many registers they take.
   ``from`` tells for each place which box of the block stands there. */
static int closed_up(const Shape *s, vd (*f)[WIDE], vi *dead, int *from, int wide) {
    int living = 0;
    int kept[BLOCK];
    for (int k = 0; k < wide * LANES; k++)
        if (!dead[k / LANES][k % LANES]) kept[living++] = k;
    const int needed = (living + LANES - 1) / LANES;
    if (4 * needed > 3 * wide || !living) return wide; /* moving costs about as much as it saves */
    for (int k = 0; k < living; k++) from[k] = from[kept[k]];
    for (long long r = s->cutoffs_at; r < s->scratch_at; r++) {
        double *const row = (double *)f[r];
        for (int k = 0; k < living; k++) row[k] = row[kept[k]];
    }
    for (int k = 0; k < needed * LANES; k++) dead[k / LANES][k % LANES] = k < living ? 0 : -1;
    return needed;
}

static void tighten(const Batch *b, const Whole *whole, vd *file, Registers *block, int wide, vi *dead) {
    const Shape *const s = SHAPE;
    vd (*const f)[WIDE] = (vd (*)[WIDE])file;
    EACH_REGISTER {
        const Registers *const r = block + w;
        for (long long i = 0; i < s->tables; i++)
            for (int end = 0; end < 2; end++) f[s->tables_at + 2 * i + end][w] = r->T[i][end];
        for (long long j = 0; j < s->goals; j++) {
            f[s->cutoffs_at + j][w] = r->C[j];
            f[s->floors_at + j][w] = r->F[j];
        }
        for (long long i = 0; i < s->moved; i++)
            for (int end = 0; end < 2; end++) f[s->variables_at + 2 * i + end][w] = r->V[s->variable[i]][end];
    }
    vi gone[WIDE];
    int from[BLOCK], left = wide;
    EACH_REGISTER gone[w] = all_i(0);
    for (int k = 0; k < wide * LANES; k++) from[k] = k;
    EACH_REGISTER dead[w] = all_i(-1);
    if (!carried_out(s->first, f, whole, gone, left)) return;
    for (long long sweep = 1; sweep < b->passes; sweep++) {
        left = closed_up(s, f, gone, from, left);
        if (!carried_out(s->later, f, whole, gone, left)) return;
    }
    carried_out(s->last, f, whole, gone, left);
    for (int k = 0; k < left * LANES; k++) {
        const int own = k / LANES, lane = k % LANES, l = from[k] % LANES;
        Registers *const r = block + from[k] / LANES;
        if (gone[own][lane]) continue;
        dead[from[k] / LANES][l] = 0;
        for (long long i = 0; i < s->moved; i++)
            for (int end = 0; end < 2; end++)
                r->V[s->variable[i]][end][l] = f[s->variables_at + 2 * i + end][own][lane];
        for (long long j = 0; j < s->goals; j++) r->goals[j][l] = f[s->goals_at + j][own][lane];
        for (long long j = 0; j < s->limits; j++) r->undecided[j][l] = ((vi)f[s->open_at + j][own])[lane];
    }
}
