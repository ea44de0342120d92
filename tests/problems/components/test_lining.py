"""What linings stand in practice: worked pressures, columns of the table, and tables that lack them."""

import math

import pytest

import synth
from synth.question.catalogs import as_catalogs

CAR = {"load_torque": "40 N*m", "driver_speed": "1500 1/min", "driven_inertia": "0.7 kg*m2"}
HOIST = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
NEW = ["p_mean_allow", "p_max_allow", "v_practice", "counter_mean_max", "counter_peak_max"]


def disc(pair="moulded_dry", requirements=None, practice="on", catalogs=None):
    return synth.evaluate(
        synth.load("disc_clutch", practice=practice),
        {**CAR, **(requirements or {})},
        values={
            "ring_outer_diameter": "248.4 mm",
            "ring_inner_diameter": "198.7 mm",
            "actuation_force": "1938 N",
            "pressure_plate_thickness": "15 mm",
            "discs": 1,
            "ramp_time": "0.5 s",
        },
        parts={"friction_pair": pair},
        catalogs=catalogs,
    )


def pack(pair="seed_multiplate_ref"):
    return synth.evaluate(
        synth.load("multi_plate_clutch", guide_model="cz", allow_obsolete="historical"),
        HOIST,
        values={
            "ring_outer_diameter": "258.110624 mm",
            "ring_inner_diameter": "154.866374 mm",
            "actuation_force": "13394.966 N",
            "ramp_time": "2 s",
            "friction_surfaces": 10,
        },
        parts={"friction_pair": pair, "inner_plate": "core 4", "outer_plate": "core 2"},
    )


def cone():
    length = 20 / math.sin(math.radians(12))
    return synth.evaluate(
        synth.load("cone_clutch"),
        CAR,
        values={
            "mean_diameter": "216 mm",
            "generator_length": f"{length} mm",
            "cone_half_angle": "12 deg",
            "shell_thickness": "8 mm",
            "actuation_force": "1500 N",
            "ramp_time": "1 s",
        },
        parts={"friction_pair": "moulded_dry", "cone_layout": "outer_spring"},
    )


def allowed(found, name):
    return found.limits[name][1]


def table(**cells):
    """Shipped linings without the columns of practice, or with others."""
    frame = as_catalogs(None).table("friction_materials").to_frame()
    heads = [head for head in frame.columns if head.split(" [")[0] in NEW]
    return {"friction_materials": frame.drop(columns=heads).assign(**cells)}


@pytest.mark.parametrize(("found", "mean", "edge"), [(disc, 0.111045978, 0.124933711), (pack, 0.4, 0.533333342)])
def test_worked_pressures(found, mean, edge):
    values = found().values
    assert values["surface_pressure"] / 1e6 == pytest.approx(mean, rel=2e-8)
    assert values["edge_pressure"] / 1e6 == pytest.approx(edge, rel=2e-8)


def test_the_narrow_end_of_a_worn_cone_is_pressed_hardest():
    values = cone().values
    assert values["edge_pressure"] / values["surface_pressure"] == pytest.approx(0.121802252 / 0.110524266, rel=2e-8)


@pytest.mark.parametrize(
    ("pair", "mean", "edge", "speed", "temperature"),
    [
        ("moulded_dry", 0.45, 0.63, 20, 200),
        ("sinter_bronze_dry", 0.7, 0.98, 25, 200),
        ("woven_dry", 0.3, 0.42, 20, 150),
    ],
)
def test_practice_asks_less_than_makers(pair, mean, edge, speed, temperature):
    used, makers = disc(pair), disc(pair, practice="off")
    assert allowed(used, "surface_pressure") / 1e6 == pytest.approx(mean, rel=1e-12)
    assert allowed(used, "edge_pressure") / 1e6 == pytest.approx(edge, rel=1e-12)
    assert allowed(used, "sliding_speed") == pytest.approx(speed, rel=1e-12)
    assert allowed(used, "mean_temperature") == pytest.approx(temperature - 40, rel=1e-12)
    row = used.parts["friction_pair"]
    assert allowed(makers, "surface_pressure") == row["p_allow"]
    assert allowed(makers, "sliding_speed") == row["v_allow"]
    assert allowed(makers, "mean_temperature") == pytest.approx(row["temp_continuous"] - 313.15, rel=1e-12)
    assert "edge_pressure" not in {*makers.limits, *makers.values}


def test_a_typed_ratio_of_edge_pressure_is_one_to_the_makers_pressure():
    assert allowed(disc(requirements={"edge_pressure_ratio": 1.2}), "edge_pressure") == pytest.approx(0.84e6, rel=1e-12)


