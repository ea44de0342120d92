"""Formulas and numbers that a declaration cannot have: told at once, with quantity, line and what to use instead."""

import math
import operator
import pickle
import re
import statistics

import casadi as ca
import numpy as np
import pytest
import scipy.integrate
import scipy.interpolate
import scipy.special

import synth
from synth.declaration import Block, Declaration, DeclarationError, Requirement, Variable
from synth.declaration.faults import INSTEAD
from synth.special import special
from synth.tables.catalogs import Catalogs
from tests.declaration.test_declaration import CATALOGS, declaration, problem

HERE = re.escape("test_faults.py")


def traced(formula):
    """Trace a problem whose derived quantity is a formula of two variables and a count."""

    def declare(d):
        x, y = d.variable("x", "mm", 1, 2), d.variable("y", "mm", 1, 2)
        d.derive("made", "-", formula(x, y))
        d.objective("made")

    return problem(declare)().model(frozenset(), CATALOGS)


def fault(formula):
    with pytest.raises(DeclarationError) as caught:
        traced(formula)
    return str(caught.value)


# -- formulas --------------------------------------------------------------------------------------

ONE = "acos acosh asin asinh atan atanh cbrt cos cosh degrees erf erfc exp exp2 expm1 fabs gamma isfinite isinf isnan"
ONE += " lgamma log log10 log1p log2 modf radians sin sinh sqrt tan tanh frexp ulp"
TWO = "atan2 copysign fmod hypot isclose pow remainder nextafter log"


@pytest.mark.parametrize("name", ONE.split())
def test_no_function_of_math_takes_a_symbol_in_silence(name):
    said = fault(lambda x, y: getattr(math, name)(2 * x))
    assert re.match(r"sample: .* asks for the value of x, which is not known in a declaration; use ", said)
    assert re.search(rf"\({HERE}, line \d+: said = fault\(lambda", said)


@pytest.mark.parametrize("name", TWO.split())
def test_nor_one_of_two_arguments(name):
    assert "asks for the value of" in fault(lambda x, y: getattr(math, name)(x, y))


@pytest.mark.parametrize(
    "name",
    "acos acosh asin asinh atan atanh cbrt cos cosh exp exp2 expm1 fabs log log10 log1p sin sqrt tan tanh".split(),
)
def test_what_is_named_instead_takes_a_symbol_and_gives_the_same_number(name):
    x = ca.SX.sym("x")
    instead = getattr(np, INSTEAD[name].removeprefix("np."))
    at = 1.5 if name == "acosh" else 0.4
    assert float(ca.Function("f", [x], [instead(x)])(at)) == pytest.approx(getattr(math, name)(at), rel=1e-14)


