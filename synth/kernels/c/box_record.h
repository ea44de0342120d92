/* Made by `make kernels`; edits are lost. */
#define WIDTH 6
#define MOST_N 24
#define MOST_LIMITS 256
#define MOST_GOALS 40
#define MOST_TABLES 256
#define MOST_NODES 1536
#define SCORE_WIDTH 16
#define CANCELLATION 1e-12
#define PI 3.141592653589793
#define TWO_PI 6.283185307179586
#define LABELS &&L_END, &&L_END_IF_DEAD, &&L_HOLD, &&L_IN_ORDER, &&L_PRODUCT_BACK, &&L_QUOTIENT_BACK, &&L_SUM_BACK, &&L_DIFFERENCE_BACK, &&L_AT_MOST, &&L_AT_LEAST, &&L_SUM, &&L_DIFFERENCE, &&L_TERM_BACK, &&L_ROOT, &&L_MEET, &&L_CROSSED, &&L_MOVE, &&L_ADD, &&L_SUB, &&L_MUL, &&L_DIV, &&L_POW, &&L_FMOD, &&L_COPYSIGN, &&L_ATAN2, &&L_HYPOT, &&L_MIN, &&L_MAX, &&L_NEG, &&L_EXP, &&L_LOG, &&L_SQRT, &&L_SIN, &&L_COS, &&L_TAN, &&L_ASIN, &&L_ACOS, &&L_ATAN, &&L_FLOOR, &&L_CEIL, &&L_ABS, &&L_SIGN, &&L_ERF, &&L_SINH, &&L_COSH, &&L_TANH, &&L_ASINH, &&L_ACOSH, &&L_ATANH, &&L_LOG1P, &&L_EXPM1, &&L_MUL_SUB, &&L_MUL_SUM, &&L_ADD_SUB_MUL, &&L_ADD_ADD_MUL, &&L_SUB_SUB_MUL, &&L_SUB_ADD_MUL, &&L_LOOSEN_UP, &&L_LOOSEN_DOWN, &&L_FMAX, &&L_FMAX_MUL, &&L_FMAX_DIV, &&L_FMAX_MUL_SUB, &&L_FMAX_SQRT, &&L_FMIN, &&L_FMIN_MUL, &&L_FMIN_DIV, &&L_FMIN_MUL_SUB, &&L_FMIN_SQRT, &&L_GT, &&L_LT, &&L_GE, &&L_LE, &&L_EQ, &&L_NE, &&L_GT_MUL, &&L_LT_MUL, &&L_NOT, &&L_AND, &&L_OR, &&L_CHOOSE, &&L_KEEP, &&L_TRUTH, &&L_KILL_ABOVE, &&L_KILL_BELOW, &&L_KILL_CROSSED, &&L_ENDS_ADD, &&L_ENDS_SUB, &&L_ENDS_MUL, &&L_ENDS_DIV, &&L_MET_ADD, &&L_MET_SUB, &&L_MET_MUL, &&L_MET_DIV, &&L_FORWARD_ADD, &&L_FORWARD_SUB, &&L_FORWARD_MUL, &&L_FORWARD_DIV, &&L_FORWARD_NEG, &&L_FORWARD_TWICE, &&L_FORWARD_SQ, &&L_FORWARD_INV, &&L_FORWARD_SQRT, &&L_FORWARD_EXP, &&L_FORWARD_EXPM1, &&L_FORWARD_LOG, &&L_FORWARD_LOG1P, &&L_FORWARD_HYPOT, &&L_FORWARD_SIN, &&L_FORWARD_COS, &&L_FORWARD_TAN, &&L_FORWARD_ASIN, &&L_FORWARD_ACOS, &&L_FORWARD_ATAN, &&L_FORWARD_ATAN2, &&L_FORWARD_SINH, &&L_FORWARD_COSH, &&L_FORWARD_TANH, &&L_FORWARD_ASINH, &&L_FORWARD_ACOSH, &&L_FORWARD_ATANH, &&L_FORWARD_FLOOR, &&L_FORWARD_CEIL, &&L_FORWARD_SIGN, &&L_FORWARD_FABS, &&L_FORWARD_FMIN, &&L_FORWARD_FMAX, &&L_FORWARD_IF_ELSE_ZERO, &&L_FORWARD_SELECT, &&L_FORWARD_LT, &&L_FORWARD_LE, &&L_FORWARD_EQ, &&L_FORWARD_NE, &&L_FORWARD_AND, &&L_FORWARD_OR, &&L_FORWARD_NOT, &&L_FORWARD_POW_CONSTANT, &&L_FORWARD_POW_ANY, &&L_WHOLE_1, &&L_WHOLE_2, &&L_WHOLE_3, &&L_BACKWARD_ADD_0, &&L_BACKWARD_ADD_1, &&L_BACKWARD_SUB_0, &&L_BACKWARD_SUB_1, &&L_BACKWARD_MUL_0, &&L_BACKWARD_MUL_1, &&L_BACKWARD_DIV_0, &&L_BACKWARD_DIV_1, &&L_BACKWARD_NEG_0, &&L_BACKWARD_TWICE_0, &&L_BACKWARD_SQ_0, &&L_BACKWARD_INV_0, &&L_BACKWARD_SQRT_0, &&L_BACKWARD_EXP_0, &&L_BACKWARD_EXPM1_0, &&L_BACKWARD_LOG_0, &&L_BACKWARD_LOG1P_0, &&L_BACKWARD_FABS_0, &&L_BACKWARD_FMIN_0, &&L_BACKWARD_FMIN_1, &&L_BACKWARD_FMAX_0, &&L_BACKWARD_FMAX_1, &&L_BACKWARD_IF_ELSE_ZERO_1, &&L_BACKWARD_SELECT_1, &&L_BACKWARD_SELECT_2, &&L_BACKWARD_POW_CONSTANT
typedef struct {
    long long count;
    long long passes;
    long long factors;
    long long goals;
    long long cutoffs_step;
    long long weights_step;
    long long bits;
    long long score_width;
    double snap;
    double pinned;
    const int *cell;
    const double *low;
    const double *high;
    const double *bounds;
    const int *tag;
    const float *scores;
    const double *cutoffs;
    const double *floors;
    const double *constants;
    const double *right_sides;
    const double *root_low;
    const double *root_high;
    const double *lower;
    const double *upper;
    const double *spans;
    const double *weights;
    const double *steep;
    const double *const *rows;
    const float *const *spreads;
    const double *const *grids;
    const long long *grid_sizes;
    const double *per_unit;
    const void *shape;
    int *out_cell;
    double *out_low;
    double *out_high;
    double *out_bounds;
    int *out_tag;
    float *out_scores;
    unsigned char *alive;
    unsigned char *undecided;
} Batch;
