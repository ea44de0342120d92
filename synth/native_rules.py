"""The rules of interval propagation in C: what :mod:`synth.intervals` says of an operation, for a register of boxes.

Every rule decides per box what the NumPy rule decides for all of a batch, so that no box depends on its neighbours.
Not-a-number means that nothing is known, here too.
"""

from __future__ import annotations

import math

import casadi as ca

from synth.intervals import CANCELLATION, SLACK
from synth.program import OP_SELECT

COMMON = rf"""
typedef struct {{ vd low, high; }} Interval;
#define RULE static Interval __attribute__((unused))
#define TRUTH(mask) keep(mask, all(1.0))
/* Of a number and not-a-number, the number. */
INLINE vd v_fmax(vd a, vd b) {{
#if defined(__AVX512F__)
    const __mmask8 known = _mm512_cmp_pd_mask((__m512d)b, (__m512d)b, _CMP_ORD_Q);
    return (vd)_mm512_mask_max_pd((__m512d)a, known, (__m512d)a, (__m512d)b);
#elif defined(__AVX__)
    return (vd)blend_of_four(max_of_four(a, b), a, (vd)(b != b));
#else
    return choose((a >= b) | (b != b), a, b);
#endif
}}
INLINE vd v_fmin(vd a, vd b) {{
#if defined(__AVX512F__)
    const __mmask8 known = _mm512_cmp_pd_mask((__m512d)b, (__m512d)b, _CMP_ORD_Q);
    return (vd)_mm512_mask_min_pd((__m512d)a, known, (__m512d)a, (__m512d)b);
#elif defined(__AVX__)
    return (vd)blend_of_four(min_of_four(a, b), a, (vd)(b != b));
#else
    return choose((a <= b) | (b != b), a, b);
#endif
}}
INLINE vd clipped(vd a, double low, double high) {{ return v_min(v_max(a, all(low)), all(high)); }}
INLINE vd loosened(vd limit, double scale, int side) {{
    return limit + side * {SLACK!r} * v_max(v_abs(limit), all(scale));
}}
INLINE Interval both(vd low, vd high) {{ Interval r = {{low, high}}; return r; }}
INLINE Interval where(vi mask, Interval a, Interval b) {{
    return both(choose(mask, a.low, b.low), choose(mask, a.high, b.high));
}}
INLINE Interval unknown(void) {{ return both(all(-INFINITY), all(INFINITY)); }}
INLINE Interval nothing(void) {{ return both(all(NAN), all(NAN)); }}
INLINE vi holds_zero(Interval a) {{ return (a.low <= 0.0) & (a.high >= 0.0); }}
INLINE Interval whole_of(vd sum) {{ return both(sum * 0.0 - INFINITY, sum * 0.0 + INFINITY); }}
RULE i_mul(Interval a, Interval b) {{
    const vi m = a.low >= 0.0, n = b.low >= 0.0, either = m | n;
    const vd p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    const vd low = v_min(v_min(p, choose(m, p, q)), v_min(choose(n, p, r), choose(either, p, s)));
    const vd high = v_max(v_max(s, choose(n, s, q)), v_max(choose(m, s, r), choose(either, s, p)));
    return both(low, high);
}}
RULE i_inv(Interval a) {{
    const vi positive = a.low >= 0.0, negative = a.high <= 0.0;
    const vd low = choose(a.low == 0.0, all(0.0), a.low), high = choose(a.high == 0.0, all(-0.0), a.high);
    return both(choose(positive, 1.0 / a.high, choose(negative, 1.0 / high, all(-INFINITY))),
                choose(positive, 1.0 / low, choose(negative, 1.0 / a.low, all(INFINITY))));
}}
RULE i_abs(Interval a) {{
    const vd p = v_abs(a.low), q = v_abs(a.high);
    return both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q));
}}
RULE i_sq(Interval a) {{
    const vd p = a.low * a.low, q = a.high * a.high;
    const vi positive = a.low >= 0.0;
    return where(positive, both(p, q), both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q)));
}}
RULE i_quotient(Interval a, Interval b) {{
    return where((b.low > 0.0) | (b.high < 0.0), i_mul(a, i_inv(b)), unknown());
}}
INLINE vd extent(Interval a) {{ return v_max(v_abs(a.low), v_abs(a.high)); }}
INLINE Interval blurred(Interval r) {{
    return both(r.low - {CANCELLATION!r} * v_abs(r.low), r.high + {CANCELLATION!r} * v_abs(r.high));
}}
INLINE Interval widened(Interval r, Interval a, Interval b) {{
    const vd size = extent(a) + extent(b);
    const vd blur = keep(is_finite(size), {CANCELLATION!r} * size);
    return both(r.low - blur, r.high + blur);
}}
/* A power with one exponent for all boxes. */
RULE i_power(Interval a, double n) {{
    vd p = v_pow(a.low, all(n)), q = v_pow(a.high, all(n));
    const vi positive = a.low >= 0.0;
    const Interval plain = n >= 0.0 ? both(p, q) : both(q, p);
    if (!any(~positive)) return plain;
    if (n != floor(n) || !isfinite(n)) return where(positive, plain, whole_of(a.low + n));
    if (n < 0.0) {{ p = v_pow(a.low, all(-n)); q = v_pow(a.high, all(-n)); }}
    Interval signed_one = both(p, q);
    if (n != 0.0 && fmod(n, 2.0) == 0.0)
        signed_one = both(choose(holds_zero(a), all(0.0), v_min(p, q)), v_max(p, q));
    return where(positive, plain, n < 0.0 ? i_inv(signed_one) : signed_one);
}}
/* A power with an exponent per box. */
RULE i_any_power(Interval a, Interval b) {{
    const vd p = v_pow(a.low, b.low), q = v_pow(a.low, b.high), r = v_pow(a.high, b.low), s = v_pow(a.high, b.high);
    return where(a.low >= 0.0, both(v_min(v_min(p, q), v_min(r, s)), v_max(v_max(p, q), v_max(r, s))),
                 whole_of(a.low + b.low));
}}
INLINE vi passes_by(Interval a, double at) {{
    return v_floor((a.high - at) / {2 * math.pi!r}) >= v_ceil((a.low - at) / {2 * math.pi!r});
}}
INLINE Interval wave(Interval a, vd p, vd q, double top) {{
    return both(choose(passes_by(a, top + {math.pi!r}), all(-1.0), v_min(p, q)),
                choose(passes_by(a, top), all(1.0), v_max(p, q)));
}}
INLINE Interval equality(Interval a, Interval b) {{
    const vi sure = (a.low == a.high) & (b.low == b.high) & (a.low == b.low);
    return both(TRUTH(sure), 1.0 - TRUTH((a.low > b.high) | (b.low > a.high)));
}}
"""


