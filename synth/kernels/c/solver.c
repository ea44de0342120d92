/* The interior-point method: the steps of synth.nlp.interior_point_numpy over registers in place of arrays. A lane is one
   element of a register, and a lane that is done takes the next problem. */

#include "vectors.h"
#include "solver_record.h"

#define EACH(k, n) for (int k = 0; k < (n); k++)
#define MATRIX(name) vd name[MOST_N + 1][MOST_N + 1]

typedef struct {
    long long count;
    const double *const *stored;
    const long long *stored_steps;
    const double *start, *low, *high, *slopes, *rights, *weights, *t_weight;
    const unsigned char *counts;
    double *y, *t, *rows, *multipliers;
    long long *status, *evaluations;
} Problems;

typedef struct {
    vd *stored;
    vd low[MOST_N], high[MOST_N], slopes[MOST_ROWS], rights[MOST_ROWS], weights[MOST_GOALS], t_weight;
    vi free[MOST_N], counts[MOST_ROWS], t_free, busy;
    vd y[MOST_N], t, form[MOST_ROWS], values[MOST_ROWS], multipliers[MOST_ROWS], low_dual[MOST_N], high_dual[MOST_N];
    vd barrier, penalty, merit;
    vd next_penalty;
    vi restoring;
    vi absent[MOST_ROWS], missing;
    vd direction[MOST_N + 1], uncorrected[MOST_N + 1], forecast[MOST_ROWS], change[MOST_ROWS];
    vd low_change[MOST_N], high_change[MOST_N];
    vd slope, step, dual_step;
    vi rejected, evaluations, late, status;
    long long number[LANES];
} State;

/* Row functions as a list of instructions. */

typedef struct {
    /* Slots hold constants, stored nodes, variables, weights and results, in this order. */
    int n, rows, constraints, goals, nonzeros, curvatures, stored, slots, constants, steps, terms;
    const int *equal, *guard, *row, *column, *curvature, *term, *code, *output;
    const double *constant, *method;
} Shape;

/* Two pointers fit where they are found without a call, also in a library that is loaded late. */
#if defined(__ELF__)
#define OF_THE_THREAD static __thread __attribute__((tls_model("initial-exec")))
#else
#define OF_THE_THREAD static __thread
#endif
OF_THE_THREAD const Shape *shape;
OF_THE_THREAD vd *slots;

#define N (shape->n)
#define ROWS (shape->rows)
#define CONSTRAINTS (shape->constraints)
#define GOALS (shape->goals)
#define NONZEROS (shape->nonzeros)
#define CURVATURES (shape->curvatures)
#define STORED (shape->stored)
#define EQUAL (shape->equal)
#define GUARD (shape->guard)
#define ROW (shape->row)
#define COLUMN (shape->column)

static void point(const vd *restrict y, const vd *restrict weights, const vd *restrict stored, vd *restrict form,
                  vd *restrict jacobian, vd *restrict hessian) {
    vd *const r = slots;
    vd *const inputs = r + shape->constants + STORED;
    EACH(a, N) inputs[a] = y[a];
    EACH(k, ROWS) inputs[N + k] = weights[k];
    const int *code = shape->code;
    for (int k = shape->steps; k > 0; k--, code += WIDTH) {
        const vd a = r[code[2]], b = r[code[3]];
        vd result;
        switch (code[0]) {
#include "solver_cases.h"
        default: result = all(NAN);
        }
        r[code[1]] = result;
    }
    const int *from = shape->output;
    EACH(k, ROWS) form[k] = r[*from++];
    EACH(k, NONZEROS) jacobian[k] = r[*from++];
    EACH(k, CURVATURES) hessian[k] = r[*from++];
}

INLINE void transposed(const vd *jacobian, const vd *vector, vd *result) {
    EACH(a, N) result[a] = all(0.0);
    EACH(k, NONZEROS) result[COLUMN[k]] += jacobian[k] * vector[ROW[k]];
}

