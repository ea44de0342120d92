"""Figures of the sources that shall fall; ``python -m tests.figures`` shows them beside their bounds and goals.

What each counts is the docstring of its function. A test fails when one gets worse than in ``figures.csv``.
"""

from __future__ import annotations

import ast
import csv
import io
import re
import tokenize
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.syntax import walked
from tests.test_layers import upward

ROOT = Path(__file__).parents[1]
TABLE = Path(__file__).parent / "figures.csv"
TOPS = ("synth", "problems", "catalogs", "reports")
GENERATED_OR_RUN = ("migrations",)  # written by a tool
SUITE = ("synth/testing/", "/cases.py")  # tests that are shipped
LONG, MANY, POSITIONAL = 40, 8, 5
OPERATIONS = ("TANH", "ATAN", "SQRT", "HYPOT", "LOG1P")
# Words of a private language, as parts of names; the field has others.
PRIVATE = frozenset(
    "told asked own found wanted aside beside brought given taken shelf signs stated restated turns look whole wide "
    "thing some rest left many alone tell says said posed room".split()
)
PRACTICE = frozenset({"rules", "scope", "complete", "whole", "body"})  # names by which families asked for it
NUMBER_WRITERS = re.compile(
    r"(plain|shown|short|format(ted)?|print(ed)?)_(number|figure|value|share|quantity)|_?percent|_?per_cent|significant"
)
VERBS = ("synthesize", "compare", "batch", "whatif", "near_equals", "prices", "explain", "rate", "verify", "improve",
         "size_range", "evaluate", "calculation", "describe", "draw")  # fmt: skip

Function = ast.FunctionDef | ast.AsyncFunctionDef


@cache
def sources() -> dict[str, str]:
    """Source texts of the package by path from the top; those of tests are not."""
    paths = (path for top in TOPS for path in sorted((ROOT / top).rglob("*.py")))
    return {
        path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
        for path in paths
        if not set(path.parts) & set(GENERATED_OR_RUN) and not any(part in path.as_posix() for part in SUITE)
    }


def nodes(*tops: str) -> Iterator[tuple[str, ast.AST]]:
    """Nodes of all modules, or of those below some folders, with their paths."""
    for path, text in sources().items():
        if not tops or path.startswith(tops):
            for node in walked(text):
                yield path, node


@cache
def functions() -> tuple[tuple[str, Function], ...]:
    """Functions and methods, with the paths of their modules."""
    return tuple((path, node) for path, node in nodes() if isinstance(node, Function))


def parameters(function: Function) -> list[ast.arg]:
    """Parameters of a function, its instance apart."""
    every = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    return [arg for arg in every if arg.arg not in ("self", "cls")]


@cache
def code_lines(path: str) -> frozenset[int]:
    """Lines of a module that hold code: no blank ones, comments or docstrings."""
    skipped = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(sources()[path]).readline):
        if token.type not in skipped:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in walked(sources()[path]):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            lines.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return frozenset(lines)


def import_names() -> int:
    """Top-level names that a wheel installs."""
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    return len({name.partition(".")[0] for name in tools["packages"]})


def loose_modules() -> int:
    """Modules directly in ``synth/``, beside its two doors."""
    return sum(path.count("/") == 1 and path.startswith("synth/") and "/__" not in path for path in sources())


def names_from_below() -> int:
    """Texts by which a module names one of a floor above."""
    return len(upward())


def facade_imports() -> int:
    """Statements ``import synth`` inside the engine."""
    return sum(
        isinstance(node, ast.Import) and any(alias.name == "synth" for alias in node.names)
        for _, node in nodes("synth/")
    )


def regular_expressions_below_bounds() -> int:
    """Modules of ``bounds``, ``nlp`` and ``kernels`` that use ``re``."""
    places = ("synth/bounds/", "synth/nlp/", "synth/kernels/")
    inside = (text for path, text in sources().items() if path.startswith(places))
    return sum(re.search(r"^import re$", text, re.MULTILINE) is not None for text in inside)


def c_writers() -> int:
    """Modules that hold or read expressions in C at run time."""
    pattern = re.compile(r"\bv_(f?max|f?min|exp|sqrt)\b|\bvd\b|\bi_mul\(|#include")
    return sum(pattern.search(text) is not None for path, text in sources().items() if path.startswith("synth/"))


def compiler_starters() -> int:
    """Modules that find or start a compiler."""
    pattern = re.compile(r"\b(c_compiler|find_compiler|compile_library|compilation|leave_behind)\b")
    return sum(pattern.search(text) is not None for path, text in sources().items() if path.startswith("synth/"))


def exit_handlers() -> int:
    """Registrations with ``atexit``."""
    return sum(text.count("atexit.register(") for text in sources().values())


def number_writers() -> int:
    """Functions that write a number or a per cent for people."""
    return sum(NUMBER_WRITERS.fullmatch(function.name) is not None for _, function in functions())


def homes_of_an_operation() -> int:
    """Modules that name one elementary operation by its number or in a table, of the worst."""
    named = (
        sum(re.search(rf"\bOP_{op}\b|\"({op}|{op.lower()})\"", text) is not None for text in sources().values())
        for op in OPERATIONS
    )
    return max(named)


