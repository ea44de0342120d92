"""Both wrap spring families: their numbers against an independent calculation, their limits, refusals and remarks."""

import math

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import remarks, requirements_in_si

PI = math.pi
BASE = {"required_torque": "30 N*m", "bore_diameter": "20 mm"}
POINT = {"interference": "0.8 mm", "hub_diameter": "45 mm", "coils_per_hub": 6}
PARTS = {"wire": "rect 4x3", "friction_pair": "hardened_steel_greased"}
ACTUATED = {**BASE, "relative_speed": "500 1/min"}
ACTUATED_POINT = {"clearance": "0.08 mm", "actuator_torque": "3 N*m", "hub_diameter": "45 mm", "coils_per_hub": 6}
WIRE = {
    "wire_modulus": "206 GPa",
    "wire_density": "7850 kg/m3",
    "wire_bending_allow": "1000 N/mm2",
    "wire_tensile_strength": "1430 N/mm2",
    "wire_endurance_amplitude": "429 N/mm2",
}


def clutch(options=None, requirements=None, values=None, parts=None):
    problem = synth.load("wrap_spring", practice="off", **(options or {}))
    return synth.evaluate(
        problem, BASE | (requirements or {}), values=POINT | (values or {}), parts=PARTS | (parts or {})
    )


def actuated(options=None, requirements=None, values=None, parts=None):
    problem = synth.load("wrap_spring_actuated", practice="off", **(options or {}))
    return synth.evaluate(
        problem, ACTUATED | (requirements or {}), values=ACTUATED_POINT | (values or {}), parts=PARTS | (parts or {})
    )


# -- numbers ---------------------------------------------------------------------------------------


def by_hand(model, policy, peak=75.0, speed=0.0, over=0.0, duty=1.0, dr=0.8e-3, n=6.0):
    """Section by section from the reference, at both ends of friction and tolerance."""
    a, b, modulus, rho, mu_min, mu_max, tol = 3e-3, 4e-3, 206e9, 7850.0, 0.08, 0.16, 0.03e-3
    r_h, bore = 22.5e-3, 20e-3
    r_m = r_h if model == "seed" else r_h + a / 2
    inertia = b * a**3 / 12

    def moment(x):
        return modulus * inertia * (x / r_m**2 if model == "seed" else 1 / (r_m - x) - 1 / r_m)

    low, high = moment(dr - tol), moment(dr + tol)
    hoop = 0.0 if model == "seed" else rho * a * b * r_m**2 * speed**2 * r_m
    beta = {mu: mu * 2 * PI * n * r_h / r_m for mu in (mu_min, mu_max)}
    v = {"closing_torque": (low - hoop) * (math.exp(beta[mu_min]) - 1)}
    v["slip_torque"] = high * (math.exp(beta[mu_max]) - 1)
    v["drag_torque"] = high * (1 - math.exp(-beta[mu_max]))
    v["belt_exponent"] = beta[mu_max]
    v["wire_torque"] = load = peak if policy == "torque_limited" else min(peak, v["slip_torque"])
    v["bending_moment"] = high
    bending = high * a / 2 / inertia
    v["wire_stress"] = bending + (high + load) / r_m / (a * b)
    v["contact_pressure"] = (high + load) / (b * r_h * r_m)
    least, most = (bending + (high + t) / r_m / (a * b) for t in (0.0, 1.5 * 30))
    v["fatigue_utilisation"] = 1.2 * ((most - least) / 2 / 429e6 + (most + least) / 2 / 1430e6)
    v["overrun_pv"] = high / (b * r_h * r_m) * over * r_h
    v["total_coils"] = total = 2 * n + 0.5
    v["length"] = length = total * (b + 0.2e-3)
    v["outer_diameter"] = outer = 2 * (r_h + a)
    v["temperature_rise"] = v["drag_torque"] * over * duty / (25 * PI * outer * length)
    v["hub_shear"] = 16 * load * 2 * r_h / (PI * ((2 * r_h) ** 4 - bore**4))
    v["liftoff_speed"] = math.sqrt(modulus * a**2 * low / (modulus * inertia) / (12 * rho * r_m**3))
    v["mean_coil_radius"] = r_m
    v["mass"] = rho * a * b * 2 * PI * r_m * total + 7850 * PI * (r_h**2 - bore**2 / 4) * length
    friction = mu_min * r_h / r_m
    end, preload = (low + 30) / r_m, low / r_m
    arc = math.log(end / preload) / friction
    elongation = 2 * ((end - preload) / friction - preload * arc) + 2 * PI * 0.5 * (end - preload)
    v["windup_angle"] = elongation / (modulus * a * b)
    v["stress_utilisation"] = v["wire_stress"] / 1000e6
    v["pressure_utilisation"] = v["contact_pressure"] / 60e6
    return v