INLINE void moved_by(const vd *jacobian, const vd *slopes, const vd *direction, vd *result) {
    EACH(r, ROWS) result[r] = -slopes[r] * direction[N];
    EACH(k, NONZEROS) result[ROW[k]] += jacobian[k] * direction[COLUMN[k]];
}

INLINE void gram(const vd *jacobian, const vd *slopes, const vd *vector, MATRIX(matrix)) {
    vd weighted[MOST_NONZEROS];
    EACH(k, NONZEROS) weighted[k] = jacobian[k] * vector[ROW[k]];
    EACH(a, N + 1) EACH(b, a + 1) matrix[a][b] = all(0.0);
    const int *term = shape->term;
    for (int k = shape->terms; k > 0; k--, term += 4) matrix[term[0]][term[1]] += weighted[term[2]] * jacobian[term[3]];
    EACH(k, NONZEROS) matrix[N][COLUMN[k]] -= weighted[k] * slopes[ROW[k]];
    EACH(r, ROWS) matrix[N][N] += vector[r] * slopes[r] * slopes[r];
}

INLINE vd price(const State *s, int r) { return EQUAL[r] ? 2.0 * s->penalty : s->penalty; }
INLINE vd sign(const State *s, int r, vd multiplier) { return EQUAL[r] ? multiplier - s->penalty : multiplier; }
INLINE vd below(const State *s, const vd *y, int a) { return choose(s->free[a], y[a] - s->low[a], all(1.0)); }
INLINE vd above(const State *s, const vd *y, int a) { return choose(s->free[a], s->high[a] - y[a], all(1.0)); }
/* Lanes that only look for a point where all rows exist and hold. */
INLINE vi first_phase(const State *s, vi missing) { return (missing > 0) | s->restoring; }
/* As long as rows are to be met, those that t can meet do not count; as long as rows are to exist, limits all do. */
INLINE vi idle(const State *s, const vi *absent, vi missing, int r) {
    const vi phase = r < CONSTRAINTS ? s->restoring : s->restoring | (missing > 0);
    return absent[r] | ((s->slopes[r] != 0.0) & phase);
}

/* 2 mu/R, but for the factor of equalities. */
INLINE vd least_of(const State *s) { return 2.0 * s->barrier / s->penalty; }
INLINE vd least_in(int r, vd least) { return EQUAL[r] ? 0.5 * least : least; }

/* Roots and divisions cost ten times the rest, so each is taken once; total is the sum of slack and excess. */
INLINE vd total_of(vd value, vd least) { return least + v_sqrt(value * value + least * least); }
INLINE void split(vd value, vd total, vd least, vd price, vd *slack, vd *excess, vd *own) {
    const vd large = 0.5 * (v_abs(value) + total);
    const vd inverse = 1.0 / (large * total);
    const vd small = 0.5 * least * total * total * inverse;
    const vi held = value <= 0.0;
    *slack = choose(held, large, small);
    *excess = choose(held, small, large);
    *own = price * *excess * large * inverse;
}

/* Sum of logarithms, one for several factors; so few cannot leave the range of exponents. */
typedef struct { vd product, sum; int factors; } Logarithms;
INLINE void add_logarithm(Logarithms *logs, vd factor) {
    logs->product *= factor;
    if (++logs->factors % 10 == 0) {
        logs->sum += v_log(logs->product);
        logs->product = all(1.0);
    }
}
INLINE vd row_merit(const State *s, int r, vd value, vd total, vd least) {
    const vd result = 0.5 * price(s, r) * (value + total - least);
    return EQUAL[r] ? result - s->penalty * value : result;
}
INLINE vd other_merit(const State *s, const vd *y, vd t, const vd *form, vi missing, Logarithms *logs) {
    vd objective = s->t_weight * t;
    EACH(k, GOALS) objective += keep(s->weights[k] != 0.0, s->weights[k] * form[CONSTRAINTS + k]);
    EACH(a, N) add_logarithm(logs, below(s, y, a) * above(s, y, a));
    return keep(~first_phase(s, missing), objective) - s->barrier * (logs->sum + v_log(logs->product));
}

