"""Shafts under torque: worked numbers, and the same from other principles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from synth.problems.components.shaft.model import SHAFT_STEEL
from synth.problems.mechanics.plates import shaft_shear_stress
from synth.problems.mechanics.shaft import fatigue_shear, shaft_diameter, size_factor

import synth
from synth.tables.catalogs import Catalogs

# Diameter [mm], torque [N m], shear, largest notch stress of a torque that pulsates by half, and the one that C45
# stands with a safety of 1.5 [N/mm2].
WORKED = [
    (65, 1058.8235, 19.63603, 34.01060, 151.2763),
    (8, 352.94118, 3510.771, 6080.833, 209.0952),
    (45, 2117.6471, 118.3549, 204.9967, 163.2923),
    (16, 14.117647, 17.55385, 30.40417, 199.3773),
    (50, 450, 18.33465, 31.75654, 159.8057),
]


@pytest.mark.parametrize(("diameter", "torque", "shear", "stress", "allowed"), WORKED)
def test_worked_shafts(diameter: float, torque: float, shear: float, stress: float, allowed: float) -> None:
    d = diameter / 1000
    assert shaft_shear_stress(torque, d) / 1e6 == pytest.approx(shear, rel=1e-6)
    stands = fatigue_shear(SHAFT_STEEL, size_factor(d), 1.5)
    # What a shear stress makes of a notch: 2 sqrt(3 (0.5 tau)**2), after von Mises.
    assert 2 * math.sqrt(3 * (0.5 * shear) ** 2) == pytest.approx(stress, rel=1e-6)
    assert stands * stress / (shear * 1e6) == pytest.approx(allowed, rel=1e-6)


def test_the_shear_of_a_shaft_balances_its_torque() -> None:
    """Stress grows with the radius, so the moment of all rings is the torque."""
    radius = np.linspace(0, 0.02, 20001)
    stress = shaft_shear_stress(300.0, 0.04) * radius / 0.02
    assert np.trapezoid(stress * radius * 2 * np.pi * radius, radius) == pytest.approx(300, rel=1e-6)
    assert shaft_shear_stress(300.0, shaft_diameter(300.0, 20e6)) == pytest.approx(20e6)


def test_thick_shafts_are_weaker() -> None:
    assert size_factor(0.0075) == 1
    assert size_factor(0.001) == 1  # never stronger than a test bar
    assert size_factor(0.15) == pytest.approx((1 - 0.26 * math.log10(150 / 16)) * 0.8)
    factors = size_factor(np.geomspace(0.008, 1, 50))
    assert (np.diff(factors) < 0).all()
    assert (factors > 0).all()


def test_the_strength_is_that_of_the_table() -> None:
    metals = Catalogs().table("metals")
    assert metals.number("fatigue_reversed_bending")[metals.row_index("C45")] == SHAFT_STEEL


DISC = {"load_torque": "200 N*m", "driver_speed": "1000 rpm", "driven_inertia": "0.5 kg*m2"}


@pytest.mark.slow
def test_a_shaft_that_breaks_is_no_design() -> None:
    front = synth.synthesize("disc_clutch", {**DISC, "shaft_diameter": "8 mm"}, points=1)
    assert front.status == "infeasible"
    assert "shaft_strength is 3510.8 N/mm2 where at most 120.72 N/mm2 is allowed" in str(front.explanation)


@pytest.mark.slow
def test_an_explanation_names_the_shaft_that_holds() -> None:
    told = synth.explain("disc_clutch", {**DISC, "shaft_diameter": "8 mm"})
    assert told.conflict == ("shaft_strength",)
    (way,) = told.single
    assert way.name == "shaft_diameter"
    holds = fatigue_shear(SHAFT_STEEL, size_factor(way.needed), 1.5)
    assert shaft_shear_stress(352.94118, way.needed) == pytest.approx(holds, rel=1e-2)


@pytest.mark.slow
def test_both_sizes_of_the_shaft_of_a_powder_clutch_count() -> None:
    duty = {"required_torque": "30 N*m", "slip_speed": "30 rpm"}
    sizes = {"gap_radius": "60 mm", "pole_length": "20 mm", "powder_gap": "1 mm"}
    problem = synth.load("magnetic_powder_clutch")
    for given in (
        {"shaft_diameter": "4 mm"},
        {"shaft_radius": "2 mm"},
        {"shaft_diameter": "4 mm", "shaft_radius": "9 mm"},
    ):
        front = synth.synthesize(problem, {**duty, **given}, points=1, fix=sizes)
        assert "shaft_strength" in str(front.explanation), given