@pytest.mark.parametrize("model", ["refined", "seed"])
@pytest.mark.parametrize("policy", ["slip_limited", "torque_limited"])
@pytest.mark.parametrize(("peak", "speed", "over", "duty"), [(75.0, 0, 0, 1), (4000.0, 150.0, 30.0, 0.2)])
def test_numbers_against_an_independent_calculation(model, policy, peak, speed, over, duty):
    requirements = {
        "peak_torque": peak,
        "spring_speed": f"{speed} rad/s",
        "overrun_speed": f"{over} rad/s",
        "overrun_duty": duty,
    }
    found = clutch({"model": model, "overload": policy}, requirements)
    assert found.parts["wire"]["endurance_amplitude"] == 429e6
    for name, value in by_hand(model, policy, peak, speed, over, duty).items():
        assert found.values[name] == pytest.approx(value, rel=1e-9), name


def test_a_wire_of_ones_own_gives_what_the_same_wire_of_the_catalogue_gives():
    own = synth.evaluate(
        synth.load("wrap_spring", practice="off", wire_choice="custom"),
        BASE | WIRE,
        values=POINT | {"a": "3 mm", "b": "4 mm"},
        parts={"friction_pair": PARTS["friction_pair"]},
    )
    catalogue = clutch()
    for name, value in catalogue.values.items():
        assert own.values[name] == pytest.approx(value, rel=1e-12), name
    assert own.utilisation == pytest.approx(catalogue.utilisation)


def test_beyond_liftoff_nothing_grips_and_no_torque_is_told():
    """Model seed counts torques at rest, as its source does: there the limit alone speaks of lift-off."""
    lift = clutch().values["liftoff_speed"]
    below, beyond = ({"spring_speed": f"{share * lift!r} rad/s"} for share in (0.999, 1.001))
    found = clutch(requirements=below)
    assert found.values["closing_torque"] > 0
    assert {"liftoff", "closing_torque"} <= set(found.violated)
    assert "grip" not in found.violated
    found = clutch(requirements=beyond)
    assert math.isnan(found.values["closing_torque"])
    assert {"liftoff", "grip"} <= set(found.violated)
    assert "closing_torque" not in found.violated  # the guard alone tells why
    loose = clutch(values={"interference": "0.02 mm"})  # less than its tolerance
    assert math.isnan(loose.values["closing_torque"])
    at_rest, spinning = (clutch({"model": "seed"}, speed) for speed in ({}, beyond))
    assert spinning.values["closing_torque"] == at_rest.values["closing_torque"] > 0
    assert "grip" not in spinning.utilisation
    assert "liftoff" in clutch({"model": "seed"}, {"spring_speed": "60000 1/min"}).violated


def test_curves_beyond_liftoff_show_no_torque_below_zero():
    lift = clutch().values["liftoff_speed"]
    speed = {"spring_speed": f"{1.5 * lift!r} rad/s"}
    frames = synth.curves(synth.load("wrap_spring", practice="off"), BASE | speed, values=POINT, parts=PARTS)
    for name in ("torque_over_friction", "torque_over_interference"):
        torques = frames[name].filter(regex=r"torque \[N")
        assert torques.shape[1] >= 2
        assert (torques.to_numpy() >= 0).all(), name
    assert (frames["torque_over_friction"]["loosest closing torque [N*m]"] == 0).all()


