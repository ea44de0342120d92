"""What is promised of the public formulas: what their docstrings tell, and that it is so.

Arguments are those of the doctests. What a function takes beside numbers is told by the types of its arguments.
"""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import doctest
import inspect
import io
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
import synth.problems.mechanics
from scipy.special import lambertw
from synth.problems.mechanics import Quantity

from synth.testing.properties import Properties
from tests.docs.mechanics_page import ARRAYS, NUMBERS, SYMBOLS, UNIT, Entry, Formula, formula, formulas, modules
from tests.problems.formula_checks import DIMENSION
from tests.waiting import PATIENCE

ca.GlobalOptions.setNumpyMode(-1)

pytestmark = pytest.mark.slow
FORMULAS = formulas()
of_a_formula = Properties()
OF_OTHERS = {"rad": "-", "rad/s": "1/s", "rad/s3": "1/s3"}
DIMENSIONS = {**DIMENSION, "m/s2": (0, 1, -2, 0), "ohm": (1, 2, -3, 0, -2), "N m s": DIMENSION["kg m2/s"]}
DIMENSIONS |= {"Wb/A": (1, 2, -2, 0, -2), "W/A2": (1, 2, -3, 0, -2)}
UNITS = {*DIMENSIONS, *OF_OTHERS, "SI"}  # SI: each of many by its own
NOT_QUANTITIES = (
    "str",
    "bool",
    "int",
    "callable",
    "StartupRun",
)  # first words of the types of arguments without a unit


@cache
def calls(f: Formula) -> list[inspect.BoundArguments]:
    """Return what the doctest of a function calls it with."""
    module = sys.modules[f"synth.problems.mechanics.{f.module}"]
    signature, found = inspect.signature(f.function), []

    def recorded(*arguments: Any, **named: Any) -> Any:
        bound = signature.bind(*arguments, **named)
        bound.apply_defaults()
        found.append(bound)
        return f.function(*arguments, **named)

    names = {**vars(module), f.name: recorded}
    for example in doctest.DocTestParser().get_examples(f.examples):
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(example.source, f.name, "single"), names)
    return found