static vd merit_of(const State *s, const vd *y, vd t, const vd *form, const vd *values, vi missing, vd *totals) {
    vd result = all(0.0);
    Logarithms logs = {all(1.0), all(0.0), 0};
    const vd usual = least_of(s);
    EACH(r, ROWS) {
        const vd least = least_in(r, usual);
        totals[r] = total_of(values[r], least);
        result += row_merit(s, r, values[r], totals[r], least);
        add_logarithm(&logs, totals[r]);
    }
    return result + other_merit(s, y, t, form, missing, &logs);
}

static void values_of(const State *s, const vd *form, vd t, const vi *absent, vi missing, vd *values) {
    EACH(r, ROWS) values[r] = choose(
        s->counts[r] & ~idle(s, absent, missing, r), form[r] - s->slopes[r] * t - s->rights[r], all(-1.0));
}

/* Which rows do not exist at a point, and how many; their derivatives are cleared. */
static vi absent_of(const State *s, vd *form, vd *jacobian, vi *absent) {
    vi missing = all_i(0), beyond = all_i(0);
    EACH(r, ROWS) absent[r] = ~(v_abs(form[r]) < LARGEST_ROW);
    EACH(k, NONZEROS) absent[ROW[k]] |= ~is_finite(jacobian[k]);
    EACH(r, ROWS) if (GUARD[r]) beyond |= s->counts[r] & ~(form[r] <= 0.0);
    vi wanted[MOST_ROWS];
    EACH(r, ROWS) {
        wanted[r] = s->counts[r];
        if (r >= CONSTRAINTS) wanted[r] |= s->weights[r - CONSTRAINTS] != 0.0;
        absent[r] = wanted[r] & (GUARD[r] ? absent[r] : absent[r] | beyond);
        missing -= absent[r];
        form[r] = choose(absent[r], all(NAN), form[r]);
    }
    missing -= beyond;
    EACH(r, ROWS) wanted[r] &= ~idle(s, absent, missing, r);
    EACH(k, NONZEROS) jacobian[k] = keep(wanted[ROW[k]] & s->free[COLUMN[k]], jacobian[k]);
    return missing;
}

static void begin(State *s, vi fresh, vd *totals) {
    vd needed = all(-INFINITY);
    EACH(r, ROWS) {
        const vi soft = s->counts[r] & (s->slopes[r] > 0.0) & ~s->absent[r] & all_i(EQUAL[r] ? 0 : -1);
        needed = choose(soft, v_max(needed, (s->form[r] - s->rights[r]) / s->slopes[r]), needed);
    }
    const vd first = needed + FIRST_SLACK;
    const vi held = ~s->t_free | first_phase(s, s->missing) | ~is_finite(first);
    s->t = choose(fresh, choose(held, all(0.0), first), s->t);
    vd values[MOST_ROWS];
    values_of(s, s->form, s->t, s->absent, s->missing, values);
    s->barrier = choose(fresh, all(FIRST_BARRIER), s->barrier);
    s->penalty = choose(fresh, choose(first_phase(s, s->missing), all(FIRST_PENALTY), s->next_penalty), s->penalty);
    const vd usual = least_of(s);
    EACH(r, ROWS) {
        vd slack, excess, own;
        s->values[r] = choose(fresh, values[r], s->values[r]);
        totals[r] = choose(fresh, total_of(s->values[r], least_in(r, usual)), totals[r]);
        split(s->values[r], totals[r], least_in(r, usual), price(s, r), &slack, &excess, &own);
        s->multipliers[r] = choose(fresh, own, s->multipliers[r]);
    }
    EACH(a, N) {
        s->low_dual[a] = choose(fresh, s->barrier / below(s, s->y, a), s->low_dual[a]);
        s->high_dual[a] = choose(fresh, s->barrier / above(s, s->y, a), s->high_dual[a]);
    }
}

