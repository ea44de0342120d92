"""C source of the interior-point solver for one set of row functions.

The same method as in :mod:`synth.interior_point`, step by step, over vector registers instead of arrays: a lane is
one element of a register, and a lane that is done takes the next problem.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

import casadi as ca
import numpy as np

from synth import interior_point as method
from synth.derivatives import RowFunctions
from synth.native_templates import SOLVER
from synth.program import COMPARISONS, OP_SELECT, Node

EXPRESSIONS = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_POW: "v_pow({0}, {1})",
    ca.OP_CONSTPOW: "v_pow({0}, {1})",
    ca.OP_LT: "{0} < {1}",
    ca.OP_LE: "{0} <= {1}",
    ca.OP_EQ: "{0} == {1}",
    ca.OP_NE: "{0} != {1}",
    ca.OP_FMOD: "v_fmod({0}, {1})",
    ca.OP_COPYSIGN: "v_copysign({0}, {1})",
    ca.OP_FMIN: "v_min({0}, {1})",
    ca.OP_FMAX: "v_max({0}, {1})",
    ca.OP_ATAN2: "v_atan2({0}, {1})",
    ca.OP_HYPOT: "v_hypot({0}, {1})",
    ca.OP_NEG: "-{0}",
    ca.OP_EXP: "v_exp({0})",
    ca.OP_LOG: "v_log({0})",
    ca.OP_SQRT: "v_sqrt({0})",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_SIN: "v_sin({0})",
    ca.OP_COS: "v_cos({0})",
    ca.OP_TAN: "v_tan({0})",
    ca.OP_ASIN: "v_asin({0})",
    ca.OP_ACOS: "v_acos({0})",
    ca.OP_ATAN: "v_atan({0})",
    ca.OP_FLOOR: "v_floor({0})",
    ca.OP_CEIL: "v_ceil({0})",
    ca.OP_FABS: "v_abs({0})",
    ca.OP_SIGN: "v_sign({0})",
    ca.OP_ERF: "v_erf({0})",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SINH: "v_sinh({0})",
    ca.OP_COSH: "v_cosh({0})",
    ca.OP_TANH: "v_tanh({0})",
    ca.OP_ASINH: "v_asinh({0})",
    ca.OP_ACOSH: "v_acosh({0})",
    ca.OP_ATANH: "v_atanh({0})",
    ca.OP_LOG1P: "v_log1p({0})",
    ca.OP_EXPM1: "v_expm1({0})",
}


def source(functions: RowFunctions) -> str:
    """Return the translation unit of one set of row functions."""
    layout = method.Layout(functions)
    parts = {
        "SIZES": _sizes(functions),
        "STORED_IN_STATE": "vd stored[AT_LEAST_ONE(STORED)];",
        "POINT": _point(functions),
        "TRANSPOSED": _transposed(layout),
        "TIMES": _times(layout),
        "GRAM": _gram(layout),
        "CURVATURE": "\n".join(
            f"    matrix[{a}][{b}] += keep(~strange & free[{a}] & free[{b}], hessian[{k}]);"
            for k, (a, b) in enumerate(layout.hessian)
        ),
        "SOLVE": "void solve(const Problems *p)",
    }
    return filled(parts)


def filled(parts: Mapping[str, str]) -> str:
    """Return the translation unit of the solver with its parts filled in; those that are not named are empty."""
    return VECTORS + re.sub(r"/\*([A-Z_]+)\*/", lambda place: parts.get(place[1], ""), SOLVER)


def settings() -> list[str]:
    """Return definitions of the settings of the method."""
    numbers = {
        "MAX_EVALUATIONS": method.MAX_EVALUATIONS, "MAX_LATE": method.MAX_LATE, "MAX_REJECTED": method.MAX_REJECTED,
        "CONVERGED": method.CONVERGED, "INFEASIBLE": method.INFEASIBLE, "STUCK": method.STUCK,
        "STOPPED": method.STOPPED,
    }  # fmt: skip
    names = (
        "FIRST_BARRIER", "LEAST_BARRIER", "BARRIER_FACTOR", "BARRIER_ERROR", "FIRST_PENALTY",
        "LAST_PENALTY", "PENALTY_FACTOR", "PENALTY_BARRIER", "DUAL_TOLERANCE", "GAP_TOLERANCE", "ROW_TOLERANCE",
        "HOPELESS_BARRIER", "HOPELESS_DUAL", "HOPELESS_RATIO", "MET", "STUCK_BARRIER", "LATE_BARRIER", "TO_BOUNDARY",
        "ARMIJO", "ROUNDING",
        "MULTIPLIER_SPREAD", "INSIDE", "PINNED_WIDTH", "FIRST_ROOM", "LEAST_PIVOT", "FIRST_SHIFT", "SHIFT_GROWTH",
        "LARGEST_SHIFT", "LARGEST_ROW",
    )  # fmt: skip
    lines = [f"#define {name} {value}" for name, value in numbers.items()]
    return lines + [f"#define {name} {_number(float(getattr(method, name)))}" for name in names]


def _sizes(functions: RowFunctions) -> str:
    layout = method.Layout(functions)
    numbers = {
        "N": layout.n, "ROWS": layout.rows, "CUTS": layout.cuts, "GOALS": layout.goals, "NONZEROS": len(layout.row),
        "CURVATURES": len(layout.hessian), "STORED": len(functions.stored),
    }  # fmt: skip
    lines = settings() + [f"#define {name} {value}" for name, value in numbers.items()]
    lines += [f"#define MOST_{name} {name}" for name in ("N", "ROWS", "GOALS")]
    lines += [f"#define MOST_{name} AT_LEAST_ONE({name})" for name in ("NONZEROS", "CURVATURES")]
    for name, flags in (("EQUAL", layout.equal.ravel()), ("GUARD", layout.guard)):
        lines.append(f"static const int {name}[] = {{{', '.join(str(int(x)) for x in flags)}}};")
    for name, places in (("ROW", layout.row), ("COLUMN", layout.column)):
        lines.append(f"static const int {name}[] = {{{', '.join(str(int(x)) for x in [*places, 0])}}};")
    return "\n".join(lines)


def _number(value: float) -> str:
    if np.isnan(value):
        return "NAN"
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(value)


def _point(functions: RowFunctions) -> str:
    """Return statements that compute rows, derivatives and second derivatives at one point per lane."""
    nodes, first = functions.nodes, functions.input_number("weights", 0)
    names = {k: f"stored[{position}]" for position, k in enumerate(functions.stored)}
    lines = []

    def value(k: int) -> str:
        return f"all({_number(nodes[k].constant)})" if nodes[k].op == ca.OP_CONST else names.get(k, f"x{k}")

    def truth(k: int) -> str:
        return f"m{k}" if k not in names and nodes[k].op in COMPARISONS else f"({value(k)} != 0.0)"

    for k in functions.point_order:
        node = nodes[k]
        if node.op == ca.OP_INPUT:
            number = int(node.constant)
            names[k] = f"y[{number}]" if number < functions.n else f"weights[{number - first}]"
        elif node.op in COMPARISONS:
            lines.append(f"    const vi m{k} = {_comparison(node, value, truth)};")
            lines.append(f"    const vd x{k} = keep(m{k}, all(1.0));")
        elif node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            other = f"choose({truth(node.args[0])}, {value(node.args[1])}, {value(node.args[-1])})"
            kept = f"keep({truth(node.args[0])}, {value(node.args[1])})"
            lines.append(f"    const vd x{k} = {other if node.op == OP_SELECT else kept};")
        else:
            lines.append(f"    const vd x{k} = {EXPRESSIONS[node.op].format(*(value(a) for a in node.args))};")
    for k, output in enumerate(functions.outputs):
        lines.append(f"    {_place(functions, k)} = {value(output)};")
    return "\n".join(lines)


def _comparison(node: Node, value: Callable[[int], str], truth: Callable[[int], str]) -> str:
    if node.op == ca.OP_NOT:
        return f"~{truth(node.args[0])}"
    if node.op in (ca.OP_AND, ca.OP_OR):
        return f"{truth(node.args[0])} {'&' if node.op == ca.OP_AND else '|'} {truth(node.args[1])}"
    return EXPRESSIONS[node.op].format(*(value(a) for a in node.args))


def _place(functions: RowFunctions, k: int) -> str:
    rows, nonzeros = functions.n_rows, len(functions.row)
    if k < rows:
        return f"form[{k}]"
    return f"jacobian[{k - rows}]" if k < rows + nonzeros else f"hessian[{k - rows - nonzeros}]"


def _transposed(layout: method.Layout) -> str:
    lines = []
    for a, places in enumerate(layout.columns):
        terms = [f"jacobian[{k}] * vector[{layout.row[k]}]" for k in places]
        lines.append(f"    result[{a}] = {' + '.join(terms) or 'all(0.0)'};")
    return "\n".join(lines)


def _times(layout: method.Layout) -> str:
    lines = []
    for r in range(layout.rows):
        terms = [f"jacobian[{k}] * direction[{layout.column[k]}]" for k in np.flatnonzero(layout.row == r)]
        lines.append(f"    result[{r}] = {' + '.join([*terms, f'-slopes[{r}] * direction[N]'])};")
    return "\n".join(lines)


def _gram(layout: method.Layout) -> str:
    lines = [f"    const vd w{k} = jacobian[{k}] * vector[{layout.row[k]}];" for k in range(len(layout.row))]
    for a, b, first, second in layout.pairs:
        terms = [f"w{i} * jacobian[{j}]" for i, j in zip(first, second, strict=True)]
        lines.append(f"    matrix[{a}][{b}] = {' + '.join(terms) or 'all(0.0)'};")
    for a, places in enumerate(layout.columns):
        terms = [f"w{k} * slopes[{layout.row[k]}]" for k in places]
        lines.append(f"    matrix[N][{a}] = -({' + '.join(terms) or 'all(0.0)'});")
    terms = [f"vector[{r}] * slopes[{r}] * slopes[{r}]" for r in range(layout.rows)]
    lines.append(f"    matrix[N][N] = {' + '.join(terms) or 'all(0.0)'};")
    return "\n".join(lines)


VECTORS = r"""
#include <math.h>
#include <string.h>
/* Reading the header of all vector instructions takes as long as compiling a sixth of the rest: what few there are of
   AVX have names of their own in GCC. */
