"""The pot magnet and the family electromagnetic_clutch: numbers, limits, refusals, remarks, start-up and curves."""

import inspect
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from synth.problems.components.magnet import formulas as pot_magnet
from synth.problems.mechanics import magnetics

import synth
from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays
from tests.problems.of_a_family import remarks, requirements_in_si

SHAPE = pot_magnet.PotMagnet(0.02, 0.015, 0.03, 0.022, 0.012, 0.4e-3)
FIELDS = list(SHAPE.__dataclass_fields__)
LENGTHS = dict.fromkeys(FIELDS, "m")


def of_shape(function):
    """Let a formula of a magnet take its lengths by name."""

    def call(**values):
        return function(pot_magnet.PotMagnet(*[values.pop(n) for n in FIELDS]), **values)

    return call


CASES = [
    (of_shape(lambda m, flux_density: pot_magnet.magnet_force(flux_density, m)), {"flux_density": "T"}, "N"),
    (of_shape(pot_magnet.yoke_flux_ratio), {}, "-"),
    (of_shape(lambda m, b, field: pot_magnet.engaged_ampere_turns(b, m, field)), {"b": "T", "field": "A/m"}, "A"),
    (of_shape(lambda m, ni, gap: pot_magnet.pull_in_force(ni, gap, m.pole_area)), {"ni": "A", "gap": "m"}, "N"),
    (of_shape(lambda m, rho, copper: pot_magnet.magnet_mass(rho, m, copper)), {"rho": "kg/m3", "copper": "kg"}, "kg"),
    (of_shape(lambda m: m.length), {}, "m"),
    (of_shape(lambda m, torque: pot_magnet.expected_clamping_force(torque, m.bore)), {"torque": "N m"}, "N"),
    (of_shape(lambda m, force: pot_magnet.return_force(force)), {"force": "N"}, "N"),
    (of_shape(lambda m, force: pot_magnet.release_drag(force)), {"force": "N"}, "N"),
]


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES)
def test_scales_as_its_unit_on_floats_arrays_and_symbols(function, units, result_unit):
    units = LENGTHS | units
    constants = [(magnetics, "MU_0", "V s/(A m)")]
    assert_homogeneous(function, units, result_unit, {}, constants=constants)
    assert_same_on_symbols_and_arrays(function, units, {})


def test_no_formula_is_left_out():
    public = {n for n, f in inspect.getmembers(pot_magnet, inspect.isfunction) if f.__module__ == pot_magnet.__name__}
    sized = {"magnet_force", "yoke_flux_ratio", "engaged_ampere_turns", "pull_in_force", "magnet_mass"}
    assert public == sized | {"expected_clamping_force", "return_force", "release_drag", "gap_against_sticking"}


def test_both_poles_have_the_same_area():
    inner = math.pi * ((0.02 + 0.015) ** 2 - 0.02**2)
    outer = math.pi * (SHAPE.outer_radius**2 - SHAPE.coil_outer_radius**2)
    assert SHAPE.pole_area == pytest.approx(inner, rel=1e-12)
    assert outer == pytest.approx(inner, rel=1e-12)
    assert SHAPE.outer_pole_width == pytest.approx(SHAPE.outer_radius - SHAPE.coil_outer_radius, rel=1e-12)
    assert SHAPE.yoke_width == pytest.approx(inner / (2 * math.pi * 0.035), rel=1e-12)


def test_the_pull_is_the_derivative_of_the_energy():
    # Released: co-energy of two gaps in series under constant ampere-turns.
    turned, gap, step = 600.0, 2.2e-3, 1e-7
    coenergy = [turned**2 * magnetics.MU_0 * SHAPE.pole_area / (2 * 2 * x) for x in (gap - step, gap + step)]
    slope = (coenergy[0] - coenergy[1]) / (2 * step)
    assert pot_magnet.pull_in_force(turned, gap, SHAPE.pole_area) == pytest.approx(slope, rel=1e-6)
    # Engaged: energy of both gaps under constant flux.
    flux = 0.9 * SHAPE.pole_area
    energy = [2 * x * (flux / SHAPE.pole_area) ** 2 / (2 * magnetics.MU_0) * SHAPE.pole_area for x in (0.0, 1.0)]
    assert pot_magnet.magnet_force(0.9, SHAPE) == pytest.approx(energy[1] - energy[0], rel=1e-12)