def test_worked_example_as_a_design():
    """The example of the reference: no tolerance to speak of, one friction coefficient, a wire of one's own."""
    pair = pd.DataFrame(
        {
            "designation": ["example"],
            "surfaces": ["wire on hub"],
            "mu_min [-]": [0.1],
            "mu_max [-]": [0.1],
            "p_allow [N/mm2]": [100.0],
            "pv_allow [W/mm2]": [1.0],
        }
    )
    for model, closing, drag, peak in (
        ("seed", 13.1463, 1.06489, 8.94069e6),
        ("refined", 9.49549, 0.916574, 6.11046e6),
    ):
        found = synth.evaluate(
            synth.load("wrap_spring", practice="off", model=model, wire_choice="custom"),
            {"required_torque": 5, "bore_diameter": "20 mm", "peak_torque": 1000, "tol": "0.001 mm", **WIRE},
            values={"dr": "0.25 mm", "a": "3 mm", "b": "4 mm", "d_h": "40 mm", "n": 4},
            parts={"friction_pair": "example"},
            catalogs={"friction_materials": pair},
        )
        v = found.values
        # The tolerance of a thousandth of a millimetre moves both ends by 0.4 % each.
        assert (v["closing_torque"] + v["slip_torque"]) / 2 == pytest.approx(closing, rel=1e-4)
        assert v["drag_torque"] == pytest.approx(drag * 1.004, rel=1e-3)
        assert v["contact_pressure"] == pytest.approx(peak * 1.004, rel=1e-3)
        assert v["wire_torque"] == v["slip_torque"]


def actuated_by_hand(model, speed):
    a, b, modulus, rho, mu_min, mu_max, tol, n = 3e-3, 4e-3, 206e9, 7850.0, 0.08, 0.16, 0.03e-3, 6.0
    r_h, bore, c, t0, peak = 22.5e-3, 20e-3, 0.08e-3, 3.0, 75.0
    r_m = r_h if model == "seed" else r_h + a / 2
    inertia = b * a**3 / 12

    def moment(x):
        return modulus * inertia * (-x / r_m**2 if model == "seed" else 1 / (r_m + x) - 1 / r_m)

    wide, narrow = moment(c + tol), moment(c - tol)
    effective = wide - (0.0 if model == "seed" else rho * a * b * r_m**3 * speed**2)
    beta = {mu: mu * 2 * PI * n * r_h / r_m for mu in (mu_min, mu_max)}
    total = n + 0.5 + 1
    length = total * (b + 0.2e-3)
    return {
        "closing_torque": t0 + (t0 + effective) * (math.exp(beta[mu_min]) - 1),
        "belt_exponent": beta[mu_max],
        "wire_torque": peak,
        "bending_moment": narrow,
        "wire_stress": abs(wide) * a / 2 / inertia + (narrow + peak) / r_m / (a * b),
        "contact_pressure": (narrow + peak) / (b * r_h * r_m),
        "wrap_angle": 2 * PI * (n + 0.5) * (c + tol) / r_m,
        "engagement_time": 2 * PI * (n + 0.5) * (c + tol) / r_m / (500 * 2 * PI / 60),
        "mean_coil_radius": r_m,
        "total_coils": total,
        "length": length,
        "outer_diameter": 2 * (r_h + a),
        "mass": rho * a * b * 2 * PI * r_m * total + 7850 * PI * (r_h**2 - bore**2 / 4) * length,
    }


@pytest.mark.parametrize("model", ["refined", "seed"])
@pytest.mark.parametrize("speed", [0.0, 120.0])
def test_numbers_of_the_clearance_fit(model, speed):
    found = actuated({"model": model}, {"spring_speed": f"{speed} rad/s"})
    assert found.status.value == "feasible"
    for name, value in actuated_by_hand(model, speed).items():
        assert found.values[name] == pytest.approx(value, rel=1e-9), name