/* Multipliers are kept within reach of those that the point itself implies. */
INLINE vd within(vd multiplier, vd own) {
    return v_min(v_max(multiplier, own * (1.0 / MULTIPLIER_SPREAD)), own * MULTIPLIER_SPREAD);
}
INLINE vd bring_in(const State *s, int r, vd own) {
    const vd top = price(s, r) - (price(s, r) - own) * (1.0 / MULTIPLIER_SPREAD);
    return v_min(within(s->multipliers[r], own), top);
}

/* Returns which lanes must start again where they are, because what they look for has changed. */
static vi judge(State *s, vi taken, const vd *jacobian, const vd *slopes, vd *totals) {
    vd weights[MOST_ROWS], residual[MOST_N];
    const vd usual = least_of(s);
    const vi first = first_phase(s, s->missing);
    vd along_t = s->t_weight, largest_multiplier = all(0.0), over = all(0.0);
    vd largest = s->barrier, least = s->barrier;
    vi pressed = all_i(0);
    EACH(r, ROWS) {
        vd slack, excess, own;
        split(s->values[r], totals[r], least_in(r, usual), price(s, r), &slack, &excess, &own);
        s->multipliers[r] = choose(taken, bring_in(s, r, own), s->multipliers[r]);
        const vd signed_one = sign(s, r, s->multipliers[r]);
        weights[r] = signed_one;
        if (r >= CONSTRAINTS) weights[r] += keep(~first, s->weights[r - CONSTRAINTS]);
        along_t -= slopes[r] * signed_one;
        largest_multiplier = v_max(largest_multiplier, v_abs(signed_one));
        const vd products[2] = {s->multipliers[r] * slack, (price(s, r) - s->multipliers[r]) * excess};
        EACH(i, 2) { largest = v_max(largest, products[i]); least = v_min(least, products[i]); }
        over = v_max(over, EQUAL[r] ? v_abs(s->values[r]) : s->values[r]);
        pressed |= s->multipliers[r] > PRESSED_SHARE * price(s, r);
    }
    transposed(jacobian, weights, residual);
    vd dual = keep(s->t_free & ~first, v_abs(along_t));
    EACH(a, N) {
        const vd b = below(s, s->y, a), h = above(s, s->y, a), inverse = s->barrier / (b * h);
        s->low_dual[a] = within(s->low_dual[a], inverse * h);
        s->high_dual[a] = within(s->high_dual[a], inverse * b);
        dual = v_max(dual, v_abs(residual[a] + keep(s->free[a], s->high_dual[a] - s->low_dual[a])));
        const vd products[2] = {s->low_dual[a] * b, s->high_dual[a] * h};
        EACH(i, 2) {
            const vd product = choose(s->free[a], products[i], s->barrier);
            largest = v_max(largest, product);
            least = v_min(least, product);
        }
    }
    dual /= v_max(all(1.0), MULTIPLIER_SHARE * largest_multiplier);
    over = choose(s->missing > 0, all(INFINITY), over);
    const vi good = (dual < DUAL_TOLERANCE) & (largest < GAP_TOLERANCE) & (over < ROW_TOLERANCE);
    const vi hopeless = first & (dual < HOPELESS_DUAL) & (s->barrier < HOPELESS_BARRIER)
        & (over > HOPELESS_RATIO * s->barrier);
    s->status = choose_i(taken & good & ~first, all_i(CONVERGED), s->status);
    s->status = choose_i(taken & hopeless, all_i(INFEASIBLE), s->status);
    const vi tired = (s->evaluations >= MAX_EVALUATIONS) | (s->late >= MAX_LATE);
    s->status = choose_i((s->status == 0) & tired, all_i(STOPPED), s->status);
    const vi leaves = taken & ~first & pressed & (s->barrier <= PENALTY_BARRIER) & (over > UNMET_RATIO * s->barrier);
    const vi comes = taken & s->restoring & (over <= MET);
    const vi again = (leaves | comes) & (s->status == 0);
    if (any(again)) {
        s->next_penalty = choose(leaves, v_min(PENALTY_FACTOR * s->penalty, all(LAST_PENALTY)), s->next_penalty);
        s->restoring = (s->restoring | leaves) & ~comes;
        begin(s, again, totals);
    }
    EACH(i, BARRIER_CUTS) {
        const vd error = v_max(dual, v_max(largest - s->barrier, s->barrier - least));
        const vd smaller = v_min(BARRIER_FACTOR * s->barrier, s->barrier * v_sqrt(s->barrier));
        const vi lower = taken & ~again & (error < BARRIER_ERROR * s->barrier);
        s->barrier = choose(lower, v_max(all(LEAST_BARRIER), smaller), s->barrier);
    }
    return again;
}

