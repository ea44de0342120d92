/* Rules that are long, as functions: both ends of a node from those of others. */

#define LONG_RULE static __attribute__((noinline)) Interval
LONG_RULE forward_mul(Interval a, Interval b) { return i_mul(a, b); }
LONG_RULE forward_div(Interval a, Interval b) { return i_mul(a, i_inv(b)); }
LONG_RULE forward_inv(Interval a) { return i_inv(a); }
LONG_RULE forward_sin(Interval a) { return wave(a, v_sin(a.low), v_sin(a.high), 0.5 * PI); }
LONG_RULE forward_cos(Interval a) { return wave(a, v_cos(a.low), v_cos(a.high), 0.0); }
LONG_RULE forward_tan(Interval a) {
    return where(v_floor(a.low / PI + 0.5) == v_floor(a.high / PI + 0.5), both(v_tan(a.low), v_tan(a.high)), unknown());
}
LONG_RULE forward_cosh(Interval a) {
    const Interval size = i_abs(a);
    return both(v_cosh(size.low), v_cosh(size.high));
}
LONG_RULE forward_hypot(Interval a, Interval b) {
    const Interval x = i_abs(a), y = i_abs(b);
    return both(v_hypot(x.low, y.low), v_hypot(x.high, y.high));
}
LONG_RULE forward_atan2(Interval a, Interval b) {
    const Interval ratio = i_mul(a, i_inv(b));
    return where(b.low > 0.0, both(v_atan(ratio.low), v_atan(ratio.high)), both(all(-PI), all(PI)));
}
LONG_RULE forward_eq(Interval a, Interval b) { return equality(a, b); }
LONG_RULE forward_ne(Interval a, Interval b) {
    const Interval same = equality(a, b);
    return both(1.0 - same.high, 1.0 - same.low);
}
LONG_RULE forward_pow_constant(Interval a, Interval b) { return i_power(a, b.low[0]); }
LONG_RULE forward_pow_any(Interval a, Interval b) { return i_any_power(a, b); }
LONG_RULE sum_less(Interval r, Interval b) { return widened(both(r.low - b.high, r.high - b.low), r, b); }
LONG_RULE difference_more(Interval r, Interval b) { return widened(both(r.low + b.low, r.high + b.high), r, b); }
LONG_RULE difference_less(Interval r, Interval a) { return widened(both(a.low - r.high, a.high - r.low), r, a); }
LONG_RULE quotient(Interval a, Interval b) { return i_quotient(a, b); }
LONG_RULE backward_exp(Interval r) {
    const Interval x = blurred(r);
    return both(v_log(v_max(x.low, all(0.0))), v_log(v_max(x.high, all(0.0))));
}
LONG_RULE backward_expm1(Interval r) {
    const Interval x = blurred(r);
    return both(v_log1p(v_max(x.low, all(-1.0))), v_log1p(v_max(x.high, all(-1.0))));
}
LONG_RULE backward_pow(Interval r, Interval a, Interval b) {
    const Interval base = both(v_max(r.low, all(0.0)), v_max(r.high, all(0.0)));
    return where((a.low >= 0.0) & (b.low != 0.0), i_power(base, 1.0 / b.low[0]), nothing());
}
