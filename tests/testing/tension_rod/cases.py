"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance


def sound_rods(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Diameters that carry the pull."""
    return rng.uniform(0.02, 0.05, (count, 1))


PULL = {"force": "40 kN"}
CASES = {
    "tension_rod": FamilyCases(
        option_sets={"default": {}},
        requirements=PULL,
        optional={},
        feasible={
            "tie": Case(
                PULL,
                settings={"parts": {"steel": ["S185", "42CrMo4"]}, "limits": {"diameter": "<= 40 mm"}},
                tighten={"force": "45 kN"},
            )
        },
        infeasible=Case(PULL, settings={"limits": {"diameter": "<= 2 mm"}}),
        culprits=frozenset({"stress"}),
        sound=sound_rods,
        names=Path(__file__).with_name("names.csv"),
        symbols={
            "F_rod": ("F", "rod", "italic"),
            "l_rod": ("l", "rod", "italic"),
            "d_rod": ("d", "rod", "italic"),
            "A_rod": ("A", "rod", "italic"),
            "m_rod": ("m", "rod", "italic"),
        },
    )
}
