"""The family multi_plate_clutch: its numbers against an independent calculation, its limits, refusals and remarks."""

import math

import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from synth.units import parse_unit, to_si
from tests.asking import instance_of
from tests.problems.start_by_steps import start

BASE = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
OPTIONAL = {
    "startup_torque": "1080 N*m",
    "overload_torque": "4000 N*m",
    "actuation_force_limit": "60 kN",
    "outer_diameter_limit": "400 mm",
    "length_limit": "200 mm",
    "jerk_limit": "60 rad/s3",
    "acceleration_limit": "40 rad/s2",
    "hub_bore_diameter": "60 mm",
    "drag_torque_limit": "20 N*m",
}
POINT = {
    "ring_outer_diameter": "258 mm",
    "ring_inner_diameter": "160 mm",
    "actuation_force": "18000 N",
    "ramp_time": "2 s",
    "friction_surfaces": 12,
}
PARTS = {"friction_pair": "seed_multiplate_ref", "inner_plate": "core 3.5", "outer_plate": "core 2"}

ALWAYS = {
    "torque_capacity",
    "never_starts",
    "surface_pressure",
    "specific_heat",
    "engagement_heat",
    "specific_power",
    "peak_temperature",
    "lug_pressure_outer",
    "lug_pressure_inner",
    "ring_ratio_min",
    "ring_ratio_max",
    "slip_time",
    "cycle_time",
    "sliding_speed",
    "guide_jams",
}
ASKED = {
    "startup_torque_available": "startup_torque",
    "torque_limit": "overload_torque",
    "actuation_force": "actuation_force_limit",
    "outer_diameter": "outer_diameter_limit",
    "length": "length_limit",
    "hub_bore": "hub_bore_diameter",
    "jerk": "jerk_limit",
    "acceleration": "acceleration_limit",
    "drag_torque": "drag_torque_limit",
}


def design(options=None, requirements=None, values=None, parts=None):
    problem = synth.load("multi_plate_clutch", practice="off", **(options or {}))
    return synth.evaluate(
        problem, BASE | (requirements or {}), values=POINT | (values or {}), parts=PARTS | (parts or {})
    )


def contact_forces(series, force, surfaces, kappa_a, kappa_b):
    """Forces surface by surface, by stepping along the pack or from the printed series."""
    guide = kappa_a + kappa_b
    damped = guide / (1 + guide)
    sums = {
        "geometric": lambda j: sum((1 + guide) ** -i for i in range(1, j + 1)),
        "exponential_form": lambda j: (1 - math.exp(-j * math.log(1 + guide))) / guide,
        "lipka": lambda j: (1 - math.exp(-j * guide)) / guide,
        "exponential_K": lambda j: (1 - math.exp(-j * damped)) / damped,
    }
    if series in sums:
        return [force * (sums[series](j) - sums[series](j - 1)) for j in range(1, surfaces + 1)]
    forces = [force / (1 + kappa_a)]
    for j in range(1, surfaces):
        kappa = kappa_b if j % 2 else kappa_a
        forces.append(forces[-1] * (1 - kappa) / (1 + kappa))
    return forces


