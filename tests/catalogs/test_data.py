"""The shipped tables: each loads strictly, and its figures agree with geometry and physics."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from synth.tables.reading import load_table
from synth.tables.schema import load_schema
from synth.tables.table import Table
from synth.units import from_si, parse_unit
from tests.shipped import FAMILIES

FOLDER = Path(__file__).parents[2] / "catalogs"
CATALOGUES = {
    "friction_materials": 48, "core_plates": 14, "lined_plates": 9, "strip_thicknesses": 34, "plate_rings": 80,
    "plate_sets": 77, "facing_sets": 12,
    "parallel_keys": 19, "splines": 93, "shaft_ends": 42, "preferred_numbers": 229, "hub_diameters": 51,
    "guide_rolling_bearings": 95, "spring_wire_round": 170, "spring_wire_flat": 46, "compression_springs": 168,
    "disc_springs_DIN2093": 87, "metals": 60, "float_materials": 25, "motors_iec": 22, "balls": 35, "powders": 3,
    "winding_wire": 54, "cone_layouts": 2, "release_aids": 4, "cooling_options": 8,
}  # fmt: skip
DATA = {
    "application_factors": ("designation", 168),
    "requirements_batch": ("request_id", 200),
    "seed_reference_case": ("quantity", 26),
    "fits_reference": ("designation", 22),
}
ROWS = CATALOGUES | {name: rows for name, (_, rows) in DATA.items()}


@lru_cache(maxsize=64)
def table(name: str) -> Table:
    return load_table(FOLDER / f"{name}.csv")


class View:
    """Columns of a table in the units of its headers, as arrays."""

    def __init__(self, of: Table) -> None:
        self._rows = of

    def __getattr__(self, column: str) -> np.ndarray:
        found = self._rows.column(column)
        if found.numeric:
            return from_si(self._rows.number(column), found.scale)
        return np.array(self._rows.text(column))

    def groups(self, column: str) -> Iterator[tuple[str, View]]:
        cells = getattr(self, column)
        for value in dict.fromkeys(cells.tolist()):
            yield value, View(self._rows.select(cells == value))

    def where(self, mask: np.ndarray) -> View:
        return View(self._rows.select(mask))

    def one(self, designation: str) -> View:
        return View(self._rows.select([self._rows.row_index(designation)]))


def view(name: str) -> View:
    return View(table(name))


def rises(values: np.ndarray) -> bool:
    return bool((np.diff(values) > 0).all())


def between(values: np.ndarray, low: float, high: float) -> bool:
    return bool(((values >= low) & (values <= high)).all())


# ---- files ----------------------------------------------------------------------------------------------------------


def test_the_tables_are_all_there() -> None:
    files = {path.name for path in FOLDER.glob("*.csv")}
    assert files == {f"{name}.csv" for name in ROWS} | {f"{name}.schema.csv" for name in ROWS}


@pytest.mark.parametrize("name", ROWS)
def test_each_table_loads_strictly(name: str) -> None:
    found = table(name)
    assert len(found) == ROWS[name]
    assert list(found.columns)[-2:] == ["source", "confidence"]
    assert all(len(source) >= 4 for source in found.text("source"))
    key = "designation" if name in CATALOGUES else DATA[name][0]
    assert next(iter(found.columns)) == key
    keys = found.text(key)
    assert len(set(keys)) == len(keys)
    assert not any(re.search("[,;]", text) for text in keys)
    assert len(set(found.hashes)) == len(found)
    for column in found.columns.values():
        assert (column.minimum is not None) == (column.maximum is not None) == column.numeric
        if column.type == "integer":
            assert column.unit == "-"
        if name in CATALOGUES and column.unit is not None:
            assert not column.unit.startswith("column:")


@pytest.mark.parametrize("name", ROWS)
def test_the_schema_is_read_as_written(name: str) -> None:
    schema = load_schema(FOLDER / f"{name}.schema.csv")
    assert [column.name for column in schema.columns] == list(table(name).columns)
    assert schema.columns[0].required


@pytest.mark.parametrize(
    ("name", "column"),
    [("application_factors", "parameter_unit"), ("seed_reference_case", "unit"), ("fits_reference", "b_unit")],
)
def test_units_inside_cells_are_units(name: str, column: str) -> None:
    units = {unit for unit in table(name).text(column) if unit}
    assert units
    assert all(parse_unit(unit).factor > 0 for unit in units)


def test_the_readme_lists_every_table_with_its_rows() -> None:
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    for name, rows in ROWS.items():
        assert f"| {name} | {rows} |" in readme
    for found in map(table, ROWS):
        for column in found.columns.values():
            assert column.unit is None or column.unit.startswith("column:") or f"`{column.unit}`" in readme


def test_bins_of_factors_have_a_unit() -> None:
    d = view("application_factors")
    assert (np.isnan(d.parameter_from) | (d.parameter_unit != "")).all()


# ---- friction -------------------------------------------------------------------------------------------------------


def test_friction_materials() -> None:
    d = view("friction_materials")
    assert ((d.mu_min <= d.mu_dynamic) & (d.mu_dynamic <= d.mu_max)).all()
    assert set(d.lubrication) == {"dry", "oil"}
    assert ((d.lubrication_note == "") | ((d.lubrication_note == "greased") & (d.lubrication == "dry"))).all()
    assert (d.mu_dynamic[d.lubrication == "oil"] <= 0.25).all()
    assert (d.temp_continuous <= d.temp_max).all()
    known = ~np.isnan(d.thickness_min + d.thickness_max)
    assert (d.thickness_min[known] < d.thickness_max[known]).all()
    known = ~np.isnan(d.wearable_depth + d.thickness_max)
    assert (d.wearable_depth[known] < d.thickness_max[known]).all()
    assert ((d.lining_thickness == 0) | (d.lining_thickness == d.thickness_min)).all()
    asbestos = np.array(["asbestos" in lining and "non-asbestos" not in lining for lining in d.lining])
    assert ((d.new_design_allowed == 0) == asbestos).all()
    np.testing.assert_allclose(d.pv_allow, d.power_density_allow / d.mu_dynamic, rtol=6e-3)
    assert set(d.take_up) == {"", "soft", "medium", "harsh"}
    told = ~np.isnan(d.p_mean_allow)  # practice asks less of a lining than its maker
    assert (d.p_mean_allow[told] <= d.p_allow[told]).all()
    assert ((d.take_up[told] != "") | ["wire on hub" in cell for cell in d.surfaces[told]]).all()
    assert (np.isnan(d.counter_mean_max) | (d.counter_mean_max < d.counter_peak_max)).all()
    np.testing.assert_array_equal(
        np.isnan(d.counter_mean_max), [set(s.split(";")) <= {"", "wire on hub"} for s in d.surfaces]
    )


def test_surfaces_of_friction_pairs() -> None:
    d = view("friction_materials")
    words = [set(cell.split(";")) - {""} for cell in d.surfaces]
    assert set().union(*words) == {"disc facing", "plate pack", "cone facing", "wire on hub"}
    wrap = d.where(np.array(["wire on hub" in cell for cell in words]))
    hardened = wrap.p_allow >= 20
    assert ((wrap.p_allow >= 20) & (wrap.p_allow <= 100)).sum() >= 9
    assert (wrap.confidence[hardened] == "typical").all()


def test_friction_fields_named_as_seen_are_filled() -> None:
    found = table("friction_materials")
    named = 0
    for i in range(len(found)):
        row = found.row(i)
        for column in ("fields_verified", "fields_textbook"):
            for field in str(row[column] or "").split(";"):
                assert not field or row[field] is not None
                named += bool(field)
    assert named > 100


def test_friction_pair_of_the_lecture() -> None:
    d = view("friction_materials").one("seed_multiplate_ref")
    figures = [d.mu_dynamic[0], d.p_allow[0], d.q_hourly_allow[0], d.power_density_allow[0]]
    assert figures == [0.1, 0.4, 20, 0.6]


# ---- plates ---------------------------------------------------------------------------------------------------------


def test_plate_thicknesses() -> None:
    assert rises(view("core_plates").thickness)
    ladders = dict(view("strip_thicknesses").groups("rolling"))
    assert set(ladders) == {"cold", "hot"}
    assert all(rises(ladder.thickness) for ladder in ladders.values())
    d = view("lined_plates")
    np.testing.assert_allclose(d.core_thickness + 2 * d.lining_thickness, d.total_thickness, rtol=1e-12)
    assert rises(d.total_thickness)


def test_plate_rings() -> None:
    d = view("plate_rings")
    outer, inner = d.ring_outer_diameter, d.ring_inner_diameter
    assert (outer > inner).all()
    assert between(d.ring_ratio, 0.09, 0.27)
    np.testing.assert_allclose((outer + inner) / 2, d.mean_diameter, atol=0.01)
    np.testing.assert_allclose((outer - inner) / 2, d.ring_width, atol=0.01)
    np.testing.assert_allclose(d.ring_width / d.mean_diameter, d.ring_ratio, atol=1e-3)
    np.testing.assert_allclose(math.pi / 4 * (outer**2 - inner**2), d.area_one_side, rtol=1e-3)


def test_plate_sets_follow_from_rings_cores_and_linings() -> None:
    rings, cores, lined, sets = (view(n) for n in ("plate_rings", "core_plates", "lined_plates", "plate_sets"))
    wanted = []
    for outer, inner in zip(rings.ring_outer_diameter, rings.ring_inner_diameter, strict=True):
        flat = [t for t in cores.thickness if t in lined.core_thickness and outer / t <= 100]
        if flat:  # the thickest core with lining is for 300 mm
            linings = lined.lining_thickness[lined.core_thickness == min(flat)]
            wanted += [(outer, inner, min(flat), lining) for lining in linings]
    found = zip(sets.ring_outer_diameter, sets.ring_inner_diameter, sets.outer_core_thickness, sets.lining_thickness,
                strict=True)  # fmt: skip
    np.testing.assert_allclose(list(found), wanted)
    np.testing.assert_allclose(sets.inner_core_thickness, sets.outer_core_thickness)
    np.testing.assert_allclose(sets.inner_spline_diameter, sets.ring_inner_diameter - 6)
    np.testing.assert_allclose(sets.outer_spline_diameter, sets.ring_outer_diameter + 6)
    np.testing.assert_array_equal(sets.inner_teeth, sets.inner_spline_diameter // 3)
    np.testing.assert_array_equal(sets.outer_teeth, sets.outer_spline_diameter // 3)


def test_facing_sets_are_usual_outsides_with_two_rings_each_that_practice_accepts() -> None:
    d = view("facing_sets")
    assert sorted(set(d.ring_outer_diameter)) == [180, 200, 215, 228, 240, 250]
    ratio = (d.ring_outer_diameter - d.ring_inner_diameter) / (d.ring_outer_diameter + d.ring_inner_diameter)
    assert ((ratio > 0.17) & (ratio < 0.28)).all()
    np.testing.assert_allclose(ratio, np.tile([0.18, 0.24], 6), atol=0.011)
    assert (d.rivet_depth < d.facing_thickness).all()
    assert set(d.confidence) == {"computed"}


# ---- rollers --------------------------------------------------------------------------------------------------------


def test_rollers() -> None:
    d = view("guide_rolling_bearings")
    assert set(d.kind) == {
        "deep_groove_ball_bearing",
        "track_roller_cyl_full_complement",
        "track_roller_needle_full_complement",
        "track_roller_needle_caged",
        "spherical_roller_bearing",
    }
    assert (d.bore < d.outer_diameter).all()
    assert ((d.contact_width <= d.width) & (d.contact_width > 0.4 * d.width)).all()
    assert (d.C_dynamic_min <= d.C_dynamic_max).all()
    assert (d.C0_static_min <= d.C0_static_max).all()
    track = np.array([kind.startswith("track_roller") for kind in d.kind])
    assert ((d.crowned == 1) == track).all()
    assert not np.isnan(d.outer_ring_load_limit[track]).any()
    ring = math.pi / 4 * (d.outer_diameter**2 - d.bore**2) * d.width * 7.85e-6
    assert between(d.mass / ring, 0.45, 1.15)
    rollers = d.where(d.kind != "deep_groove_ball_bearing")
    assert between(rollers.C0_static_max / (rollers.outer_diameter * rollers.width), 8, 70)


def test_ball_bearings() -> None:
    d = view("guide_rolling_bearings")
    balls = d.where(d.kind == "deep_groove_ball_bearing")
    assert (balls.C_dynamic_min / balls.C_dynamic_max > 0.80).all()
    assert (balls.C0_static_min / balls.C0_static_max > 0.85).all()
    assert (balls.C_dynamic_min > balls.C0_static_max).all()
    series = np.array([designation[:2] for designation in balls.designation])
    for two in set(series):
        ladder = balls.where(series == two)
        for column in ("bore", "outer_diameter", "C_dynamic_min", "C0_static_min", "mass"):
            assert rises(getattr(ladder, column)), (two, column)
        assert (np.diff(ladder.limiting_speed) <= 0).all()


# ---- wire and springs -----------------------------------------------------------------------------------------------


def test_round_wire() -> None:
    d = view("spring_wire_round")
    for _, ladder in d.groups("material"):
        assert rises(ladder.wire_diameter)
        assert (np.diff(ladder.Rm_min) <= 0).all()
    assert between(d.Rm_min, 900, 2900)
    assert between(d.tau_allow_solid / d.Rm_min, 0.475, 0.565)


def test_round_wire_against_the_fits() -> None:
    fits = view("fits_reference")
    log = fits.form == "log"
    assert (fits.b_unit[log] == "N/mm2").all()
    assert not np.isnan(fits.cap[log]).any()
    assert (fits.b_unit[~log] == "-").all()
    compared = 0
    for material, ladder in view("spring_wire_round").groups("material"):
        if material in fits.designation:
            fit = fits.one(material)
            strength = np.minimum(fit.cap[0], fit.a[0] - fit.b[0] * np.log10(ladder.wire_diameter))
            np.testing.assert_allclose(ladder.Rm_min, strength, rtol=0.012)
            compared += 1
    assert compared >= 3


def test_flat_wire() -> None:
    d = view("spring_wire_flat")
    a, b = d.radial_thickness_a, d.axial_width_b
    np.testing.assert_allclose(d.I_radial_bending, b * a**3 / 12, rtol=2e-3)
    np.testing.assert_allclose(d.area, a * b - (4 - math.pi) * d.corner_radius**2, rtol=2e-3)
    assert ((d.shape == "square") == (a == b)).all()
    np.testing.assert_allclose(d.bending_allow_static, 0.7 * d.Rm_min, atol=8)
    np.testing.assert_allclose(d.endurance_amplitude, 0.30 * d.Rm_min, atol=1)
    assert (d.confidence == "typical").all()


def test_compression_springs() -> None:
    d = view("compression_springs")
    coil, wire, n = d.mean_diameter_D, d.wire_diameter_d, d.active_coils_n
    rate = 81500.0 * wire**4 / (8 * coil**3 * n)
    np.testing.assert_allclose(rate, d.rate_R, rtol=2e-3)
    solid, clearance = (n + 2) * wire, n * (0.0015 * coil**2 / wire + 0.1 * wire)
    np.testing.assert_allclose(solid, d.solid_length_Lc, atol=2e-3)
    np.testing.assert_allclose(solid + clearance, d.min_working_length_Ln, atol=2e-3)
    force = rate * (d.free_length_L0 - solid - clearance)
    np.testing.assert_allclose(force, d.max_force_Fn, rtol=5e-3)
    np.testing.assert_allclose(8 * coil * force / (math.pi * wire**3), d.tau_n, rtol=5e-3)
    assert (d.tau_c <= d.tau_allow_solid + 0.5).all()
    assert between(d.spring_index_w, 4, 16)
    assert (d.max_force_Fn < d.solid_force_Fc).all()
    volume = math.pi / 4 * wire**2 * math.pi * coil * d.total_coils_nt
    assert between(d.mass / (volume * 7.85e-6), 0.85, 1.15)


def test_disc_springs() -> None:
    d = view("disc_springs_DIN2093")
    assert (np.abs(d.deviation_computed_vs_recalled) < 0.025).all()
    deviation = d.F_at_075_h0_computed / d.F_at_075_h0_recalled - 1
    np.testing.assert_allclose(deviation, d.deviation_computed_vs_recalled, atol=1e-3)
    ranges = {"A": (0.30, 0.51), "B": (0.60, 0.85), "C": (1.05, 1.40)}
    series = dict(d.groups("series"))
    assert set(series) == set(ranges)
    for letter, ladder in series.items():
        assert between(ladder.h0_over_t, *ranges[letter])
        assert rises(ladder.De)


# ---- shafts, preferred numbers --------------------------------------------------------------------------------------


def test_keys() -> None:
    d = view("parallel_keys")
    assert rises(d.width_b)
    assert (d.shaft_diameter_over[1:] == d.shaft_diameter_up_to[:-1]).all()
    depth = d.shaft_depth_t1 + d.hub_depth_t2
    assert ((depth >= d.height_h) & (depth <= d.height_h + 0.6)).all()


def test_splines() -> None:
    d = view("splines")
    assert (d.inner_diameter < d.outer_diameter).all()
    np.testing.assert_allclose((d.inner_diameter + d.outer_diameter) / 2, d.mean_flank_diameter, atol=0.01)
    involute = d.series == "din5480"
    assert not np.isnan(d.width_b[~involute]).any()
    d = d.where(involute)
    shift = (d.reference_diameter_dB - d.module * d.teeth - 1.1 * d.module) / 2
    np.testing.assert_allclose(shift, d.profile_shift_xm, atol=1e-3)
    assert between(shift / d.module, -0.0501, 0.4501)


def test_shaft_ends_and_hubs() -> None:
    d = view("shaft_ends")
    assert rises(d.diameter)
    known = ~np.isnan(d.length_short)
    assert known.any()
    assert (d.length_short[known] < d.length_long[known]).all()
    assert rises(view("hub_diameters").diameter)


def test_preferred_numbers() -> None:
    d = view("preferred_numbers")
    assert (np.abs(d.value / d.exact_value - 1) < 0.0135).all()
    for series, ladder in d.groups("series"):
        assert rises(ladder.value)
        np.testing.assert_allclose(ladder.exact_value, 10 ** (ladder.index / int(series[1:])), rtol=1e-4)


# ---- materials and motors -------------------------------------------------------------------------------------------


def test_metals() -> None:
    d = view("metals")
    assert (d.yield_Re <= d.tensile_Rm).all()
    assert (d.fatigue_reversed_bending < d.tensile_Rm).all()
    assert (d.hertz_allow_cyclic < d.hertz_limit_static).all()
    steel = np.array([bool(re.search("steel|hardened|case|nitrided|tempered", kind)) for kind in d.material_class])
    assert steel.sum() > 10
    assert between(d.E[steel], 180000, 220000)


def test_float_materials_follow_the_metals() -> None:
    d = view("float_materials")
    m = View(table("metals").select([table("metals").row_index(name) for name in d.designation]))
    assert (d.hertz_allow < d.hertz_static).all()
    assert (d.hertz_static <= 4000).all()
    np.testing.assert_allclose(d.hertz_allow, np.minimum(m.hertz_allow_cyclic, 4000))
    np.testing.assert_allclose(d.hertz_static, np.minimum(m.hertz_limit_static, 4000))
    np.testing.assert_allclose(d.strength_allow, np.minimum(m.fatigue_reversed_bending, m.yield_Re / 1.5), atol=0.51)
    for column in ("E", "nu", "density"):
        assert (getattr(d, column) == getattr(m, column)).all()
    assert set(d.guide_surface) <= {"hardened", "unhardened", "plastic"}


def test_motors() -> None:
    d = view("motors_iec")
    np.testing.assert_allclose(9549.3 * d.rated_power / d.rated_speed, d.rated_torque, rtol=0.01)
    np.testing.assert_allclose(1 - d.rated_speed / d.synchronous_speed, d.rated_slip, atol=1e-4)
    known = ~np.isnan(d.breakdown_slip)
    assert (known == ~np.isnan(d.pullout_torque_ratio)).all()
    # Kloss: the curve through the breakdown point gives the rated torque at rated slip
    ratio = d.rated_slip[known] / d.breakdown_slip[known]
    np.testing.assert_allclose(2 * d.pullout_torque_ratio[known] / (ratio + 1 / ratio), 1, rtol=2e-3)
    generic = d.where(d.row_kind == "generic")
    assert len(generic.designation) == 19
    assert all(rises(getattr(generic, column)) for column in ("rated_power", "rated_torque", "rotor_inertia"))


# ---- balls, powders, winding wire, small tables ---------------------------------------------------------------------


def test_balls() -> None:
    d, steel = view("balls"), view("metals").one("100Cr6")
    assert rises(d.diameter)
    np.testing.assert_allclose(d.mass, d.density * math.pi / 6 * (d.diameter * 1e-3) ** 3, rtol=1e-4)
    assert (d.hertz_limit == 4200).all()
    assert (d.density == steel.density[0]).all()
    assert (d.E == steel.E[0]).all()


def test_powders() -> None:
    d = view("powders")
    packing = d.bulk_density / 7870
    np.testing.assert_allclose(d.relative_permeability, (1 + 2 * packing) / (1 - packing), rtol=1e-4)
    assert between(d.tau_sat * 0.6**2 / (0.6**2 + d.half_flux_density**2), 10, 40)
    assert (d.confidence == "typical").all()


def test_winding_wire() -> None:
    d = view("winding_wire")
    np.testing.assert_allclose(d.copper_area, math.pi / 4 * d.copper_diameter**2, rtol=1e-4)
    assert between(d.copper_diameter / d.overall_diameter, 0.85, 0.97)
    for _, ladder in d.groups("insulation_temperature"):
        assert rises(ladder.copper_diameter)
        assert rises(ladder.overall_diameter)
        assert rises(ladder.copper_diameter / ladder.overall_diameter)


def test_small_tables() -> None:
    cones = view("cone_layouts")
    assert cones.one("outer_spring").force_closed[0] == 0
    assert cones.one("inner_cone").force_closed[0] == 1
    assert cones.one("inner_cone").mass_factor[0] > 1
    none = view("release_aids").one("none")
    assert [none.force_fraction[0], none.area_factor[0], none.drag_factor[0]] == [0, 1, 1]
    cooling = view("cooling_options")
    dry, oil, water = (cooling.lubrication == name for name in ("dry", "oil", "any"))
    assert (dry | oil | water).all()
    assert ((cooling.forced_oil == 0) | oil).all()
    for found in (cooling.heat_transfer, cooling.heat_transfer_still):
        assert between(found[dry], 12, 80)  # gases, free and forced: 2 to 250
        assert rises(found[oil])
        assert between(found[oil], 80, 300)
    assert np.isnan(cooling.heat_transfer[water]).all()  # a jacket needs a body that stands
    assert (cooling.heat_transfer[~water] >= cooling.heat_transfer_still[~water]).all()
    assert ((cooling.area_factor > 1) == (cooling.fin_mass > 0)).all()


# ---- factors, requests, the lecture's case --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["c_m_engagements", "c_v_speed", "c_z_surfaces"])
def test_factors_fall(name: str) -> None:
    d = view("application_factors")
    factors = d.factor[d.table == name]
    assert len(factors) > 1
    assert (np.diff(factors) < 0).all()


@pytest.fixture(scope="module")
def requests() -> View:
    return view("requirements_batch")


def names_family(d: View, pattern: str) -> np.ndarray:
    every = zip(d.family, d.alternative_families, strict=True)
    return np.array([bool(re.search(pattern, f"{first};{others}")) for first, others in every])


def test_requests_name_families(requests: View) -> None:
    d = requests
    assert set(d.family) <= set(FAMILIES)
    assert {family for cell in d.alternative_families for family in cell.split(";")} - {""} <= set(FAMILIES)
    assert ((d.lubrication != "") == names_family(d, "multi_plate_clutch")).all()
    assert set(d.lubrication) == {"", "dry", "oil"}


@pytest.mark.parametrize(
    ("column", "families"),
    [
        ("load_torque", "multi_plate_clutch|disc_clutch|cone_clutch"),
        ("required_torque", "wrap_spring|centrifugal|magnetic_powder|roller_coupling"),
        ("bore_diameter", "wrap_spring"),
        ("full_torque_speed", "centrifugal"),
    ],
)
def test_requests_are_filled_where_a_family_asks(requests: View, column: str, families: str) -> None:
    assert (~np.isnan(getattr(requests, column)) == names_family(requests, families)).all()


def test_requests_agree_with_physics(requests: View) -> None:
    d = requests
    c = d.where(names_family(d, "centrifugal"))
    speeds = [c.idle_speed, c.contact_speed_min, c.contact_speed_max, c.full_torque_speed, c.top_speed]
    assert all((low < high).all() for low, high in pairwise(speeds))
    np.testing.assert_allclose(9549.3 * d.rated_power / d.driver_speed, d.rated_torque, rtol=0.02)
    q = d.where(~names_family(d, "roller_coupling") & ~np.isnan(d.required_torque))
    np.testing.assert_allclose(q.safety_factor * q.rated_torque / q.required_torque, 1, rtol=0.01)
    both = d.where(~np.isnan(d.load_torque) & ~np.isnan(d.required_torque))
    assert (both.required_torque > both.load_torque).all()
    assert (d.outer_diameter_limit > 1.8 * d.hub_bore_diameter).all()
    assert (d.slip_time_limit >= d.acceleration_time_estimate * 0.99).all()
    hourly = d.friction_work_estimate * d.engagements_per_hour
    assert (hourly <= 1.05 * 0.35 * d.rated_power * 3.6e6 + 1e6).all()


def test_the_lectures_case() -> None:
    d = view("seed_reference_case")
    ours = np.where(np.isnan(d.value_recomputed), d.value_in_seed, d.value_recomputed)
    v = dict(zip(d.quantity.tolist(), ours.tolist(), strict=True))
    torque = v["n"] * v["M2_nominal"] / (v["c_m"] * v["c_v"] * v["c_z"])
    assert torque == pytest.approx(v["Mk_design"], rel=1e-5)
    ring = math.pi * v["mu"] * v["p_allow"] * v["z"] * v["c"] * (1 + v["c"] ** 2 / 3)
    assert (2e3 * torque / ring) ** (1 / 3) == pytest.approx(v["dm"], rel=1e-6)
    assert v["W_friction"] * v["engagements_per_hour"] / v["A_total"] == pytest.approx(v["w"], rel=1e-5)
