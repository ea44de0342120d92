"""Who may import what, and what an installed copy contains."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

import synth
from synth.plugins import AROUND_THE_ENGINE
from tests.conftest import LONGEST
from tests.shipped import FAMILIES
from tests.syntax import parsed, walked

ROOT = Path(__file__).parents[1]


def packages_of(top: str) -> tuple[str, ...]:
    """Return a package and all packages inside it, as folders."""
    return tuple(sorted({path.parent.relative_to(ROOT).as_posix() for path in (ROOT / top).rglob("*.py")}))


ENGINE, PROBLEMS, REPORTS = packages_of("synth"), packages_of("problems"), packages_of("reports")
PACKAGES = (*ENGINE, *PROBLEMS, "catalogs", *REPORTS)
OURS = {package.split("/")[0] for package in PACKAGES}


def sources(package: str) -> list[Path]:
    found = sorted((ROOT / package).glob("*.py"))
    assert found, f"no source files in {package}"
    return found


def module_name(path: Path) -> str:
    """Dotted name by which a source file is imported; that of its package for ``__init__.py``."""
    steps = path.relative_to(ROOT).with_suffix("").parts
    steps = steps[:-1] if steps[-1] == "__init__" else steps
    return ".".join(steps if steps[0] == "synth" else ("synth", *steps))


@cache
def imported(text: str, package: str) -> set[str]:
    """Full dotted names that a source text of a package imports, wherever the import stands."""
    names: set[str] = set()
    for node in walked(text):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            module = ".".join([*start, *([node.module] if node.module else [])])
            names |= {f"{module}.{alias.name}" for alias in node.names}
    return names


def imported_by(path: Path) -> set[str]:
    """Full dotted names that a source file imports."""
    return imported(path.read_text(), module_name(path.parent / "__init__.py"))


def strangers(names: set[str], allowed: set[str]) -> list[str]:
    """Return the names that lie neither in an allowed module nor in the standard library."""

    def known(name: str) -> bool:
        steps = name.split(".")
        return any(".".join(steps[:k]) in allowed for k in range(1, len(steps) + 1))

    return sorted(n for n in names if not known(n) and n.split(".")[0] not in sys.stdlib_module_names)


def test_imports_are_found_wherever_they_stand() -> None:
    text = (
        "import numpy as np\nfrom typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from ..table import x\nelse:\n    import synth.problems.friction\n"
        "def f():\n    from synth import DesignProblem\nfrom . import y\nfrom .z import z\n"
    )
    found = {"numpy", "typing.TYPE_CHECKING", "synth.reports.table.x", "synth.problems.friction"}
    found |= {"synth.DesignProblem", "synth.reports.sheet.y", "synth.reports.sheet.z.z"}
    assert imported(text, "synth.reports.sheet") == found
    reports = sorted(name for name in found if name.startswith("synth.reports"))
    assert strangers(found, {"synth.DesignProblem", "synth.problems", "numpy"}) == reports
    assert strangers({"synthetic.x", "synth.units.x"}, {"synth.units"}) == ["synthetic.x"]
    assert module_name(ROOT / "problems/cone/model.py") == "synth.problems.cone.model"
    assert module_name(ROOT / "synth/__init__.py") == "synth"


# package: what it may import besides the standard library
FAMILY = {"synth.problems", "numpy", "pandas", "synth.Design", "synth.DesignProblem", "synth.declaration"}
FAMILY |= {"synth.drawing"}
GROUND = {"synth.errors", "synth.special", "synth.text"}
FAMILY |= GROUND
SUITE = {"synth.testing"}
REPORT = {
    "synth.reports",
    "matplotlib",
    "rich",
    "pandas",
    "synth.results",
    "synth.operations",
    "synth.units",
    "synth.errors",
    "synth.folders.files",
}
REPORT |= {
    "synth.folders.files",
    "synth.order.feasibility",
    "synth.text.plain_text",
    "synth.text",
    "synth.ui",
    "synth.drawing",
}
MAY_IMPORT = {
    **dict.fromkeys(PROBLEMS, FAMILY),
    "problems/mechanics": {"synth.problems.mechanics", "numpy", "pandas", "scipy", *GROUND},
    "catalogs": set(),
    **dict.fromkeys(REPORTS, REPORT),
}


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_around_the_engine_keep_to_its_public_side(package: str) -> None:
    found = {
        path.name: strangers(imported_by(path), MAY_IMPORT[package] | (SUITE if path.name == "cases.py" else set()))
        for path in sources(package)
    }
    assert not {name: names for name, names in found.items() if names}


def test_the_engine_imports_no_family_no_catalogue_and_no_report() -> None:
    found = {
        str(path): [n for n in imported_by(path) if n.startswith(AROUND_THE_ENGINE)]
        for package in ENGINE
        for path in sources(package)
    }
    assert not {name: names for name, names in found.items() if names}


def test_a_family_is_imported_by_no_other_package_of_problems() -> None:
    def owner(module: str) -> str:
        return ".".join(module.split(".")[:3])

    families = {owner(type(synth.load(name)).__module__) for name in FAMILIES}
    assert len(families) > 5
    found = {
        (str(path.relative_to(ROOT)), name)
        for package in PROBLEMS
        for path in sources(package)
        for name in imported_by(path)
        if owner(name) in families - {owner(module_name(path))}
    }
    assert found == set()


def test_nothing_but_cases_imports_the_suite_and_pytest() -> None:
    found = {
        str(path.relative_to(ROOT))
        for package in PACKAGES
        for path in sources(package)
        if any(
            name.startswith(("synth.testing", "pytest.", "_pytest")) or name == "pytest" for name in imported_by(path)
        )
    }
    assert found
    assert all(path.startswith("synth/testing/") or path.endswith("/cases.py") for path in found)


def circles(graph: dict[str, set[str]]) -> set[str]:
    """Return the nodes that are left when all without open dependencies are taken away again and again."""
    left = {name: set(needs) & set(graph) for name, needs in graph.items()}
    while free := {name for name, needs in left.items() if not needs & set(left)}:
        left = {name: needs for name, needs in left.items() if name not in free}
    return set(left)


def test_modules_of_the_engine_do_not_import_each_other_in_circles() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}) == {"a", "b", "c"}
    modules = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path
        for package in ENGINE
        for path in sources(package)
        if path.stem != "__init__"
    }

    def module_of(name: str) -> str:
        steps = name.split(".")
        return next((m for k in range(len(steps), 0, -1) if (m := ".".join(steps[:k])) in modules), "")

    graph = {name: {module_of(other) for other in imported_by(path)} - {""} for name, path in modules.items()}
    assert len(graph) > 10
    assert "synth.batches.store" in graph["synth.batches.batch"]
    assert circles(graph) == set()


def spoken(text: str) -> set[str]:
    """Return the identifiers and texts of a source, docstrings apart."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in walked(text)
        if isinstance(node, documented) and node.body and isinstance(node.body[0], ast.Expr)
    }
    words: set[str] = set()
    for node in walked(text):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            words.add(node.value)
        elif isinstance(node, ast.Name):
            words.add(node.id)
        elif isinstance(node, ast.Attribute):
            words.add(node.attr)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.alias)):
            words.add(node.name)
    return words