def test_pull_with_iron_is_the_slope_of_the_coenergy_with_iron():
    """Virtual work under constant ampere-turns: the iron stores co-energy too, but does not pull."""

    def flux(turned, gap):
        def missing(b):
            iron = b * max(1.0, pot_magnet.yoke_flux_ratio(SHAPE))
            return 2 * gap * b / magnetics.MU_0 + 160 * iron / (1 - iron / 2) * SHAPE.iron_path - turned

        top = 2 / max(1.0, pot_magnet.yoke_flux_ratio(SHAPE)) * (1 - 1e-12)
        return brentq(missing, 0, top, xtol=1e-15) * SHAPE.pole_area

    def coenergy(gap, steps=4001):
        turned = np.linspace(0, 900, steps)
        return np.trapezoid([flux(x, gap) for x in turned], turned)

    gap, step = 0.5e-3, 2e-5
    slope = (coenergy(gap - step) - coenergy(gap + step)) / (2 * step)
    assert pot_magnet.magnet_force(flux(900, gap) / SHAPE.pole_area, SHAPE) == pytest.approx(slope, rel=2e-3)


def test_mass_by_cells():
    r2, r3, r4, t = SHAPE.inner_pole_radius, SHAPE.coil_outer_radius, SHAPE.outer_radius, 0.012
    length, cells = 0.03 + 2 * t, 1500
    r = (np.arange(cells) + 0.5) * r4 / cells
    z = (np.arange(cells) + 0.5) * length / cells
    disc = (z < t) | (z > length - t)
    pole = ((r > 0.02) & (r < r2)) | (r > r3)
    iron = np.where(disc[None, :], (r > 0.02)[:, None], pole[:, None])
    volume = (2 * math.pi * r[:, None] * iron).sum() * r4 / cells * length / cells
    assert pot_magnet.magnet_mass(7850, SHAPE, 0.4) == pytest.approx(7850 * volume + 0.4, rel=3e-3)


# -- the family --------------------------------------------------------------------------------------

BASE = {"load_torque": "8 N*m", "driver_speed": "960 1/min", "driven_inertia": "0.05 kg*m2"}
MAGNET = {
    "inner_pole_width": "15 mm",
    "coil_length": "30 mm",
    "coil_height": "20 mm",
    "yoke_thickness": "12 mm",
    "flux_density": "0.95 T",
}
RING = {"ring_outer_diameter": "112 mm", "ring_inner_diameter": "90 mm", "ramp_time": "0.1 s"}
PLATES = {
    "friction_pair": "steel_steel_wet",
    "inner_plate": "core 1.5",
    "outer_plate": "core 1.5",
    "winding_wire": "Cu 0.5 class 155",
}
KINDS = {
    "multi_plate": (RING | {"friction_surfaces": 4}, PLATES, synth.load("multi_plate_clutch", practice="off")),
    "disc": (
        RING | {"ring_inner_diameter": "88 mm", "pressure_plate_thickness": "6 mm", "discs": 1},
        {"friction_pair": "sinter_bronze_dry", "winding_wire": "Cu 0.5 class 155"},
        synth.load("disc_clutch", practice="off"),
    ),
}
PROBLEMS = {kind: synth.load("electromagnetic_clutch", practice="off", pack=kind) for kind in KINDS}


def design(kind="multi_plate", requirements=None, values=None, parts=None, problem=None):
    sizes, own, _ = KINDS[kind]
    given = {k: v for k, v in (sizes | MAGNET | (values or {})).items() if v is not None}
    return synth.evaluate(
        problem or PROBLEMS[kind], BASE | (requirements or {}), values=given, parts=own | (parts or {})
    )


