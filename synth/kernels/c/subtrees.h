/* Whole subtrees of boxes: tighten, compare with what is known, split, and again; and boxes that are split alone. */

#include <stdlib.h>

typedef struct {
    long long levels, capacity, columns, known, steps, contracted;
    const long long *column;
    const double *fixed, *of_cluster, *known_at[2][2], *steps_at, *steps_largest;
    const int *const *left, *const *right;
    const double *ranges;
    int *out_cell;
    double *out_low, *out_high, *out_bounds;
    int *out_tag;
    unsigned char *too_small;
} Tree;

/* What a design of a box must keep to be of use; whether the box may hold any. */
static int cutoffs_of(const Batch *b, const Tree *t, const double *lower, const int *cell, double *cutoffs) {
    for (int j = 0; j < GOALS; j++) {
        cutoffs[j] = t->fixed[j];
        if (t->of_cluster) cutoffs[j] = fmin(cutoffs[j], t->of_cluster[cell[0] * GOALS + j]);
    }
    if (t->columns == 2) {
        const double own[2] = {lower[t->column[0]], lower[t->column[1]]};
        for (int k = 0; k < 2; k++) {
            const long long place = above(t->known_at[k][0], t->known, own[1 - k]);
            if (place) cutoffs[t->column[k]] = fmin(cutoffs[t->column[k]], t->known_at[k][1][place - 1]);
        }
        if (t->steps >= 0) {
            const long long from = above(t->steps_at, t->steps, own[0]);
            long long first = 0, count = t->steps;
            while (count > 0) {
                const long long half = count / 2;
                const int right = t->steps_largest[first + half] > own[1];
                first = right ? first + half + 1 : first;
                count = right ? count - half - 1 : half;
            }
            if (from >= first) return 0;
            cutoffs[t->column[0]] = fmin(cutoffs[t->column[0]], t->steps_at[first - 1]);
            cutoffs[t->column[1]] = fmin(cutoffs[t->column[1]], t->steps_largest[from]);
        }
    }
    for (int j = 0; j < GOALS; j++) if (lower[j] >= cutoffs[j]) return 0;
    return 1;
}

/* Where a variable of a box is cut: the end of the first half and the start of the second. */
static void middle_of(const Batch *b, int i, double low, double high, double *end, double *start) {
    const long long size = b->grid_sizes[i];
    if (size) {
        const double *grid = b->grids[i], per_unit = b->per_unit[i];
        const long long first = not_below_soon(grid, size, per_unit, end_below(low, b->snap, b->pinned));
        const long long last = above_soon(grid, size, per_unit, end_above(high, b->snap, b->pinned)) - 1;
        const long long cut = (first + last) / 2;
        *end = grid[cut];
        *start = grid[cut + 1 < size ? cut + 1 : size - 1];
    } else {
        *end = *start = low > 0.0 ? sqrt(low * high) : 0.5 * (low + high);
    }
}

typedef struct { double low[MOST_N], high[MOST_N], bounds[MOST_GOALS]; long long place; int tag, level; } Box;

INLINE void put(const Batch *b, Tree *t, long long place, const Box *box, const int *cell, int too_small) {
    memcpy(t->out_cell + place * b->factors, cell, b->factors * sizeof *cell);
    memcpy(t->out_low + place * N, box->low, N * sizeof(double));
    memcpy(t->out_high + place * N, box->high, N * sizeof(double));
    memcpy(t->out_bounds + place * GOALS, box->bounds, GOALS * sizeof(double));
    t->out_tag[place] = box->tag;
    t->too_small[place] = (unsigned char)too_small;
}

/* What is splittable of a box is split where the scores say; 0 where nothing is. */
static int halved(const Batch *b, const Tree *t, const Box *box, const int *cell, const float *scores,
                  Box *second, int *second_cell, Box *first, int *first_cell) {
    int wide[MOST_N], choice = -1, flat = 1;
    double best = -1.0;
    for (int i = 0; i < N; i++) {
        const double low = box->low[i], high = box->high[i], size = fmax(fabs(low), fabs(high));
        wide[i] = high - low > (b->grid_sizes[i] ? b->snap * size : 1e-7 * fmax(size, 1e-9 * t->ranges[i]));
        if (!wide[i]) continue;
        flat &= !(scores[i] > 1e-9);
        if (scores[i] > best) { best = scores[i]; choice = i; }
    }
    for (int f = 0; f < b->factors; f++) {
        if (t->left[f][cell[f]] < 0) continue;
        flat &= !(scores[N + f] > 1e-9);
        if (scores[N + f] > best) { best = scores[N + f]; choice = N + f; }
    }
    if (flat) {
        best = -1.0;
        choice = -1;
        for (int i = 0; i < N; i++) {
            if (!wide[i]) continue;
            const double low = box->low[i], high = box->high[i];
            const double width = fmax(b->spans[i] == 0.0 ? log(high / low) : (high - low) / b->spans[i], 1e-12);
            if (width > best) { best = width; choice = i; }
        }
        for (int f = 0; f < b->factors; f++)
            if (t->left[f][cell[f]] >= 0 && 1e3 > best) { best = 1e3; choice = N + f; }
    }
    if (choice < 0) return 0;
    *first = *second = *box;
    memcpy(first_cell, cell, b->factors * sizeof *cell);
    memcpy(second_cell, cell, b->factors * sizeof *cell);
    if (choice < N) {
        middle_of(b, choice, box->low[choice], box->high[choice], &first->high[choice], &second->low[choice]);
    } else {
        first_cell[choice - N] = t->left[choice - N][cell[choice - N]];
        second_cell[choice - N] = t->right[choice - N][cell[choice - N]];
    }
    return 1;
}