def _rising(name: str) -> str:
    return f"both({name}(a.low), {name}(a.high))"


def _on_domain(name: str, low: str, high: str) -> str:
    return f"both({name}(clipped(a.low, {low}, {high})), {name}(clipped(a.high, {low}, {high})))"


# Per operation: the enclosure from those of the arguments a, b and c.
FORWARD: dict[int, str] = {
    ca.OP_ADD: "both(a.low + b.low, a.high + b.high)",
    ca.OP_SUB: "both(a.low - b.high, a.high - b.low)",
    ca.OP_MUL: "i_mul(a, b)",
    ca.OP_DIV: "i_mul(a, i_inv(b))",
    ca.OP_NEG: "both(-a.high, -a.low)",
    ca.OP_SQ: "i_sq(a)",
    ca.OP_TWICE: "both(2.0 * a.low, 2.0 * a.high)",
    ca.OP_EXP: _rising("v_exp"),
    ca.OP_LOG: _on_domain("v_log", "0.0", "INFINITY"),
    ca.OP_LOG1P: _on_domain("v_log1p", "-1.0", "INFINITY"),
    ca.OP_EXPM1: _rising("v_expm1"),
    ca.OP_SQRT: _on_domain("v_sqrt", "0.0", "INFINITY"),
    ca.OP_INV: "i_inv(a)",
    ca.OP_FABS: "i_abs(a)",
    ca.OP_SIN: f"wave(a, v_sin(a.low), v_sin(a.high), {math.pi / 2!r})",
    ca.OP_COS: "wave(a, v_cos(a.low), v_cos(a.high), 0.0)",
    ca.OP_TAN: (
        f"where(v_floor(a.low / {math.pi!r} + 0.5) == v_floor(a.high / {math.pi!r} + 0.5), "
        f"{_rising('v_tan')}, unknown())"
    ),
    ca.OP_ASIN: _on_domain("v_asin", "-1.0", "1.0"),
    ca.OP_ACOS: "both(v_acos(clipped(a.high, -1.0, 1.0)), v_acos(clipped(a.low, -1.0, 1.0)))",
    ca.OP_ATAN: _rising("v_atan"),
    ca.OP_SINH: _rising("v_sinh"),
    ca.OP_COSH: "both(v_cosh(i_abs(a).low), v_cosh(i_abs(a).high))",
    ca.OP_TANH: _rising("v_tanh"),
    ca.OP_ASINH: _rising("v_asinh"),
    ca.OP_ACOSH: _on_domain("v_acosh", "1.0", "INFINITY"),
    ca.OP_ATANH: _on_domain("v_atanh", "-1.0", "1.0"),
    ca.OP_FLOOR: _rising("v_floor"),
    ca.OP_CEIL: _rising("v_ceil"),
    ca.OP_SIGN: _rising("v_sign"),
    ca.OP_FMIN: "both(v_min(a.low, b.low), v_min(a.high, b.high))",
    ca.OP_FMAX: "both(v_max(a.low, b.low), v_max(a.high, b.high))",
    ca.OP_HYPOT: "both(v_hypot(i_abs(a).low, i_abs(b).low), v_hypot(i_abs(a).high, i_abs(b).high))",
    ca.OP_ATAN2: (
        "where(b.low > 0.0, both(v_atan(i_mul(a, i_inv(b)).low), v_atan(i_mul(a, i_inv(b)).high)), "
        f"both(all({-math.pi!r}), all({math.pi!r})))"
    ),
    ca.OP_LT: "both(TRUTH(a.high < b.low), 1.0 - TRUTH(a.low >= b.high))",
    ca.OP_LE: "both(TRUTH(a.high <= b.low), 1.0 - TRUTH(a.low > b.high))",
    ca.OP_EQ: "equality(a, b)",
    ca.OP_NE: "both(1.0 - equality(a, b).high, 1.0 - equality(a, b).low)",
    ca.OP_NOT: "both(1.0 - a.high, 1.0 - a.low)",
    ca.OP_AND: "both(a.low * b.low, a.high * b.high)",
    ca.OP_OR: "both(v_max(a.low, b.low), v_max(a.high, b.high))",
    ca.OP_IF_ELSE_ZERO: (
        "both(choose(a.low > 0.5, b.low, keep(a.high > 0.5, v_min(b.low, all(0.0)))), "
        "choose(a.low > 0.5, b.high, keep(a.high > 0.5, v_max(b.high, all(0.0)))))"
    ),
    OP_SELECT: (
        "both(choose(a.low > 0.5, b.low, choose(a.high < 0.5, c.low, v_min(b.low, c.low))), "
        "choose(a.low > 0.5, b.high, choose(a.high < 0.5, c.high, v_max(b.high, c.high))))"
    ),
}