@pytest.mark.parametrize(
    ("formula", "names", "instead"),
    [
        (lambda x, y: math.sin(x), "x", "np.sin"),
        (lambda x, y: math.atan2(x, y), "x", "np.arctan2"),
        (lambda x, y: math.pow(y, 2), "y", r"the operator \*\*"),
        (lambda x, y: max(0.0, math.sqrt(y)), "y", "np.sqrt"),
        (lambda x, y: max(x, y), "x, y", "np.maximum"),
        (lambda x, y: min([x, 0.001]), "x", "np.minimum"),
        (lambda x, y: np.max([x, y]), "[xy], [xy]", "np.maximum"),
        (lambda x, y: sorted([x, y])[0], "[xy], [xy]", "np.minimum and np.maximum"),
        (lambda x, y: x if x > 0.001 else y, "x", r"np.where\(condition, a, b\)"),
        (lambda x, y: x > 0.001 and y, "x", "np.logical_and"),
        (lambda x, y: x > 0.001 or y, "x", "np.logical_or"),
        (lambda x, y: not x > 0.001, "x", "np.logical_not"),
        (lambda x, y: 0.001 < y < 0.002, "y", r"np.logical_and\(a < x, x < b\)"),
        (lambda x, y: y in [0.001, x], "[xy](, [xy])?", "np.logical_or"),
        (lambda x, y: any([x > 0.001]), "x", "np.logical_or"),
        (lambda x, y: float(x), "x", "the expression as it is"),
        (lambda x, y: int(1000 * x), "x", "np.floor, or d.count"),
        (lambda x, y: bool(x), "x", "NumPy functions"),
        (lambda x, y: complex(x), "x", "the expression"),
        (lambda x, y: np.float64(x), "x", "the expression"),
        (lambda x, y: np.asarray([x, y], dtype=float)[0], "x, y", "the expression"),
        (lambda x, y: f"{x:.3f}", "x", "NumPy functions"),
        (lambda x, y: "%f" % x, "x", "NumPy functions"),  # noqa: UP031
        (lambda x, y: x & y, "x, y", "NumPy functions"),
        (lambda x, y: [1.0, 2.0][x], "x", "NumPy functions"),
        (lambda x, y: operator.truth(x > 1), "x", "NumPy functions"),
        (lambda x, y: statistics.mean([x, y]), "x, y", "NumPy functions"),
        (lambda x, y: np.linalg.solve([[x, 1], [1, y]], [1, 2])[0], "x, y", "casadi.solve"),
        (lambda x, y: np.linalg.det([[x, 1], [1, y]]), "x, y", "casadi.det"),
        (lambda x, y: np.polyval([1, 2, 3], x), "x", "powers"),
        (lambda x, y: np.piecewise(x, [x > 1], [1, 2]), "x", "np.where"),
        (lambda x, y: np.isnan(x), "x", "a guard"),
        (lambda x, y: np.vectorize(math.sin)(x), "x", "NumPy functions"),
        (lambda x, y: scipy.special.erf(x), "x", "casadi.erf"),
        (lambda x, y: scipy.special.jv(0, x), "x", "NumPy functions"),
        (lambda x, y: scipy.interpolate.interp1d([0, 1], [1, 2])(x), "x", "np.interp"),
        (lambda x, y: scipy.integrate.quad(lambda t: t * x, 0, 1)[0], "x", "a sum"),
    ],
)
def test_what_cannot_take_symbols_is_told_with_quantity_line_and_what_to_use(formula, names, instead):
    said = fault(formula)
    assert re.search(rf"(asks for the value of|does not take) {names}\b", said)
    assert re.search(rf"; use (.* )?{instead}", said)
    line = formula.__code__.co_firstlineno
    assert re.search(rf"\({HERE}, line {line}: \(lambda x, y: ", said)


def test_what_is_named_instead_of_linear_algebra_works():
    def declare(d):
        x = d.variable("x", "-", 2, 3)
        matrix, right = ca.SX(np.array([[x, 1], [1, 2 * x]])), ca.SX([1, 2])
        d.derive("first", "-", ca.solve(matrix, right)[0])
        d.derive("size", "-", ca.det(matrix) * ca.inv(matrix)[0, 0])
        d.derive("normal", "-", ca.erf(x))
        d.objective("first")

    found = synth.evaluate(problem(declare), {}, values={"x": 2})
    assert found.values["first"] == pytest.approx(np.linalg.solve([[2, 1], [1, 4]], [1, 2])[0])
    assert found.values["size"] == pytest.approx(4)
    assert found.values["normal"] == pytest.approx(math.erf(2))


@pytest.mark.parametrize(
    ("formula", "number"),
    [
        (lambda x, y: x * float("nan"), "nan"),
        (lambda x, y: x + math.inf, "inf"),
        (lambda x, y: np.where(x > 0.001, x, -np.inf), "-inf"),
        (lambda x, y: x / 0.0, "inf"),
        (lambda x, y: x + 1 / (y - y), "inf"),
        (lambda x, y: ca.log(ca.SX(-1)) + x, "nan"),
        (lambda x, y: float("nan"), "nan"),
        (lambda x, y: 1e400 * x, "inf"),
    ],
)
def test_a_formula_holds_finite_numbers_alone(formula, number):
    said = fault(formula)
    assert said.startswith(
        f"sample: derived made holds {number}; formulas take finite numbers alone ({'test_faults.py'}"
    )
    assert 'd.derive("made", "-", formula(x, y))' in said


