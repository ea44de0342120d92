"""Works that sources of families name; sources of their main results."""

from __future__ import annotations

import pytest

from synth.testing.texts import structures, works

pytestmark = pytest.mark.slow


def test_works_are_seen() -> None:
    assert works("S0 (Szoke 1966), eq. (5)") == {"S0", "Szoke"}
    assert works("DIN 743-2, from memory; practice") == {"DIN 743"}
    assert works("geometry; table metals, C45") == works("S4, Delta r") == set()


# The formulas of torque and pressure are those of the family: a pack with friction in its guides, discs, a cone.
OWN = {
    "disc_clutch": ("S1 (lecture on friction clutches), sizing", "S1 (lecture on friction clutches), p"),
    "cone_clutch": ("S1 (lecture on friction clutches), cone clutch; formula lost in print, derived",) * 2,
}


@pytest.mark.parametrize("family", ["disc_clutch", "cone_clutch", "multi_plate_clutch", "electromagnetic_clutch"])
def test_the_main_result_cites_its_own_formula(family: str) -> None:
    for posed in structures(family):
        d = posed.model.declaration
        if family in OWN:
            right = OWN[family]
        elif "guide_model" in d.options and d.options["guide_model"].chosen == "series":
            right = ("S0 (Szoke 1966), eq. (5)", "S0 (Szoke 1966), eq. (3)")
        else:
            right = OWN["disc_clutch"]
        assert (d.derived["torque"].source, d.derived["surface_pressure"].source) == right
        assert "S0" not in d.limits["torque_capacity"].source
