"""A component is declared and drawn in one package; others take what it hands over, and read no quantity of it."""

from __future__ import annotations

import ast
import re
import sys
from functools import cache
from pathlib import Path

import pytest

import synth
from synth.declaration import Block, Declaration
from synth.question.catalogs import as_catalogs
from tests.conformance.cases import CASES
from tests.syntax import parsed
from tests.test_architecture import ROOT, imported_by

pytestmark = pytest.mark.slow
COMPONENTS = "components/"
HOME = re.compile(r"synth\.problems\.(components\.\w+|(?!components\b)\w+)\.")
FETCHED = re.compile(r"(\w+)(?:\.\w+)?")  # a quantity, or a column of a slot


def folder_of(module: str) -> str:
    """Folder in problems/ of a module of a family or component; empty for one that declares for its callers."""
    found = HOME.match(module)
    return found[1].replace(".", "/") if found else ""


def home_of(name: str) -> str:
    """Folder whose source declares a name, seen from inside the verb that declares it."""
    frame = sys._getframe(2)
    while frame is not None:
        block = frame.f_locals.get("self")
        owners = [kind for kind in type(block).__mro__ if name in vars(kind)] if isinstance(block, Block) else []
        module = owners[0].__module__ if owners else frame.f_globals["__name__"]
        if folder := folder_of(module):
            return folder
        frame = frame.f_back
    raise AssertionError(name)


@cache
def homes(family: str) -> dict[str, str]:
    """Folder that declares it of every quantity, option and slot of a family, over all its option sets."""
    found: dict[str, str] = {}
    claim = Declaration._claim

    def noted(d: Declaration, name: str, symbol: str | None) -> str:
        found[name] = home_of(name)
        return claim(d, name, symbol)

    cases = CASES[family]
    given = {*cases.requirements, *cases.optional, *(name for more in cases.needed.values() for name in more)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Declaration, "_claim", noted)
        for options in cases.option_sets.values():
            for stated in (given, ()):
                synth.load(family, **options).declaration(frozenset(stated), as_catalogs(None))
    return found


@cache
def declared() -> dict[str, set[str]]:
    """Names that the sources of each folder in problems/ declare, in any family."""
    found: dict[str, set[str]] = {}
    for family in CASES:
        for name, home in homes(family).items():
            found.setdefault(home, set()).add(name)
    return found


def drawing_modules(folder: str) -> list[Path]:
    """Sources of a folder in problems/ that draw; a model does no more than name the type of a drawing."""
    sources = sorted((ROOT / "problems" / folder).glob("*.py"))
    return [p for p in sources if any(re.match(r"synth\.drawing\.(?!Drawing$)", n) for n in imported_by(p))]


def fetched(path: Path) -> set[str]:
    """Names of quantities and slots in the texts of a source."""
    texts = (
        node.value for node in ast.walk(parsed(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Constant)
    )
    return {match[1] for text in texts if isinstance(text, str) and (match := FETCHED.fullmatch(text))}


def test_no_drawing_reads_a_quantity_that_a_component_declares() -> None:
    of_components = set().union(*(names for home, names in declared().items() if home.startswith(COMPONENTS)))
    assert len(of_components) > 50
    families = {folder_of(type(synth.load(family)).__module__) for family in CASES}
    components = {home for home in declared() if home.startswith(COMPONENTS)}
    found = {
        f"{folder}/{path.name}: {name}"
        for folder in families | components
        for path in drawing_modules(folder)
        for name in fetched(path) & (of_components - declared()[folder])
    }
    assert found == set()


def test_a_component_with_a_mass_has_its_drawing() -> None:
    heavy = set()
    for family, cases in CASES.items():
        for options in cases.option_sets.values():
            d = synth.load(family, **options).declaration(frozenset(), as_catalogs(None))
            masses = (one.name for one in (*d.derived.values(), *d.steps.values()) if one.unit == "kg")
            heavy |= {homes(family)[name] for name in masses}
    heavy = {home for home in heavy if home.startswith(COMPONENTS)}
    assert {f"{COMPONENTS}{name}" for name in ("coil", "magnet")} <= heavy
    assert {home for home in heavy if (ROOT / "problems" / home / "drawing.py") in drawing_modules(home)} == heavy


def test_a_family_takes_from_components_and_never_from_another_family() -> None:
    families = {folder_of(type(synth.load(family)).__module__) for family in CASES}
    found = {
        f"{path.relative_to(ROOT / 'problems')}: {name}"
        for folder in ("components", *sorted(families))
        for path in sorted((ROOT / "problems" / folder).rglob("*.py"))
        for name in imported_by(path)
        if folder_of(f"{name}.") in families - {folder}
    }
    assert found == set()
