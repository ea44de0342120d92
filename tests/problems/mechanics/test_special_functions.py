"""What the formulas that the search keeps as one node declare of themselves, checked on wide samples."""

import inspect
from functools import cache

import casadi as ca
import numpy as np
import pytest
import synth.problems.centrifugal.ball_ramp
import synth.problems.cone.model
import synth.problems.magnetic_powder.model
import synth.problems.multi_plate.model  # noqa: F401 - fills the table
from synth.problems.mechanics import startup

from synth.special import TABLE, SpecialFunction

POINTS = 6000
NAMES = sorted(n for n in TABLE if n.startswith("synth.problems."))
REACTIVE = [n for n in NAMES if ".reactive_" in n]
# Ratios of guide friction end at 1, where plates jam; all else is sampled over many decades.
RANGES = {
    "inner_ratio": (1e-6, 0.98),
    "outer_ratio": (1e-6, 0.98),
    "surfaces": (2, 100),
    "load_torque": (1e-1, 1e6),
    "driven_inertia": (1e-4, 1e4),
    "driver_speed": (1e-1, 6e3),
    "ramp_time": (1e-2, 10),
    # Cones blunter than arctan(1/mu), where the wedge effect ends, are beyond the bounds of the family.
    "half_angle": (1e-3, 0.45),
    "mu": (1e-3, 0.7),
}
ANYTHING = (1e-4, 1e3)


def arguments_of(name):
    return list(inspect.signature(TABLE[name].formula).parameters)


def sample(name, count, seed):
    """Points of the whole domain (arguments, count); those of the start-up lie on both sides of every switch."""
    rng = np.random.default_rng(seed)
    names = arguments_of(name)
    ends = np.log([RANGES.get(a, ANYTHING) for a in names])
    points = dict(zip(names, np.exp(rng.uniform(ends[:, :1], ends[:, 1:], (len(names), count))), strict=True))
    if name in REACTIVE:
        load, ramp, speed = points["load_torque"], points["ramp_time"], points["driver_speed"]
        points["torque"] = torque = load * (1 + 10 ** rng.uniform(-4, 3, count))
        # Lock-up after or in the ramp is a matter of this inertia; half of the points lie around it.
        border = ramp * (torque - load) ** 2 / (2 * torque * speed)
        points["driven_inertia"] = np.where(
            rng.random(count) < 0.5, points["driven_inertia"], border * 10 ** rng.uniform(-2, 2, count)
        )
    elif TABLE[name].above is not None:
        first, second = (names[k] for k in TABLE[name].above)
        points[first] = points[second] * (1 + 10 ** rng.uniform(-4, 3, count))
    return np.array([points[a] for a in names])


@cache
def derivatives(name):
    """Value, gradient and Hessian matrix of the logarithm in the logarithms of the arguments."""
    logs = ca.SX.sym("y", len(arguments_of(name)))
    value = ca.log(TABLE[name].formula(*[ca.exp(logs[k]) for k in range(logs.shape[0])]))
    hessian, gradient = ca.hessian(value, logs)
    return ca.Function("derivatives", [logs], [value, gradient, ca.densify(hessian)])


def derivatives_at(name, points):
    n, count = points.shape
    value, gradient, hessian = derivatives(name).map(count)(np.log(points))
    return np.array(value).ravel(), np.array(gradient), np.array(hessian).T.reshape(count, n, n)


def log_value(name, points):
    return np.log(TABLE[name].formula(*points))


@pytest.mark.parametrize("name", NAMES)
def test_values_are_positive(name):
    value = TABLE[name].formula(*sample(name, POINTS, 1))
    assert np.all(np.isfinite(value) & (value > 0))


@pytest.mark.parametrize("name", NAMES)
def test_elasticities_lie_in_their_ranges(name):
    points = sample(name, POINTS, 2)
    _, gradient, _ = derivatives_at(name, points)
    for slope, (least, largest) in zip(gradient, TABLE[name].elasticity, strict=True):
        slack = 1e-9 * np.maximum(1, np.abs(slope))
        assert np.all(slope >= least - slack)
        assert np.all(slope <= largest + slack)
        # ... which are no wider than need be: every end that is finite is nearly reached.
        for end, reached in ((least, slope.min()), (largest, slope.max())):
            assert np.isinf(end) or abs(reached - end) < 0.02


