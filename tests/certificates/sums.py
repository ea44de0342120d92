"""Random problems of sums: limits against zero, units that are switched off, squares over wide boxes.

A limit must mean the same on whichever side its zero is written, hold where both of its sides vanish, and an objective
that is small beside what it could be must be proven to its own size.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tests.certificates.structures import STRUCTURES, Builder, Formula, Limit, Unknowns, add, scaled

TURNED = {"at_most": "at_least", "at_least": "at_most", "equal": "equal"}
TINY = 1e-12


def _largest(*sides: Formula) -> Formula:
    """Return the size of the largest side."""
    return lambda u: np.maximum.reduce(np.broadcast_arrays(TINY, *(np.abs(f(u)) for f in sides)))


def _against_zero(b: Builder, name: str, sense: str, left: Formula, right: Formula) -> None:
    """State a limit between two sides with both on one of them, or as it is."""
    difference, terms = add(left, scaled(-1.0, right)), _largest(left, right)
    way = b.integer(0, 2)
    if way == 0:
        b.case.limits[name] = Limit(sense, difference, lambda u: 0.0, terms=terms)
    elif way == 1:
        turned: Formula = scaled(-1.0, difference)
        b.case.limits[name] = Limit(TURNED[sense], turned, lambda u: 0.0, terms=terms)
    else:
        b.case.limits[name] = Limit(sense, left, right, terms=terms)


def _zero_sided(b: Builder) -> None:
    """Equations and limits with a zero on one side, at sizes from 1e-6 to 1e6."""
    size = 10.0 ** b.integer(-6, 6)
    names = b.variables(1) + b.slots(b.integer(0, 1), (2, 4)) + b.maybe_count()
    if b.chance():
        b.variable("z", 0.5, b.uniform(2, 4))
        names.append("z")
    free = scaled(size, b.posynomial(names))
    b.variable("y", 0.05 * size, 40 * size)
    b.case.solved["y"] = free
    _against_zero(b, "balance", "equal", lambda u: u["y"], free)
    least = b.posynomial(names)
    bound = float(np.median(least(b.cloud())))
    _against_zero(b, "least", "at_least", least, lambda u: bound)
    b.objective("cost", add(b.posynomial(names), lambda u: u["y"] / size))


def _switched_off(b: Builder) -> None:
    """A unit that delivers nothing while its count is zero: both sides of its equation vanish."""
    pace, top = b.uniform(0.2, 1.0), b.uniform(2, 8)
    b.variable("x", 0.0, top)
    b.case.counts["n"] = (0.0, 1.0, 2.0)
    gain = b.uniform(0.5, 2.0)
    b.variable("y", 0.0, 5 * gain)

    def delivered(u: Unknowns) -> object:
        return gain * (1 - np.exp(-pace * u["x"])) * u["n"]

    b.case.solved["y"] = delivered
    _against_zero(b, "delivered", "equal", lambda u: u["y"], delivered)
    _against_zero(b, "running", "at_most", lambda u: u["x"], lambda u: top * u["n"])
    spare, price = b.uniform(0.1, 1.5), b.uniform(0.2, 2.0)
    b.case.limits["served"] = Limit("at_least", lambda u: u["y"] + spare, lambda u: spare * b.case.seed % 3)
    b.objective("cost", lambda u: 1 + price * u["n"] + 0.3 * u["x"] - 0.1 * u["y"])


def _squares(b: Builder) -> None:
    """Sums of squares over boxes up to a hundred thousand times as wide as the answer, with counts or without."""
    width = 10.0 ** b.integer(1, 5)
    for name in "xy":
        b.variable(name, -width * b.uniform(0.5, 1), width * b.uniform(0.5, 1))
    names = b.maybe_count()
    rows = [(b.uniform(-2, 2), b.uniform(-2, 2), b.uniform(-3, 3)) for _ in range(4)]
    shift = (lambda u: u["n"] - 1.0) if names else (lambda u: 0.0)

    def error(u: Unknowns) -> object:
        return sum((r * u["x"] + s * u["y"] - t - shift(u)) ** 2 for r, s, t in rows)

    b.objective("error", error)
    if b.case.seed % 2:
        aim = b.uniform(-2, 2)
        b.objective("off", lambda u: (u["x"] - aim) ** 2 + (u["y"] + aim) ** 2)
    b.case.positive = False


SUMS: dict[str, Callable[[Builder], None]] = {
    "zero_sided": _zero_sided,
    "switched_off": _switched_off,
    "squares": _squares,
}
STRUCTURES.update(SUMS)