def test_the_quantity_that_brings_it_is_named_and_none_that_uses_it():
    def declare(d):
        x = d.variable("x", "mm", 1, 2)
        first = d.derive("first", "mm", x * math.nan)
        d.at_most("room", d.derive("second", "mm", first + x), 1, "mm")
        d.objective("second")

    with pytest.raises(DeclarationError, match=r"derived first holds nan.* d.derive\(\"first\""):
        problem(declare)().model(frozenset(), CATALOGS)


def test_such_a_number_is_found_wherever_a_formula_stands():
    nan = float("nan")

    def with_one(declared):
        def declare(d):
            x = d.variable("x", "mm", 1, 2)
            declared(d, x)
            d.objective("x")

        with pytest.raises(DeclarationError) as caught:
            problem(declare)().model(frozenset(), CATALOGS)
        return str(caught.value).partition(":")[2].partition(" holds")[0].strip()

    assert with_one(lambda d, x: d.at_most("room", x, nan, "mm")) == "limit room"
    assert with_one(lambda d, x: d.at_most("room", x, math.inf, "mm")) == "limit room"
    assert with_one(lambda d, x: d.at_least("room", nan * x, 1, "mm", guard=True)) == "limit room"
    assert with_one(lambda d, x: d.step("on_the_way", "mm", nan * x)) == "step on_the_way"
    assert with_one(lambda d, x: d.advise("hint", x > nan, "told")) == "advice hint"
    assert with_one(lambda d, x: d.refuse("hint", d.requirement("r", "-", 1) > nan, "told")) == "refusal hint"
    assert with_one(lambda d, x: d.next_row("rod", nan * x, "rods", "diameter")) == "next row rod"
    given = "the default of requirement r2"
    assert with_one(lambda d, x: d.requirement("r2", "-", nan * d.requirement("r", "-", 1))) == given


@special((0.0, 1.0))
def bent(load):
    """Return a formula that Python's functions are in."""
    return load / math.sqrt(1 + load)


@special((0.0, 1.0))
def void(load):
    """Return a formula that holds a number that is none."""
    return np.where(load > 0, load, math.nan)


def test_special_functions_are_read_too():
    assert "use np.sqrt" in fault(lambda x, y: bent(x))
    assert "special function tests.declaration.test_faults.void holds nan" in fault(lambda x, y: void(x))


@pytest.mark.parametrize(
    "made",
    [None, "a text", [], [1.0, 2.0], np.zeros(2), np.array([[1.0, 2.0]]), {"a": 1}, object()],
    ids=lambda made: type(made).__name__ + str(np.shape(made) if isinstance(made, np.ndarray | list) else ""),
)
def test_a_quantity_is_one_number_or_expression(made):
    said = fault(lambda x, y: made)
    assert re.match(r"sample: derived made is .*; it must be a number or an expression of quantities \(", said)


def test_arrays_of_expressions_are_refused_with_their_shape():
    assert "derived made is SX of shape (2, 1)" in fault(lambda x, y: x * np.array([1.0, 2.0]))
    assert "derived made is ndarray of shape (2, 1)" in fault(lambda x, y: np.array([x, y]))


def test_arrays_of_one_and_sums_of_arrays_are_formulas():
    model = traced(
        lambda x, y: np.sum(np.array([x, y]) ** 2) + np.array([x])[0] + sum([x, y]) + np.interp(x, [0, 1], [2, 3])
    )
    assert "made" in model.quantity_node


def test_any_error_in_a_declaration_tells_its_line():
    assert re.search(rf"sample: ZeroDivisionError: .*\({HERE}, line \d+: ", fault(lambda x, y: x / (1 - 1) + 1 / 0))
    assert "sample: NameError: name 'unheard_of' is not defined" in fault(lambda x, y: unheard_of)  # noqa: F821
    assert "does not take x, a symbol without a value ('SX' object has no attribute 'mean')" in fault(
        lambda x, y: x.mean()
    )


def test_faults_of_verbs_tell_their_line():
    def declare(d):
        d.variable("side", "mm", 1, math.inf)

    with pytest.raises(DeclarationError, match="upper end of variable side is inf") as caught:
        synth.describe(problem(declare))
    assert re.search(rf"\({HERE}, line \d+: d.variable\(", str(caught.value))
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)


