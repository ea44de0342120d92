/* Made by `make kernels`; edits are lost. */
#define WIDTH 5
#define MOST_N 24
#define MOST_ROWS 96
#define MOST_GOALS 40
#define MOST_NONZEROS 1024
#define MOST_CURVATURES 300
#define CONVERGED 1
#define INFEASIBLE 2
#define STUCK 3
#define STOPPED 4
#define MAX_EVALUATIONS ((long long)shape->method[0])
#define MAX_LATE ((long long)shape->method[1])
#define LATE_BARRIER (shape->method[2])
#define DUAL_TOLERANCE (shape->method[3])
#define GAP_TOLERANCE (shape->method[4])
#define ROW_TOLERANCE (shape->method[5])
#define MULTIPLIER_SHARE (shape->method[6])
#define FIRST_BARRIER (shape->method[7])
#define LEAST_BARRIER (shape->method[8])
#define BARRIER_ERROR (shape->method[9])
#define BARRIER_FACTOR (shape->method[10])
#define BARRIER_CUTS ((long long)shape->method[11])
#define FIRST_PENALTY (shape->method[12])
#define LAST_PENALTY (shape->method[13])
#define PENALTY_FACTOR (shape->method[14])
#define PRESSED_SHARE (shape->method[15])
#define UNMET_RATIO (shape->method[16])
#define PENALTY_BARRIER (shape->method[17])
#define MET (shape->method[18])
#define HOPELESS_BARRIER (shape->method[19])
#define HOPELESS_DUAL (shape->method[20])
#define HOPELESS_RATIO (shape->method[21])
#define ARMIJO (shape->method[22])
#define ROUNDING (shape->method[23])
#define BACKTRACKING (shape->method[24])
#define TO_BOUNDARY (shape->method[25])
#define MAX_REJECTED ((long long)shape->method[26])
#define STUCK_FACTOR (shape->method[27])
#define STUCK_BARRIER (shape->method[28])
#define MULTIPLIER_SPREAD (shape->method[29])
#define INSIDE (shape->method[30])
#define FIRST_ROOM (shape->method[31])
#define PINNED_WIDTH (shape->method[32])
#define LEAST_PIVOT (shape->method[33])
#define FIRST_SHIFT (shape->method[34])
#define SHIFT_GROWTH (shape->method[35])
#define LARGEST_SHIFT (shape->method[36])
#define UNKNOWN_SHIFT (shape->method[37])
#define LARGEST_ROW (shape->method[38])
