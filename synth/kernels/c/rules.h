/* Interval arithmetic per register of boxes: the enclosure of each result from those of its arguments. */

typedef struct { vd low, high; } Interval;
#define RULE static Interval __attribute__((unused))
#define TRUTH(mask) keep(mask, all(1.0))
/* Of a number and not-a-number, the number; of zeros the second, as the instructions of processors have it. */
INLINE vd v_fmax(vd a, vd b) {
#if defined(__AVX512F__)
    return (vd)max_of_eight(a, known_of_eight(b), b);
#elif defined(__AVX__)
    return (vd)blend_of_four(max_of_four(a, b), a, (vd)(b != b));
#else
    return choose((a > b) | (b != b), a, b);
#endif
}
INLINE vd v_fmin(vd a, vd b) {
#if defined(__AVX512F__)
    return (vd)min_of_eight(a, known_of_eight(b), b);
#elif defined(__AVX__)
    return (vd)blend_of_four(min_of_four(a, b), a, (vd)(b != b));
#else
    return choose((a < b) | (b != b), a, b);
#endif
}
INLINE vd clipped(vd a, double low, double high) { return v_min(v_max(a, all(low)), all(high)); }
INLINE vd loosened(vd limit, vd size, double share) { return limit + share * v_max(v_abs(limit), size); }
INLINE Interval both(vd low, vd high) { Interval r = {low, high}; return r; }
INLINE Interval where(vi mask, Interval a, Interval b) {
    return both(choose(mask, a.low, b.low), choose(mask, a.high, b.high));
}
INLINE Interval unknown(void) { return both(all(-INFINITY), all(INFINITY)); }
INLINE Interval nothing(void) { return both(all(NAN), all(NAN)); }
INLINE vi holds_zero(Interval a) { return (a.low <= 0.0) & (a.high >= 0.0); }
INLINE Interval whole_of(vd sum) { return both(sum * 0.0 - INFINITY, sum * 0.0 + INFINITY); }
/* In place: a call, with registers put away, takes about as long as what it does. */
INLINE Interval i_mul(Interval a, Interval b) {
    const vi m = a.low >= 0.0, n = b.low >= 0.0, either = m | n;
    const vd p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    const vd low = v_min(v_min(p, choose(m, p, q)), v_min(choose(n, p, r), choose(either, p, s)));
    const vd high = v_max(v_max(s, choose(n, s, q)), v_max(choose(m, s, r), choose(either, s, p)));
    return both(low, high);
}
INLINE Interval i_inv(Interval a) {
    const vi positive = a.low >= 0.0, negative = a.high <= 0.0;
    const vd low = choose(a.low == 0.0, all(0.0), a.low), high = choose(a.high == 0.0, all(-0.0), a.high);
    return both(choose(positive, 1.0 / a.high, choose(negative, 1.0 / high, all(-INFINITY))),
                choose(positive, 1.0 / low, choose(negative, 1.0 / a.low, all(INFINITY))));
}
RULE i_abs(Interval a) {
    const vd p = v_abs(a.low), q = v_abs(a.high);
    return both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q));
}
RULE i_sq(Interval a) {
    const vd p = a.low * a.low, q = a.high * a.high;
    const vi positive = a.low >= 0.0;
    return where(positive, both(p, q), both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q)));
}
RULE i_quotient(Interval a, Interval b) {
    return where((b.low > 0.0) | (b.high < 0.0), i_mul(a, i_inv(b)), unknown());
}
INLINE vd extent(Interval a) { return v_max(v_abs(a.low), v_abs(a.high)); }
INLINE Interval blurred(Interval r) {
    return both(r.low - CANCELLATION * v_abs(r.low), r.high + CANCELLATION * v_abs(r.high));
}
INLINE Interval widened(Interval r, Interval a, Interval b) {
    const vd size = extent(a) + extent(b);
    const vd blur = keep(is_finite(size), CANCELLATION * size);
    return both(r.low - blur, r.high + blur);
}
/* A power with one exponent for all boxes. */
RULE i_power(Interval a, double n) {
    vd p = v_pow(a.low, all(n)), q = v_pow(a.high, all(n));
    const vi positive = a.low >= 0.0;
    const Interval plain = n >= 0.0 ? both(p, q) : both(q, p);
    if (!any(~positive)) return plain;
    if (n != floor(n) || !isfinite(n)) return where(positive, plain, whole_of(a.low + n));
    if (n < 0.0) { p = v_pow(a.low, all(-n)); q = v_pow(a.high, all(-n)); }
    Interval signed_one = both(p, q);
    if (n != 0.0 && fmod(n, 2.0) == 0.0)
        signed_one = both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q));
    return where(positive, plain, n < 0.0 ? i_inv(signed_one) : signed_one);
}
/* A power with an exponent per box. */
RULE i_any_power(Interval a, Interval b) {
    const vd p = v_pow(a.low, b.low), q = v_pow(a.low, b.high), r = v_pow(a.high, b.low), s = v_pow(a.high, b.high);
    return where(a.low >= 0.0, both(v_min(v_min(p, q), v_min(r, s)), v_max(v_max(p, q), v_max(r, s))),
                 whole_of(a.low + b.low));
}
INLINE vi passes_by(Interval a, double at) {
    return v_floor((a.high - at) / TWO_PI) >= v_ceil((a.low - at) / TWO_PI);
}
INLINE Interval wave(Interval a, vd p, vd q, double top) {
    return both(choose(passes_by(a, top + PI), all(-1.0), v_min(p, q)),
                choose(passes_by(a, top), all(1.0), v_max(p, q)));
}
INLINE Interval equality(Interval a, Interval b) {
    const vi sure = (a.low == a.high) & (b.low == b.high) & (a.low == b.low);
    return both(TRUTH(sure), 1.0 - TRUTH((a.low > b.high) | (b.low > a.high)));
}