def test_the_energising_torque_of_the_closed_form_is_just_enough():
    """Section 4 of the reference: least clearance that survives, and the torque that closes and holds."""
    front = synth.synthesize(
        synth.load("wrap_spring_actuated", practice="off"),
        ACTUATED,
        objectives=["actuator_torque"],
        parts={k: [v] for k, v in PARTS.items()},
        fix={"hub_diameter": "45 mm", "coils_per_hub": 6},
    )
    (best,) = front.designs
    assert best.values["clearance"] == pytest.approx(0.08e-3, rel=1e-6)
    r_m, beta = 24e-3, 0.08 * 2 * PI * 6 * 22.5 / 24
    effective = 206e9 * 9e-12 * (1 / (r_m + 0.11e-3) - 1 / r_m)
    wanted = (1.3 * 30 - effective * (math.exp(beta) - 1)) * math.exp(-beta)
    assert best.values["actuator_torque"] == pytest.approx(wanted, rel=1e-5)


# -- limits ----------------------------------------------------------------------------------------

ALWAYS = {
    "interference_positive",
    "grip",
    "interference_range",
    "closing_torque",
    "liftoff",
    "wire_stress",
    "contact_pressure",
    "fatigue",
    "overrun_pv",
    "overrun_temperature",
    "hub_bore",
    "hub_shear",
    "spring_index",
}
ASKED = {
    "drag_torque": ("drag_torque_limit", "8 N*m"),
    "belt_exponent": ("belt_exponent_limit", 20),
    "outer_diameter": ("outer_diameter_limit", "60 mm"),
    "length": ("length_limit", "90 mm"),
}
ALWAYS_ACTUATED = {
    "closing_torque",
    "grip",
    "clearance_kept",
    "wire_stress",
    "contact_pressure",
    "spring_index",
    "hub_bore",
}
ASKED_ACTUATED = {
    "actuator_torque": ("actuator_torque_limit", "5 N*m"),
    "wrap_angle": ("wrap_angle_limit", "3 rad"),
    **{k: v for k, v in ASKED.items() if k != "drag_torque"},
}


@pytest.mark.parametrize(
    ("make", "always", "asked"), [(clutch, ALWAYS, ASKED), (actuated, ALWAYS_ACTUATED, ASKED_ACTUATED)]
)
def test_limits_are_built_when_they_are_asked_for(make, always, asked):
    assert set(make().limits) == always
    for limit, (requirement, value) in asked.items():
        assert set(make(None, {requirement: value}).limits) == always | {limit}
    assert set(make(None, dict(asked.values())).limits) == always | set(asked)


@pytest.mark.parametrize(
    ("limit", "requirements", "values", "parts"),
    [
        ("interference_range", {"interference_ratio_max": 0.02}, {}, {}),
        ("closing_torque", {"slip_safety": 4}, {}, {}),
        ("liftoff", {"spring_speed": "12000 1/min"}, {}, {}),
        ("wire_stress", {"peak_torque": "300 N*m"}, {}, {}),
        ("contact_pressure", {"peak_torque": "400 N*m"}, {}, {}),
        ("fatigue", {"service_factor": 5}, {}, {}),
        ("overrun_pv", {"overrun_speed": "1500 1/min"}, {}, {}),
        ("overrun_temperature", {"overrun_speed": "200 1/min"}, {}, {}),
        ("hub_shear", {"hub_shear_limit": "4 N/mm2"}, {}, {}),
        ("spring_index", {}, {"hub_diameter": "14 mm"}, {}),
        ("hub_bore", {"bore_diameter": "50 mm"}, {}, {}),
        ("interference_positive", {}, {"interference": "0.029 mm"}, {}),
        ("drag_torque", {"drag_torque_limit": "1 N*m"}, {}, {}),
        ("belt_exponent", {"belt_exponent_limit": 5}, {}, {}),
        ("outer_diameter", {"outer_diameter_limit": "50 mm"}, {}, {}),
        ("length", {"length_limit": "40 mm"}, {}, {}),
    ],
)
def test_each_limit_of_the_interference_fit_can_be_violated(limit, requirements, values, parts):
    assert limit not in clutch().violated
    assert limit in clutch(None, requirements, values, parts).violated