def lines_of_code() -> int:
    """Lines of code, without comments, docstrings and blank lines."""
    return sum(len(code_lines(path)) for path in sources())


def bare_any() -> int:
    """Parameters that are ``Any``."""
    return sum(
        isinstance(arg.annotation, ast.Name) and arg.annotation.id == "Any"
        for _, function in functions()
        for arg in parameters(function)
    )


def mappings_of_any() -> int:
    """``Mapping[str, Any]`` in signatures."""
    found = 0
    for _, function in functions():
        signature = [arg.annotation for arg in parameters(function)] + [function.returns]
        found += sum(len(re.findall(r"\bMapping\[str, Any\]", ast.unparse(part))) for part in signature if part)
    return found


def long_functions() -> int:
    """Functions of more than 40 lines of code."""
    found = 0
    for path, function in functions():
        body = range(function.lineno, (function.end_lineno or function.lineno) + 1)
        found += len(code_lines(path) & set(body)) > LONG
    return found


def functions_of_many_parameters() -> int:
    """Functions of eight parameters or more."""
    return sum(len(parameters(function)) >= MANY for _, function in functions())


def positional_in_verbs() -> int:
    """Positional parameters of public verbs beyond five, summed."""
    over = 0
    for path, function in functions():
        if path.startswith("synth/") and function.name in VERBS and function.col_offset == 0:
            over += max(len(function.args.posonlyargs) + len(function.args.args) - POSITIONAL, 0)
    return over


def return_what() -> int:
    """Docstrings that begin with "Return what"."""
    documented = (ast.Module, ast.ClassDef, *Function.__args__)
    texts = (ast.get_docstring(node) for _, node in nodes() if isinstance(node, documented))
    return sum(text is not None and text.startswith("Return what") for text in texts)


def private_names() -> int:
    """Names of functions, classes, parameters, attributes and variables that hold a word of the private language."""
    names: set[tuple[str, str]] = set()
    for path, node in nodes():
        if isinstance(node, (*Function.__args__, ast.ClassDef)):
            names.add((path, node.name))
        elif isinstance(node, ast.arg):
            names.add((path, node.arg))
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add((path, node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add((path, node.attr))
    words = (set(re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower())) for _, name in names)
    return sum(bool(PRIVATE & found) for found in words)


def family_hint_lines() -> int:
    """Lines of source that speak of ``family_hint``."""
    return sum("family_hint" in line for text in sources().values() for line in text.splitlines())


def asks_for_practice(condition: ast.AST) -> bool:
    """True for a condition on rules of practice, on what is counted as mass, or on a model of a source.

    An optional requirement of the rules may be asked for: ``rules.top_speed is not None``.
    """
    values = {id(node.value) for node in ast.walk(condition) if isinstance(node, ast.Attribute)}
    return any(
        (isinstance(node, ast.Name) and node.id in PRACTICE and id(node) not in values)
        or (isinstance(node, ast.Attribute) and node.attr in PRACTICE)
        or (isinstance(node, ast.Constant) and node.value == "seed")
        for node in ast.walk(condition)
    )


def practice_asked() -> int:
    """Conditions in families that ask for practice; layers stand on the declared family in their place."""
    found = 0
    for _, node in nodes("problems/"):
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            found += asks_for_practice(node.test)
        elif isinstance(node, ast.comprehension):
            found += any(map(asks_for_practice, node.ifs))
    return found


def readme_lines() -> int:
    """Lines of README.md."""
    return len((ROOT / "README.md").read_text(encoding="utf-8").splitlines())


def changelog_words() -> int:
    """Words of CHANGELOG.md."""
    return len((ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split())


FIGURES: tuple[Callable[[], int], ...] = (
    import_names,
    loose_modules,
    names_from_below,
    facade_imports,
    regular_expressions_below_bounds,
    c_writers,
    compiler_starters,
    exit_handlers,
    number_writers,
    homes_of_an_operation,
    lines_of_code,
    bare_any,
    mappings_of_any,
    long_functions,
    functions_of_many_parameters,
    positional_in_verbs,
    return_what,
    private_names,
    family_hint_lines,
    practice_asked,
    readme_lines,
    changelog_words,
)


@dataclass(frozen=True)
class Bound:
    """What a figure was when the count began, what it may be now, and its goal."""

    begun: int
    most: int
    goal: int


def bounds() -> dict[str, Bound]:
    """Bounds of the figures by name, as the table holds them."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return {
            row["figure"]: Bound(int(row["begun"]), int(row["most"]), int(row["goal"])) for row in csv.DictReader(file)
        }


def main() -> None:
    """Print all figures beside their bounds."""
    held = bounds()
    print(f"{'figure':34s} {'begun':>7s} {'now':>7s} {'most':>7s} {'goal':>7s}")
    for figure in FIGURES:
        bound = held.get(figure.__name__, Bound(0, 0, 0))
        print(f"{figure.__name__:34s} {bound.begun:7d} {figure():7d} {bound.most:7d} {bound.goal:7d}")


if __name__ == "__main__":
    main()
