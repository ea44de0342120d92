"""Random problems whose optima lie on kinks: edges of max and min on either side, absolute values, one in another."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from tests.certificates.structures import STRUCTURES, Builder, Formula, Unknowns, of


def _line(b: Builder, names: Sequence[str]) -> Formula:
    slopes, constant = b.rng.normal(size=len(names)), b.uniform(-1, 1)
    return lambda u: sum(k * u[n] for k, n in zip(slopes, names, strict=True)) + constant


def _bowl(b: Builder, names: Sequence[str]) -> Formula:
    middle, width = b.rng.uniform(-1.5, 1.5, len(names)), b.rng.uniform(0.3, 2, len(names))
    return lambda u: sum(w * (u[n] - m) ** 2 for w, n, m in zip(width, names, middle, strict=True))


def _kinks_positive(b: Builder) -> None:
    """Sums of powers: the larger or lesser of two that both fall in one unknown and rise in another."""
    names = b.variables(2) + b.slots(1, (2, 4)) + b.maybe_count()
    first, second, third, fourth = (b.posynomial(names, 2) for _ in range(4))
    b.keeps("load", "at_most", of(np.maximum, first, second), factor=True)
    b.keeps("way", "at_most", of(np.minimum, b.monomial(names), b.monomial(names)), factor=True)
    b.objective("cost", of(np.maximum, third, of(np.minimum, fourth, b.posynomial(names, 2))))
    if b.case.seed % 2:
        b.objective("loss", of(np.maximum, b.posynomial(names, 2), b.posynomial(names, 2)))


def _kinks_signed(b: Builder) -> None:
    """Lines of unknowns of both signs: absolute values, clipped ones, and branches that meet or do not."""
    for name in "xy":
        b.variable(name, -round(b.uniform(1.5, 3), 2), round(b.uniform(1.5, 3), 2))
    names = ["x", "y"]
    a, c, d, e = (_line(b, names) for _ in range(4))
    kind, more = b.case.seed % 4, b.uniform(-1, 1)
    b.keeps("off", "at_most", lambda u: np.abs(a(u)))
    if kind == 0:
        b.keeps("inner", "at_most", of(np.maximum, of(np.minimum, c, d), e))
    elif kind == 1:
        b.keeps("beyond", "at_least", lambda u: np.abs(c(u)))
    elif kind == 2:
        b.keeps("branch", "at_least", lambda u: np.where(c(u) < 0, np.maximum(d(u), e(u)), np.abs(d(u))))
    else:
        b.keeps("step", "at_most", lambda u: np.where(c(u) < 0, d(u), d(u) + more))
    bowl = _bowl(b, names)

    def cost(u: Unknowns) -> object:
        return bowl(u) + np.abs(np.maximum(d(u), e(u)) - 0.3) + 2 * np.clip(c(u), -0.5, 0.5) + 3

    b.objective("cost", cost)
    b.case.positive = False


KINKS: dict[str, Callable[[Builder], None]] = {"kinks_positive": _kinks_positive, "kinks_signed": _kinks_signed}
STRUCTURES.update(KINKS)