#if defined(__AVX__) && !defined(__AVX512F__) && defined(__GNUC__) && !defined(__clang__)
#define sqrt_of_four __builtin_ia32_sqrtpd256
#define max_of_four __builtin_ia32_maxpd256
#define min_of_four __builtin_ia32_minpd256
#define blend_of_four __builtin_ia32_blendvpd256
#elif defined(__AVX512F__) || defined(__AVX__) || defined(__SSE2__)
#include <immintrin.h>
#define sqrt_of_four _mm256_sqrt_pd
#define max_of_four _mm256_max_pd
#define min_of_four _mm256_min_pd
#define blend_of_four _mm256_blendv_pd
#endif
#if defined(__AVX512F__)
#define LANES 8
#elif defined(__AVX__)
#define LANES 4
#else
#define LANES 2
#endif
typedef double vd __attribute__((vector_size(8 * LANES)));
typedef long long vi __attribute__((vector_size(8 * LANES)));
#define INLINE static inline __attribute__((always_inline))

INLINE vd all(double x) { vd r; for (int l = 0; l < LANES; l++) r[l] = x; return r; }
INLINE vi all_i(long long x) { vi r; for (int l = 0; l < LANES; l++) r[l] = x; return r; }
INLINE vd choose(vi m, vd a, vd b) { return (vd)((m & (vi)a) | (~m & (vi)b)); }
INLINE vi choose_i(vi m, vi a, vi b) { return (m & a) | (~m & b); }
INLINE vd keep(vi m, vd a) { return (vd)(m & (vi)a); }
INLINE int any(vi m) {
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)m, (__m512i)m) != 0;
#else
    long long r = 0;
    for (int l = 0; l < LANES; l++) r |= m[l];
    return r != 0;
