"""Random problems whose unknowns, data and objectives have any sign, or are zero.

Variables, columns, counts and requirements below, across and on zero; gridded, pinned, continuous and mixed; poles
inside a range; objectives that cross zero or end there; fewer designs asked for than there are objectives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from tests.certificates.structures import CLOUD, STRUCTURES, Builder, Formula, Limit, add, times

ENDS = ("across", "across", "below", "to zero", "from zero", "above")


def _ends(b: Builder, kind: str) -> tuple[float, float]:
    """Return the ends of a range of some kind."""
    near, far = round(b.uniform(0.2, 1.5), 2), round(b.uniform(2, 6), 2)
    return {
        "across": (-far, round(b.uniform(1, 5), 2)),
        "below": (-far, -near),
        "to zero": (-far, 0.0),
        "from zero": (0.0, far),
        "above": (near, far),
    }[kind]


def _variable(b: Builder, name: str, gridded: bool) -> str:
    """Add a variable of any sign, continuous or with makeable values: steps through zero, or a list."""
    low, high = _ends(b, str(b.rng.choice(ENDS)))
    unit: dict[str, Any] = {"unit": "mm", "factor": 1e-3} if b.chance(0.2) else {}
    if not gridded:
        b.variable(name, low, high, **unit)
    elif b.chance(0.6):
        step = float(b.rng.choice([0.25, 0.5, 1.0]))
        first, last = np.floor(low / step), np.ceil(high / step)
        values = step * np.arange(first, last + 1)
        b.variable(name, values[0], values[-1], grid=tuple(values.tolist()), **unit)
    else:
        values = np.unique(np.round(b.rng.uniform(low, high, 9), 2))
        values = np.unique(np.append(values, 0.0)) if low < 0 < high and b.chance() else values
        b.variable(name, low, high, grid=tuple(values.tolist()), **unit)
    return name


def _size(b: Builder, name: str) -> Formula:
    """Return an unknown as a number near one."""
    factor = b.case.variables[name].factor if name in b.case.variables else 1.0
    return lambda u: u[name] / factor


def _data(b: Builder) -> list[str]:
    """Add a slot, a count and a requirement of any sign, each or not."""
    names = []
    if b.chance(0.7):
        size = b.integer(2, 5)
        k = np.round(b.rng.uniform(-2, 2, size), 2)
        k[b.rng.random(size) < 0.15] = 0.0
        s = np.round(b.rng.uniform(-2, -0.2, size) if b.chance() else b.rng.uniform(-1, 2, size), 2)
        b.table("rod", pd.DataFrame({"designation": [f"rod {i}" for i in range(size)], "k": k, "s": s}))
        names += ["rod.k", "rod.s"]
    if b.chance(0.5):
        low = b.integer(-4, 0)
        b.case.counts["n"] = tuple(float(x) for x in range(low, low + b.integer(1, 4) + 1))
        names.append("n")
    if b.chance(0.4):
        b.case.requirements["demand"] = 0.0 if b.chance(0.2) else b.uniform(-2, 2)
        names.append("demand")
    return names


def _unknowns(b: Builder, gridded: float, most: int = 3) -> list[str]:
    """Add one to three variables, each gridded by a chance, and data."""
    names = [_variable(b, name, b.chance(gridded)) for name in "xyz"[: b.integer(1, most)]]
    return names + _data(b)


def _term(b: Builder, names: Sequence[str]) -> Formula:
    """Return a product of powers and absolute values, with a factor of any sign."""
    factor = b.uniform(0.3, 2.0) * (-1 if b.chance() else 1)
    parts: list[Formula] = [lambda u: factor]
    for name in b.rng.permutation(names)[: b.integer(1, 2)]:
        size, kind = _size(b, str(name)), b.integer(0, 6)
        parts.append(
            [
                size,
                size,
                lambda u, size=size: size(u) ** 2,
                lambda u, size=size: size(u) ** 3 / 4,
                lambda u, size=size: np.abs(size(u)),
                lambda u, size=size: size(u) * np.abs(size(u)) / 2,
                lambda u, size=size: size(u) / (1.0 + size(u) ** 2),
            ][kind]
        )
    return times(*parts)


def _sum(b: Builder, names: Sequence[str], terms: int = 3) -> Formula:
    shift = 0.0 if b.chance(0.3) else b.uniform(-3, 3)
    return add(*(_term(b, names) for _ in range(b.integer(2, terms))), lambda u: shift)


def _limits(b: Builder, names: Sequence[str]) -> None:
    """Add limits that the witness keeps: on a variable alone, against a number, against a requirement."""
    for k in range(b.integer(0, 2)):
        b.keeps(f"limit_{k}", "at_most" if b.chance() else "at_least", _sum(b, names), 0.4)
    if b.chance(0.6):
        name = str(b.rng.choice(list(b.case.variables)))
        b.keeps(f"reach_{name}", "at_most" if b.chance() else "at_least", _size(b, name), b.rng.choice([0.0, 0.3]))
    if b.chance(0.3):  # a limit between two formulas, both of any sign
        value, other = _term(b, names), _term(b, names)
        gap = float(np.broadcast_to(value(b.cloud()) - other(b.cloud()), CLOUD)[0])
        room = gap + abs(gap) * b.uniform(0, 0.3)
        b.case.limits["pair"] = Limit("at_most", value, lambda u: other(u) + room)


def _objectives(b: Builder, names: Sequence[str], count: int) -> None:
    """Add objectives that may cross zero, to be made small or large."""
    for name in ("cost", "loss", "size")[:count]:
        b.objective(name, _sum(b, names), "max" if b.chance(0.3) else "min")


def _finish(b: Builder) -> None:
    b.case.positive = False
    b.case.gap = (1e-3, 1e-2, 1e-2)[b.case.seed % 3]
    b.case.points = (1, 3, 5, 10)[b.integer(0, 3)]
    b.case.seconds = 3.0


def _pin(b: Builder, share: float) -> None:
    """Pin some variables and counts to what the witness has; a value may lie off the grid."""
    for name, v in b.case.variables.items():
        if b.chance(share):
            b.case.fix[name] = float(b.cloud()[name][0]) / v.factor
            if v.factor != 1.0:
                b.case.fix[name] = round(b.case.fix[name], 6)
    if "n" in b.case.counts and b.chance(share / 2):
        b.case.fix["n"] = float(b.cloud()["n"][0])


def _signs(b: Builder) -> None:
    """Everything of any sign, gridded or not."""
    names = _unknowns(b, 0.5)
    _limits(b, names)
    _objectives(b, names, 1 + b.case.seed % 2)
    _finish(b)


def _signs_gridded(b: Builder) -> None:
    """Makeable values of any sign alone."""
    names = _unknowns(b, 1.0)
    _limits(b, names)
    _objectives(b, names, 1 + b.case.seed % 2)
    _finish(b)


def _signs_continuous(b: Builder) -> None:
    """Dimensions of any sign alone."""
    names = _unknowns(b, 0.0, 2)
    _limits(b, names)
    _objectives(b, names, 1 + b.case.seed % 2)
    _finish(b)


def _signs_pinned(b: Builder) -> None:
    """Values of any sign that are pinned, some of them all."""
    names = _unknowns(b, 0.4)
    _limits(b, names)
    _objectives(b, names, 1 + b.case.seed % 2)
    _pin(b, 1.0 if b.chance(0.3) else 0.5)
    _finish(b)


def _pole(b: Builder, name: str) -> tuple[Formula, float]:
    """Return the distance of a variable from a pole inside its range, and how far the witness is from it."""
    v, size = b.case.variables[name], _size(b, name)
    own = float(b.cloud()[name][0]) / v.factor
    for _ in range(50):
        at = round(b.uniform(v.lower + 0.1 * (v.upper - v.lower), v.upper - 0.1 * (v.upper - v.lower)), 3)
        if abs(own - at) > 0.02 * (v.upper - v.lower):
            break
    return lambda u: size(u) - at, own - at


def _signs_poles(b: Builder) -> None:
    """Divisions by what is zero inside the range; a limit keeps away from there, or no makeable value is on it."""
    gridded = b.chance()
    names = [_variable(b, "x", gridded), _variable(b, "y", b.chance()), *_data(b)]
    distance, own = _pole(b, "x")
    if not gridded or b.chance():
        share = abs(own) * b.uniform(0.3, 1.0)
        if b.chance():
            b.case.limits["clear"] = Limit("at_least", lambda u: distance(u) ** 2, lambda u: share**2)
        elif own > 0:
            b.case.limits["clear"] = Limit("at_least", distance, lambda u: share)
        else:
            b.case.limits["clear"] = Limit("at_most", distance, lambda u: -share)
    over, rest = _sum(b, names, 2), _sum(b, names, 2)
    power = b.case.seed % 3
    b.objective("cost", lambda u: over(u) / distance(u) ** (1 + power % 2) + 0.2 * rest(u))
    if power == 2:
        b.objective("loss", _sum(b, names), "max" if b.chance() else "min")
    _limits(b, names)
    _finish(b)


def _mismatch(b: Builder) -> None:
    """A squared or absolute mismatch, alone or against something else: its optimum is zero, or nearly so."""
    names = _unknowns(b, 0.4, 2)
    value = _sum(b, names)
    values = np.broadcast_to(value(b.cloud()), (CLOUD,))
    kind = b.case.seed % 4
    scale = float(np.max(np.abs(values - np.median(values)))) or 1.0
    aim = float(values[0]) + (0.0 if kind < 2 else scale * 10.0 ** b.uniform(-9, -2))
    square: Callable[[Any], Any] = np.abs if b.chance(0.3) else lambda v: v * v
    b.objective("mismatch", lambda u: square((value(u) - aim) / scale))
    if kind % 2:
        b.objective("cost", _sum(b, names), "max" if b.chance(0.3) else "min")
    _limits(b, names)
    _finish(b)


def _signs_equality(b: Builder) -> None:
    """An equality between values of any sign fixes a variable."""
    names = [_variable(b, "x", b.chance(0.4)), *_data(b)]
    free = _sum(b, names)
    values = np.broadcast_to(free(b.cloud()), (CLOUD,))
    low, high = float(values.min()), float(values.max())
    room = max(high - low, 0.5)
    ends = sorted((low - b.uniform(-0.2, 0.3) * room, high + b.uniform(-0.2, 0.3) * room))
    b.variable("y", round(ends[0], 3), round(ends[1], 3))
    b.case.solved["y"] = free
    difference: Formula = lambda u: u["y"] - free(u)  # noqa: E731
    if b.chance():
        b.case.limits["balance"] = Limit("equal", lambda u: u["y"], free)
    else:
        size: Formula = lambda u: np.maximum(1e-12, np.maximum(np.abs(u["y"]), np.abs(free(u))))  # noqa: E731
        b.case.limits["balance"] = Limit("equal", difference, lambda u: 0.0, terms=size)
    _objectives(b, [*names, "y"], 1 + b.case.seed % 2)
    _finish(b)


def _few_points(b: Builder) -> None:
    """Fewer designs asked for than there are objectives, of any sign or all positive."""
    if b.chance():
        names = _unknowns(b, 0.5, 2)
        _limits(b, names)
        _objectives(b, names, 2 + b.case.seed % 2)
        _finish(b)
    else:
        names = b.variables(b.integer(1, 2)) + b.slots(1, (2, 4)) + b.maybe_count()
        b.keeps("load", "at_most", b.posynomial(names), factor=True)
        for name in ("cost", "loss", "size")[: 2 + b.case.seed % 2]:
            b.objective(name, b.posynomial(names))
    b.case.points = b.integer(1, len(b.case.objectives) - 1)


SIGNS: dict[str, Callable[[Builder], None]] = {
    "signs": _signs,
    "signs_gridded": _signs_gridded,
    "signs_continuous": _signs_continuous,
    "signs_pinned": _signs_pinned,
    "signs_poles": _signs_poles,
    "mismatch": _mismatch,
    "signs_equality": _signs_equality,
    "few_points": _few_points,
}
STRUCTURES.update(SIGNS)