@pytest.mark.parametrize("name", NAMES)
def test_elasticities_hold_for_steps(name):
    """The same without derivatives, from values alone, also across the conditions that choose a formula."""
    function, rng = TABLE[name], np.random.default_rng(3)
    points = sample(name, POINTS, 11)
    for k, (least, largest) in enumerate(function.elasticity):
        moved = points.copy()
        moved[k] *= 10 ** rng.uniform(-0.3, 0.3, POINTS)
        with np.errstate(invalid="ignore"):  # a plate that jams
            value = function.formula(*moved)
        exists = np.isfinite(value) & (value > 0)
        assert exists.mean() > 0.5
        rise = (np.log(value[exists]) - log_value(name, points)[exists]) / np.log(moved[k] / points[k])[exists]
        assert np.all((rise >= least - 1e-6) & (rise <= largest + 1e-6))


@pytest.mark.parametrize("name", NAMES)
def test_curvature_declared_is_that_of_the_hessian(name):
    function = TABLE[name]
    _, _, hessian = derivatives_at(name, sample(name, POINTS, 4))
    size = np.maximum(np.abs(hessian).max(axis=(1, 2)), 1.0)
    bends = np.linalg.eigvalsh(hessian) / size[:, None]
    if function.curvature == "log-convex":
        assert bends.min() > -1e-11
    elif function.curvature == "log-concave":
        assert bends.max() < 1e-11
    else:  # nothing is declared only where neither is true
        assert bends.min() < -1e-3
        assert bends.max() > 1e-3


@pytest.mark.parametrize("name", [n for n in NAMES if TABLE[n].curvature])
def test_curvature_declared_holds_between_any_two_points(name):
    """Midpoints far and near: also across the conditions that choose a formula, where the Hessian jumps."""
    function, rng = TABLE[name], np.random.default_rng(5)
    first = sample(name, POINTS, 6)
    for reach in (1.0, 0.1, 0.01):
        second = first * (sample(name, POINTS, 7) / first) ** reach
        share = rng.random(POINTS)
        between = first**share * second ** (1 - share)
        logs = [log_value(name, x) for x in (first, second, between)]
        excess = logs[2] - (share * logs[0] + (1 - share) * logs[1])
        # Beside the load torque the difference of torques has few digits left.
        slack = 1e-10 * (1 + np.abs(logs[0]) + np.abs(logs[1]))
        assert np.all(excess <= slack if function.curvature == "log-convex" else excess >= -slack)


@pytest.mark.parametrize("name", REACTIVE)
def test_formulas_of_the_start_up_have_no_kink(name):
    """Where lock-up or peak power moves to the end of the ramp, the slopes of both formulas agree."""
    rng = np.random.default_rng(8)
    load, speed, ramp = np.exp(rng.uniform(0, 5, (3, 500)))
    torque = load * (1 + 10 ** rng.uniform(-2, 2, 500))
    factor = 3 * torque - load if "power" in name else torque - load
    inertia = ramp * (torque - load) * factor / (2 * torque * speed)
    sides = [np.array([torque, load, inertia * (1 + e), speed, ramp]) for e in (-1e-7, 1e-7)]
    left, right = (derivatives_at(name, side)[1] for side in sides)
    np.testing.assert_allclose(left, right, rtol=1e-4, atol=1e-6)
    after = [startup.locks_after_ramp(*side) for side in sides]
    if "power" not in name:
        assert not after[0].any()
        assert after[1].all()


# -- bounds over boxes -----------------------------------------------------------------------------------