def by_hand(given, pair, t_i, t_o, d_out, d_in, force, ramp, z, *, series, kind, worst, cooled, aid=(0.0, 1.0, 1.0)):
    """Section by section from the sources, with unfactored ring integrals and sums over the surfaces."""
    low, high = (pair["mu_min"], pair["mu_max"]) if worst else (pair["mu_dynamic"],) * 2
    r1, r2 = d_in / 2, d_out / 2
    a, b = r1 - 0.003, r2 + 0.003
    radius = 2 / 3 * (r2**3 - r1**3) / (r2**2 - r1**2)
    one = math.pi * (r2**2 - r1**2)
    net = force * (1 - aid[0])
    result = {"friction_area": z * one, "friction_radius": radius}

    def forces(mu):
        if series is None:
            return [net] * z
        return contact_forces(series, net, z, mu * 0.1 * radius / a, mu * 0.1 * radius / b)

    built = {mu: mu * radius * sum(forces(mu)) for mu in (low, high)}
    result["torque"] = built[low]
    result["plate_effectiveness"] = sum(forces(high)) / net / z
    result["guide_number"] = 0.0 if series is None else low * 0.1 * radius * (a + b) / (a * b)
    result["surface_pressure"] = forces(low)[0] / (aid[1] * one)
    f = forces(high)
    result["lug_pressure_outer"] = high * radius * (f[0] + f[1]) / (b * 12 * 0.003 * t_o)
    inner = f[0] if z == 2 else f[1] + f[2]
    result["lug_pressure_inner"] = high * radius * inner / (a * 12 * 0.003 * t_i)

    ramps = {mu: given.get("T_start", torque) for mu, torque in built.items()}
    duty = (given["M_load"], given["J2"], given["omega1"], ramp, kind)
    work, slip, _, _ = start(ramps[low], *duty)
    _, _, power, at_lock = start(ramps[high], *duty)
    result |= {"friction_work": work, "slip_time": slip, "peak_slip_power": power}
    result["jerk"] = ramps[high] / (ramp * given["J2"])
    result["acceleration"] = (at_lock - given["M_load"]) / given["J2"]
    result["hourly_heat"] = work * 50 / 3600 / (aid[1] * z * one)
    result["single_heat"] = work / (aid[1] * z * one)
    result["power_density"] = power / (aid[1] * z * one)
    result["sliding_speed"] = given["omega1"] * r2

    steel = 7850 * math.pi * ((z / 2 + 1) * t_i * (r2**2 - a**2) + z / 2 * t_o * (b**2 - r1**2))
    result["mass"] = steel + pair["density"] * pair["lining_thickness"] * z * one
    result["length"] = (z / 2 + 1) * t_i + z / 2 * t_o + z * (pair["lining_thickness"] + 0.0003)
    result["outer_diameter"] = diameter = 2 * (b + 0.006)
    result["volume"] = math.pi * diameter**2 * result["length"] / 4
    surface = math.pi * diameter * result["length"] + math.pi * diameter**2 / 2
    capacity = 480 * steel
    cycle, constant = 72.0, capacity / (cooled * surface)
    result["peak_temperature_rise"] = work / capacity / (1 - math.exp(-cycle / constant))
    viscosity = given["eta_oil"]
    shear = math.pi / 2 * viscosity * given["omega1"] * (r2**4 - r1**4) / 0.0003
    result["drag_torque"] = aid[2] * z * shear
    return result