@pytest.mark.parametrize("unit", ["kV", "lx", "", "mm^", None, 3])
@pytest.mark.parametrize(
    "what",
    [
        lambda d, unit: d.requirement("load", unit),
        lambda d, unit: d.variable("load", unit, 1, 2),
        lambda d, unit: d.derive("load", unit, d.sx_side),
        lambda d, unit: d.step("load", unit, d.sx_side),
        lambda d, unit: d.constant("load", unit, 1.0),
        lambda d, unit: d.at_most("load", d.sx_side, 1, unit),
    ],
)
def test_a_unit_that_is_none_is_told_with_quantity_and_line(what, unit):
    def declare(d):
        d.sx_side = d.variable("side", "mm", 1, 2)
        what(d, unit)

    with pytest.raises(DeclarationError, match=r"sample: \w+ load has unit: ") as caught:
        synth.describe(problem(declare))
    assert re.search(rf"\({HERE}, line \d+: ", str(caught.value))


def test_what_users_type_is_no_fault_of_the_family():
    def declare(d):
        d.option("shape", ("round",), "round")

    with pytest.raises(synth.InputError, match="option shape"):
        problem(declare)(shape="oval").model(frozenset(), CATALOGS)


def test_symbols_outside_of_a_declaration_are_left_alone():
    x = ca.SX.sym("x")
    assert math.isnan(float(x))
    assert float(ca.SX(2.0)) == 2.0
    assert bool(ca.SX(1) > 0)


def test_conditions_that_are_decided_already_may_be_asked():
    model = traced(lambda x, y: x if ca.SX(2) > 1 else y)
    assert model.quantity_node["made"] == model.quantity_node["x"]


# -- numbers ---------------------------------------------------------------------------------------

BAD = [math.nan, math.inf, -math.inf, 10**400, True, "5", None, [1.0], ca.SX.sym("x"), np.array([1.0, 2.0]), 1j]
NUMBERS = {
    "the lower end of variable q": lambda d, bad: d.variable("q", "mm", bad, 2),
    "the upper end of variable q": lambda d, bad: d.variable("q", "mm", 1, bad),
    "the lower end of count q": lambda d, bad: d.count("q", bad, 2),
    "the upper end of count q": lambda d, bad: d.count("q", 1, bad),
    "the step of count q": lambda d, bad: d.count("q", 1, 2, bad),
    "constant q": lambda d, bad: d.constant("q", "mm", bad),
}


@pytest.mark.parametrize("bad", BAD, ids=lambda x: str(x)[:12])
@pytest.mark.parametrize("what", NUMBERS)
def test_numbers_of_a_declaration_are_finite_numbers(what, bad):
    with pytest.raises(DeclarationError, match=f"sample: {what} is .*; it must be a finite number"):
        NUMBERS[what](declaration(), bad)


OPTIONAL = {
    "the ceiling of q": lambda d, bad: d.derive("q", "mm", 1.0, ceiling=bad),
    "the scale of limit q": lambda d, bad: d.at_most("q", 1.0, 2.0, "mm", scale=bad),
    "the resolution of objective q": lambda d, bad: d.objective("q", resolution=bad),
}


@pytest.mark.parametrize("bad", [x for x in BAD if x is not None], ids=lambda x: str(x)[:12])
@pytest.mark.parametrize("what", OPTIONAL)
def test_so_are_those_that_may_be_left_out(what, bad):
    with pytest.raises(DeclarationError, match=f"sample: {what} is .*; it must be a finite number"):
        OPTIONAL[what](declaration(), bad)


def test_a_scale_is_above_zero():
    for scale in (0, -1):
        with pytest.raises(DeclarationError, match=r"limit room has scale .*; it must be above 0"):
            declaration().at_most("room", 1.0, 2.0, "mm", scale=scale)


def test_a_bound_that_depends_on_quantities_is_a_limit():
    def declare(d):
        d.variable("side", "mm", 1, 2 * d.requirement("load", "N", 1))

    with pytest.raises(DeclarationError, match="what depends on quantities is a limit"):
        problem(declare)().model(frozenset(), CATALOGS)


def test_a_number_that_is_none_in_si_is_none():
    with pytest.raises(DeclarationError, match="the upper end of variable q is 1e\\+308"):
        declaration().variable("q", "km", 1, 1e308)