/* Factors L and one over D of shifted matrices; returns which are positive definite. */
INLINE vi factorise(MATRIX(matrix), vd shift, MATRIX(factor), vd *inverses) {
    vi good = all_i(-1);
    EACH(a, N + 1) {
        vd scaled[MOST_N + 1];
        EACH(b, a) {
            vd entry = matrix[a][b];
            EACH(c, b) entry -= scaled[c] * factor[b][c];
            scaled[b] = entry;
            factor[a][b] = entry * inverses[b];
        }
        vd pivot = matrix[a][a] + shift;
        const vd least = LEAST_PIVOT * v_abs(pivot);
        EACH(b, a) pivot -= scaled[b] * factor[a][b];
        good &= pivot > least;
        inverses[a] = 1.0 / pivot;
    }
    return good;
}

static void solve_shifted(MATRIX(matrix), const vd *right, vd shift, vi wanted, vd *result) {
    MATRIX(factor);
    vd inverses[MOST_N + 1];
    for (;;) {
        const vi again = wanted & ~factorise(matrix, shift, factor, inverses) & (shift <= LARGEST_SHIFT);
        if (!any(again)) break;
        shift = choose(again, choose(shift > 0.0, SHIFT_GROWTH * shift, all(FIRST_SHIFT)), shift);
    }
    EACH(a, N + 1) {
        result[a] = right[a];
        EACH(b, a) result[a] -= factor[a][b] * result[b];
    }
    for (int a = N; a >= 0; a--) {
        result[a] *= inverses[a];
        for (int b = a + 1; b <= N; b++) result[a] -= factor[b][a] * result[b];
    }
}

INLINE vd add_curvature(MATRIX(matrix), const vd *hessian, const vi *free) {
    vd total = all(0.0);
    EACH(k, CURVATURES) total += hessian[k];
    const vi strange = ~is_finite(total);
    EACH(k, CURVATURES) {
        const int a = shape->curvature[2 * k], b = shape->curvature[2 * k + 1];
        matrix[a][b] += keep(~strange & free[a] & free[b], hessian[k]);
    }
    return keep(strange, all(UNKNOWN_SHIFT));
}