/* Splits boxes that are scored: first halves come in their order, second halves t->capacity places further on. What is too
   small to be split comes back as it is, in place of its first half. */
void split(const Batch *b, const Tree *t) {
    const long long factors = b->factors, columns = N + factors;
    for (long long k = 0; k < b->count; k++) {
        const int *cell = b->cell + k * factors;
        const float *scores = b->scores + k * columns;
        int cells[2][factors + 1];
        Box box, halves[2];
        memcpy(box.low, b->low + k * N, N * sizeof(double));
        memcpy(box.high, b->high + k * N, N * sizeof(double));
        t->too_small[k] = (unsigned char)!halved(b, t, &box, cell, scores, halves + 1, cells[1], halves, cells[0]);
        for (int half = 0; half < 2 - t->too_small[k]; half++) {
            const Box *own = t->too_small[k] ? &box : halves + half;
            const long long place = k + half * t->capacity;
            memcpy(b->out_cell + place * factors, t->too_small[k] ? cell : cells[half], factors * sizeof *cell);
            memcpy(b->out_low + place * N, own->low, N * sizeof(double));
            memcpy(b->out_high + place * N, own->high, N * sizeof(double));
            memcpy(b->out_bounds + place * b->goals, b->bounds + k * b->goals, b->goals * sizeof(double));
            memcpy(b->out_scores + place * columns, scores, columns * sizeof *scores);
            b->out_tag[place] = b->tag[k];
        }
    }
}

/* Where a box comes among those that come back: first those of the last box, and first its first half. */
static int by_place(const void *a, const void *b) {
    const long long first = ((const long long *)a)[0], second = ((const long long *)b)[0];
    return (first > second) - (first < second);
}

/* Puts what comes back into the order of where it comes from, so that it does not depend on what was done together. */
static int in_order(const Batch *b, Tree *t, const long long *places, long long kept) {
    const long long factors = b->factors;
    long long sorted = 1;
    while (sorted < kept && places[sorted - 1] <= places[sorted]) sorted++;
    if (sorted >= kept) return 1; /* as always after one generation */
    long long *order = malloc((kept + 1) * 2 * sizeof *order);
    double *ends = malloc((kept + 1) * sizeof *ends);
    int *cells = malloc((kept + 1) * (factors + 1) * sizeof *cells);
    const int room = order && ends && cells;
    if (room) {
        for (long long k = 0; k < kept; k++) { order[2 * k] = places[k]; order[2 * k + 1] = k; }
        qsort(order, kept, 2 * sizeof *order, by_place);
#define SORTED(array, width, buffer) \
        for (long long i = 0; i < (width); i++) { \
            for (long long k = 0; k < kept; k++) buffer[k] = array[order[2 * k + 1] * (width) + i]; \
            for (long long k = 0; k < kept; k++) array[k * (width) + i] = buffer[k]; \
        }
        SORTED(t->out_cell, factors, cells)
        SORTED(t->out_low, N, ends)
        SORTED(t->out_high, N, ends)
        SORTED(t->out_bounds, GOALS, ends)
        SORTED(t->out_tag, 1, cells)
        SORTED(t->too_small, 1, cells)
    }
    free(order);
    free(ends);
    free(cells);
    return room;
}

