"""Problems of one limit on a formula of what scatters, for tests of what is claimed of a range."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import synth

Formula = Callable[[Sequence[Any]], Any]
SCATTER = "+-20 %"  # of requirements that are 1
LOW, HIGH = 0.8, 1.2


class ScatteredLimit(synth.DesignProblem):
    """One limit ``factor * formula <= bound`` on a formula of requirements; the factor is the only variable."""

    name, title = "scattered_limit", "Scattered limit"
    sources = ("made up",)

    def __init__(self, formula: Formula, count: int, bound: float, sense: str = "at_most") -> None:
        super().__init__()
        self.formula, self.count, self.bound, self.sense = formula, count, bound, sense

    def declare(self, d):
        q = [d.requirement(f"q{k}", "-", lower=0.01, upper=100) for k in range(self.count)]
        factor = d.variable("factor", "-", 0.5, 100)
        value = factor * self.formula(q)
        if self.sense == "at_most":
            d.at_most("limit", value, self.bound, "-")
        else:
            d.at_least("limit", 2 * self.bound + 10 - value, self.bound + 10, "-")
        d.derive("inverse", "-", 1 / factor)
        d.objective("inverse")

    @property
    def needed(self) -> dict[str, str]:
        return {f"q{k}": "1" for k in range(self.count)}

    @property
    def block(self) -> dict[str, Any]:
        return {name: SCATTER for name in self.needed}

    def design(self, factor: float = 1.0) -> synth.Design:
        return synth.evaluate(self, self.needed, values={"factor": str(factor)})

    def rated(self, factor: float = 1.0) -> Any:
        return synth.rate(self.design(factor), self.block, problem=self).designs[0].robust


def wavy(q):
    """Three directions that are monotone, and one with its worst between the ends."""
    return q[0] * q[1] / q[2] * (1 + 0.6 * np.cos(9 * (q[3] - 1.05)))


def ridged(q):
    """At most 1, and 1 on a ridge of two dimensions: more parts of the range are needed than are bounded."""
    return 1 + q[0] * q[1] - ((q[0] + q[1]) / 2) ** 2 + q[2] * q[3] - ((q[2] + q[3]) / 2) ** 2