/* A first step that was refused is corrected by what the rows at the trial point differ from their linear forecast. */
static void direct(State *s, vi taken, vi bent, const vd *jacobian, const vd *hessian, const vd *slopes,
                   const vd *values) {
    MATRIX(matrix);
    vd own[MOST_ROWS], stiffness[MOST_ROWS], weights[MOST_ROWS], inverse[MOST_ROWS], gradient[MOST_N + 1];
    vd direction[MOST_N + 1], moved[MOST_ROWS], low[MOST_N], high[MOST_N], by_low[MOST_N], by_high[MOST_N];
    const vd usual = least_of(s);
    const vi first = first_phase(s, s->missing);
    vd along_t = s->t_weight, merit = all(0.0);
    Logarithms logs = {all(1.0), all(0.0), 0};
    EACH(r, ROWS) {
        vd slack, excess;
        const vd least = least_in(r, usual), total = total_of(s->values[r], least);
        merit += row_merit(s, r, s->values[r], total, least);
        add_logarithm(&logs, total);
        split(s->values[r], total, least, price(s, r), &slack, &excess, &own[r]);
        s->multipliers[r] = bring_in(s, r, own[r]);
        const vd rest = price(s, r) - s->multipliers[r], both = s->multipliers[r] * rest;
        const vd sum = slack * rest + excess * s->multipliers[r], one_over = 1.0 / (both * sum);
        inverse[r] = sum * one_over;
        stiffness[r] = both * both * one_over;
        weights[r] = sign(s, r, own[r]);
        along_t -= slopes[r] * weights[r];
        if (r >= CONSTRAINTS) weights[r] += keep(~first, s->weights[r - CONSTRAINTS]);
    }
    transposed(jacobian, weights, gradient);
    EACH(a, N) {
        const vd b = below(s, s->y, a), h = above(s, s->y, a), one_over = 1.0 / (b * h);
        by_low[a] = h * one_over;
        by_high[a] = b * one_over;
        low[a] = s->barrier * by_low[a];
        high[a] = s->barrier * by_high[a];
        s->low_dual[a] = within(s->low_dual[a], low[a]);
        s->high_dual[a] = within(s->high_dual[a], high[a]);
        gradient[a] += high[a] - low[a];
    }
    const vi held = ~s->t_free | first;
    gradient[N] = keep(~held, along_t);
    gram(jacobian, slopes, stiffness, matrix);
    const vd shift = add_curvature(matrix, hessian, s->free);
    EACH(a, N) matrix[a][a] += s->low_dual[a] * by_low[a] + s->high_dual[a] * by_high[a];
    matrix[N][N] += keep(held, all(1.0));
    vd right[MOST_N + 1];
    EACH(a, N + 1) right[a] = gradient[a];
    if (any(bent)) {
        vd off[MOST_ROWS], off_gradient[MOST_N], off_t = all(0.0);
        EACH(r, ROWS) {
            off[r] = stiffness[r] * (values[r] - s->forecast[r]);
            off_t -= slopes[r] * off[r];
        }
        transposed(jacobian, off, off_gradient);
        EACH(a, N) right[a] = choose(bent, off_gradient[a], right[a]);
        right[N] = choose(bent, keep(~held, off_t), right[N]);
    }
    solve_shifted(matrix, right, shift, taken | bent, direction);
    EACH(a, N + 1) direction[a] = -direction[a];
    moved_by(jacobian, slopes, direction, moved);
    /* The largest share of the step that keeps everything positive; each row is a rate of decrease. */
    vd primal = all(0.0), dual = all(0.0), slope = all(0.0);
    EACH(r, ROWS) {
        const vd change = own[r] - s->multipliers[r] + stiffness[r] * moved[r];
        const vd by_multiplier = (price(s, r) - s->multipliers[r]) * inverse[r];
        primal = v_max(primal, 1.0 + (change - own[r]) * by_multiplier);
        dual = v_max(dual, v_max(-change * by_multiplier, change * s->multipliers[r] * inverse[r]));
        s->change[r] = choose(taken, change, s->change[r]);
    }
    EACH(a, N) {
        const vd low_change = low[a] - s->low_dual[a] * (1.0 + direction[a] * by_low[a]);
        const vd high_change = high[a] - s->high_dual[a] * (1.0 - direction[a] * by_high[a]);
        primal = v_max(primal, v_max(-direction[a] * by_low[a], direction[a] * by_high[a]));
        const vd one_over = 1.0 / (s->low_dual[a] * s->high_dual[a]);
        dual = v_max(dual, -v_min(low_change * s->high_dual[a], high_change * s->low_dual[a]) * one_over);
        s->low_change[a] = choose(taken, low_change, s->low_change[a]);
        s->high_change[a] = choose(taken, high_change, s->high_change[a]);
    }
    const vd by_step = 1.0 / choose(s->step > 0.0, s->step, all(1.0));
    EACH(a, N + 1) {
        slope += gradient[a] * direction[a];
        const vd other = s->uncorrected[a] + keep(bent, direction[a] * by_step);
        s->direction[a] = choose(taken, direction[a], other);
        s->uncorrected[a] = choose(taken, direction[a], s->uncorrected[a]);
    }
    const vd nearly = v_max(all(TO_BOUNDARY), 1.0 - s->barrier);
    merit += other_merit(s, s->y, s->t, s->form, s->missing, &logs);
    s->merit = choose(taken, merit, s->merit);
    s->slope = choose(taken, slope, s->slope);
    s->step = choose(taken, nearly / v_max(nearly, primal), choose(bent, s->step, BACKTRACKING * s->step));
    EACH(r, ROWS) s->forecast[r] = choose(taken, s->values[r] + s->step * moved[r], s->forecast[r]);
    s->dual_step = choose(taken, nearly / v_max(nearly, dual), s->dual_step);
}