def magnet_by_hand(v, wire, surfaces, work, force_back=100.0):
    w, lm, hc, t, b = (
        v[n] for n in ("inner_pole_width", "coil_length", "coil_height", "yoke_thickness", "flux_density")
    )
    mu0, r1, gap = 4e-7 * math.pi, 0.02, 0.4e-3
    r2 = r1 + w
    r3 = r2 + hc
    area = math.pi * (r2**2 - r1**2)
    r4 = math.sqrt(r3**2 + area / math.pi)
    pull = b * b * area / mu0
    yoke = 1.15 * b * area / (2 * math.pi * r2 * t)
    iron = max(1.15 * b, yoke)
    path = 2 * (lm + t) + 2 * hc + w + (r4 - r3)
    turned = 2 * gap * b / mu0 + 160 * iron / (1 - iron / 2) * path
    g_in = gap + surfaces * 0.3e-3
    b_in = mu0 * turned / (2 * g_in)
    n = 0.85 * lm * hc / wire["overall_diameter"] ** 2
    current = turned / n
    cold = 1.72e-8 * 2 * math.pi * (r2 + hc / 2) * n / wire["copper_area"]
    surface = 2 * math.pi * r4 * (lm + 2 * t) + 2 * math.pi * r4**2
    rise = 0.0
    for _ in range(3000):
        hot = cold * (1 + 0.00393 * (313.15 + rise - 293.15))
        rise = (current**2 * hot + work * 50 / 3600) / (12 * surface)
    copper = 8960 * 2 * math.pi * (r2 + hc / 2) * n * wire["copper_area"]
    values = {
        "magnet_force": pull,
        "actuation_force": pull - force_back,
        "pull_in_force": b_in**2 * area / mu0,
        "magnet_diameter": 2 * r4,
        "ampere_turns": turned,
        "turns": math.floor(n),
        "current": turned / math.floor(n),
        "current_density": current / wire["copper_area"],
        "coil_voltage": current * hot,
        "coil_temperature_rise": rise,
        "coil_power": current**2 * hot,
    }
    mass = 7850 * (2 * area * lm + 2 * math.pi * (r4**2 - r1**2) * t) + copper
    limits = {
        "magnet_overcomes_springs": (pull, force_back),
        "pull_in": (values["pull_in_force"], 1.3 * (force_back + 20)),
        "pole_flux_density": (1.15 * b, 1.5),
        "yoke_flux_density": (yoke, 1.5),
        "iron_saturation": (iron, 2.0),
        "coil_temperature": (rise, 155 - 40),
        "thermal_stability": (0.00393 * current**2 * cold / (12 * surface), 0.9),
        "coil_power": (values["coil_power"], 60),
        "coil_voltage": (values["coil_voltage"], 24),
        "current_density": (values["current_density"], 5e6),
        "turns": (n, 1),
    }
    return values, mass, limits


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("values", [{}, {"yoke_thickness": "8 mm", "flux_density": "0.85 T", "coil_height": "31 mm"}])
def test_numbers_against_an_independent_calculation(kind, values):
    found = design(kind, values=values)
    v = found.values
    surfaces = v["friction_surfaces"] if kind == "multi_plate" else 2
    expected, mass, limits = magnet_by_hand(v, found.parts["winding_wire"], surfaces, v["friction_work"])
    for name, value in expected.items():
        assert v[name] == pytest.approx(value, rel=1e-9), name
    for name, sides in limits.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-9), name

    # Everything that the pack does is what it does in the family it is taken from, under the force of the magnet.
    sizes, parts, family = KINDS[kind]
    plain = synth.evaluate(
        family,
        BASE,
        values=sizes | {"actuation_force": f"{v['actuation_force']!r} N"},
        parts={k: p for k, p in parts.items() if k != "winding_wire"},
    )
    together = {"mass", "outer_diameter", "length", "volume"}
    same = set(plain.values) - together
    assert {"torque", "friction_work", "surface_pressure"} < same < set(v)
    for name in same:
        assert v[name] == pytest.approx(plain.values[name], rel=1e-9, nan_ok=True), name
    assert set(found.limits) == set(plain.limits) | set(limits)
    for name in plain.limits:
        assert found.limits[name] == pytest.approx(plain.limits[name], rel=1e-9), name

    assert v["mass"] == pytest.approx(plain.values["mass"] + mass, rel=1e-9)
    assert v["outer_diameter"] == max(plain.values["outer_diameter"], v["magnet_diameter"])
    magnet_length = v["coil_length"] + 2 * v["yoke_thickness"] + 0.4e-3
    assert v["length"] == pytest.approx(plain.values["length"] + magnet_length, rel=1e-9)
    assert v["volume"] == pytest.approx(math.pi / 4 * v["outer_diameter"] ** 2 * v["length"], rel=1e-9)


