"""What is promised of the public formulas: what their docstrings tell, and that it is so.

Arguments are those of the doctests. What a function takes beside numbers is told by the types of its arguments.
"""

from __future__ import annotations

import contextlib
import dataclasses
import doctest
import inspect
import io
import re
import subprocess
import sys
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.special import lambertw

import problems.mechanics
from tests.docs.mechanics_page import ARRAYS, NUMBERS, SYMBOLS, Formula, formula, formulas, modules
from tests.problems.formula_checks import DIMENSION

ca.GlobalOptions.setNumpyMode(-1)

FORMULAS = formulas()
every_formula = pytest.mark.parametrize("f", FORMULAS, ids=lambda f: f"{f.module}.{f.name}")
UNITS = {*DIMENSION, "rad", "rad/s", "rad/s3", "ohm", "m2/s2", "Wb/A", "W/A2", "N m s", "SI"}


def calls(f: Formula) -> list[inspect.BoundArguments]:
    """Return what the doctest of a function calls it with."""
    module = sys.modules[f"problems.mechanics.{f.module}"]
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


def test_what_has_no_underscore_is_promised_and_nothing_else() -> None:
    folder = {info.__name__.rsplit(".", 1)[1] for info in modules()}
    files = {path.stem for path in _folder().glob("*.py")} - {"__init__"}
    assert folder == files
    for module in modules():
        own = {
            name
            for name, value in vars(module).items()
            if not name.startswith("_") and (name.isupper() or getattr(value, "__module__", "") == module.__name__)
        }
        aliases = {"Ramp", "DriverTorque"} & set(vars(module))
        borrowed = {
            n for n in own if not re.search(rf"^(?:def|class) {n}\b|^.*\b{n}\b.* = |^    {n},", _source(module), re.M)
        }
        assert own - borrowed | aliases == set(module.__all__), module.__name__


def _folder() -> Any:
    from pathlib import Path

    return Path(problems.mechanics.__file__).parent


def _source(module: Any) -> str:
    return inspect.getsource(module)


@every_formula
def test_a_formula_tells_meaning_units_equation_source_and_a_number(f: Formula) -> None:
    assert faults(f) == []


def faults(f: Formula) -> list[str]:
    """Return what the docstring of a function lacks."""
    found = [] if re.fullmatch(r"[A-Z].{8,}\.", f.meaning) else ["meaning"]
    found += [] if f.equation else ["equation"]
    told = [name.lstrip("*") for entry in f.entries for name in entry.names]
    found += [] if told == list(inspect.signature(f.function).parameters) else ["arguments"]
    for entry in f.entries:
        if entry.type not in ("str", "callable", "StartupRun", "str, table or callable", "int", "int, optional"):
            found += [] if entry.units and set(entry.units) <= UNITS else [f"unit of {', '.join(entry.names)}"]
    returned = re.findall(r"\[([^\]]+)\]", f.returns)
    no_number = inspect.signature(f.function).return_annotation in ("StartupPhases", "StartupRun", "SwitchingRun")
    a_verdict = "True where" in f.returns
    alike = f.name == "larger"
    if not (no_number or a_verdict or alike):
        found += [] if returned and set(returned) <= UNITS else ["unit of the result"]
    found += [] if len(f.source) > 5 else ["source"]
    examples = doctest.DocTestParser().get_examples(f.examples)
    found += [] if any(re.search(rf"\b{f.name}\(", e.source) for e in examples) and examples[-1].want else ["doctest"]
    return found


def test_a_docstring_that_lacks_something_is_noticed() -> None:
    def poor(force: Any, arm: Any) -> Any:
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


@every_formula
def test_floats_and_arrays_give_the_same(f: Formula) -> None:
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


@every_formula
@pytest.mark.parametrize("kind", [ca.SX, ca.MX], ids=["SX", "MX"])
def test_floats_and_symbols_give_the_same(f: Formula, kind: Any) -> None:
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
        "import sys, problems.mechanics as m\n"
        "for name in m.__all__: getattr(m, name)\n"
        "m.startup.reactive_slip_time(1080.0, 600.0, driven_inertia=30.0, driver_speed=26.6, ramp_time=2.0)\n"
        "print([name for name in ('casadi', 'pandas', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "[]\n"
    with pytest.raises(AttributeError, match="no attribute 'friction_radius'"):
        _ = problems.mechanics.friction_radius


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
    module = sys.modules[f"problems.mechanics.{f.module}"]
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


@pytest.mark.parametrize("f", [f for f in FORMULAS if not f.how], ids=lambda f: f"{f.module}.{f.name}")
def test_the_equation_is_what_is_computed(f: Formula) -> None:
    for bound in calls(f):
        computed = [float(x) for x in flat(f.function(*bound.args, **bound.kwargs))]
        np.testing.assert_allclose([float(x) for x in flat(equation_value(f, bound))], computed, rtol=1e-9)


def test_nearly_all_equations_are_computed() -> None:
    assert sum(bool(f.how) for f in FORMULAS) < 0.05 * len(FORMULAS)


def test_an_equation_that_is_wrong_is_noticed() -> None:
    right = next(f for f in FORMULAS if f.name == "friction_radius")
    for wrong in ("r = (dm/2) (1 + c**2/2)", "r = dm/2 + c", "r = (d/2) (1 + c**2/3)", "r = (dm/2) (1 + c**2/3) q"):
        with pytest.raises((AssertionError, NameError)):
            test_the_equation_is_what_is_computed(dataclasses.replace(right, equation=wrong))