/* Returns how many boxes come back, -1 where there is no memory. */
long long grow(const Batch *b, Tree *t) {
    vd file[REGISTERS];
    Whole whole;
    Registers block[WIDE];
    vi dead_of[WIDE];
    const int factors = (int)b->factors;
    const long long most = b->count + (t->levels + 2) * 2 * BLOCK;
    Box *stack = malloc(most * sizeof *stack);
    int *cells = malloc(most * (factors + 1) * sizeof *cells);
    long long *places = malloc((t->capacity + 1) * sizeof *places);
    float counted[LANES][b->score_width], scores[N + factors + 1];
    long long waiting = b->count, kept = 0;
    if (!stack || !cells || !places) { free(stack); free(cells); free(places); return -1; }
    for (long long k = 0; k < b->count; k++) {
        Box *box = stack + k;
        memcpy(box->low, b->low + k * N, N * sizeof(double));
        memcpy(box->high, b->high + k * N, N * sizeof(double));
        memcpy(box->bounds, b->bounds + k * GOALS, GOALS * sizeof(double));
        memcpy(cells + k * factors, b->cell + k * factors, factors * sizeof *cells);
        box->tag = b->tag[k];
        box->level = 0;
        box->place = (b->count - 1 - k) << t->levels;
    }
    begin(b, &whole, file, counted);
    while (waiting && kept + waiting + 2 * BLOCK < t->capacity && waiting + 2 * BLOCK <= most) {
        Box taken[BLOCK];
        int own_cells[BLOCK][factors + 1];
        int number = 0;
        while (number < BLOCK && waiting) {
            double cutoffs[MOST_GOALS];
            const Box *box = stack + --waiting;
            const int *cell = cells + waiting * factors;
            if (!cutoffs_of(b, t, box->bounds, cell, cutoffs)) continue;
            Registers *const r = block + number / LANES;
            const int lane = number % LANES;
            taken[number] = *box;
            memcpy(own_cells[number], cell, factors * sizeof *cell);
            for (int i = 0; i < N; i++) { r->V[i][0][lane] = box->low[i]; r->V[i][1][lane] = box->high[i]; }
            for (int j = 0; j < GOALS; j++) r->C[j][lane] = cutoffs[j];
            load_floors(b, cell, r->F, lane);
            load_tables(b, cell, r->T, lane);
            number++;
        }
        if (!number) break;
        const int wide = (number + LANES - 1) / LANES;
        for (int l = number; l < wide * LANES; l++) {
            Registers *const r = block + l / LANES;
            const int lane = l % LANES;
            for (int i = 0; i < N; i++) { r->V[i][0][lane] = r->V[i][0][0]; r->V[i][1][lane] = r->V[i][1][0]; }
            for (int j = 0; j < GOALS; j++) { r->C[j][lane] = r->C[j][0]; r->F[j][lane] = r->F[j][0]; }
            for (int i = 0; i < TABLES; i++) { r->T[i][0][lane] = r->T[i][0][0]; r->T[i][1][lane] = r->T[i][1][0]; }
        }
        t->contracted += number;
        tighten(b, &whole, file, block, wide, dead_of);
        for (int w = 0; w < wide; w++) {
            Registers *const r = block + w;
            dead_of[w] |= snap(b, r->V);
            if (!any(~dead_of[w])) continue;
            score(b, r, counted);
            for (int l = 0; l < LANES && w * LANES + l < number; l++) {
                if (dead_of[w][l]) continue;
                double cutoffs[MOST_GOALS];
                Box *box = taken + w * LANES + l;
                const int *own = own_cells[w * LANES + l];
                for (int i = 0; i < N; i++) {
                    box->low[i] = r->V[i][0][l];
                    box->high[i] = r->V[i][1][l];
                    scores[i] = (float)r->scores[i][l];
                }
                for (int j = 0; j < GOALS; j++) {
                    const double least = r->goals[j][l];
                    box->bounds[j] = box->bounds[j] >= least || least != least ? box->bounds[j] : least;
                }
                if (!cutoffs_of(b, t, box->bounds, own, cutoffs)) continue;
                for (int f = 0; f < factors; f++)
                    scores[N + f] = dot(counted[l], b->spreads[f] + own[f] * b->score_width, b->score_width);
                box->level++;
                Box first, second;
                int first_cell[factors + 1], second_cell[factors + 1];
                if (!halved(b, t, box, own, scores, &second, second_cell, &first, first_cell)) {
                    places[kept] = box->place;
                    put(b, t, kept++, box, own, 1);
                    continue;
                }
                second.place += 1LL << (t->levels - box->level);
                if (box->level >= t->levels) {
                    places[kept] = first.place;
                    put(b, t, kept++, &first, first_cell, 0);
                    places[kept] = second.place;
                    put(b, t, kept++, &second, second_cell, 0);
                } else {
                    stack[waiting] = second;
                    memcpy(cells + waiting++ * factors, second_cell, factors * sizeof *cells);
                    stack[waiting] = first;
                    memcpy(cells + waiting++ * factors, first_cell, factors * sizeof *cells);
                }
            }
        }
    }
    while (waiting) {
        waiting--;
        places[kept] = stack[waiting].place;
        put(b, t, kept++, stack + waiting, cells + waiting * factors, 0);
    }
    if (!in_order(b, t, places, kept)) kept = -1;
    free(stack);
    free(cells);
    free(places);
    return kept;
}
