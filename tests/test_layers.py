"""Layers of the engine: who may import whom.

Read from all imports, those of types and inside functions included, and from texts that name a module.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

from tests.syntax import walked

ROOT = Path(__file__).parents[1]
ENGINE = ROOT / "synth"

# From the ground up; each place, a package or a module, may import what stands in lines before its own.
LAYERS = (
    ("system", "text", "order", "special", "operations", "plugins", "ui"),
    ("kernels",),
    ("errors",),
    ("folders",),
    ("units", "drawing"),
    ("results", "tables"),
    ("declaration", "queue"),
    ("model",),
    ("question",),
    ("verbs",),
    ("proof", "bounds", "nlp"),
    ("robust",),
    ("analysis",),
    ("search",),
    ("verification",),
    ("studies", "batches"),
    ("variants",),
    ("kinds",),
    ("workers", "client"),
    ("service",),
    ("terminal",),
    ("testing",),
    ("__init__", "__main__"),
)
MODULE = re.compile(r"synth(\.\w+)+(:\w+)?")  # as entry points and tables of tasks name a module, or what is in it
LEVELS = {place: level for level, places in enumerate(LAYERS) for place in places}


@cache
def modules() -> dict[str, Path]:
    """Return all modules of the engine by dotted name; migrations are run by their own tool."""
    found = {}
    for path in ENGINE.rglob("*.py"):
        steps = path.relative_to(ROOT).with_suffix("").parts
        if "migrations" not in steps:
            found[".".join(steps[:-1] if steps[-1] == "__init__" and len(steps) > 2 else steps)] = path
    return found


@cache
def read(text: str) -> tuple[set[str], list[str]]:
    """Return what a source text imports or names in a text to import it later, and the classes that it defines."""
    names: set[str] = set()
    classes: list[str] = []
    for node in walked(text):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Constant):
            if isinstance(node.value, str) and MODULE.fullmatch(node.value):
                names.add(node.value.partition(":")[0])
        elif isinstance(node, ast.ClassDef):
            classes.append(node.name)
    return names, classes


def imports(text: str, known: set[str]) -> set[str]:
    """Modules that a source text imports, wherever the import stands, or names in a text to import them later."""
    names = read(text)[0]
    found = set()
    for name in names:
        steps = name.split(".")
        found |= {next((m for k in range(len(steps), 0, -1) if (m := ".".join(steps[:k])) in known), "")}
    return found - {""}


def place_of(module: str) -> str:
    """Return the place that a module belongs to."""
    steps = module.split(".")
    return steps[1]


@cache
def arrows() -> dict[tuple[str, str], set[tuple[str, str]]]:
    """Return which modules import which, by their places."""
    known = modules()
    found: dict[tuple[str, str], set[tuple[str, str]]] = {}
    for module, path in known.items():
        for other in imports(path.read_text(), set(known)):
            ends = place_of(module), place_of(other)
            if ends[0] != ends[1]:
                found.setdefault(ends, set()).add((module, other))
    return found


def test_imports_are_found_wherever_they_stand() -> None:
    text = (
        "from typing import TYPE_CHECKING\nfrom synth.a import b, C\n"
        "if TYPE_CHECKING:\n    from synth.d import E\ndef f():\n    import synth.g\n"
        "TASK = 'synth.h:work'\nTEXT = 'see synth.i for more'\nimport_module('synth.j')\n"
    )
    every = {f"synth.{name}" for name in ("a", "a.b", "d", "g", "h", "i", "j")}
    assert imports(text, every) == every - {"synth.i"}


def test_every_place_has_a_level_and_every_level_a_place() -> None:
    found = {place_of(module) for module in modules()}
    assert found == set(LEVELS)


def test_only_results_ask_the_facade() -> None:
    asking = {
        place_of(module)
        for module, path in modules().items()
        if "import synth" in map(str.strip, path.read_text().split("\n"))
    }
    # A method of a front needs what stands above results; the suite for families asks as users do.
    assert asking <= {"results", "testing"}


def upward() -> set[tuple[str, str]]:
    """Modules that import or name one of the same level or above."""
    return {pair for ends, pairs in arrows().items() if LEVELS[ends[1]] >= LEVELS[ends[0]] for pair in pairs}


def test_imports_point_one_way() -> None:
    assert upward() == set()


SOUND = {"intervals", "instructions", "fused_instructions", "box_emitter", "array_reader", "contractor", "clusters"}
SOUND |= {"boxes", "propagated_nodes", "root_propagation", "question_bounds", "propagation"}
SOUND |= {"log_forms", "log_relaxation", "settings"}
STEERING = {"influences", "branching", "relaxed_branching"}
BOTH = {"box_batches", "kernel_boxes", "kernel_subtrees", "kernel_propagation", "bounding"}
# What kind of function a formula is: not of the search.
OF_FORMULAS = {"structure", "shapes", "composition", "log_terms", "feasible_intervals", "curvature", "existence"}


def test_what_proves_does_not_know_what_steers() -> None:
    own = {module for module in modules() if module.startswith("synth.bounds.")}
    assert {module.removeprefix("synth.bounds.") for module in own} == SOUND | STEERING | BOTH | OF_FORMULAS
    for name in SOUND:
        known = imports(modules()[f"synth.bounds.{name}"].read_text(), own)
        assert known <= {f"synth.bounds.{other}" for other in SOUND}, f"{name} imports what steers"


def test_no_class_name_stands_for_two_things() -> None:
    homes: dict[str, list[str]] = {}
    for module, path in modules().items():
        for name in read(path.read_text())[1]:
            homes.setdefault(name, []).append(module)
    assert len(homes) > 100
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def picture() -> str:
    """Return the packages as text: a line for each level from the ground up, with what its places import."""
    lines = []
    for level, places in enumerate(LAYERS[:-1]):
        for place in places:
            needs = {end[1] for end in arrows() if end[0] == place and LEVELS[end[1]] < LEVELS[place]}
            packages = sorted((p for p in needs if is_drawn(p)), key=lambda p: (LEVELS[p], p))
            if is_drawn(place):
                lines.append(f"{level:2d}  {place:13s} <- {' '.join(packages) or 'the ground'}")
    return "\n".join(lines)


# Whatever reads, writes or shows something imports them.
ON_THE_GROUND = {"system", "text", "order", "operations", "folders", "ui"}


def is_drawn(place: str) -> bool:
    return place not in ON_THE_GROUND and (ENGINE / place).is_dir()


def test_contributing_shows_the_packages_as_they_are() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert f"```text\n{picture()}\n```" in text
