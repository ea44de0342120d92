"""Cases of the families of this distribution: what somebody else has installed beside it changes no test."""

from __future__ import annotations

import numpy as np

from synth.testing.records import FamilyCases, answer, cases_of, front_of, question, question_to
from tests.repetitions import repetitions
from tests.shipped import FAMILIES

__all__ = ["CASES", "STRUCTURES", "answer", "front_of", "known_design", "question", "question_to"]

CASES: dict[str, FamilyCases] = {family: cases_of(family) for family in FAMILIES}

# Family, option set, and whether optional requirements are given; of most sets the models with all of them say it all.
STRUCTURES = [
    (family, name, optional)
    for family, data in CASES.items()
    for number, name in enumerate(data.option_sets)
    for optional in (False, True)
    if optional or number < repetitions(1, len(data.option_sets))
]


def known_design(family: str, name: str, optional: bool) -> tuple[np.ndarray, list[np.ndarray]] | None:
    """Variables and data of the design that is known of an option set, twice, or None."""
    design = CASES[family].designs.get(name)
    if design is None:
        return None
    instance = question(
        family,
        CASES[family].option_sets[name],
        optional,
        fix={**design.sizes, **design.counts},
        parts={slot: [row] for slot, row in design.parts.items()},
    )
    data = [np.broadcast_to(np.asarray(x, dtype=float), (2,)) for x in instance.data(np.zeros(2, dtype=int))]
    return np.tile(instance.ranges.lower, (2, 1)), data
