/* The contraction of many boxes, a register of them at a time: load, tighten, snap to the grid, score, pack.
   What comes of a box depends on nothing but the box. */

/* As wide on every processor, so that sums round alike. */
typedef float vf __attribute__((vector_size(4 * SCORE_WIDTH)));

#define LARGEST_RATIO 1.7976931348623157e308 /* a score of no influence and an infinite width would be no number */

/* The first place whose value is not below x, and the first whose value is above x. */
static long long not_below(const double *grid, long long count, double x) {
    long long first = 0;
    while (count > 0) {
        const long long half = count / 2;
        const int right = grid[first + half] < x;
        first = right ? first + half + 1 : first;
        count = right ? count - half - 1 : half;
    }
    return first;
}
static long long above(const double *grid, long long count, double x) {
    long long first = 0;
    while (count > 0) {
        const long long half = count / 2;
        const int right = grid[first + half] <= x;
        first = right ? first + half + 1 : first;
        count = right ? count - half - 1 : half;
    }
    return first;
}

/* The same where values stand at equal distances mostly: the place that this says is looked at before all are searched. */
static long long guessed(const double *grid, long long size, double per_unit, double x) {
    const double place = (x - grid[0]) * per_unit;
    return !(place > 0.0) ? 0 : place < (double)(size - 1) ? (long long)place + 1 : size;
}
static long long not_below_soon(const double *grid, long long size, double per_unit, double x) {
    const long long k = guessed(grid, size, per_unit, x);
    return (k == size || !(grid[k] < x)) && (!k || grid[k - 1] < x) ? k : not_below(grid, size, x);
}
static long long above_soon(const double *grid, long long size, double per_unit, double x) {
    const long long k = guessed(grid, size, per_unit, x);
    return (k == size || !(grid[k] <= x)) && (!k || grid[k - 1] <= x) ? k : above(grid, size, x);
}

static vi snap(const Batch *b, vd V[][2]) {
    vi dead = all_i(0);
    for (int i = 0; i < N; i++) {
        vd low = v_max(V[i][0], all(b->lower[i])), high = v_min(V[i][1], all(b->upper[i]));
        const long long size = b->grid_sizes[i];
        if (size) {
            const double *grid = b->grids[i], per_unit = b->per_unit[i];
            for (int l = 0; l < LANES; l++) {
                const long long first = not_below_soon(grid, size, per_unit, end_below(low[l], b->snap, b->pinned));
                const long long last = above_soon(grid, size, per_unit, end_above(high[l], b->snap, b->pinned)) - 1;
                if (first > last) dead[l] = -1;
                low[l] = grid[first < size ? first : size - 1];
                high[l] = grid[last > 0 ? last : 0];
            }
            high = v_max(high, low);
        }
        dead |= low > ends_above(high, b->snap, b->pinned);
        V[i][0] = low;
        V[i][1] = v_max(high, low);
    }
    return dead;
}

/* Sum of products of two rows whose length is a multiple of SCORE_WIDTH. */
static float dot(const float *a, const float *b, long long width) {
    vf sum = {0};
    float parts[SCORE_WIDTH];
    for (long long k = 0; k < width; k += SCORE_WIDTH) {
        vf x, y;
        memcpy(&x, a + k, sizeof x);
        memcpy(&y, b + k, sizeof y);
        sum += x * y;
    }
    memcpy(parts, &sum, sizeof sum);
    for (int half = SCORE_WIDTH / 2; half; half /= 2)
        for (int k = 0; k < half; k++) parts[k] += parts[k + half];
    return parts[0];
}

static void begin(const Batch *b, Whole *whole, vd *file, float counted[LANES][b->score_width]) {
    for (int k = 0; k < NODES; k++) { whole->RL[k] = all(b->root_low[k]); whole->RH[k] = all(b->root_high[k]); }
    for (int j = 0; j < LIMITS; j++) whole->B[j] = all(b->right_sides[j]);
    memset(counted, 0, LANES * sizeof counted[0]);
    begin_file(b, file);
}