@pytest.mark.parametrize(
    ("limit", "requirements", "values"),
    [
        ("closing_torque", {"slip_safety": 4}, {}),
        ("grip", {}, {"actuator_torque": "0.05 N*m"}),
        ("clearance_kept", {"clearance_min": "0.06 mm"}, {}),
        ("wire_stress", {"peak_torque": "400 N*m"}, {}),
        ("contact_pressure", {"peak_torque": "200 N*m"}, {}),
        ("hub_bore", {"hub_wall_min": "13 mm"}, {}),
        ("actuator_torque", {"actuator_torque_limit": "1 N*m"}, {}),
        ("wrap_angle", {"wrap_angle_limit": "0.1 rad"}, {}),
    ],
)
def test_each_limit_of_the_clearance_fit_can_be_violated(limit, requirements, values):
    assert limit not in actuated().violated
    assert limit in actuated(None, requirements, values).violated


def test_without_grip_nothing_closes():
    found = actuated(values={"actuator_torque": "0.05 N*m"})
    assert found.violated == ("grip",)
    assert math.isnan(found.values["closing_torque"])
    assert found.values["mass"] > 0


def test_with_a_preload_that_may_vanish_nothing_is_known_of_the_fit():
    found = clutch(values={"interference": "0.029 mm"})
    assert set(found.violated) == {"interference_positive", "grip"}
    for name in ("liftoff_speed", "windup_angle", "wire_stress", "drag_torque"):
        assert math.isnan(found.values[name]), name


# -- refusals and remarks --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "options", "requirements", "code"),
    [
        (clutch, {}, {"peak_torque": "29 N*m"}, "peak_below_required"),
        (actuated, {}, {"peak_torque": "29 N*m"}, "peak_below_required"),
        (clutch, {}, {"bore_diameter": "200 mm"}, "hub_thinner_than_bore"),
        (clutch, {}, {"outer_diameter_limit": "20 mm"}, "no_room_for_hub"),
        (clutch, {"wire_choice": "custom"}, {}, "wire_modulus"),
        (actuated, {"wire_choice": "custom"}, {"wire_modulus": "206 GPa"}, "wire_density"),
        (clutch, {}, {"relative_speed": 5}, "relative_speed"),
        (clutch, {}, {"interference_tolerance": 0}, "interference_tolerance"),
        (clutch, {"overload": "none"}, {}, "overload"),
        (actuated, {"overload": "slip_limited"}, {}, "options"),
    ],
)
def test_impossible_input_is_refused_by_name(make, options, requirements, code):
    with pytest.raises(synth.InputError) as refusal:
        make(options, requirements)
    assert code in refusal.value.field or code in str(refusal.value.value)
    assert refusal.value.expected


def test_a_clutch_with_a_speed_must_be_told_it():
    with pytest.raises(synth.InputError, match="relative_speed"):
        synth.synthesize(synth.load("wrap_spring_actuated", practice="off"), BASE)


@pytest.mark.parametrize("value", [0.5, 1.0])
def test_less_than_two_coils_are_not_offered(value):
    with pytest.raises(synth.InputError, match="coils_per_hub"):
        synth.synthesize(synth.load("wrap_spring", practice="off"), BASE, fix={"coils_per_hub": value})


def left_out(requirements, catalogs=None):
    instance = instance_of(synth.load("wrap_spring", practice="off"), BASE | requirements, as_catalogs(catalogs))
    return {row["designation"]: row["reason"] for row in instance.selection.left_out}


def test_pairs_that_cannot_reach_the_drag_limit_are_left_out():
    """The floor of section 10: S_T T_req (1 - exp(-beta_max))/(exp(beta_min) - 1) with twelve coils."""

    def floor(mu_min, mu_max):
        low, high = (mu * 2 * PI * 12 for mu in (mu_min, mu_max))
        return 39 * (1 - math.exp(-high)) / math.expm1(low)

    border = floor(0.06, 0.12)  # hardened_steel_oil
    assert "hardened_steel_oil" in left_out({"drag_torque_limit": f"{border * 0.999} N*m"})
    assert "hardened_steel_oil" not in left_out({"drag_torque_limit": f"{border * 1.001} N*m"})
    reason = left_out({"drag_torque_limit": f"{border * 0.999} N*m"})["hardened_steel_oil"]
    assert reason.startswith("drag_limit_unreachable")
    with pytest.raises(synth.InputError, match="drag_limit_unreachable"):
        synth.synthesize(
            synth.load("wrap_spring", practice="off"),
            BASE | {"drag_torque_limit": f"{border * 0.999} N*m"},
            parts={"friction_pair": ["hardened_steel_oil"]},
        )


