"""How heat leaves a clutch: rows of cooling_options in the families that have heat."""

import math

import pytest

import synth
from synth.tables.catalogs import Catalogs
from tests.problems.of_a_family import remarks

POWDER = {
    "values": {
        "gap_radius": "67 mm", "pole_length": "18 mm", "powder_gap": "1.25 mm", "coil_length": "23 mm",
        "coil_height": "15 mm", "yoke_thickness": "11 mm", "flux_density": "0.84 T", "coil": "stationary",
    },
    "parts": {"powder": "carbonyl_graphite", "winding_wire": "Cu 0.8 class 155"},
}  # fmt: skip
DISC = {
    "values": {
        "ring_outer_diameter": "175 mm", "ring_inner_diameter": "124 mm", "pressure_plate_thickness": "9 mm",
        "ramp_time": "0.57 s", "actuation_force": "3400 N", "discs": 1,
    },
    "parts": {"friction_pair": "moulded_dry"},
}  # fmt: skip
LOAD = {"load_torque": "60 N*m", "driver_speed": "1450 1/min", "driven_inertia": "0.4 kg*m2"}


def powder(coil="stationary", **options):
    asked = {**POWDER, "values": {**POWDER["values"], "coil": coil}}
    return synth.evaluate(synth.load("magnetic_powder_clutch", **options), {"required_torque": "30 N*m"}, **asked)


def disc(requirements=None, **options):
    return synth.evaluate(synth.load("disc_clutch", **options), LOAD | (requirements or {}), **DISC)


def conductance(found):
    """What a body of a coil gives off [W/K], of the outside that is told."""
    outside = found.values["outer_diameter"] / 2
    length = found.values["pack_length"]
    return found.steps["coil_conductance"] / (2 * math.pi * outside * (outside + length))


@pytest.mark.parametrize(
    ("row", "expected"), [("still_air", 12), ("finned", 30), ("fan", 40), ("finned_fan", 100), ("water", 500)]
)
def test_a_standing_body_gives_off_heat_by_its_row(row, expected):
    assert conductance(powder(cooling=row)) == pytest.approx(expected)


def test_a_turning_body_gives_off_more():
    found = powder("rotating", cooling="finned")
    speed = found.values["outer_diameter"] / 2 * 1432.39 * math.pi / 30
    assert conductance(found) == pytest.approx(2.5 * (12 + 3 * speed**0.8))


def test_fins_weigh_a_tenth_of_the_shell_that_bears_them():
    plain, finned = powder(cooling="still_air"), powder()
    outside, length = plain.values["outer_diameter"] / 2, plain.values["pack_length"]
    shell = 7850 * math.pi * (outside**2 - (outside - 0.011) ** 2) * length
    assert finned.values["mass"] - plain.values["mass"] == pytest.approx(0.1 * shell)
    assert "fins_mass" not in plain.steps


def test_a_typed_coefficient_wins_over_the_row_and_keeps_the_fins():
    typed = synth.evaluate(
        synth.load("magnetic_powder_clutch", cooling="finned"),
        {"required_torque": "30 N*m", "still_heat_transfer": "15 W/(m2*K)"},
        **POWDER,
    )
    assert conductance(typed) == pytest.approx(2.5 * 15)
    rise = {row: disc(cooling=row).values["mean_temperature_rise"] for row in ("still_air", "finned", "fan")}
    assert rise["still_air"] == pytest.approx(2.5 * rise["finned"])
    assert rise["still_air"] == pytest.approx(2.5 * rise["fan"])
    found = disc({"heat_transfer": "50 W/(m2*K)"}, cooling="finned").values["mean_temperature_rise"]
    assert found == pytest.approx(rise["fan"] / 2.5)


def test_a_jacket_needs_a_body_that_stands():
    assert powder(cooling="water").limits["standing_body"][0] < 0.5
    assert "standing_body" in powder("rotating", cooling="water").violated
    right = "a cooling of bodies that turn: still_air, finned, fan, finned_fan, forced_air, oil_bath, through_oil"
    with pytest.raises(synth.InputError, match=right):
        disc(cooling="water")


def test_a_powder_clutch_is_dry():
    with pytest.raises(synth.InputError, match=r"for lubrication dry: still_air or finned or fan .* or water"):
        powder(cooling="oil_bath")


def test_a_row_of_starts_warms_less_than_starts_without_end():
    endless, row = disc(), disc({"starts_in_row": "10"})
    decays = 10 * 20 * endless.steps["cooled_area"] / (endless.steps["heat_capacity"] * 50 / 3600)
    mean = -math.expm1(-decays) * endless.values["mean_temperature_rise"]
    assert row.limits["mean_temperature"][0] == pytest.approx(mean)
    assert row.values["mean_temperature_rise"] == row.limits["mean_temperature"][0]


RATES = [("moulded_dry", 2.5, 18.0, 60, 0.282698908), ("woven_dry", 1.5, 12.0, 8, 0.948180838)]


@pytest.mark.parametrize(("pair", "single", "hourly", "rate", "allowed"), RATES)
def test_one_law_for_the_heat_of_one_engagement_and_of_an_hour(pair, single, hourly, rate, allowed):
    asked = {**DISC, "parts": {"friction_pair": pair}}
    requirements = LOAD | {"engagements_per_hour": f"{rate} 1/h"}
    on, off = (
        synth.evaluate(synth.load("disc_clutch", practice=word), requirements, **asked) for word in ("on", "off")
    )
    row = on.parts["friction_pair"]
    assert (row["q_single_allow"], row["q_hourly_allow"] * 3600) == pytest.approx((1e6 * single, 1e6 * hourly))
    assert on.limits["rate_heat"] == pytest.approx((on.values["single_heat"], 1e6 * allowed))
    assert not {"engagement_heat", "specific_heat"} & set(on.limits)
    assert allowed < min(off.limits["engagement_heat"][1], off.limits["specific_heat"][1] * 3600 / rate) / 1e6
    assert "rate_heat" not in off.limits


def test_without_the_heat_of_one_engagement_only_that_of_an_hour_counts():
    rows = Catalogs().table("friction_materials").to_frame()
    lacking = rows.drop(columns=[head for head in rows if str(head).startswith("q_single_allow")])
    found = synth.evaluate(synth.load("disc_clutch"), LOAD, **DISC, catalogs={"friction_materials": lacking})
    assert found.limits["rate_heat"][1] == pytest.approx(18e6 / 50)


def test_the_next_stronger_cooling_is_named_where_little_is_left():
    cool = disc({"engagements_per_hour": "10 1/h"})
    assert "stronger_cooling" not in remarks(cool)
    limit = cool.limits["mean_temperature"]
    often = f"{9.5 * limit[1] / limit[0]} 1/h"  # 95 % of what the lining stands
    for chosen, following, share in (("still_air", "finned", 40), ("forced_air", "finned_fan", 64)):
        scale = {"still_air": 1, "forced_air": 4}[chosen]
        found = disc({"engagements_per_hour": f"{scale * float(often.split()[0])} 1/h"}, cooling=chosen)
        text = next(x for x in found.advice if x.startswith("stronger_cooling"))
        assert f"cooling {following.replace('_', ' ')} would bring the rise to about {share} %" in text
        again = disc({"engagements_per_hour": f"{scale * float(often.split()[0])} 1/h"}, cooling=following)
        assert found.steps["cooler_rise"] == pytest.approx(again.values["mean_temperature_rise"])
    typed = {"engagements_per_hour": often, "heat_transfer": "20 W/(m2*K)"}
    assert "stronger_cooling" not in remarks(disc(typed))