/* How much each variable blurs what is left of boxes, and how much each limit and objective counts. */
static void score(const Batch *b, Registers *r, float counted[LANES][b->score_width]) {
    const double *own[LANES];
    for (int i = 0; i < N; i++) r->scores[i] = all(0.0);
    for (int l = 0; l < LANES; l++) {
        long long pattern = 0;
        for (int j = 0; j < b->bits; j++) pattern |= (long long)(r->C[j][l] - r->C[j][l] == 0.0) << j;
        own[l] = b->weights + pattern * b->weights_step;
    }
    for (int j = 0; j < LIMITS + GOALS; j++) {
        vd weight;
        for (int l = 0; l < LANES; l++) weight[l] = j >= LIMITS || r->undecided[j][l] ? own[l][j] : 0.0;
        for (int i = 0; i < N; i++) r->scores[i] += weight * b->steep[j * N + i];
        for (int l = 0; l < LANES; l++) counted[l][j] = (float)weight[l];
    }
    for (int i = 0; i < N; i++) {
        const vd low = r->V[i][0], high = r->V[i][1];
        r->scores[i] *= b->spans[i] == 0.0 ? v_log(v_min(high / low, all(LARGEST_RATIO))) : (high - low) / b->spans[i];
    }
}

/* The least that objectives of a box may be, by its cluster of the first factor. */
static void load_floors(const Batch *b, const int *cell, vd *F, int lane) {
    for (int j = 0; j < GOALS; j++) F[j][lane] = b->floors ? b->floors[cell[0] * GOALS + j] : -INFINITY;
}

long long contract(const Batch *b) {
    vd file[REGISTERS];
    Whole whole;
    Registers block[WIDE];
    vi dead_of[WIDE];
    float counted[LANES][b->score_width];
    const long long columns = N + b->factors;
    long long kept = 0;
    begin(b, &whole, file, counted);
    for (long long start = 0; start < b->count; start += BLOCK) {
        const long long rest = b->count - start;
        const int wide = rest < BLOCK ? (int)((rest + LANES - 1) / LANES) : WIDE;
        for (int l = 0; l < wide * LANES; l++) {
            const long long box = start + (l < rest ? l : rest - 1);
            Registers *const r = block + l / LANES;
            const int lane = l % LANES;
            for (int i = 0; i < N; i++) { r->V[i][0][lane] = b->low[box * N + i]; r->V[i][1][lane] = b->high[box * N + i]; }
            for (int j = 0; j < GOALS; j++) r->C[j][lane] = b->cutoffs[box * b->cutoffs_step + j];
            load_floors(b, b->cell + box * b->factors, r->F, lane);
            load_tables(b, b->cell + box * b->factors, r->T, lane);
        }
        tighten(b, &whole, file, block, wide, dead_of);
        for (int w = 0; w < wide; w++) {
            const long long first = start + w * LANES, left = b->count - first;
            Registers *const r = block + w;
            const vi dead = dead_of[w] | snap(b, r->V);
            for (int l = 0; b->alive && l < LANES && l < left; l++) {
                b->alive[first + l] = !dead[l];
                for (int j = 0; j < LIMITS; j++)
                    b->undecided[(first + l) * LIMITS + j] = !dead[l] && r->undecided[j][l] != 0;
            }
            if (!any(~dead)) continue;
            score(b, r, counted);
            for (int l = 0; l < LANES && l < left; l++) {
                if (dead[l]) continue;
                const long long box = first + l;
                const int *cell = b->cell + box * b->factors;
                for (int i = 0; i < N; i++) {
                    b->out_low[kept * N + i] = r->V[i][0][l];
                    b->out_high[kept * N + i] = r->V[i][1][l];
                    b->out_scores[kept * columns + i] = (float)r->scores[i][l];
                }
                for (long long j = 0; j < b->goals; j++) {
                    const double bound = b->bounds[box * b->goals + j];
                    const double least = j < GOALS ? r->goals[j][l] : NAN;
                    b->out_bounds[kept * b->goals + j] = bound >= least || least != least ? bound : least;
                }
                for (long long f = 0; f < b->factors; f++) {
                    const float *spread = b->spreads[f] + cell[f] * b->score_width;
                    b->out_cell[kept * b->factors + f] = cell[f];
                    b->out_scores[kept * columns + N + f] = dot(counted[l], spread, b->score_width);
                }
                b->out_tag[kept++] = b->tag[box];
            }
        }
    }
    return kept;
}