PAIR = {
    "designation": ["good", "reversed"],
    "surfaces": ["wire on hub", "wire on hub;cone facing"],
    "mu_min [-]": [0.1, 0.2],
    "mu_max [-]": [0.15, 0.15],
    "p_allow [N/mm2]": [50.0, 50.0],
    "pv_allow [W/mm2]": [1.0, 1.0],
}


def test_a_friction_range_the_wrong_way_round_is_left_out():
    found = left_out({}, {"friction_materials": pd.DataFrame(PAIR)})
    assert set(found) == {"reversed"}
    assert found["reversed"].startswith("friction_range_reversed")


@pytest.mark.parametrize(
    ("table", "column", "value"),
    [
        ("friction_materials", "mu_min [-]", 0.0),
        ("spring_wire_flat", "radial_thickness_a [mm]", 0.0),
        ("spring_wire_flat", "axial_width_b [mm]", -1.0),
        ("spring_wire_flat", "E [N/mm2]", 0.0),
    ],
)
def test_figures_that_no_part_can_have_are_refused_with_the_table(table, column, value):
    frame = as_catalogs(None).table(table).to_frame()
    frame.loc[0, column] = value
    with pytest.raises(synth.InputError) as refusal:
        synth.synthesize(synth.load("wrap_spring", practice="off"), BASE, catalogs={table: frame})
    assert column.split(" ")[0] in refusal.value.field


@pytest.mark.parametrize(
    ("make", "options", "requirements", "values", "parts", "code"),
    [
        (clutch, {}, {}, {"coils_per_hub": 8}, {}, "locks_at_any_peak"),
        (clutch, {}, {}, {"coils_per_hub": 3}, {}, "weak_belt"),
        (clutch, {}, {"peak_torque": "9000 N*m"}, {}, {}, "slips_below_peak"),
        (clutch, {}, {"coil_gap": "0.01 mm"}, {}, {}, "keystoning"),
        (clutch, {}, {"wire_modulus": "206 GPa"}, {}, {}, "wire_material_unused"),
        (clutch, {}, {"peak_torque": "640 N*m"}, {}, {}, "curved_wire"),
        (clutch, {}, {"required_torque": "45 N*m"}, {}, {}, "tip_lifts_off"),
        (clutch, {}, {"overrun_speed": "3000 1/min"}, {}, {}, "overrun_sliding_speed"),
        (clutch, {}, {}, {"interference": "9.99 mm", "hub_diameter": "14 mm"}, {}, "no_free_radius"),
        (actuated, {}, {}, {"coils_per_hub": 12}, {}, "locks_at_any_peak"),
        (actuated, {}, {"peak_torque": "175 N*m"}, {}, {}, "fatigue_of_the_wire"),
    ],
)
def test_remark(make, options, requirements, values, parts, code):
    assert code in remarks(make(options, requirements, values, parts))
    assert code not in remarks(make())


def test_shapes_that_are_hard_to_coil_and_locked_clutches_are_remarked():
    def remarked(friction, a, b):
        frame = pd.DataFrame(PAIR | {"mu_min [-]": [0.7, 0.7], "mu_max [-]": [friction, friction]})
        found = synth.evaluate(
            synth.load("wrap_spring", practice="off", wire_choice="custom"),
            BASE | WIRE,
            values=POINT | {"coils_per_hub": 12, "a": a, "b": b},
            parts={"friction_pair": "good"},
            catalogs={"friction_materials": frame},
        )
        assert np.isfinite(found.values["slip_torque"])
        return remarks(found)

    assert "locked" in remarked(0.9, "3 mm", "4 mm")
    assert "locked" not in remarked(0.7, "3 mm", "4 mm")
    assert "unwound_shape" in remarked(0.9, "4.1 mm", "1 mm")
    assert "unwound_shape" in remarked(0.9, "1 mm", "6.1 mm")
    assert "unwound_shape" not in remarked(0.9, "2 mm", "4 mm")


# -- slots, ladders, defaults ----------------------------------------------------------------------


