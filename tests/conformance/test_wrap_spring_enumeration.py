"""Both wrap springs against enumeration of the whole catalogue, with formulas written out again.

With wire, friction pair, hub and coils fixed only the fit is left, and everything grows with it: the least interference
that holds (or clearance that survives, and energising torque that holds) is the best one. So every combination of the
shipped tables is evaluated once, and nothing may beat the front.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import synth
from synth.results import ParetoFront
from synth.tables.catalogs import Catalogs

pytestmark = pytest.mark.slow

GAP = 1e-3
LADDER = Catalogs().table("hub_diameters").number("diameter")
LADDER = LADDER[LADDER <= 0.2]  # the range of the variable
COILS = np.arange(2, 12.25, 0.5)
PI = np.pi
PAIR = "hardened_steel_greased"


@dataclass(frozen=True)
class Ask:
    """Requirements of an enumeration in SI."""

    required: float
    bore: float
    peak: float
    speed: float = 0.0
    overrun: float = 0.0
    duty: float = 1.0
    belt_limit: float = np.inf
    drag_limit: float = np.inf
    slip_limited: bool = True
    seed: bool = False
    tolerance: float = 0.03e-3

    def requirements(self, **more):
        asked = {
            "required_torque": self.required,
            "bore_diameter": f"{1000 * self.bore} mm",
            "peak_torque": self.peak,
            "spring_speed": f"{self.speed} rad/s",
            "interference_tolerance": f"{1000 * self.tolerance} mm",
        }
        if np.isfinite(self.belt_limit):
            asked["belt_exponent_limit"] = self.belt_limit
        return asked | more


def combinations(wires=(), pairs=()):
    """Return columns of every combination of wire, pair, hub and coils as arrays that broadcast."""
    wire_table, pair_table = Catalogs().table("spring_wire_flat"), Catalogs().table("friction_materials")
    taken = [not wires or name in wires for name in wire_table.designations]
    cells = zip(pair_table.designations, pair_table.text("surfaces"), strict=True)
    offered = ["wire on hub" in cell.split(";") and (not pairs or name in pairs) for name, cell in cells]
    wire, pair, hub, coils = np.ix_(np.flatnonzero(taken), np.flatnonzero(offered), LADDER, COILS)
    names = ("radial_thickness_a", "axial_width_b", "E", "density", "bending_allow_static", "Rm_min")
    of_wire = [wire_table.number(name)[wire] for name in (*names, "endurance_amplitude")]
    of_pair = [pair_table.number(name)[pair] for name in ("mu_min", "mu_max", "p_allow", "pv_allow")]
    return *of_wire, of_pair, hub, coils


def interference_fit(ask: Ask, wires=(), pairs=()):
    """Return (mass, drag) of all feasible combinations at the least interference that holds."""
    a, b, modulus, density, allow, strength, endurance, friction, hub, n = combinations(wires, pairs)
    mu_min, mu_max, p_allow, pv_allow = friction
    hub_radius = hub / 2
    mean = hub_radius + 0 * a if ask.seed else hub_radius + a / 2
    inertia = b * a**3 / 12
    low, high = (mu * 2 * PI * n * hub_radius / mean for mu in (mu_min, mu_max))
    hoop = density * a * b * mean**3 * ask.speed**2
    grip = 1.3 * ask.required / np.expm1(low) + (0 if ask.seed else hoop)
    moment = np.maximum(grip, hoop / 0.7**2)
    curvature = moment / (modulus * inertia)
    linear = curvature * mean**2
    least = linear if ask.seed else linear / (1 + curvature * mean)
    most = least + 2 * ask.tolerance
    with np.errstate(all="ignore"):
        moment_high = modulus * inertia * most / (mean * (mean if ask.seed else mean - most))
        cap = moment_high * np.expm1(high)
        load = np.minimum(ask.peak, cap) if ask.slip_limited else ask.peak
        bending = moment_high * a / 2 / inertia
        stress = bending + (moment_high + load) / (mean * a * b)
        pressure = (moment_high + load) / (b * hub_radius * mean)
        lower = bending + moment_high / (mean * a * b)
        upper = bending + (moment_high + 1.5 * ask.required) / (mean * a * b)
        fatigue = 1.2 * ((upper - lower) / 2 / endurance + (upper + lower) / 2 / strength)
        drag = moment_high * (1 - np.exp(-high))
        rubbing = moment_high / (b * hub_radius * mean) * ask.overrun * hub_radius
        total = 2 * n + 0.5
        length, outer = total * (b + 0.2e-3), hub + 2 * a
        rise = drag * ask.overrun * ask.duty / (25 * PI * outer * length)
        shear = 16 * load * hub / (PI * (hub**4 - ask.bore**4))
        ok = (hub > ask.bore) & (shear <= 80e6) & (stress <= allow) & (pressure <= p_allow) & (fatigue <= 1)
        ok &= (2 * mean / a >= 6) & (most <= 0.1 * mean) & (rubbing <= pv_allow) & (rise <= 60)
        ok &= (high <= ask.belt_limit) & (drag <= ask.drag_limit) & (least >= 0)
        # The bounds of the variable.
        ok &= (least + ask.tolerance >= 0.005e-3) & (least + ask.tolerance <= 10e-3)
    mass = density * a * b * 2 * PI * mean * total + 7850 * PI / 4 * (hub**2 - ask.bore**2) * length
    return np.stack([np.broadcast_to(x, ok.shape)[ok] for x in (mass, drag)], axis=1)


def clearance_fit(ask: Ask):
    """Return (mass, energising torque) of all feasible combinations at the least clearance that survives."""
    a, b, modulus, density, allow, _, _, friction, hub, n = combinations()
    mu_min, mu_max, p_allow, _ = friction
    hub_radius, clearance = hub / 2, 0.05e-3 + ask.tolerance
    mean = hub_radius + a / 2
    inertia = b * a**3 / 12
    low, high = (mu * 2 * PI * n * hub_radius / mean for mu in (mu_min, mu_max))

    def moment(c):
        return -modulus * inertia * c / (mean * (mean + c))

    wide, narrow = moment(clearance + ask.tolerance), moment(clearance - ask.tolerance)
    effective = wide - density * a * b * mean**3 * ask.speed**2
    actuator = (1.3 * ask.required - effective * np.expm1(low)) * np.exp(-low)
    stress = -wide * a / 2 / inertia + (narrow + ask.peak) / (mean * a * b)
    pressure = (narrow + ask.peak) / (b * hub_radius * mean)
    total = n + 0.5 + 1
    length = total * (b + 0.2e-3)
    ok = (hub >= ask.bore + 6e-3 - 1e-9) & (stress <= allow) & (pressure <= p_allow) & (2 * mean / a >= 6)
    ok = ok & (high <= ask.belt_limit) & (actuator >= 1e-4) & (actuator <= 1e4)
    mass = density * a * b * 2 * PI * mean * total + 7850 * PI / 4 * (hub**2 - ask.bore**2) * length
    return np.stack([np.broadcast_to(x, ok.shape)[ok] for x in (mass, actuator)], axis=1)


def nondominated(points):
    order = np.lexsort(points.T[::-1])
    points = points[order]
    before = np.concatenate([[np.inf], np.minimum.accumulate(points[:, 1])[:-1]])
    return points[points[:, 1] < before]


def compare(front: ParetoFront, points: np.ndarray, objectives) -> None:
    """Nothing enumerated beats the front, and the front has nothing that enumeration does not know."""
    assert front.interrupted == ""
    assert front.certificate.kind in ("global", "exhaustive")
    assert len(points) > 100
    found = np.array([[d.values[o] for o in objectives] for d in front.designs])
    for own in found:
        assert not np.all(points < own * (1 - GAP), axis=1).any()
        # Some enumerated design is as good: the front tells of designs that exist.
        assert np.all(points <= own * (1 + 3e-6), axis=1).any()
    assert found.min(axis=0) == pytest.approx(points.min(axis=0), rel=GAP)


INTERFERENCE = {
    "locking": (Ask(50, 0.020, 125), {}),
    "slips_at_most_at_6": (Ask(50, 0.020, 125, belt_limit=6), {}),
    "freewheel": (
        Ask(30, 0.016, 75, speed=146.6, overrun=31.4, duty=0.2),
        {"overrun_speed": "31.4 rad/s", "overrun_duty": 0.2},
    ),
    "little_drag": (Ask(20, 0.012, 50, drag_limit=0.6), {"drag_torque_limit": "0.6 N*m"}),
    "source": (Ask(5, 0.012, 12.5, seed=True, slip_limited=False), {}),
}


@pytest.mark.parametrize("name", INTERFERENCE)
def test_no_interference_fit_of_the_whole_catalogue_beats_the_front(name):
    ask, more = INTERFERENCE[name]
    options = {
        "model": "seed" if ask.seed else "refined",
        "overload": "slip_limited" if ask.slip_limited else "torque_limited",
    }
    problem = synth.load("wrap_spring", practice="off", **options)
    front = synth.synthesize(problem, ask.requirements(**more), points=6, gap=GAP, time_limit=60)
    compare(front, interference_fit(ask), ("mass", "drag_torque"))


def test_no_clearance_fit_of_the_whole_catalogue_beats_the_front():
    ask = Ask(50, 0.020, 125, speed=100.0, belt_limit=8)
    asked = ask.requirements(relative_speed="500 1/min")
    front = synth.synthesize(
        synth.load("wrap_spring_actuated", practice="off"), asked, points=6, gap=GAP, time_limit=60
    )
    compare(front, clearance_fit(ask), ("mass", "actuator_torque"))


def test_a_small_catalogue_gives_its_whole_front():
    ask = Ask(50, 0.020, 125, belt_limit=6)
    wires, pairs = ["rect 4x3", "rect 5x3"], ["hardened_steel_greased"]
    parts = {"wire": wires, "friction_pair": pairs}
    front = synth.synthesize(
        synth.load("wrap_spring", practice="off"), ask.requirements(), points=200, gap=1e-4, parts=parts
    )
    wanted = nondominated(interference_fit(ask, wires, pairs))
    assert front.complete
    assert len(front.designs) == len(wanted) >= 5
    found = np.array(sorted([d.values["mass"], d.values["drag_torque"]] for d in front.designs))
    np.testing.assert_allclose(found, wanted, rtol=2e-6)  # a limit holds to a millionth


def test_free_dimensions_of_the_source_model_are_a_geometric_program():
    """Wire, hub and interference all continuous, coils and pair given: cvxpy solves the same as a convex problem."""
    import cvxpy as cp  # slow to import: whoever collects tests does without

    torque, bore, coils, tol = 50.0, 0.020, 5.0, 0.03e-3
    modulus, density, allow, strength, endurance = 206e9, 7850.0, 1000e6, 1430e6, 430e6
    pair = next(r for r in map(Catalogs().table("friction_materials").row, range(48)) if r["designation"] == PAIR)
    low, high = (pair[mu] * 2 * PI * coils for mu in ("mu_min", "mu_max"))
    a, b, r, dr, most = (cp.Variable(pos=True) for _ in range(5))
    moment = modulus * b * a**3 / 12 * most / r**2
    bending = modulus * a * most / (2 * r**2)
    rest = bending + moment / (r * a * b)
    cycle = 1.5 * torque / (r * a * b)
    peak = 2.5 * torque
    limits = [
        dr + tol <= most,
        tol + 12 * r**2 * 1.3 * torque / (modulus * b * a**3 * np.expm1(low)) <= dr,
        bending + (moment + peak) / (r * a * b) <= allow,
        (moment + peak) / (b * r**2) <= pair["p_allow"],
        1.2 * (cycle / 2 / endurance + (rest + cycle / 2) / strength) <= 1,
        16 * peak * 2 * r / (PI * 80e6) + bore**4 <= 16 * r**4,
        6 * a <= 2 * r,
        most <= 0.1 * r,
        b >= 0.3e-3,  # the bounds of the variables
        b <= 30e-3,
        a <= 15e-3,
        r <= 0.1,
        dr <= 10e-3,
    ]
    material = {
        "wire_modulus": f"{modulus / 1e6} N/mm2",
        "wire_density": density,
        "wire_bending_allow": f"{allow / 1e6} N/mm2",
        "wire_tensile_strength": f"{strength / 1e6} N/mm2",
        "wire_endurance_amplitude": f"{endurance / 1e6} N/mm2",
    }
    problem = synth.load("wrap_spring", practice="off", model="seed", overload="torque_limited", wire_choice="custom")
    objectives = {
        "mass": density * a * b * 2 * PI * r * (2 * coils + 0.5),  # hubs without mass: else it is no posynomial
        "drag_torque": moment * -np.expm1(-high),
    }
    for name, expression in objectives.items():
        convex = cp.Problem(cp.Minimize(expression), limits)
        convex.solve(gp=True, solver=cp.CLARABEL)
        front = synth.synthesize(
            problem,
            {"required_torque": torque, "bore_diameter": "20 mm", "hub_density": 0, **material},
            objectives=[name],
            fix={"coils_per_hub": coils},
            parts={"friction_pair": [PAIR]},
            grid=False,
            gap=1e-3,
        )
        assert front.certificate.kind == "global"
        assert front.designs[0].values[name] == pytest.approx(convex.value, rel=1e-4)


# -- policies of overload --------------------------------------------------------------------------


def fronts(peak):
    """Return the fronts of both policies for one peak torque."""
    found = []
    for overload in ("slip_limited", "torque_limited"):
        requirements = {"required_torque": "50 N*m", "bore_diameter": "20 mm", "peak_torque": peak}
        front = synth.synthesize(synth.load("wrap_spring", practice="off", overload=overload), requirements, points=4)
        assert front.certificate.kind == "global"
        found.append(front)
    return found


def test_a_clutch_that_slips_need_not_carry_twenty_times_the_torque():
    slip, locked = fronts("1000 N*m")
    lightest = [min(d.values["mass"] for d in front.designs) for front in (slip, locked)]
    assert lightest[0] < 0.9 * lightest[1]
    for design in slip.designs:
        v = design.values
        assert v["wire_torque"] == pytest.approx(min(v["slip_torque"], 1000.0), rel=1e-12)
    assert any(d.values["wire_torque"] < 999 for d in slip.designs)
    assert all(d.values["wire_torque"] == 1000 for d in locked.designs)
    for front, limited in ((slip, True), (locked, False)):
        ask = Ask(50, 0.020, 1000.0, slip_limited=limited)
        compare(front, interference_fit(ask), ("mass", "drag_torque"))
