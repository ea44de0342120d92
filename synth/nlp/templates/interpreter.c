/* What makes the solver one for all row functions: formulas are carried out instruction by instruction, from a list.
   The definitions stand at the place FORMULAS in solver.c. What is between the braces of a function in capitals stands at
   the place of the same name there, where it finds the names that it uses. */

typedef struct {
    /* Slots hold constants, stored nodes, variables, weights and results, in this order. */
    int n, rows, constraints, goals, nonzeros, curvatures, stored, slots, constants, steps, terms;
    const int *equal, *guard, *row, *column, *curvature, *term, *code, *output;
    const double *constant;
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

void POINT(void) {
    vd *const r = slots;
    vd *const inputs = r + shape->constants + STORED;
    EACH(a, N) inputs[a] = y[a];
    EACH(k, ROWS) inputs[N + k] = weights[k];
    const int *code = shape->code;
    for (int k = shape->steps; k > 0; k--, code += WIDTH) {
        const vd a = r[code[2]], b = r[code[3]];
        vd result;
        switch (code[0]) {
/*CASES*/
        default: result = all(NAN);
        }
        r[code[1]] = result;
    }
    const int *from = shape->output;
    EACH(k, ROWS) form[k] = r[*from++];
    EACH(k, NONZEROS) jacobian[k] = r[*from++];
    EACH(k, CURVATURES) hessian[k] = r[*from++];
}

void TRANSPOSED(void) {
    EACH(a, N) result[a] = all(0.0);
    EACH(k, NONZEROS) result[COLUMN[k]] += jacobian[k] * vector[ROW[k]];
}

void TIMES(void) {
    EACH(r, ROWS) result[r] = -slopes[r] * direction[N];
    EACH(k, NONZEROS) result[ROW[k]] += jacobian[k] * direction[COLUMN[k]];
}

void GRAM(void) {
    vd weighted[MOST_NONZEROS];
    EACH(k, NONZEROS) weighted[k] = jacobian[k] * vector[ROW[k]];
    EACH(a, N + 1) EACH(b, a + 1) matrix[a][b] = all(0.0);
    const int *term = shape->term;
    for (int k = shape->terms; k > 0; k--, term += 4) matrix[term[0]][term[1]] += weighted[term[2]] * jacobian[term[3]];
    EACH(k, NONZEROS) matrix[N][COLUMN[k]] -= weighted[k] * slopes[ROW[k]];
    EACH(r, ROWS) matrix[N][N] += vector[r] * slopes[r] * slopes[r];
}

void CURVATURE(void) {
    EACH(k, CURVATURES) {
        const int a = shape->curvature[2 * k], b = shape->curvature[2 * k + 1];
        matrix[a][b] += keep(~strange & free[a] & free[b], hessian[k]);
    }
}

void BEGIN(void) {
    vd file[given->slots];
    shape = given;
    slots = file;
    s.stored = file + given->constants;
    EACH(k, given->slots) file[k] = all(0.0);
    EACH(k, given->constants) file[k] = all(given->constant[k]);
}