@pytest.mark.parametrize(("ladder", "some", "step"), [("R20", 0.0224, 20), ("R40", 0.0236, 40)])
def test_hub_diameters_are_on_the_ladder_chosen(ladder, some, step):
    instance = instance_of(synth.load("wrap_spring", practice="off", hub_ladder=ladder), BASE, as_catalogs(None))
    (grid,) = [g for g in instance.ranges.grids() if len(g)]
    assert np.isclose(grid, some).any()
    assert len(grid) == pytest.approx(step * math.log10(200 / 6), abs=1.5)


def test_a_hub_table_of_ones_own_is_the_ladder():
    frame = pd.DataFrame({"designation": ["mine", "other", "far"], "diameter [mm]": [41.5, 33.0, 900.0]})
    front = synth.synthesize(
        synth.load("wrap_spring", practice="off"), BASE, catalogs={"hub_diameters": frame}, points=5
    )
    assert {round(1e3 * d.values["hub_diameter"], 6) for d in front.designs} <= {41.5, 33.0}
    with pytest.raises(synth.InputError, match="hub_diameters"):
        synth.synthesize(synth.load("wrap_spring", practice="off"), BASE, catalogs={"hub_diameters": frame.iloc[2:]})


def test_peak_torque_follows_the_required_torque():
    instance = instance_of(synth.load("wrap_spring", practice="off"), BASE | {"required_torque": 8}, as_catalogs(None))
    assert instance.values.requirements["peak_torque"] == 20.0


@pytest.mark.parametrize("torque", [0.05, 3.0, 900.0])
@pytest.mark.parametrize("more", [{}, {"drag_torque_limit": 100, "spring_speed": 2000, "interference_ratio_max": 0.3}])
def test_objectives_are_surely_positive_so_that_the_gap_is_relative(torque, more):
    from synth.search.formulation import Formulation

    given = {"required_torque": torque, "bore_diameter": "4 mm", **more}
    instance = instance_of(synth.load("wrap_spring", practice="off"), given, as_catalogs(None))
    goals = ("mass", "drag_torque", "stress_utilisation", "pressure_utilisation", "outer_diameter")
    assert Formulation(instance, dict.fromkeys(goals, "min"), 2).objectives.log.all()


# -- curves ----------------------------------------------------------------------------------------


def check_frames(frames):
    for key, frame in frames.items():
        assert key.isidentifier()
        assert len(frame) > 50
        assert all("[" in c and c.endswith("]") for c in frame.columns)
        assert frame.attrs["title"]
        drawn = [c for p in frame.attrs["panels"] for c in p["columns"]]
        assert set(drawn) == set(frame.columns[1:])
        assert all(0 <= x["panel"] < len(frame.attrs["panels"]) for x in frame.attrs.get("lines", []))
        assert np.isfinite(frame.iloc[:, 0]).all()
        assert np.isfinite(frame.to_numpy(dtype=float)).mean() > 0.4