def flat(value: Any) -> list[Any]:
    """Return the quantities of a result: itself, or those of a tuple or record."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return [getattr(value, field.name) for field in dataclasses.fields(value)]
    return list(value) if isinstance(value, (tuple, list)) else [value]


# ---- what is told ---------------------------------------------------------------------------------------------------


def defined(source: str) -> set[str]:
    """Return what a module defines at its top, without what starts with an underscore."""
    names: list[str] = []
    for node in ast.parse(source).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.append(node.name)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names += [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
    return {name for name in names if not name.startswith("_")}


def test_what_has_no_underscore_is_promised_and_nothing_else() -> None:
    assert defined("a: int = 1\n_b = 2\nC, D = 1, 2\ndef f():\n    g = 1\nclass _H: ...") == {"a", "C", "D", "f"}
    folder = Path(synth.problems.mechanics.__file__).parent
    promised = {module.__name__.rsplit(".", 1)[1]: module for module in modules()}
    assert set(promised) == {path.stem for path in folder.glob("*.py")} - {"__init__"}
    for name, module in promised.items():
        assert defined((folder / f"{name}.py").read_text(encoding="utf-8")) == set(module.__all__), name


@of_a_formula
def a_formula_tells_meaning_units_equation_source_and_a_number(f: Formula) -> None:
    assert faults(f) == []


def faults(f: Formula) -> list[str]:
    """Return what the docstring of a function lacks."""
    found = [] if re.fullmatch(r"[A-Z].{8,}\.", f.meaning) else ["meaning"]
    found += [] if f.equation else ["equation"]
    told = [name.lstrip("*") for entry in f.entries for name in entry.names]
    found += [] if told == list(inspect.signature(f.function).parameters) else ["arguments"]
    for entry in f.entries:
        if not entry.type.startswith(NOT_QUANTITIES):
            found += [] if entry.units and set(entry.units) <= UNITS else [f"unit of {', '.join(entry.names)}"]
    returned = UNIT.findall(f.returns)
    a_record = "Quantity" not in (kind := str(inspect.signature(f.function).return_annotation)) and kind != "float"
    if not (a_record or "True where" in f.returns or f.returns == "The larger."):
        found += [] if returned and set(returned) <= UNITS else ["unit of the result"]
    found += [] if len(f.source) > 5 else ["source"]
    examples = doctest.DocTestParser().get_examples(f.examples)
    found += [] if any(re.search(rf"\b{f.name}\(", e.source) for e in examples) and examples[-1].want else ["doctest"]
    return found


def test_a_docstring_that_lacks_something_is_noticed() -> None:
    def poor(force: Any, arm: Any) -> Quantity:
        """Torque.

        Parameters
        ----------
        force : scalar, array or symbol
            F.

        Returns
        -------
        scalar, array or symbol
            M.
        """
        return force * arm

    lacks = ["meaning", "equation", "arguments", "unit of force", "unit of the result", "source", "doctest"]
    assert faults(formula("none", poor)) == lacks


# ---- the same for floats, arrays and symbols ------------------------------------------------------------------------


def varied(f: Formula, bound: inspect.BoundArguments, kinds: tuple[str, ...]) -> dict[str, list[Any]]:
    """Return the arguments that take what is wanted, each as a list of numbers."""
    found = {}
    for name, value in bound.arguments.items():
        if f.entry_of(name).takes in kinds:
            found[name] = [float(x) for x in value] if isinstance(value, (tuple, list)) else [float(value)]
    return found


def called(f: Formula, bound: inspect.BoundArguments, instead: dict[str, list[Any]]) -> list[Any]:
    """Call a function with other values in place of those of its doctest."""
    own = inspect.BoundArguments(bound.signature, dict(bound.arguments))  # type: ignore[arg-type]
    for name, values in instead.items():
        many = isinstance(own.arguments[name], (tuple, list))
        own.arguments[name] = type(own.arguments[name])(values) if many else values[0]
    return flat(f.function(*own.args, **own.kwargs))


@of_a_formula
def floats_and_arrays_give_the_same(f: Formula) -> None:
    if f.takes == NUMBERS:
        assert not varied(f, calls(f)[0], (SYMBOLS, ARRAYS))
        return
    for bound in calls(f):
        base = varied(f, bound, (SYMBOLS, ARRAYS))
        scales = (1.0, 1.001, 0.999)
        single = [called(f, bound, {n: [x * k for x in xs] for n, xs in base.items()}) for k in scales]
        arrays = called(f, bound, {n: [x * np.array(scales) for x in xs] for n, xs in base.items()})
        for place, array in enumerate(arrays):
            numbers = [float(one[place]) for one in single]
            np.testing.assert_allclose(np.broadcast_to(np.asarray(array, float), 3), numbers, rtol=1e-12)


@of_a_formula
def floats_and_sx_give_the_same(f: Formula) -> None:
    assert_same_of_symbols(f, ca.SX)


@of_a_formula
def floats_and_mx_give_the_same(f: Formula) -> None:
    assert_same_of_symbols(f, ca.MX)


def assert_same_of_symbols(f: Formula, kind: Any) -> None:
    if f.takes != SYMBOLS:
        return
    for bound in calls(f):
        base = varied(f, bound, (SYMBOLS,))
        symbols = {n: [kind.sym(f"{n}_{k}") for k in range(len(xs))] for n, xs in base.items()}
        results = [kind(x) for x in called(f, bound, symbols)]
        traced = ca.Function("formula", [s for group in symbols.values() for s in group], results)
        values = traced(*[x for xs in base.values() for x in xs])
        found = [float(x) for x in (values if len(results) > 1 else [values])]
        np.testing.assert_allclose(found, [float(x) for x in called(f, bound, base)], rtol=1e-12)


def test_most_formulas_take_symbols() -> None:
    assert sum(f.takes == SYMBOLS for f in FORMULAS) > 0.9 * len(FORMULAS)


def test_formulas_are_used_without_casadi() -> None:
    code = (
        "import sys, synth.problems.mechanics as m\n"
        "for name in m.__all__: getattr(m, name)\n"
        "m.startup.reactive_slip_time(1080.0, 600.0, driven_inertia=30.0, driver_speed=26.6, ramp_time=2.0)\n"
        "print([name for name in ('casadi', 'pandas', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout == "[]\n"
    with pytest.raises(AttributeError, match="no attribute 'friction_radius'"):
        _ = synth.problems.mechanics.friction_radius


# ---- the units are those of what is computed -------------------------------------------------------------------------

CONSTANT = re.compile(r"^([A-Z_0-9]+) = .*  # .*\[(.+?)\]", re.MULTILINE)


@of_a_formula
def the_result_scales_as_its_unit_when_arguments_and_constants_do(f: Formula) -> None:
    if f.takes == NUMBERS or not UNIT.search(f.returns):
        return
    rng = np.random.default_rng(0)
    for _ in range(3):
        scale = rng.uniform(0.5, 2.0, 5)
        factor = {unit: float(np.prod(scale[: len(e)] ** np.array(e))) for unit, e in DIMENSIONS.items()}
        factor |= {unit: factor[other] for unit, other in OF_OTHERS.items()}
        for bound in calls(f):
            base = varied(f, bound, (SYMBOLS, ARRAYS))
            told = {n.lstrip("*"): unit for e in f.entries for n, unit in zip(e.names, units_of(e), strict=True)}
            expected = [float(x) * factor[u] for x, u in zip(called(f, bound, base), results_of(f), strict=True)]
            with pytest.MonkeyPatch.context() as patch:
                for module in modules():  # a formula may use the constants of others
                    for name, unit in CONSTANT.findall(inspect.getsource(module)):
                        patch.setattr(module, name, getattr(module, name) * factor[unit])
                scaled = {n: [x * factor[told[n]] for x in xs] for n, xs in base.items()}
                found = [float(x) for x in called(f, bound, scaled)]
            np.testing.assert_allclose(found, expected, rtol=1e-9)


def units_of(entry: Entry) -> list[str]:
    """Return the unit of each name: one for all, or one each."""
    return entry.units if len(entry.units) == len(entry.names) else entry.units[:1] * len(entry.names) or [""]


def results_of(f: Formula) -> list[str]:
    """Return the units of a result: of a tuple all that are told, else the first."""
    told = UNIT.findall(f.returns)
    return told if str(inspect.signature(f.function).return_annotation).startswith("tuple") else told[:1]


def test_a_unit_that_is_wrong_is_noticed() -> None:
    right = next(f for f in FORMULAS if f.name == "friction_radius")
    with pytest.raises(AssertionError):
        the_result_scales_as_its_unit_when_arguments_and_constants_do(dataclasses.replace(right, returns="r [m2]."))


# ---- the equation is what is computed -------------------------------------------------------------------------------

TOKEN = re.compile(r"\d+(?:\.\d+)?(?:e-?\d+)?|E\*(?!\*)(?=[\s),/.]|$)|E\*(?=\*\*)|[A-Za-z_]\w*|\*\*|<=|>=|[-+*/(),<>]")
WORDS = {"if", "else"}
FUNCTIONS: dict[str, Any] = {
    "sqrt": np.sqrt,
    "exp": np.exp,
    "ln": np.log,
    "cbrt": np.cbrt,
    "arctan": np.arctan,
    "artanh": np.arctanh,
    "max": max,
    "min": min,
    "ceil": np.ceil,
    "sum": sum,
    "W0": lambda x: lambertw(x).real,
}
UNIT_OF_A_NUMBER = re.compile(r"^([\d.e-]+(?: pi)?) (?:m/s2|ohm m|kg/m3|1/K|V s/\(A m\))$")
DEFINITION = re.compile(r", (?=\w+ = )")


def as_python(expression: str, functions: set[str]) -> str:
    """Return a formula as Python: what stands side by side is multiplied."""
    assert not (rest := TOKEN.sub("", expression).strip()), f"{rest!r} in {expression!r}"
    tokens, text = TOKEN.findall(expression), ""
    for before, token in zip(["(", *tokens[:-1]], tokens, strict=True):
        ends = before == ")" or (before[0].isalnum() and before not in WORDS | functions)
        starts = token == "(" or (token[0].isalnum() and token not in WORDS)
        text += (" * " if ends and starts else " ") + token.replace("E*", "E_star")
    return text


def symbols_of(f: Formula, bound: inspect.BoundArguments) -> dict[str, Any]:
    """Return the values of the symbols of an equation: each argument names its own, last before its unit."""
    used = {*re.findall(r"[A-Za-z_]\w*", f.equation), *re.findall(r"E\*(?!\*[^*])", f.equation)}
    found: dict[str, Any] = {}
    for entry in f.entries:
        values = [bound.arguments[n.lstrip("*")] for n in entry.names]
        if entry.type == "str":
            found |= {entry.names[0]: values[0], values[0]: True}
            continue
        told = re.split(r"\[[^\]]*\](?!.*\[)", entry.text)[0]
        explicit = re.match(r"(?:.*[ ,])?([A-Za-z]\w*) = ", told)
        words = re.findall(r"E\*|[A-Za-z]\w*", told)
        names = [explicit[1]] if explicit and explicit[1] in used else [w for w in words if w in used][-len(values) :]
        assert len(names) == len(values), f"{f.name}: {entry.names} have no symbols of {f.equation!r} in {told!r}"
        found |= dict(zip(names, values, strict=True))
    return found


def equation_value(f: Formula, bound: inspect.BoundArguments) -> Any:
    """Return what the equation of a docstring gives."""
    module = sys.modules[f"synth.problems.mechanics.{f.module}"]
    own = {n: x for n, x in vars(module).items() if inspect.isfunction(x)}
    functions = {**own, **FUNCTIONS}
    _, _, right = f.equation.partition(" = ")
    main, _, definitions = right.partition(", with ")
    names = symbols_of(f, bound)
    said = [e.type for e in f.entries]
    if "str" in said:  # cases are told by name: reactive, lipka, ...
        names = {
            **dict.fromkeys(set(re.findall(r"(?:if|else) (\w+)(?= else)", f.equation)) - set(names), False),
            **names,
        }
    values = {"pi": np.pi, **{n.replace("E*", "E_star"): x for n, x in names.items()}}
    for definition in filter(None, DEFINITION.split(definitions)):
        name, text = definition.split(" = ", 1)
        text = UNIT_OF_A_NUMBER.sub(r"\1", text)
        values[name] = eval(as_python(text, set(functions)), {**functions, **values})
    return eval(as_python(main, set(functions)), {**functions, **values})


@of_a_formula
def the_equation_is_what_is_computed(f: Formula) -> None:
    if f.how:
        return
    for bound in calls(f):
        computed = [float(x) for x in flat(f.function(*bound.args, **bound.kwargs))]
        np.testing.assert_allclose([float(x) for x in flat(equation_value(f, bound))], computed, rtol=1e-9)


@pytest.mark.parametrize("f", FORMULAS, ids=lambda f: f"{f.module}.{f.name}")
def test_a_formula_keeps_every_property(f: Formula) -> None:
    of_a_formula.check(f)


def test_nearly_all_equations_are_computed() -> None:
    assert sum(bool(f.how) for f in FORMULAS) < 0.05 * len(FORMULAS)


def test_an_equation_that_is_wrong_is_noticed() -> None:
    right = next(f for f in FORMULAS if f.name == "friction_radius")
    for wrong in ("r = (dm/2) (1 + c**2/2)", "r = dm/2 + c", "r = (d/2) (1 + c**2/3)", "r = (dm/2) (1 + c**2/3) q"):
        with pytest.raises((AssertionError, NameError)):
            the_equation_is_what_is_computed(dataclasses.replace(right, equation=wrong))
