/* The margins by which ends are moved outward, for single ends and for registers of them. */

static inline double end_below(double end, double relative, double absolute) {
    const double less = end * (1.0 - relative), more = end * (1.0 + relative);
    return (less < more ? less : more) - absolute;
}
static inline double end_above(double end, double relative, double absolute) {
    const double less = end * (1.0 - relative), more = end * (1.0 + relative);
    return (less > more ? less : more) + absolute;
}
INLINE vd ends_above(vd ends, double relative, double absolute) {
    return v_max(ends * (1.0 + relative), ends * (1.0 - relative)) + absolute;
}