@pytest.mark.parametrize("model", ["refined", "seed"])
def test_curves_of_an_interference_fit_pass_through_its_values(model):
    requirements = BASE | {"overrun_speed": "200 1/min", "overrun_duty": 0.1, "spring_speed": "900 1/min"}
    problem = synth.load("wrap_spring", practice="off", model=model)
    spec = requirements_in_si(problem, requirements)
    found = clutch({"model": model}, requirements)
    v, frames = found.values, problem.curves(spec, found)
    check_frames(frames)
    assert ("torque_over_speed" in frames) == (model == "refined")

    friction = frames["torque_over_friction"].set_index("friction coefficient [-]")
    assert friction.loc[0.08, "loosest closing torque [N*m]"] == pytest.approx(v["closing_torque"], rel=1e-9)
    assert friction.loc[0.16, "tightest closing torque [N*m]"] == pytest.approx(v["slip_torque"], rel=1e-9)
    assert friction.loc[0.16, "tightest opening torque [N*m]"] == pytest.approx(v["drag_torque"], rel=1e-9)

    coils = frames["along_the_coils"]
    assert coils["overload pressure [N/mm2]"].iloc[-1] == pytest.approx(v["contact_pressure"] / 1e6, rel=1e-9)
    assert coils["overload stress [N/mm2]"].iloc[-1] == pytest.approx(v["wire_stress"] / 1e6, rel=1e-9)
    loss = coils["overrunning tension [N]"].iloc[[0, -1]].to_numpy()
    # What the tension loses from the free end to the gap is the drag on this hub.
    assert (loss[0] - loss[1]) * v["mean_coil_radius"] == pytest.approx(v["drag_torque"], rel=1e-9)

    windup = frames["windup"].set_index("torque [N*m]")
    assert windup.loc[30.0, "loosest wind-up [deg]"] == pytest.approx(math.degrees(v["windup_angle"]), rel=1e-9)
    ends = windup["loosest slipping coils [-]"].dropna()
    # At rest the loosest fit holds a little more than at speed; there all coils slip.
    assert ends.iloc[-1] == pytest.approx(6.0, abs=0.1)

    heat = frames["overrun"].set_index("overrun speed [1/min]")
    at = np.abs(heat.index - 200).argmin()
    assert heat["temperature rise [K]"].iloc[at] == pytest.approx(v["temperature_rise"], rel=1e-9)
    assert heat["pressure times speed [W/mm2]"].iloc[at] == pytest.approx(v["overrun_pv"] / 1e6, rel=1e-9)

    fit = frames["torque_over_interference"].set_index("interference [mm]")
    here = np.abs(fit.index - 0.8).argmin()
    assert fit["least closing torque [N*m]"].iloc[here] == pytest.approx(v["closing_torque"], rel=1e-6)
    assert fit["largest drag [N*m]"].iloc[here] == pytest.approx(v["drag_torque"], rel=1e-6)
    assert fit["least closing torque [N*m]"].is_monotonic_increasing


def test_curves_of_a_clearance_fit_pass_through_its_values():
    problem = synth.load("wrap_spring_actuated", practice="off")
    requirements = ACTUATED | {"spring_speed": "900 1/min"}
    spec, found = requirements_in_si(problem, requirements), actuated(None, requirements)
    v, frames = found.values, problem.curves(spec, found)
    check_frames(frames)
    friction = frames["torque_over_friction"].set_index("friction coefficient [-]")
    assert friction.loc[0.08, "widest closing torque [N*m]"] == pytest.approx(v["closing_torque"], rel=1e-9)
    actuator = frames["torque_over_actuator"].set_index("energising torque [N*m]")
    assert actuator.loc[3.0, "least closing torque [N*m]"] == pytest.approx(v["closing_torque"], rel=1e-9)
    assert actuator["least closing torque [N*m]"].iloc[0] == 0  # nothing grips without an energising torque
    coils = frames["along_the_coils"]
    assert coils["overload pressure [N/mm2]"].iloc[-1] == pytest.approx(v["contact_pressure"] / 1e6, rel=1e-9)
    clearance = frames["actuation_over_clearance"].set_index("clearance [mm]")
    here = np.abs(clearance.index - 0.08).argmin()
    assert clearance["angle until closed [rad]"].iloc[here] == pytest.approx(v["wrap_angle"], rel=1e-9)


@pytest.mark.parametrize(("family", "given"), [("wrap_spring", BASE), ("wrap_spring_actuated", ACTUATED)])
def test_a_requirement_alone_has_curves(family, given):
    problem = synth.load(family)
    frames = problem.curves(requirements_in_si(problem, given))
    check_frames(frames)
    (frame,) = frames.values()
    falling = frame.iloc[:, 1].to_numpy()
    assert np.all(np.diff(falling) < 0)


def test_the_curves_of_a_wire_of_ones_own_need_no_slot():
    problem = synth.load("wrap_spring", practice="off", wc="custom", mdl="seed")
    values = POINT | {"a": "3 mm", "b": "4 mm"}
    parts = {"friction_pair": PARTS["friction_pair"]}
    found = synth.evaluate(problem, BASE | WIRE, values=values, parts=parts)
    frames = problem.curves(requirements_in_si(problem, BASE | WIRE), found)
    stress = frames["along_the_coils"]["overload stress [N/mm2]"].iloc[-1]
    assert stress == pytest.approx(found.values["wire_stress"] / 1e6, rel=1e-9)