@pytest.mark.parametrize(
    "default", [math.nan, math.inf, -math.inf, 10**400, True, "20 N", [1.0, 2.0], np.zeros(2)], ids=str
)
def test_the_default_of_a_requirement_is_a_number_or_an_expression(default):
    with pytest.raises(DeclarationError, match="sample: the default of requirement q is"):
        declaration().requirement("q", "mm", default)


def test_whole_numbers_of_numpy_are_numbers_in_the_unit():
    d = declaration()
    d.requirement("q", "mm", np.int64(5), lower=np.float32(1), upper=np.int8(9))
    assert (d.requirements["q"].default, d.requirements["q"].upper) == (0.005, 0.009)
    d.variable("x", "mm", np.int64(1), np.int32(4), grid=np.int16(1))
    assert d.variables["x"].grid.tolist() == [0.001, 0.002, 0.003, 0.004]


@pytest.mark.parametrize(
    ("lower", "upper"),
    [(2, 1), (math.inf, None), (None, -math.inf), (math.inf, math.inf), (math.nan, 1), (1, math.nan)],
)
def test_a_requirement_has_a_range(lower, upper):
    with pytest.raises(DeclarationError, match="requirement q"):
        declaration().requirement("q", "mm", lower=lower, upper=upper)


def test_the_range_of_a_requirement_may_be_open_or_one_value():
    d = declaration()
    d.requirement("open", "mm", lower=-math.inf, upper=math.inf)
    d.requirement("one", "mm", lower=2, upper=2)
    assert (d.requirements["open"].lower, d.requirements["open"].upper) == (-math.inf, math.inf)
    assert d.requirements["one"].lower == d.requirements["one"].upper == 0.002


@pytest.mark.parametrize(
    "grid", [math.nan, math.inf, True, [1.0, math.nan], [1.0, math.inf], np.array([math.nan])], ids=str
)
def test_a_grid_holds_finite_numbers(grid):
    with pytest.raises(DeclarationError, match=r"sample: variable q: .*grid.* finite"):
        declaration().variable("q", "mm", 1, 2, grid=grid)


@pytest.mark.parametrize("value", [math.nan, math.inf, "1", None], ids=str)
def test_what_fills_a_column_is_a_number(value):
    with pytest.raises(DeclarationError, match=r"slot rod: .* fills column diameter; it must be a finite number"):
        declaration().part("rod", "rods").filled("diameter", value)


class Fields(Block):
    """A block with a default that holds a number that is none, and a bound that is none."""

    load = Requirement("N", 1.0)
    peak = Requirement("N", lambda block: block.load * math.nan)


class Endless(Block):
    """A block with a variable without end."""

    side = Variable("mm", 1, math.inf)


def test_blocks_are_declared_by_the_same_verbs():
    with pytest.raises(DeclarationError, match="variable side"):
        declaration().block(Endless)

    def declare(d):
        d.block(Fields)
        d.variable("x", "mm", 1, 2)
        d.objective("x")

    with pytest.raises(DeclarationError, match=rf"default of requirement peak holds nan.*\({HERE}, line \d+: d.block"):
        problem(declare)().model(frozenset(), CATALOGS)


# -- equal ends ------------------------------------------------------------------------------------


def plate(x, y, grid=None):
    def declare(d):
        load = d.requirement("load", "N", 1000, lower=1, upper=1e6)
        width, height = d.variable("width", "mm", *x, grid=grid), d.variable("height", "mm", *y)
        d.at_most("stress", load / (width * height), 100e6, "N/mm2")
        d.derive("area", "mm2", width * height)
        d.derive("slim", "-", height / width)
        d.objective("area")
        d.objective("slim")

    return problem(declare)


