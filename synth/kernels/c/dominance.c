/* Which known designs cover boxes: the least value of each objective among those that do in all other objectives. For
   three objectives it is read from a table of corners, for more from sets of designs; both are made by NumPy. The
   structures have fields of the same names in dominance_code.py. */

#include <math.h>

typedef long long whole;

/* Designs in order of each objective, in blocks of a power of two, and what is least of all blocks before two of them. */
typedef struct {
    whole points, shift, blocks, strict;
    const double *ordered; /* [objective][design] */
    const int *place;      /* [objective of the order][objective][design]: its place in the other order */
    const double *value;   /* [objective of the order][objective][design] */
    const double *corner;  /* [objective][blocks before in the order of the next one][in that of the last one] */
} Table;

/* Sets of designs: a bit for each, those that are best in one objective first. */
typedef struct {
    whole points, objectives, block, rows, words, strict;
    const double *ordered;           /* [objective][design] */
    const int *place;                /* [objective of the order][objective][design]: its place in the other order */
    const unsigned long long *inside; /* [objective of the order][objective][row][word]: in the first rows blocks */
} Sets;

#define LANES 8

/* How many designs stand before a box in the order of each objective. */
static void count_before(const double *ordered, whole points, whole m, const double *lower, whole strict, whole *before) {
    for (whole a = 0; a < m; a++) before[a] = 0;
    for (whole count = points; count > 1; count -= count / 2)
        for (whole a = 0; a < m; a++) {
            const double last = ordered[a * points + before[a] + count / 2 - 1];
            before[a] += (strict ? last < lower[a] : last <= lower[a]) ? count / 2 : 0;
        }
    for (whole a = 0; a < m; a++) {
        const double last = ordered[a * points + before[a]];
        before[a] += strict ? last < lower[a] : last <= lower[a];
    }
}

/* The least value in one block of an order: of the designs before one place in it, and one place in another order. */
static double least_of_block(const int *place, const double *value, whole block, int before, int other) {
    double least[LANES];
    for (int l = 0; l < LANES; l++) least[l] = INFINITY;
    for (int i = 0; i < block; i += LANES)
        for (int l = 0; l < LANES; l++) {
            const double own = (place[i + l] < other) & (i + l < before) ? value[i + l] : INFINITY;
            least[l] = own < least[l] ? own : least[l];
        }
    for (int l = 1; l < LANES; l++) least[0] = least[l] < least[0] ? least[l] : least[0];
    return least[0];
}

void from_table(const Table *t, whole boxes, const double *lower, double *least) {
    const whole width = t->blocks + 1, padded = t->blocks << t->shift;
    for (whole box = 0; box < boxes; box++, lower += 3, least += 3) {
        whole before[3];
        count_before(t->ordered, t->points, 3, lower, t->strict, before);
        for (int k = 0; k < 3; k++) {
            const int pair[2] = {(k + 1) % 3, (k + 2) % 3};
            const double *corner =
                t->corner + (k * width + (before[pair[0]] >> t->shift)) * width + (before[pair[1]] >> t->shift);
            double result = *corner;
            /* Designs in the two blocks that are begun are looked at only where one of them may be better. */
            if (corner[width + 1] < result)
                for (int s = 0; s < 2; s++) {
                    const int a = pair[s], b = pair[1 - s];
                    const whole first = before[a] >> t->shift << t->shift;
                    const double own = least_of_block(t->place + (3 * a + b) * padded + first,
                                                      t->value + (3 * a + k) * padded + first, 1 << t->shift,
                                                      before[a] - first, before[b]);
                    result = own < result ? own : result;
                }
            least[k] = result;
        }
    }
}

/* The first design in the order of an objective that covers a box in all others; none: the number of designs. */
static whole first_of_set(const Sets *s, const whole *before, whole k) {
    const whole m = s->objectives;
    for (whole word = 0; word < s->words; word++) {
        unsigned long long left = ~0ULL;
        for (whole j = 0; j < m; j++)
            if (j != k) left &= s->inside[((k * m + j) * s->rows + (before[j] + s->block - 1) / s->block) * s->words + word];
        /* A block that is begun is in the set as a whole. */
        for (; left; left &= left - 1) {
            const whole design = 64 * word + __builtin_ctzll(left);
            int covers = 1;
            for (whole j = 0; j < m; j++) covers &= (j == k) | (s->place[(k * m + j) * s->points + design] < before[j]);
            if (covers) return design;
        }
    }
    return s->points;
}

void from_sets(const Sets *s, whole boxes, const double *lower, double *least) {
    const whole m = s->objectives;
    whole before[m];
    for (whole box = 0; box < boxes; box++, lower += m, least += m) {
        count_before(s->ordered, s->points, m, lower, s->strict, before);
        for (whole k = 0; k < m; k++) {
            const whole design = first_of_set(s, before, k);
            least[k] = design < s->points ? s->ordered[k * s->points + design] : INFINITY;
        }
    }
}
