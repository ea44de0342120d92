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
#define LABELS &&L_END, &&L_END_IF_DEAD, &&L_HOLD, &&L_IN_ORDER, &&L_PRODUCT_BACK, &&L_QUOTIENT_BACK, &&L_SUM_BACK, &&L_DIFFERENCE_BACK, &&L_AT_MOST, &&L_AT_LEAST, &&L_SUM, &&L_DIFFERENCE, &&L_TERM_BACK, &&L_ROOT, &&L_MEET, &&L_CROSSED, &&L_16, &&L_17, &&L_18, &&L_19, &&L_20, &&L_21, &&L_22, &&L_23, &&L_24, &&L_25, &&L_26, &&L_27, &&L_28, &&L_29, &&L_30, &&L_31, &&L_32, &&L_33, &&L_34, &&L_35, &&L_36, &&L_37, &&L_38, &&L_39, &&L_40, &&L_41, &&L_42, &&L_43, &&L_44, &&L_45, &&L_46, &&L_47, &&L_48, &&L_49, &&L_50, &&L_51, &&L_52, &&L_53, &&L_54, &&L_55, &&L_56, &&L_57, &&L_58, &&L_59, &&L_60, &&L_61, &&L_62, &&L_63, &&L_64, &&L_65, &&L_66, &&L_67, &&L_68, &&L_69, &&L_70, &&L_71, &&L_72, &&L_73, &&L_74, &&L_75, &&L_76, &&L_77, &&L_78, &&L_79, &&L_80, &&L_81, &&L_82, &&L_83, &&L_84, &&L_85, &&L_86, &&L_87, &&L_88, &&L_89, &&L_90, &&L_91, &&L_92, &&L_93, &&L_94, &&L_95, &&L_96, &&L_97, &&L_98, &&L_99, &&L_100, &&L_101, &&L_102, &&L_103, &&L_104, &&L_105, &&L_106, &&L_107, &&L_108, &&L_109, &&L_110, &&L_111, &&L_112, &&L_113, &&L_114, &&L_115, &&L_116, &&L_117, &&L_118, &&L_119, &&L_120, &&L_121, &&L_122, &&L_123, &&L_124, &&L_125, &&L_126, &&L_127, &&L_128, &&L_129, &&L_130, &&L_131
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