#endif
}
INLINE vd v_abs(vd a) { return (vd)((vi)a & all_i(0x7fffffffffffffffLL)); }
INLINE vd v_max(vd a, vd b) { return choose((a > b) | (a != a), a, b); }
INLINE vd v_min(vd a, vd b) { return choose((a < b) | (a != a), a, b); }
INLINE vd v_sign(vd a) { return choose(a > 0.0, all(1.0), choose(a < 0.0, all(-1.0), a)); }
INLINE vi is_finite(vd a) { return (a - a) == 0.0; }
INLINE vd v_sqrt(vd a) {
#if defined(__AVX512F__)
    return (vd)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX__)
    return (vd)sqrt_of_four(a);
#elif defined(__SSE2__)
    return (vd)_mm_sqrt_pd((__m128d)a);
#else
    for (int l = 0; l < LANES; l++) a[l] = sqrt(a[l]);
    return a;
#endif
}
#define LANEWISE(name) INLINE vd v_##name(vd a) { for (int l = 0; l < LANES; l++) a[l] = name(a[l]); return a; }
#define LANEWISE2(name) \
    INLINE vd v_##name(vd a, vd b) { for (int l = 0; l < LANES; l++) a[l] = name(a[l], b[l]); return a; }
LANEWISE(sin) LANEWISE(cos) LANEWISE(tan) LANEWISE(asin) LANEWISE(acos) LANEWISE(atan) LANEWISE(sinh) LANEWISE(cosh)
LANEWISE(tanh) LANEWISE(asinh) LANEWISE(acosh) LANEWISE(atanh) LANEWISE(erf) LANEWISE(floor) LANEWISE(ceil)
LANEWISE2(fmod) LANEWISE2(copysign) LANEWISE2(atan2) LANEWISE2(hypot)

