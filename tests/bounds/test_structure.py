"""The classification of limits and objectives on small problems whose answer is known by hand."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy.special import erf
from synth.problems.mechanics.guide_friction import sum_geometric, sum_lipka
from synth.problems.mechanics.heat import peak_rise_per_work
from synth.problems.mechanics.startup import reactive_friction_work, reactive_peak_slip_power

import synth
from synth.bounds.composition import curvature_of
from synth.bounds.shapes import LONGEST
from synth.bounds.structure import classify
from synth.declaration import Declaration
from synth.model.program import OPERATIONS
from synth.operations.records import LOG_BELOW_ONE
from synth.question.catalogs import as_catalogs
from synth.question.ranges import declared_ranges
from synth.special import TABLE, special


def structure_of(build, low=None, high=None):
    """Classify a problem whose declaration is a function."""

    class Made(synth.DesignProblem):
        name, title = "made", "Made"

        def declare(self, d: Declaration) -> None:
            build(d)

    catalogs = as_catalogs(None)
    model = Made().model(frozenset(), catalogs)
    ranges = declared_ranges(model, catalogs)
    return classify(model, ranges[0] if low is None else low, ranges[1] if high is None else high)


def shape_of(formula, *limits):
    """Classify one formula of x, y, z in 0.5 .. 4 m, a choice and a count, under guards a > b."""

    def build(d):
        x, y, z = (d.variable(name, "-", 0.5, 4) for name in "xyz")
        n = d.count("n", 2, 8)
        kind = d.choice("kind", ("plain", "fancy", "other"))
        d.derive("value", "-", formula(x, y, z, n, kind))
        for k, limit in enumerate(limits):
            d.at_least(f"limit_{k}", *limit(x, y, z), "-", guard=True)

    return structure_of(build).quantities["value"]


AFFINE = [
    lambda x, y, z, n, kind: 3 * x * y / z,
    lambda x, y, z, n, kind: np.sqrt(x**3 / (2 * y)) * n**-1.5,
    lambda x, y, z, n, kind: (x * y) ** 2 / x,
    lambda x, y, z, n, kind: x + x / 3,
    lambda x, y, z, n, kind: 5 * x - 2 * x,
    lambda x, y, z, n, kind: np.abs(-x * y),
    lambda x, y, z, n, kind: np.maximum(x, -y),
    lambda x, y, z, n, kind: np.minimum(x / 10, y),
    lambda x, y, z, n, kind: np.where(x > 0.1, x * y, x + y),
    lambda x, y, z, n, kind: np.where(n < 2, x + y, x * y),
    lambda x, y, z, n, kind: x * kind.select({"plain": 1.0, "fancy": 1.5, "other": 0.2}),
    lambda x, y, z, n, kind: kind.select({"plain": x, "fancy": y, "other": x * z}),
    lambda x, y, z, n, kind: (x + y) * z / (x + y),
]
CONVEX = [
    lambda x, y, z, n, kind: x + y,
    lambda x, y, z, n, kind: x**2 / y + 3 * np.sqrt(z * n) + 1,
    lambda x, y, z, n, kind: np.maximum(x + y, z / n),
    lambda x, y, z, n, kind: (x + y) * np.maximum(x, y * z) ** 2 / z,
    lambda x, y, z, n, kind: np.exp(x + y),
    lambda x, y, z, n, kind: np.hypot(x, y * z),
    lambda x, y, z, n, kind: np.expm1(x),
    lambda x, y, z, n, kind: np.cosh(-x * y),
    lambda x, y, z, n, kind: kind.select({"plain": x + y, "fancy": y, "other": x * z}),
    lambda x, y, z, n, kind: 1 / -np.expm1(-x * y),
    lambda x, y, z, n, kind: 1 / np.minimum(x, y),
    lambda x, y, z, n, kind: 1 / sum_geometric(n, x + y),
    lambda x, y, z, n, kind: peak_rise_per_work(x + y, z, z, x),
    lambda x, y, z, n, kind: 1 / (9 * x - y),
    lambda x, y, z, n, kind: x * (1 + y) + x * z,
    lambda x, y, z, n, kind: -np.minimum(-x, -y * z),
]
CONCAVE = [
    lambda x, y, z, n, kind: np.minimum(x, y),
    lambda x, y, z, n, kind: 1 / (x + y),
    lambda x, y, z, n, kind: 10 - x - y,
    lambda x, y, z, n, kind: 40 * x - y * z,
    lambda x, y, z, n, kind: np.log1p(x * y),
    lambda x, y, z, n, kind: np.tanh(x),
    lambda x, y, z, n, kind: -np.expm1(-x * y),
    lambda x, y, z, n, kind: np.exp(-x - y),
    lambda x, y, z, n, kind: np.log(3 * x),
    lambda x, y, z, n, kind: np.sin(x / 4),
    lambda x, y, z, n, kind: np.cos(x * y / 20),
    lambda x, y, z, n, kind: sum_lipka(n, x + y),
    lambda x, y, z, n, kind: (9 * x + y) * (9 * x - y),
    lambda x, y, z, n, kind: (9 * x + y) * (9 * x - y) ** 2 / z,
    lambda x, y, z, n, kind: -np.maximum(-x, -y),
    lambda x, y, z, n, kind: (-np.minimum(x, y)) ** 3 * -z,
]
UNKNOWN = [
    lambda x, y, z, n, kind: (x + y) / (x + z),
    lambda x, y, z, n, kind: x + np.minimum(y, z),
    lambda x, y, z, n, kind: (9 * x + y) ** 2 * (9 * x - y),
    lambda x, y, z, n, kind: np.maximum(x, 10 - x - y),
    lambda x, y, z, n, kind: np.where(x < y, x * y, z),
    lambda x, y, z, n, kind: kind.select({"plain": x + y, "fancy": 10 - y, "other": x}),
    lambda x, y, z, n, kind: np.log1p(x + y),
    lambda x, y, z, n, kind: np.floor(2 * x),
    lambda x, y, z, n, kind: 2 + np.sin(x * y),
    lambda x, y, z, n, kind: x**y,
]


@pytest.mark.parametrize("formula", AFFINE)
def test_log_affine(formula):
    assert shape_of(formula).curvature == "log-affine"


@pytest.mark.parametrize("formula", CONVEX)
def test_log_convex(formula):
    assert shape_of(formula).curvature == "log-convex"


@pytest.mark.parametrize("formula", CONCAVE)
def test_log_concave(formula):
    assert shape_of(formula).curvature == "log-concave"


@pytest.mark.parametrize("formula", UNKNOWN)
def test_curvature_that_does_not_follow_from_the_rules(formula):
    shape = shape_of(formula)
    assert (shape.sign, shape.curvature) == (1, "unknown")


@pytest.mark.parametrize(
    "formula",
    [
        lambda x, y, z, n, kind: x - y,
        lambda x, y, z, n, kind: np.log(x),
        lambda x, y, z, n, kind: np.sin(2 * x),
        lambda x, y, z, n, kind: np.minimum(x - 0.5, 1),
        lambda x, y, z, n, kind: (x < y) * 1.0,
        lambda x, y, z, n, kind: ca.if_else(x < y, x, 0),
        lambda x, y, z, n, kind: (x - y) ** 2,
        lambda x, y, z, n, kind: reactive_friction_work(x, y - 1, 1, 1, z),
        lambda x, y, z, n, kind: np.sqrt(x - 0.6),
        lambda x, y, z, n, kind: (-x) ** 1.5,
    ],
)
def test_a_sign_that_is_not_sure(formula):
    shape = shape_of(formula)
    assert (shape.sign, shape.curvature, shape.text) == (0, "unknown", "not surely positive")
    assert set(map(tuple, shape.elasticity.tolist())) == {(0.0, 0.0), (-np.inf, np.inf)}


def elasticities(formula, *limits):
    found = shape_of(formula, *limits)
    assert found.sign
    return [tuple(row) for row in found.elasticity[:3]]


def test_elasticities_of_products_and_sums():
    assert elasticities(lambda x, y, z, n, kind: x**2 / y) == [(2, 2), (-1, -1), (0, 0)]
    # x/(x + y) lies in 0.5/4.5 .. 4/4.5
    share = pytest.approx((1 / 9, 8 / 9))
    assert elasticities(lambda x, y, z, n, kind: x + y)[:2] == [share, share]
    assert elasticities(lambda x, y, z, n, kind: z**2 * x + z**2 * y) == [share, share, pytest.approx((2, 2))]
    assert elasticities(lambda x, y, z, n, kind: (x + y) * z / (y + x)) == [(0, 0), (0, 0), (1, 1)]
    # x**2 in x**2 + x has a share of 1/3 .. 4/5
    assert elasticities(lambda x, y, z, n, kind: x**2 + x)[0] == pytest.approx((4 / 3, 9 / 5))


def test_elasticities_of_differences():
    # 10 x/(10 x - y) lies in 40/39.5 .. 5/1
    found = elasticities(lambda x, y, z, n, kind: 10 * x - y)
    assert found[0] == pytest.approx((40 / 39.5, 5))
    assert found[1] == pytest.approx((-4, -0.5 / 39.5))
    # ... without end where only a guard says that it is positive
    found = elasticities(lambda x, y, z, n, kind: x - y, lambda x, y, z: (x, y))
    assert found == [(pytest.approx(8 / 7), np.inf), (-np.inf, pytest.approx(-1 / 7)), (0, 0)]
    # what both terms share does not count twice, and does not hide the sign
    assert elasticities(lambda x, y, z, n, kind: 10 * x * z - y * z)[2] == pytest.approx((1, 1))
    # (a + b)(a - b) falls with b, though a + b rises
    found = elasticities(lambda x, y, z, n, kind: (10 * x + y) * (10 * x - y))
    assert found[0][0] >= 2 - 1e-12
    assert found[1][1] <= 0


def test_elasticities_of_functions():
    def functions(x, y, z, n, kind):
        return np.exp(x) * np.log1p(y) * np.exp(-z / 2)

    found = elasticities(functions)
    assert found[0] == pytest.approx((0.5, 4))
    assert found[1] == pytest.approx((4 / (5 * np.log(5)), 0.5 / (1.5 * np.log(1.5))))
    assert found[2] == pytest.approx((-2, -0.25))
    assert elasticities(lambda x, y, z, n, kind: np.floor(2 * x))[0] == (0, np.inf)
    assert elasticities(lambda x, y, z, n, kind: np.minimum(x * z, y))[0] == (0, 1)
    assert elasticities(lambda x, y, z, n, kind: sum_lipka(x, y / z)) == [(0, 1), (-1, 0), (0, 1)]
    assert elasticities(lambda x, y, z, n, kind: 2 + np.sin(x * y)) == [(-np.inf, np.inf)] * 2 + [(0, 0)]


def test_a_condition_on_inputs_jumps_with_these_alone():
    found = elasticities(lambda x, y, z, n, kind: np.where(x < 2, y * x, y * z**2))
    assert found == [(-np.inf, np.inf), (1, 1), (0, 2)]
    shape = shape_of(lambda x, y, z, n, kind: x * kind.select({"plain": 1.0, "fancy": 1.5, "other": 0.2}))
    assert shape.elasticity[4].tolist() == [-np.inf, np.inf]  # a choice has no order
    assert shape.text == "log-affine"


def test_functions_that_do_not_exist_everywhere_need_a_convex_set_to_be_convex():
    def work(torque):
        return lambda x, y, z, n, kind: reactive_friction_work(torque(x, y), z, n, 20.0, 2.0)

    for torque, curvature in (
        (lambda x, y: 9 * x, "log-convex"),
        (lambda x, y: 90 / (x + y), "log-convex"),
        (lambda x, y: 9 * x + 9 * y, "unknown"),
    ):
        shape = shape_of(work(torque), lambda x, y, z, torque=torque: (torque(x, y), z))
        assert (shape.sign, shape.nonzero, shape.curvature) == (1, True, curvature)

    @special((1.0, 1.0), (-1.0, -1.0), curvature="log-convex", above=(0, 1))
    def ratio(a, b):
        return a / b

    TABLE.pop(next(name for name in TABLE if name.endswith("ratio")))
    for torque, curvature in ((lambda x, y: 9 * x, "log-convex"), (lambda x, y: 9 * x + 9 * y, "unknown")):
        assert shape_of(lambda x, y, z, n, kind, torque=torque: ratio(torque(x, y), z)).curvature == curvature
    power = shape_of(lambda x, y, z, n, kind: reactive_peak_slip_power(9 * x, z, n, 20.0, 2.0))
    assert (power.curvature, power.text) == ("unknown", "monotone: rises with x, z, n")


# -- what limits tell ----------------------------------------------------------------------------------


def ring(d):
    outer = d.variable("outer", "mm", 40, 800)
    inner = d.variable("inner", "mm", 20, 700)
    d.derive("width", "mm", outer - inner)
    d.derive("ratio", "-", (outer - inner) / (outer + inner))
    d.objective("width", "max")
    d.objective("ratio", "min")
    return outer, inner


def test_a_difference_that_limits_keep_positive_counts_as_positive():
    def build(d):
        outer, inner = ring(d)
        d.at_least("ratio_min", (outer - inner) / (outer + inner), 0.1, "-")
        d.at_most("ratio_max", (outer - inner) / (outer + inner), 0.25, "-")

    found = structure_of(build)
    assert found.inputs == ("outer", "inner")
    assert {name: shape.text for name, shape in found.limits.items()} == {
        "ratio_min": "log-convex",
        "ratio_max": "log-concave",
    }
    assert {name: shape.text for name, shape in found.objectives.items()} == {
        "width": "log-convex",  # a max, so what must be small is the negative
        "ratio": "log-concave",
    }
    assert found.quantities["width"].text == "log-concave"
    # The ranges are not those that limits leave: the width may be nearly nothing beside the diameters.
    assert found.quantities["width"].elasticity[0, 1] == np.inf
    assert structure_of(ring).quantities["width"].text == "not surely positive"


@pytest.mark.parametrize(
    ("limit", "text"),
    [
        (lambda d, outer, inner, part: d.at_least("gap", outer, inner, "mm", guard=True), "log-concave"),
        (lambda d, outer, inner, part: d.at_most("gap", inner, outer, "mm", guard=True), "log-concave"),
        # Within the tolerance the diameters may be equal.
        (lambda d, outer, inner, part: d.at_least("gap", outer, inner, "mm"), "not surely positive"),
        (lambda d, outer, inner, part: d.at_least("gap", outer - inner, 1e-3, "mm"), "log-concave"),
        (lambda d, outer, inner, part: d.at_least("gap", outer - inner, 1e-3, "mm", scale=1e7), "not surely positive"),
        (lambda d, outer, inner, part: d.equal("gap", outer - inner, 1e-3, "mm"), "log-concave"),
        (lambda d, outer, inner, part: d.at_least("gap", outer - inner, part.thickness, "mm"), "log-concave"),
        # A row without the value is under no limit.
        (
            lambda d, outer, inner, part: d.at_least("gap", outer - inner, part.optional("thickness"), "mm"),
            "not surely positive",
        ),
    ],
)
def test_what_kind_of_limit_makes_a_difference_positive(limit, text):
    def build(d):
        outer, inner = ring(d)
        limit(d, outer, inner, d.part("plate", "core_plates"))

    assert structure_of(build).quantities["width"].text == text


def test_limits_that_exclude_everything_tell_nothing():
    def build(d):
        outer, inner = ring(d)
        d.at_least("wide", outer - inner, 1.0, "m")
        d.at_least("narrow", inner - outer, 1.0, "m")

    assert structure_of(build).quantities["width"].text == "not surely positive"


# -- words ---------------------------------------------------------------------------------------------


def test_limits_are_judged_by_their_quotient():
    def build(d):
        x, y = d.variable("x", "-", 0.5, 4), d.variable("y", "-", 0.5, 4)
        load = d.requirement("load", "N", lower=1)
        slack = d.requirement("slack", "N", lower=0, upper=5)
        odd = d.requirement("odd", "N", upper=5)
        d.at_most("convex", x + y, load, "-")
        d.at_least("reversed", load, x + y, "-")
        d.at_most("concave", x, x + y, "-")
        d.at_most("cancels", (x + y) * x, (x + y) * load, "-")
        d.equal("sum", x + y, load, "-")
        d.equal("product", x * y, load, "-")
        d.equal("difference", x, y - x, "-")
        d.at_most("zero", slack * x, load, "-")
        d.at_most("zero_difference", 9 * slack * x - slack * y, load, "-")
        d.at_most("allowed_zero", load, slack, "-")
        d.at_most("special_zero", sum_lipka(slack, y), load, "-")
        d.at_most("special_no_zero", sum_lipka(x, slack), load, "-")
        d.at_most("function_zero", np.log1p(slack), load, "-")
        d.at_most("logarithm_zero", np.log(load), load, "-")
        d.at_most("cosine_zero", np.cos(slack * np.pi / 10), load, "-")
        d.at_most("no_zero", np.exp(slack) * np.cosh(slack) * np.cos(slack / 4), load, "-")
        d.at_most("signless", odd * x, load, "-")
        d.at_most("not_a_limit", x + y, load / (x + y + load), "-")

    texts = {name: shape.text for name, shape in structure_of(build).limits.items()}
    assert texts == {
        "convex": "log-convex",
        "reversed": "log-convex",
        "concave": "log-concave",
        "cancels": "log-affine",
        "sum": "equality",
        "product": "equality, log-affine",
        "difference": "equality",
        "zero": "log-affine, can be 0",
        "zero_difference": "log-concave, can be 0",
        "allowed_zero": "log-affine, can be 0",
        "special_zero": "log-concave, can be 0",
        "special_no_zero": "log-concave",
        "function_zero": "log-concave, can be 0",
        "logarithm_zero": "log-concave, can be 0",
        "cosine_zero": "log-concave, can be 0",
        "no_zero": "monotone in all but slack",
        "signless": "not surely positive",
        "not_a_limit": "log-convex",
    }


def test_a_column_that_no_row_has_says_nothing():
    def build(d):
        x = d.variable("x", "-", 0.5, 4)
        d.at_most("known", x, d.requirement("load", "-", lower=1), "-")
        d.at_most("missing", x, d.part("plate", "core_plates").optional("thickness"), "-")

    texts = structure_of(build, np.array([0.5, 1, np.nan]), np.array([4, np.inf, np.nan])).limits
    assert texts["known"].text == "log-affine"
    assert texts["missing"].text == "not surely positive"


def wordy(count, formula, choose=lambda names: names):
    def build(d):
        inputs = [d.variable(name, "-", 1, 2) for name in choose([f"quantity_{k}" for k in range(count)])]
        fixed = d.row("cooling_options", "fan").heat_transfer
        d.derive("value", "-", formula(inputs) * fixed / fixed + 0 * fixed)

    return structure_of(build).quantities["value"].text


def test_texts_name_the_inputs_there_is_room_for():
    def ratio(q):
        return (q[0] + q[1]) / (q[2] + 1)

    assert wordy(3, ratio) == "monotone: rises with quantity_0, quantity_1, falls with quantity_2"
    assert wordy(2, lambda q: (q[0] + 1) / (q[0] + q[1])) == "monotone in all but quantity_0"
    assert wordy(3, lambda q: q[2] * (2 + np.sin(q[0] + q[1]))) == "monotone in all but quantity_0, quantity_1"
    assert wordy(2, lambda q: 2 + np.sin(q[0] + q[1])) == "unknown"
    many = wordy(9, lambda q: sum(q[:5]) / (q[5] + q[6] + q[7] + q[8]))
    assert (
        many == "monotone: rises with quantity_0, quantity_1 and 3 more, falls with quantity_5, quantity_6 and 2 more"
    )
    long = wordy(6, lambda q: sum(q) / (9 + q[4] + q[5]), lambda names: [f"{'long_' * 8}{n}" for n in names])
    assert long == "monotone in 4 inputs, unknown in 2 inputs"
    for text in (many, long):
        assert len(text) <= LONGEST


# -- functions of one argument -------------------------------------------------------------------------


def size_of(op, y, mirrored):
    """Logarithm of the size of a function, as the bounds compute it."""
    scope = {"np": np, "erf": erf, "a": -y if mirrored else y}
    return np.log(np.abs(eval(OPERATIONS[op].numeric.format("a"), scope)))


TABLES = [(op, known.elasticity, False) for op, known in OPERATIONS.items() if known.elasticity]
TABLES += [(op, known.mirrored, True) for op, known in OPERATIONS.items() if known.mirrored]
TABLES += [(ca.OP_LOG, LOG_BELOW_ONE, False)]


@cache
def inside(outer):
    low, high = outer.domain
    high = min(high, 20.0)
    return low + (high - low) * np.linspace(0.002, 0.998, 1500)


@pytest.mark.parametrize(("op", "outer", "mirrored"), TABLES)
def test_functions_of_one_argument(op, outer, mirrored):
    y, step = inside(outer), 1e-6
    slope = (size_of(op, y * np.exp(step), mirrored) - size_of(op, y * np.exp(-step), mirrored)) / (2 * step)
    with np.errstate(over="ignore"):
        claimed = outer.at(y)
    np.testing.assert_allclose(claimed, slope, rtol=1e-5, atol=1e-7)
    # Rising elasticity is log-convex, falling log-concave.
    changes = np.diff(claimed)
    assert np.all(changes >= -1e-9) if curvature_of(outer).convex else np.all(changes <= 1e-9)
    assert curvature_of(outer).convex != curvature_of(outer).concave
    least, most = min(outer.first, outer.last), max(outer.first, outer.last)
    assert np.all((claimed >= least - 1e-9) & (claimed <= most + 1e-9))
    values = eval(OPERATIONS[op].numeric.format("a"), {"np": np, "erf": erf, "a": -y if mirrored else y})
    assert np.all(np.sign(values) == outer.sign)
    for first, last in ((0, -1), (100, 700), (900, 901)):
        ends = outer.ends((y[first], y[last]))
        assert ends == pytest.approx((claimed[first : last + 1 or None].min(), claimed[first : last + 1 or None].max()))
    assert outer.ends(outer.domain) == (least, most)


@pytest.mark.parametrize("op", [ca.OP_SIN, ca.OP_TAN, ca.OP_COS, ca.OP_ATAN])
def test_a_range_that_is_the_lower_end_of_the_domain_has_the_elasticity_there(op):
    outer = OPERATIONS[op].elasticity
    assert outer.ends((0.0, 0.0)) == (outer.first, outer.first)
    low, high = outer.ends((0.0, 0.2))
    assert low <= outer.first <= high
    assert np.isfinite([low, high]).all()
