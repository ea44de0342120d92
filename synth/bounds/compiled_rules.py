"""The rules of interval propagation in C, for a register of boxes: what :mod:`synth.bounds.intervals` says in NumPy.

Every rule decides per box what the NumPy rule decides for all of a batch, so that no box depends on its neighbours.
Not-a-number means that nothing is known, here too.
"""

from __future__ import annotations

import math

import casadi as ca

from synth.model.program import OP_SELECT


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