static void advance(State *s) {
    vd y[MOST_N], form[MOST_ROWS], values[MOST_ROWS], multipliers[MOST_ROWS], weights[MOST_ROWS], slopes[MOST_ROWS];
    vd totals[MOST_ROWS], jacobian[MOST_NONZEROS], hessian[MOST_CURVATURES];
    vi absent[MOST_ROWS];
    EACH(a, N) y[a] = s->y[a] + s->step * s->direction[a];
    const vd t = s->t + s->step * s->direction[N];
    EACH(r, ROWS) {
        multipliers[r] = s->multipliers[r] + s->dual_step * s->change[r];
        weights[r] = keep(s->counts[r] & ~s->absent[r], sign(s, r, multipliers[r]));
        if (r >= CONSTRAINTS) weights[r] += keep(~first_phase(s, s->missing), s->weights[r - CONSTRAINTS]);
    }
    point(y, weights, s->stored, form, jacobian, hessian);
    const vi missing = absent_of(s, form, jacobian, absent);
    values_of(s, form, t, absent, missing, values);
    const vd merit = merit_of(s, y, t, form, values, missing, totals);
    const vd enough = s->merit + ARMIJO * s->step * s->slope + ROUNDING * (1.0 + v_abs(s->merit));
    const vi fresh = s->busy & (missing < s->missing);
    const vi taken = fresh | (s->busy & (missing == s->missing) & (merit <= enough));
    EACH(r, ROWS) {
        s->form[r] = choose(taken, form[r], s->form[r]);
        s->values[r] = choose(taken, values[r], s->values[r]);
        s->absent[r] = choose_i(taken, absent[r], s->absent[r]);
        s->multipliers[r] = choose(taken, multipliers[r], s->multipliers[r]);
    }
    EACH(a, N) {
        s->y[a] = choose(taken, y[a], s->y[a]);
        s->low_dual[a] = choose(taken, s->low_dual[a] + s->dual_step * s->low_change[a], s->low_dual[a]);
        s->high_dual[a] = choose(taken, s->high_dual[a] + s->dual_step * s->high_change[a], s->high_dual[a]);
    }
    s->t = choose(taken, t, s->t);
    s->missing = choose_i(taken, missing, s->missing);
    s->evaluations += 1;
    s->late -= s->barrier <= LATE_BARRIER;
    s->rejected = choose_i(taken, all_i(0), s->rejected + 1);
    if (any(fresh)) begin(s, fresh, totals);
    EACH(r, ROWS) slopes[r] = keep(~idle(s, absent, missing, r) & ~first_phase(s, missing), s->slopes[r]);
    const vi changed = judge(s, taken, jacobian, slopes, totals);
    const vi bent = s->busy & (s->rejected == 1) & (missing == s->missing) & is_finite(merit);
    direct(s, taken, bent, jacobian, hessian, slopes, values);
    const vi stuck = ~taken & (s->rejected > MAX_REJECTED) & (s->status == 0);
    s->status = choose_i(stuck & (s->barrier <= STUCK_BARRIER), all_i(STUCK), s->status);
    const vi smaller = stuck & (s->status == 0), again = changed | smaller;
    s->barrier = choose(smaller, v_max(all(LEAST_BARRIER), STUCK_FACTOR * s->barrier), s->barrier);
    s->merit = choose(again, all(INFINITY), s->merit);
    s->step = choose(again, all(0.0), s->step);
    s->dual_step = choose(again, all(0.0), s->dual_step);
    s->rejected = choose_i(again, all_i(0), s->rejected);
}

