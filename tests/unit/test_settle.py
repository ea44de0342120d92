"""What the best design in one objective leaves free is settled by the other objectives, makeable values included."""

import pytest

import synth
from synth import DesignProblem


class Beam(DesignProblem):
    """A clamped beam with a cover: the deflection does not see the cover, which only weighs."""

    name, title, sources = "covered_beam", "Covered beam", ("textbook",)

    def declare(self, d):
        load = d.requirement("load", "kN", 1, lower=0.1, upper=10)
        height = d.variable("height", "mm", 20, 90, grid=1)
        width = d.variable("width", "mm", 10, 40)
        cover = d.variable("cover", "mm", 2, 12, grid=0.5)
        clamp = d.variable("clamp", "N", 10, 1e5)
        d.derive("deflection", "mm", load * 1e-9 / (width * height**3) * (1 + clamp / 1e5))
        d.derive("mass", "kg", 7850 * height * (width + cover))
        d.at_most("slenderness", height, 3.5 * width, "mm")
        d.at_least("hold", clamp * height, load / 2, "N*m")
        d.objective("deflection")
        d.objective("mass")


@pytest.mark.parametrize("points", [6, 30])
def test_the_stiffest_beam_has_no_cover_that_only_weighs(points):
    front = synth.synthesize(Beam, {}, points=points)
    assert front.certificate.kind == "global"
    stiffest = min(front.designs, key=lambda d: d.values["deflection"]).values
    assert stiffest["height"] == pytest.approx(0.090)
    assert stiffest["cover"] == pytest.approx(0.002)


def test_the_parts_that_an_objective_does_not_see_are_the_lightest():
    requirements = {
        "load_torque": "200 N*m", "driver_speed": "700 rpm", "driven_inertia": "2 kg*m2",
        "jerk_limit": "600 rad/s3", "outer_diameter_limit": "400 mm", "engagements_per_hour": 30,
    }  # fmt: skip
    front = synth.synthesize("cone_clutch", requirements, points=30)
    least = min(front.designs, key=lambda d: d.values["actuation_force"])
    assert str(least.parts["cone_layout"]) == "outer_spring"  # the inner cone is heavier and needs the same force
    assert least.values["shell_thickness"] == pytest.approx(0.003)


def test_a_makeable_value_that_is_pinned_stays():
    front = synth.synthesize(Beam, {}, points=6, fix={"cover": "7.5 mm"})
    assert {round(d.values["cover"], 9) for d in front.designs} == {0.0075}