# Per operation and argument: what the enclosure r of the result says of the argument; "" where it says nothing.
BACKWARD: dict[int, tuple[str, ...]] = {
    ca.OP_ADD: (
        "widened(both(r.low - b.high, r.high - b.low), r, b)",
        "widened(both(r.low - a.high, r.high - a.low), r, a)",
    ),
    ca.OP_SUB: (
        "widened(both(r.low + b.low, r.high + b.high), r, b)",
        "widened(both(a.low - r.high, a.high - r.low), r, a)",
    ),
    ca.OP_MUL: ("i_quotient(r, b)", "i_quotient(r, a)"),
    ca.OP_DIV: ("i_mul(r, b)", "i_quotient(a, r)"),
    ca.OP_NEG: ("both(-r.high, -r.low)",),
    ca.OP_TWICE: ("both(0.5 * r.low, 0.5 * r.high)",),
    ca.OP_SQ: (
        "both(choose(a.low >= 0.0, v_sqrt(v_max(r.low, all(0.0))), -v_sqrt(v_max(r.high, all(0.0)))), "
        "choose(a.high <= 0.0, -v_sqrt(v_max(r.low, all(0.0))), v_sqrt(v_max(r.high, all(0.0)))))",
    ),
    ca.OP_INV: ("i_quotient(both(all(1.0), all(1.0)), r)",),
    ca.OP_EXP: ("both(v_log(v_max(blurred(r).low, all(0.0))), v_log(v_max(blurred(r).high, all(0.0))))",),
    ca.OP_LOG: ("both(v_exp(r.low), v_exp(r.high))",),
    ca.OP_LOG1P: ("both(v_expm1(r.low), v_expm1(r.high))",),
    ca.OP_EXPM1: ("both(v_log1p(v_max(blurred(r).low, all(-1.0))), v_log1p(v_max(blurred(r).high, all(-1.0))))",),
    ca.OP_SQRT: ("both(keep(r.low > 0.0, r.low * r.low), r.high * r.high)",),
    ca.OP_FABS: ("both(choose(a.low >= 0.0, r.low, -r.high), choose(a.high <= 0.0, -r.low, r.high))",),
    ca.OP_FMAX: ("both(all(-INFINITY), r.high)", "both(all(-INFINITY), r.high)"),
    ca.OP_FMIN: ("both(r.low, all(INFINITY))", "both(r.low, all(INFINITY))"),
    ca.OP_IF_ELSE_ZERO: ("", "where(a.low > 0.5, r, unknown())"),
    OP_SELECT: ("", "where(a.low > 0.5, r, unknown())", "where(a.high < 0.5, r, unknown())"),
}

# Powers have rules for an exponent that is the same for all boxes, and for any other.
POWERS = (ca.OP_POW, ca.OP_CONSTPOW)
POWER_FORWARD = {True: "i_power(a, b.low[0])", False: "i_any_power(a, b)"}
POWER_BACKWARD = (
    "where((a.low >= 0.0) & (b.low != 0.0), "
    "i_power(both(v_max(r.low, all(0.0)), v_max(r.high, all(0.0))), 1.0 / b.low[0]), nothing())"
)