@pytest.mark.slow
@pytest.mark.parametrize("grid", [None, 1, "R10", [5.0, 6.0]], ids=str)
@pytest.mark.parametrize("other", [(1, 20), (5, 5)], ids=str)
def test_equal_ends_of_a_variable_are_a_constant(grid, other, tmp_path):
    kind = plate((5, 5), other, grid)
    front = synth.synthesize(kind, {})
    assert front.certificate.kind == "global"
    assert front.designs
    assert {d.values["width"] for d in front.designs} == {0.005}
    fixed = synth.synthesize(plate((1, 10), other), {}, fix={"width": "5 mm"})
    rows = [[d.values["area"] for d in found.designs] for found in (front, fixed)]
    assert rows[0] == pytest.approx(rows[1], rel=1e-6)
    loaded = synth.load_front(front.save(tmp_path))
    assert loaded.verify(kind).holds
    loaded.report(tmp_path, problem=kind)
    assert synth.prices(front)
    sizes = {name: f"{front.designs[0].values[name]!r} m" for name in ("width", "height")}
    assert synth.evaluate(kind, {}, values=sizes).status.value == "feasible"


def test_equal_ends_that_cannot_be_are_no_fault_either():
    front = synth.synthesize(plate((5, 5), (0.01, 0.01)), {})
    assert (front.status.value, front.certificate.kind) == ("infeasible", "global")
    with pytest.raises(synth.InputError, match=r"fix: width: got '6 mm'; expected 5 mm$"):
        synth.synthesize(plate((5, 5), (1, 20)), {}, fix={"width": "6 mm"})


def test_a_declaration_alone_refuses_too():
    with pytest.raises(DeclarationError, match="lower end of variable q is nan"):
        Declaration("sample", {}, frozenset(), Catalogs()).variable("q", "mm", math.nan, 1)


# -- texts -----------------------------------------------------------------------------------------


def compared(formula):
    """Trace a problem that compares what it has declared, and return the fault."""

    def declare(d):
        x, holes = d.variable("x", "mm", 1, 2), d.count("holes", 1, 4)
        finish, rod = d.choice("finish", ("drawn", "ground")), d.part("rod", "metals")
        d.derive("made", "-", x * np.where(formula(x, holes, finish, rod), 1.0, 2.0))
        d.objective("made")

    with pytest.raises(DeclarationError) as caught:
        problem(declare)().model(frozenset(), CATALOGS)
    return str(caught.value)


COMPARED = [
    (lambda x, n, c, p: c == "ground", "choice finish", r"finish.select\(\{'drawn': ..., 'ground': ...\}\)"),
    (lambda x, n, c, p: "ground" == c, "choice finish", "finish.select"),
    (lambda x, n, c, p: c != "ground", "choice finish", "finish.select"),
    (lambda x, n, c, p: c in ("ground", "drawn"), "choice finish", "finish.select"),
    (lambda x, n, c, p: c == 1, "choice finish", "finish.select"),
    (lambda x, n, c, p: c == x, "choice finish", "finish.select"),
    (lambda x, n, c, p: p == "steel", "part rod", r"rod.says\(column, text\)"),
    (lambda x, n, c, p: p != "steel", "part rod", "rod.says"),
    (lambda x, n, c, p: p.code("source") == "x", r"rod\..*source", r"part.says\(column, text\)"),
    (lambda x, n, c, p: n == "4", "holes", "numbers"),
    (lambda x, n, c, p: "4" != n, "holes", "numbers"),
    (lambda x, n, c, p: 2 * x == "4 mm", "x", "numbers"),
    (lambda x, n, c, p: x in ("4 mm",), "x", "numbers"),
]


@pytest.mark.parametrize(("formula", "what", "instead"), COMPARED)
def test_what_is_compared_with_a_text_is_refused_with_line_and_what_to_use(formula, what, instead):
    said = compared(formula)
    assert re.search(rf"{what} is compared with .*; use .*{instead}", said)
    assert re.search(rf"\({HERE}, line {formula.__code__.co_firstlineno}: \(lambda x, n, c, p: ", said)


def test_records_are_equal_to_themselves_alone():
    def declare(d):
        finish, other = d.choice("finish", ("drawn", "ground")), d.choice("other", ("drawn", "ground"))
        rod, spare = d.part("rod", "metals"), d.part("spare", "metals")
        assert finish == finish
        assert finish != other
        assert finish is not None
        assert finish in {finish}
        assert rod == rod
        assert rod != spare
        assert rod not in [None, spare]
        d.derive("made", "-", d.variable("x", "-", 1, 2))
        d.objective("made")

    problem(declare)().model(frozenset(), CATALOGS)