CASES = [
    ({}, {}, {"series": "geometric"}),
    ({"guide_series": "exponential_form"}, {}, {"series": "exponential_form"}),
    ({"guide_series": "lipka"}, {"friction_surfaces": 30}, {"series": "lipka"}),
    ({"guide_series": "exponential_K"}, {"friction_surfaces": 8}, {"series": "exponential_K"}),
    ({"guide_series": "exact"}, {"friction_surfaces": 10}, {"series": "exact"}),
    ({"guide_model": "cz"}, {"friction_surfaces": 10}, {"series": None}),
    ({"load_kind": "active"}, {}, {"series": "geometric", "kind": "active"}),
    ({"load_kind": "active"}, {"ramp_time": "9 s", "actuation_force": "40 kN"}, {"kind": "active"}),
    ({"friction_basis": "worst_case"}, {"actuation_force": "30 kN"}, {"worst": True}),
    ({"release_aid": "sine_plates"}, {}, {"aid": (0.02, 1.0, 0.3)}),
    ({"release_aid": "wavy_rings", "cooling": "through_oil"}, {}, {"aid": (0.0, 0.9, 0.5), "cooled": 300.0}),
    ({"release_aid": "cone_springs"}, {"friction_surfaces": 2, "actuation_force": "80 kN"}, {"aid": (0.0, 1.0, 0.4)}),
    ({}, {"ramp_time": "9 s", "actuation_force": "50 kN"}, {}),
    ({}, {"ramp_time": "0.05 s"}, {}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("options", "values", "how"), CASES)
@pytest.mark.parametrize("limited_start", [False, True])
def test_numbers_against_an_independent_calculation(options, values, how, limited_start):
    found = design(options, {"startup_torque": "1080 N*m"} if limited_start else None, values)
    row = found.parts["friction_pair"]
    given = {"M_load": 600.0, "J2": 30.0, "omega1": 26.6, "eta_oil": 0.02}
    if limited_start:
        given["T_start"] = 1080.0
    how = {"series": "geometric", "kind": "reactive", "worst": False, "cooled": 150.0} | how
    si = {name: found.values[name] for name in (*POINT, "friction_surfaces")}
    expected = by_hand(
        given,
        row,
        0.0035,
        0.002,
        si["ring_outer_diameter"],
        si["ring_inner_diameter"],
        si["actuation_force"],
        si["ramp_time"],
        round(si["friction_surfaces"]),
        **how,
    )
    stepped = {
        "friction_work",
        "slip_time",
        "peak_slip_power",
        "acceleration",
        "hourly_heat",
        "single_heat",
        "power_density",
        "peak_temperature_rise",
    }
    for name, value in expected.items():
        assert found.values[name] == pytest.approx(value, rel=3e-5 if name in stepped else 1e-9), name


def test_the_lecture_as_a_design():
    found = design(
        {"guide_model": "cz"},
        {"startup_torque": "1080 N*m"},
        {
            "ring_outer_diameter": "258.110624 mm",
            "ring_inner_diameter": "154.866374 mm",
            "actuation_force": "13394.966 N",
            "friction_surfaces": 10,
        },
    )
    assert found.frame.requirement_values["required_torque"] == pytest.approx(1411.76, abs=5e-3)
    assert found.values["torque"] == pytest.approx(found.frame.requirement_values["required_torque"], rel=1e-7)
    assert found.values["friction_work"] == pytest.approx(39524.1, abs=0.05)
    assert found.values["slip_time"] == pytest.approx(3.21806, abs=5e-6)
    assert found.values["hourly_heat"] == pytest.approx(5.90134 * 1e6 / 3600, rel=1e-6)
    assert found.values["outer_plates"] == 5
    assert found.values["inner_plates"] == 6
    assert "torque_capacity" not in found.violated
    assert "surface_pressure" not in found.violated


@pytest.mark.slow
@pytest.mark.parametrize("guide_model", ["series", "cz"])
def test_limits_are_built_when_they_are_asked_for(guide_model):
    always = ALWAYS | ({"plate_count_worthwhile"} if guide_model == "series" else set())
    assert set(design({"guide_model": guide_model}).limits) == always
    for limit, requirement in ASKED.items():
        found = design({"guide_model": guide_model}, {requirement: OPTIONAL[requirement]})
        assert set(found.limits) == always | {limit}, limit
    everything = design({"guide_model": guide_model, "spline_choice": "catalogue"}, OPTIONAL, parts=SPLINE)
    assert set(everything.limits) == always | set(ASKED) | {"spline_clearance"}


def spline_row():
    table = Catalogs().table("splines")
    wanted = to_si(145.0, parse_unit("mm"))
    rows = [table.row(k) for k in range(len(table))]
    return min(rows, key=lambda row: abs(row["mean_flank_diameter"] - wanted))


SPLINE = {"inner_spline": str(spline_row()["designation"])}


def test_catalogue_spline_replaces_the_inner_lugs():
    row = spline_row()
    found = design({"spline_choice": "catalogue"}, parts=SPLINE)
    a = row["mean_flank_diameter"] / 2
    assert found.values["inner_spline_radius"] == pytest.approx(a, rel=1e-12)
    assert found.limits["spline_clearance"] == pytest.approx((0.08 - a, 0.003), rel=1e-9)
    r, b = found.values["friction_radius"], found.values["outer_spline_radius"]
    mu = found.parts["friction_pair"]["mu_dynamic"]
    forces = contact_forces("geometric", 18000.0, 12, mu * 0.1 * r / a, mu * 0.1 * r / b)
    pressure = mu * r * (forces[1] + forces[2]) / (a * row["teeth"] * row["flank_height_h"] * 0.0035)
    assert found.values["lug_pressure_inner"] == pytest.approx(pressure, rel=1e-9)
    r1, r2 = 0.08, 0.129
    steel = 7850 * math.pi * (7 * 0.0035 * (r2**2 - a**2) + 6 * 0.002 * (b**2 - r1**2))
    lining = found.parts["friction_pair"]["density"] * found.parts["friction_pair"]["lining_thickness"]
    assert found.values["mass"] == pytest.approx(steel + lining * found.values["friction_area"], rel=1e-9)


def test_a_clutch_weaker_than_its_load_never_starts():
    found = design(values={"actuation_force": "3000 N"})
    assert "never_starts" in found.violated
    assert "slip_time" not in found.violated
    for name in ("friction_work", "slip_time", "peak_slip_power", "hourly_heat", "peak_temperature_rise"):
        assert math.isnan(found.values[name]), name
    assert found.values["torque"] < 600


def test_inner_plates_that_jam_are_no_design():
    found = design(
        requirements={"lug_clearance": "30 mm"}, values={"ring_outer_diameter": "76 mm", "ring_inner_diameter": "56 mm"}
    )
    assert "guide_jams" in found.violated
    assert math.isnan(found.values["torque_sum_factor"])


@pytest.mark.parametrize(
    ("options", "requirements", "code"),
    [
        ({}, {"surface_factor": 0.75}, "double_guide_loss"),
        ({}, {"oil_viscosity": 0}, "lubrication_mismatch"),
        ({"lubrication": "dry"}, {"oil_viscosity": 0.02}, "lubrication_mismatch"),
        ({"lubrication": "dry", "cooling": "oil_bath"}, {}, "lubrication_mismatch"),
        ({"cooling": "fan"}, {}, "lubrication_mismatch"),
        ({}, {"startup_torque": "600 N*m"}, "never_starts"),
        ({}, {"overload_torque": "1058 N*m"}, "capacity_window_empty"),
        ({"guide_model": "cz"}, {"overload_torque": "1411 N*m"}, "capacity_window_empty"),
        ({}, {"ring_ratio_min": 0.2, "ring_ratio_max": 0.15}, "bad_ratio"),
        ({}, {"hub_bore_diameter": "160 mm", "outer_diameter_limit": "220 mm"}, "no_room_for_ring"),
        ({}, {"actuation_force_limit": "500 N", "outer_diameter_limit": "300 mm"}, "torque_above_guide_limit"),
        ({}, {"safety_factor": 0.9}, "safety_factor"),
        ({}, {"speed_factor": 1.6}, "speed_factor"),
        ({}, {"driver_speed": 0}, "driver_speed"),
    ],
)
def test_impossible_input_is_refused_by_name(options, requirements, code):
    with pytest.raises(synth.InputError) as refusal:
        design(options, requirements)
    assert code in refusal.value.field
    assert refusal.value.expected


@pytest.mark.parametrize(
    ("options", "requirements"),
    [
        ({"guide_model": "cz"}, {"surface_factor": 0.75}),
        ({}, {"startup_torque": "601 N*m"}),
        ({}, {"overload_torque": "1060 N*m"}),
        ({}, {"hub_bore_diameter": "160 mm", "outer_diameter_limit": "230 mm"}),
        ({}, {"actuation_force_limit": "1900 N"}),
        ({"guide_series": "exponential_K"}, {"actuation_force_limit": "500 N", "outer_diameter_limit": "300 mm"}),
        ({"lubrication": "dry"}, {}),
    ],
)
def test_possible_input_is_not_refused(options, requirements):
    assert design(options, requirements).values["mass"] > 0


def test_torque_above_guide_limit_is_where_the_asymptote_is():
    """Just above the refused force, a pack of very many plates at the largest ring carries the sizing torque."""
    required = 1.5 * 600 / 0.85
    b = 0.150 - 0.006
    r2 = b - 0.003
    a = r2 * (1 - 0.1) / (1 + 0.1) - 0.003
    border = required * 0.1 * (a + b) / (a * b)
    requirements = {"outer_diameter_limit": "300 mm"}
    with pytest.raises(synth.InputError, match="torque_above_guide_limit"):
        design({}, requirements | {"actuation_force_limit": f"{border * 0.999} N"})
    assert design({}, requirements | {"actuation_force_limit": f"{border * 1.001} N"}).values["mass"] > 0


@pytest.mark.parametrize(
    ("options", "requirements", "values", "code"),
    [
        ({"shaft_position": "vertical"}, {}, {}, "vertical_shaft"),
        ({}, {}, {}, "no_release_aid"),
        ({"release_aid": "sine_plates"}, {}, {}, "release_aid_sine_plates"),
        ({"release_aid": "wavy_rings"}, {}, {}, "release_aid_wavy_rings"),
        ({"release_aid": "cone_springs"}, {}, {}, "release_aid_cone_springs"),
        ({"lubrication": "dry", "cooling": "fan"}, {}, {}, "fan_cooling"),
        ({"load_kind": "active"}, {}, {}, "runs_backwards"),
        ({}, {}, {"actuation_force": "30 kN"}, "thin_plates"),
        ({}, {"engagements_per_hour": 200}, {}, "frequent_switching"),
        ({}, {"engagements_per_hour": 1000, "ambient_temperature": "60 degC"}, {}, "mean_temperature"),
        ({}, {"guide_friction": 0.4}, {"friction_surfaces": 60}, "beyond_legacy_plate_limit"),
        ({"guide_model": "cz"}, {}, {}, "surface_factor_fits_ten_surfaces"),
        ({}, {"startup_torque": "605 N*m"}, {"actuation_force": "6000 N"}, "static_hold"),
    ],
)
def test_remark(options, requirements, values, code):
    assert any(remark.startswith(f"{code}:") for remark in design(options, requirements, values).advice)


def test_remarks_that_do_not_concern_a_design_are_silent():
    found = design(
        {"release_aid": "cone_springs"},
        {"engagements_per_hour": 0.1},
        {"actuation_force": "12 kN"},
        {"inner_plate": "core 4", "outer_plate": "core 3.5"},
    )
    assert [remark.split(":")[0] for remark in found.advice] == ["release_aid_cone_springs"]


def test_obsolete_pairs_need_an_option():
    def rows(**options):
        instance = instance_of(synth.load("multi_plate_clutch", practice="off", **options), BASE, as_catalogs(None))
        slot = next(s for s in instance.selection.slots if s.slot == "friction_pair")
        return {slot.table.designations[k] for k in slot.rows}, slot.table

    new, table = rows()
    every, _ = rows(allow_obsolete="yes")
    dry, _ = rows(lubrication="dry")
    flags = dict(zip(table.designations, table.number("new_design_allowed"), strict=True))
    lubricated = dict(zip(table.designations, table.text("lubrication"), strict=True))
    surfaces = dict(zip(table.designations, table.text("surfaces"), strict=True))
    assert new
    assert all(flags[name] == 1 and lubricated[name] == "oil" for name in new)
    assert new <= every
    assert dry
    assert all(lubricated[name] == "dry" for name in dry)
    assert all("plate pack" in surfaces[name].split(";") for name in every | dry)


def test_defaults_follow_the_options():
    oil, dry = (
        synth.load("multi_plate_clutch", practice="off", lubrication=kind).model(frozenset(), Catalogs())
        for kind in ("oil", "dry")
    )
    assert oil.declaration.options["cooling"].chosen == "oil_bath"
    assert dry.declaration.options["cooling"].chosen == "still_air"
    assert oil.declaration.requirements["oil_viscosity"].default == 0.02
    assert dry.declaration.requirements["oil_viscosity"].default == 0.0
    cz = synth.load("multi_plate_clutch", practice="off", guide_model="cz").model(frozenset(), Catalogs()).declaration
    assert cz.requirements["surface_factor"].default == 0.75
    assert oil.declaration.requirements["surface_factor"].sx is None
    assert [o.name for o in cz.objectives.values() if o.default] == ["mass", "actuation_force"]
    assert [o.name for o in cz.objectives.values() if not o.default] == [
        "length",
        "outer_diameter",
        "volume",
        "friction_work",
        "drag_torque",
    ]


def test_everything_has_text_and_source():
    problem = synth.load("multi_plate_clutch", practice="off", spline_choice="catalogue", release_aid="sine_plates")
    d = problem.model(frozenset(OPTIONAL), Catalogs()).declaration
    for members in (d.requirements, d.options, d.variables, d.counts, d.slots, d.derived, d.limits):
        for member in members.values():
            assert member.text, member.name if hasattr(member, "name") else member.slot
            assert member.source, member.name if hasattr(member, "name") else member.slot
    assert all(remark.source for remark in d.advices)


def test_the_plate_counts_that_a_curve_marks_are_where_plates_stop_to_pay():
    design = synth.evaluate(synth.load("multi_plate_clutch", practice="off"), BASE, values=POINT, parts=PARTS)
    attrs = synth.curves(synth.load("multi_plate_clutch", practice="off"), BASE, design)["torque_over_plates"].attrs
    at = {mark["label"].split()[-1]: mark["x"] for mark in attrs["marks"]}
    s, k = design.values["guide_number"], math.log1p(design.values["guide_number"])
    assert (1 - math.exp(-k * at["(16)"])) / (s * at["(16)"]) == pytest.approx(0.5, rel=1e-9)
    assert at["(14)"] / at["(15)"] == pytest.approx(1.5936243 / math.sqrt(2), rel=1e-7)
    assert at["(15)"] == pytest.approx(math.sqrt(2) / s, rel=0.1)
    (bound,) = [line["y"] for line in attrs["lines"] if line["label"].startswith("never more")]
    assert bound == pytest.approx(design.values["torque"] / design.values["torque_sum_factor"] / s, rel=1e-12)