def test_a_table_without_columns_of_practice_counts_as_before():
    found = disc(catalogs=table())
    row = found.parts["friction_pair"]
    assert allowed(found, "surface_pressure") == row["p_allow"]
    assert allowed(found, "edge_pressure") == pytest.approx(1.4 * row["p_allow"], rel=1e-12)
    assert allowed(found, "sliding_speed") == row["v_allow"]
    assert allowed(found, "mean_temperature") == pytest.approx(row["temp_continuous"] - 313.15, rel=1e-12)


def test_a_listed_edge_pressure_counts():
    found = disc(catalogs=table(**{"p_mean_allow [N/mm2]": 0.4, "p_max_allow [N/mm2]": 0.5}))
    assert allowed(found, "surface_pressure") == pytest.approx(0.4e6, rel=1e-12)
    assert allowed(found, "edge_pressure") == pytest.approx(0.5e6, rel=1e-12)


def test_hot_plates_in_oil_are_limited_by_the_steel():
    assert allowed(pack("graphitic_wet"), "peak_temperature") == pytest.approx(210, rel=1e-12)
    assert allowed(pack("steel_steel_wet"), "mean_temperature") == pytest.approx(90, rel=1e-12)


def test_centrifugal_linings_have_a_mean_pressure_beside_that_of_the_edge():
    case = {
        "required_torque": "20 N*m",
        "idle_speed": "1200 1/min",
        "contact_speed_min": "1400 1/min",
        "contact_speed_max": "2000 1/min",
        "full_torque_speed": "3000 1/min",
        "top_speed": "5000 1/min",
    }
    parts = {"ball": ["ball 18"], "return_spring": ["CS-0.8x4x12.5"], "friction_pair": ["metal_ceramic_bronze_dry"]}
    (found,) = synth.synthesize("centrifugal_ball_ramp", case, ["mass"], 1, parts=parts).designs
    inner, outer = found.values["lining_inner_radius"], found.values["lining_outer_radius"]
    area = math.pi * (outer**2 - inner**2)
    assert found.values["surface_pressure"] == pytest.approx(found.values["clamp_force"] / area, rel=1e-9)
    assert allowed(found, "surface_pressure") == pytest.approx(0.5e6, rel=1e-12)
    assert allowed(found, "lining_pressure") == pytest.approx(0.7e6, rel=1e-12)


@pytest.mark.parametrize(
    ("family", "options", "take_up"),
    [
        ("disc_clutch", {}, "soft"),
        ("cone_clutch", {}, "soft"),
        ("cone_clutch", {"cone_release": "self"}, "any"),  # soft linings hold cones fast
        ("multi_plate_clutch", {}, "any"),
        ("electromagnetic_clutch", {"pack": "disc"}, "any"),
        ("centrifugal_lever", {}, "any"),
    ],
)
def test_discs_and_cones_take_up_softly(family, options, take_up):
    assert {o["name"]: o["default"] for o in rows_of(family, options)}["take_up"] == take_up


def rows_of(family, options):
    return synth.describe(synth.load(family, **options)).to_dict("records")


def test_one_disc_is_built_unless_two_are_asked_for():
    assert allowed(disc(), "discs_practice") == 1
    assert allowed(disc(requirements={"discs_max": 2}), "discs_practice") == 2


def test_oil_ages_before_lining_and_steel_give_way():
    assert allowed(pack(), "oil_temperature") == pytest.approx(80, rel=1e-12)
    assert allowed(pack(), "oil_temperature") < allowed(pack(), "mean_temperature")


def test_no_torque_comes_as_a_step_where_no_jerk_is_limited():
    for found in (disc(), pack(), cone()):
        ramp, least = found.limits["soft_start"]
        assert ramp == found.values["ramp_time"]
        assert least == pytest.approx(0.1 * found.values["slip_time"], rel=1e-12)
    assert disc(requirements={"soft_start_share": 0.2}).limits["soft_start"][1] == pytest.approx(
        2 * disc().limits["soft_start"][1], rel=1e-12
    )
    for found in (disc(requirements={"jerk_limit": "300 rad/s3"}), disc(practice="off")):
        assert "soft_start" not in found.limits


def test_a_ramp_at_the_limit_of_the_soft_start_is_no_step():
    duty = {"load_torque": "60.5 N*m", "driver_speed": "1500 1/min", "driven_inertia": "0.5 kg*m2"}
    front = synth.synthesize("cone_clutch", duty, points=6)
    assert all(design.utilisation["soft_start"] == pytest.approx(1, abs=2e-6) for design in front.designs)
    assert not any("step" in remark for design in front.designs for remark in design.advice)
    free = synth.synthesize("cone_clutch", {**duty, "soft_start_share": 0.05}, points=1).designs[0]
    assert any("step" in remark for remark in free.advice)