def test_the_larger_of_pack_and_magnet_is_outside():
    pack = design(values={"coil_height": "6 mm", "inner_pole_width": "10 mm"}).values
    assert pack["outer_diameter"] == pytest.approx(0.112 + 2 * 0.009)
    magnet = design(values={"coil_height": "40 mm"}).values
    assert magnet["outer_diameter"] == magnet["magnet_diameter"] > 0.15


def test_room_and_force_are_limited_when_asked_for():
    asked = {"actuation_force_limit": "2 kN", "outer_diameter_limit": "140 mm", "length_limit": "80 mm"}
    found = design(requirements=asked)
    v = found.values
    assert found.limits["actuation_force"] == pytest.approx((v["actuation_force"], 2000))
    assert found.limits["outer_diameter"] == pytest.approx((v["outer_diameter"], 0.14))
    assert found.limits["length"] == pytest.approx((v["length"], 0.08))


@pytest.mark.parametrize("kind", KINDS)
def test_ampere_turns_are_accepted_in_place_of_the_flux_density(kind):
    known = design(kind, values={"flux_density": "0.7 T"})
    again = design(kind, values={"flux_density": None, "NI": known.values["ampere_turns"]})
    assert again.values["flux_density"] == pytest.approx(0.7, rel=1e-10)


def does_not_exist(value):
    return value is None or math.isnan(value)


def test_a_magnet_weaker_than_its_springs_presses_nothing():
    found = design(requirements={"return_spring_force": "2 kN"})
    assert "magnet_overcomes_springs" in found.violated
    for name in ("actuation_force", "torque", "friction_work", "coil_power"):
        assert does_not_exist(found.values[name]), name
    assert found.values["pull_in_force"] > 0


def test_saturated_iron_has_no_ampere_turns():
    found = design(values={"flux_density": "1.3 T", "yoke_thickness": "7 mm"})
    assert "iron_saturation" in found.violated
    assert does_not_exist(found.values["ampere_turns"])
    assert does_not_exist(found.values["pull_in_force"])
    assert found.values["torque"] > 0


def test_many_surfaces_open_a_gap_that_the_magnet_cannot_bridge():
    near, far = design(values={"friction_surfaces": 2}), design(values={"friction_surfaces": 8})
    assert near.values["pull_in_force"] / far.values["pull_in_force"] == pytest.approx((2.8 / 1.0) ** 2)
    assert "pull_in" in far.violated
    assert "pull_in" not in near.violated


@pytest.mark.parametrize(
    ("requirements", "field"),
    [
        ({"iron_flux_limit": "1.8 T", "iron_saturation": "1.7 T"}, "iron_saturates"),
        ({"overload_torque": "10 N*m"}, "capacity_window_empty"),
        ({"residual_gap": 0}, "residual_gap"),
        ({"pull_in_margin": 0.9}, "pull_in_margin"),
        ({"startup_torque": "8 N*m"}, "never_starts"),
        ({"hub_bore_diameter": "100 mm", "outer_diameter_limit": "130 mm"}, "no_room_for_ring"),
    ],
)
def test_impossible_input_is_refused_by_name(requirements, field):
    with pytest.raises(synth.InputError) as refusal:
        design(requirements=requirements)
    assert field in refusal.value.field
    assert refusal.value.expected


def test_cooling_of_a_disc_pack_is_dry():
    with pytest.raises(synth.InputError, match="lubrication_mismatch"):
        design("disc", problem=synth.load("electromagnetic_clutch", practice="off", pack="disc", cooling="oil_bath"))


@pytest.mark.parametrize(
    ("kind", "requirements", "values", "code"),
    [
        ("multi_plate", {}, {}, "magnet_model"),
        ("multi_plate", {"residual_gap": "0.2 mm"}, {}, "armature_sticks"),
        ("multi_plate", {"return_spring_force": 0}, {}, "no_return_springs"),
        ("multi_plate", {}, {}, "no_release_aid"),
        ("disc", {}, {"discs": 2}, "twin_disc_release"),
    ],
)
def test_remark(kind, requirements, values, code):
    found = design(kind, requirements, values)
    assert any(remark.startswith(f"{code}:") for remark in found.advice)