static void load(State *s, const Problems *p, int l, long long number) {
    const long long count = p->count;
    s->number[l] = number;
    s->busy[l] = -1;
    EACH(k, STORED) s->stored[k][l] = p->stored[k][number * p->stored_steps[k]];
    s->t_weight[l] = p->t_weight[number];
    s->t_free[l] = 0;
    EACH(r, ROWS) {
        const int counts = p->counts[r * count + number] != 0;
        s->counts[r][l] = -counts;
        s->slopes[r][l] = counts && s->t_weight[l] != 0.0 ? p->slopes[r * count + number] : 0.0;
        s->rights[r][l] = p->rights[r * count + number];
        if (s->slopes[r][l] != 0.0) s->t_free[l] = -1;
        s->form[r][l] = s->values[r][l] = s->multipliers[r][l] = s->change[r][l] = s->forecast[r][l] = 0.0;
        s->absent[r][l] = -1;
    }
    EACH(k, GOALS) s->weights[k][l] = p->weights[k * count + number];
    EACH(a, N) {
        const double low = p->low[a * count + number], high = p->high[a * count + number], width = high - low;
        const int free = width > PINNED_WIDTH;
        const double inside = fmin(fmax(p->start[a * count + number], low + INSIDE * width), high - INSIDE * width);
        s->low[a][l] = low;
        s->high[a][l] = high;
        s->free[a][l] = -free;
        s->y[a][l] = free ? inside : 0.5 * (low + high);
        s->low_dual[a][l] = s->high_dual[a][l] = s->low_change[a][l] = s->high_change[a][l] = 0.0;
    }
    EACH(a, N + 1) s->direction[a][l] = s->uncorrected[a][l] = 0.0;
    s->t[l] = s->merit[l] = s->slope[l] = s->step[l] = s->dual_step[l] = 0.0;
    s->barrier[l] = FIRST_BARRIER;
    s->penalty[l] = s->next_penalty[l] = FIRST_PENALTY;
    s->restoring[l] = 0;
    s->missing[l] = ROWS + 2;
    s->rejected[l] = s->evaluations[l] = s->late[l] = s->status[l] = 0;
}

static void unload(const State *s, const Problems *p, int l) {
    const long long count = p->count, number = s->number[l];
    EACH(a, N) p->y[a * count + number] = s->y[a][l];
    p->t[number] = s->t[l];
    EACH(r, ROWS) {
        const double multiplier = EQUAL[r] ? s->multipliers[r][l] - s->penalty[l] : s->multipliers[r][l];
        p->rows[r * count + number] = s->form[r][l];
        p->multipliers[r * count + number] = s->counts[r][l] && !s->absent[r][l] ? multiplier : 0.0;
    }
    p->status[number] = s->status[l];
    p->evaluations[number] = s->evaluations[l];
}

void solve(const Problems *p, const Shape *given) {
    State s;
    long long waiting = 0;
    int busy = 0;
    memset(&s, 0, sizeof s);
    vd file[given->slots];
    shape = given;
    slots = file;
    s.stored = file + given->constants;
    EACH(k, given->slots) file[k] = all(0.0);
    EACH(k, given->constants) file[k] = all(given->constant[k]);
    for (;;) {
        for (int l = 0; l < LANES && waiting < p->count; l++)
            if (!s.busy[l]) { load(&s, p, l, waiting++); busy++; }
        if (!busy) return;
        advance(&s);
        for (int l = 0; l < LANES; l++)
            if (s.busy[l] && s.status[l]) { unload(&s, p, l); s.busy[l] = 0; busy--; }
    }
}