def boxes(name, count, seed, widest=2.0):
    """Boxes around points of the domain, and points in them that may lie outside the domain."""
    rng = np.random.default_rng(seed)
    centre = sample(name, count, seed)
    width = rng.exponential(0.5, (2, *centre.shape)) * (rng.random((2, *centre.shape)) < 0.8)
    low, high = centre * np.exp(-np.minimum(width[0], widest)), centre * np.exp(np.minimum(width[1], widest))
    inside = low * (high / low) ** rng.random((30, *centre.shape))
    return low, high, np.concatenate([inside, centre[None], low[None], high[None]])


@pytest.mark.parametrize("name", REACTIVE)
def test_bounds_hold_in_boxes_that_straddle_the_border_of_the_domain(name):
    function = TABLE[name]
    low, high, points = boxes(name, 3000, 9)
    straddling = low[0] < high[1]
    assert 0.2 < straddling.mean() < 0.95
    least, most = function.bounds(list(zip(low, high, strict=True)))
    for x in points:
        exists = x[0] > x[1]
        value = function.formula(*x)
        assert np.isnan(value[x[0] < x[1]]).all()
        assert np.all((value >= least * (1 - 1e-9)) | ~exists)
        assert np.all((value <= most * (1 + 1e-9)) | ~exists)
    # Where the box lies inside, the ends are values; beyond the border one end is open, and not the other.
    falling = function.elasticity[0][1] <= 0
    assert np.isfinite(least).all()
    assert np.all(least >= 0)
    assert np.isfinite(most[~straddling]).all()
    if falling:
        assert np.isinf(most[straddling]).all()


@pytest.mark.parametrize("name", REACTIVE)
def test_nothing_is_known_where_the_load_never_starts(name):
    function = TABLE[name]
    low, high, _ = boxes(name, 300, 10)
    load = high[0] * 1.001, high[0] * 2
    arguments = [(low[0], high[0]), load, *zip(low[2:], high[2:], strict=True)]
    least, most = function.bounds(arguments)
    assert np.isneginf(least).all()
    assert np.isposinf(most).all()
    assert not function.exists(arguments).any()
    assert np.isnan(function.formula(100.0, 100.1, 30.0, 26.6, 2.0))


def test_the_limit_on_the_border_is_the_value_there():
    work, power = (
        TABLE[f"synth.problems.mechanics.startup.reactive_{n}"] for n in ("friction_work", "peak_slip_power")
    )
    same = np.array(600.0)
    with np.errstate(divide="ignore"):
        assert np.isposinf(work.formula(same, same, 30.0, 26.6, 2.0))
    assert float(power.formula(same, same, 30.0, 26.6, 2.0)) == pytest.approx(600 * 26.6, rel=1e-12)
    box = [(590.0, 700.0), (600.0, 600.0), (30.0, 30.0), (26.6, 26.6), (2.0, 2.0)]
    assert float(power.bounds(box)[0]) == pytest.approx(600 * 26.6, rel=1e-12)
    assert float(work.bounds(box)[0]) == pytest.approx(float(work.formula(700.0, 600.0, 30.0, 26.6, 2.0)), rel=1e-12)
    assert np.isposinf(work.bounds(box)[1])
    # A load above every torque does not exist, so that the border is the worst that can be.
    box[1] = (600.0, 900.0)
    assert float(power.bounds(box)[1]) == pytest.approx(700 * 26.6, rel=1e-12)


def test_the_table_is_complete():
    names = {n.rsplit(".", 1)[1] for n in NAMES}
    assert names == {
        "sum_geometric",
        "sum_lipka",
        "sum_exact",
        "peak_rise_per_work",
        "row_share",
        "reactive_friction_work",
        "reactive_slip_time",
        "reactive_peak_slip_power",
        "grip_factor",
        "iron_field",
        "resistance_rise",
        "hot_copper_loss",
        "rim_section_width",
        "ramp_gain",
    }
    assert all(isinstance(TABLE[n], SpecialFunction) for n in NAMES)
    assert {n.rsplit(".", 1)[1] for n in NAMES if TABLE[n].curvature is None} == {
        "sum_exact",
        "reactive_peak_slip_power",
        "grip_factor",
    }