def test_remarks_that_do_not_concern_a_design_are_silent():
    codes = remarks(design("disc", {"jerk_limit": "1e5 rad/s3"}))
    assert not codes & {"armature_sticks", "no_return_springs", "twin_disc_release"}


# -- hooks -------------------------------------------------------------------------------------------


def spec_of(kind, requirements=None):
    return requirements_in_si(PROBLEMS[kind], BASE | (requirements or {}))


@pytest.mark.parametrize("kind", KINDS)
def test_curves_of_a_design_meet_it(kind):
    spec, found = spec_of(kind), design(kind)
    v = found.values
    curves = PROBLEMS[kind].curves(spec, found)
    pack = "torque_over_plates" if kind == "multi_plate" else "diameter_over_lining"
    own = {"torque_over_current", "torque_over_temperature", "force_over_gap", "heat_balance"}
    assert set(curves) == {"startup_over_torque", pack} | own
    assert set(PROBLEMS[kind].curves(spec)) == {"startup_over_torque", pack}

    over_current = curves["torque_over_current"].set_index("current [A]")
    at = over_current.iloc[np.argmin(abs(over_current.index - v["current"]))]
    assert at["torque [N*m]"] == pytest.approx(v["torque"], rel=1e-9)
    assert at["on the pack [N]"] == pytest.approx(v["actuation_force"], rel=1e-9)
    assert at["pull on the released armature [N]"] == pytest.approx(v["pull_in_force"], rel=1e-9)
    assert at["poles [T]"] == pytest.approx(found.limits["pole_flux_density"][0], rel=1e-9)
    assert at["yoke [T]"] == pytest.approx(found.limits["yoke_flux_density"][0], rel=1e-9)
    assert at["temperature rise [K]"] == pytest.approx(v["coil_temperature_rise"], rel=1e-9)
    assert over_current.iloc[0]["torque [N*m]"] == 0
    lines = {line["label"]: line["y"] for line in curves["torque_over_current"].attrs["lines"]}
    assert lines["pull_in"] == pytest.approx(156)
    assert lines["sizing torque"] == pytest.approx(found.frame.requirement_values["required_torque"])

    gaps = curves["force_over_gap"]
    assert gaps.iloc[0]["pull [N]"] == pytest.approx(v["magnet_force"], rel=1e-9)
    surfaces = v["friction_surfaces"] if kind == "multi_plate" else 2
    at_rest = np.interp(0.4 + surfaces * 0.3, gaps["gap at each pole [mm]"], gaps["pull, iron neglected [N]"])
    assert at_rest == pytest.approx(v["pull_in_force"], rel=1e-3)
    assert (gaps["pull [N]"] < gaps["pull, iron neglected [N]"]).all()

    warm = curves["torque_over_temperature"]
    steady = 40 + v["coil_temperature_rise"]
    torque = np.interp(steady, warm["coil temperature [degC]"], warm["constant voltage [N*m]"])
    assert torque == pytest.approx(v["torque"], rel=1e-4)
    balance = curves["heat_balance"]
    made, given = (
        np.interp(steady, balance["temperature [degC]"], balance[f"heat {word} [W]"]) for word in ("made", "given off")
    )
    assert made == pytest.approx(given, rel=1e-9)
    assert made == pytest.approx(v["coil_power"] + v["friction_work"] * 50 / 3600, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_the_start_up_in_time_agrees(kind):
    found = design(kind)
    frames = synth.simulate(PROBLEMS[kind], BASE, found)
    opinion = synth.second_opinion(found, frames).set_index("quantity")
    for name in ("slip_time", "friction_work", "peak_slip_power"):
        assert opinion.loc[name, "relative_difference"] == pytest.approx(0, abs=1e-6), name
    sizes, parts, family = KINDS[kind]
    plain = synth.simulate(
        family,
        BASE,
        values=sizes | {"actuation_force": f"{found.values['actuation_force']!r} N"},
        parts={k: p for k, p in parts.items() if k != "winding_wire"},
    )
    temperature, reference = frames["temperature"], plain["temperature"]
    for column in reference.columns:
        np.testing.assert_allclose(temperature[column], reference[column], rtol=1e-6, err_msg=column)