/* x = k ln 2 + r with |r| <= ln 2 / 2; Taylor series of exp(r), error below 1e-17. */
static vd v_exp(vd x) {
    const vd magic = all(6755399441055744.0);
    const vd held = v_min(v_max(x, all(-745.0)), all(710.0));
    const vd shifted = held * 1.4426950408889634074 + magic;
    const vd k = shifted - magic;
    const vd r = (held - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    vd p = all(1.0 / 6227020800.0);
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r * r + r + 1.0;
    /* In two factors, so that neither leaves the range of exponents too early. */
    const vi e = (vi)shifted - (vi)magic, half = e >> 1;
    const vd first = (vd)((half + 1023) << 52), second = (vd)((e - half + 1023) << 52);
    return choose(x != x, x, p * first * second);
}

/* x = 2**k (1 + f); the rational form of log(1 + f) in s = f/(2 + f) after fdlibm (Sun Microsystems, 1993). */
static vd v_log(vd x) {
    const vi tiny = x < 2.2250738585072014e-308;
    const vd scaled = choose(tiny, x * 18014398509481984.0, x);
    const vi bits = (vi)scaled;
    const vi rest = (bits & all_i(0x000fffffffffffffLL)) | all_i(0x3ff0000000000000LL);
    const vi upper = (vd)rest > 1.41421356237309504880;
    vi k = ((bits >> 52) & all_i(0x7ff)) - 1023 + (upper & all_i(1)) - (tiny & all_i(54));
    const vd f = choose(upper, 0.5 * (vd)rest, (vd)rest) - 1.0;
    const vd magic = all(6755399441055744.0);
    const vd e = (vd)(k + (vi)magic) - magic;
    const vd s = f / (2.0 + f), z = s * s, w = z * z;
    const vd even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const vd odd = z * (6.666666666666735130e-01 + w * (2.857142874366239149e-01
        + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const vd half = 0.5 * f * f;
    const vd result = e * 6.93147180369123816490e-01
        - ((half - (s * (half + even + odd) + e * 1.90821492927058770002e-10)) - f);
    const vi usual = (x > 0.0) & (x < INFINITY);
    const vd unusual = choose(x == 0.0, all(-INFINITY), choose(x > 0.0, x, all(NAN)));
    return choose(usual, result, choose(x != x, x, unusual));
}

/* W. Kahan: the rounding of 1 + x is undone by the ratio. */
static vd v_log1p(vd x) {
    const vd u = 1.0 + x;
    return choose((u == 1.0) | (x == INFINITY), x, v_log(u) * (x / (u - 1.0)));
}

static vd v_expm1(vd x) {
    const vd u = v_exp(x);
    const vd usual = (u - 1.0) * (x / v_log(u));
    return choose(u == 1.0, x, choose((u - 1.0 == -1.0) | (u == INFINITY), u - 1.0, usual));
}

static vd v_pow(vd a, vd b) {
    vd r = v_exp(b * v_log(a));
    const vi plain = (a > 0.0) & (a < INFINITY) & is_finite(b);
    if (any(~plain))
        for (int l = 0; l < LANES; l++)
            if (!plain[l]) r[l] = pow(a[l], b[l]);
    return r;
}
"""