def test_the_engine_names_no_family() -> None:
    assert FAMILIES
    families = {*FAMILIES, *(type(synth.load(name)).__name__ for name in FAMILIES)}
    # Messages may show a line of a spec that can be typed; nothing else may know a name.
    example = re.compile(r"'family: \w+'")
    for path in (path for package in ENGINE for path in sources(package)):
        words = {example.sub("", word) for word in spoken(path.read_text())}
        named = {word for word in words for family in families if family in word}
        assert not named, f"{path.name} names {named}"


# Folders of tests/ beside those named like a package of the engine, and what their tests have in common.
KINDS = {
    "ground": "single files of the engine",
    "problems": "the shipped families, in folders as those of problems/",
    "catalogs": "the shipped tables",
    "reports": "figures and tables of results",
    "conformance": "what every family must keep",
    "certificates": "claims on random problems against an independent reference",
    "endtoend": "what people meet, across packages",
    "docs": "what the documentation shows",
    "benchmarks": "run by hand",
    "referees": "independent solvers that answers are compared with",
    "sample_problems": "small problems for tests of the engine",
}


def test_tests_stand_in_folders_named_like_what_they_test() -> None:
    def folders(place: str) -> set[str]:
        return {path.name for path in (ROOT / place).iterdir() if any(path.rglob("*.py"))}

    packages = {path.name for path in (ROOT / "synth").iterdir() if path.is_dir() and any(path.rglob("*.py"))}
    assert folders("tests") == packages | set(KINDS)
    assert folders("tests/problems") <= folders("problems")
    assert {path.name for path in (ROOT / "tests").glob("test_*.py")} == {
        "test_architecture.py",
        "test_figures.py",
        "test_layers.py",
        "test_portability.py",
    }


def test_files_that_run_first_are_there() -> None:
    assert [name for name in LONGEST if not (ROOT / "tests" / name).is_file()] == []


def test_the_list_of_packages_is_that_of_the_folders() -> None:
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    folders = {path for top in sorted(OURS) for path in (ROOT / top).rglob("__init__.py")}
    assert tools["packages"] == sorted(map(module_name, folders))
    assert tools["package-dir"] == {f"synth.{top}": top for top in OURS - {"synth"}}
    assert set(tools["package-dir"]) == set(AROUND_THE_ENGINE)


def test_no_package_has_the_name_of_a_verb() -> None:
    # Importing synth.batch as a package would replace the function synth.batch.
    packages = {module_name(path).split(".")[1] for path in (ROOT / "synth").glob("*/__init__.py")}
    assert not packages & set(synth.__all__)


def numbers_of(tree: ast.Module) -> set[str]:
    """Return the constants of a module that are numbers."""
    found = set()
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name, value = node.targets[0].id, node.value
            parts = [x for x in ast.walk(value) if not isinstance(x, (ast.operator, ast.unaryop))]
            if name.isupper() and all(isinstance(x, (ast.Constant, ast.BinOp, ast.UnaryOp)) for x in parts):
                found |= {name} if any(isinstance(getattr(x, "value", None), (int, float)) for x in parts) else set()
    return found


def test_no_test_patches_a_number_of_the_engine() -> None:
    assert numbers_of(parsed("A = 1\nB = -2 * 3.0\nC = 'x'\nD = f(1)\nE, F = 1, 2\nf = 1")) == {"A", "B"}
    numbers = {name for package in ENGINE for path in sources(package) for name in numbers_of(parsed(path.read_text()))}
    assert len(numbers) > 20
    patched = set()
    texts = ((path, path.read_text()) for path in (ROOT / "tests").rglob("*.py"))
    for path, text in ((path, text) for path, text in texts if "setattr" in text):
        for node in walked(text):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "setattr":
                told = [x.value for x in node.args if isinstance(x, ast.Constant) and isinstance(x.value, str)]
                patched |= {(path.name, word) for word in told if word.rsplit(".", 1)[-1] in numbers}
    assert patched == set()
