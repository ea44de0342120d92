"""Layers of the engine: who may import whom, read from all imports, those of types and inside functions included."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
ENGINE = ROOT / "synth"

# From the ground up; each place, a package or a module, may import what stands in lines before its own.
LAYERS = (
    ("special", "margins", "pareto", "feasibility", "interrupts", "deadline", "effort", "file_locks", "native_switch"),
    ("plain_text", "input_limits", "tuning", "proof_limits", "study_limits"),
    ("errors",),
    ("files",),
    ("output_folder",),
    ("units",),
    ("results", "tables"),
    ("declaration",),
    ("model",),
    ("question",),
    ("compiled",),
    ("proof", "bounds", "nlp"),
    ("robust",),
    ("analysis",),
    ("search",),
    ("parametric", "verification"),
    ("studies",),
    ("jobs",),
    ("variants",),
    ("terminal",),
    ("__init__",),
)
LEVELS = {place: level for level, places in enumerate(LAYERS) for place in places}

# Where modules belong that still lie side by side.
FLAT: dict[str, str] = {
    "assembly": "results",
    "batch_nlp": "nlp",
    "best_first": "search",
    "breaks": "studies",
    "choice_commands": "terminal",
    "choice_console": "terminal",
    "cli": "terminal",
    "clock": "search",
    "clusters": "bounds",
    "combinations": "question",
    "comparing": "studies",
    "comparison": "studies",
    "compilation": "compiled",
    "conditions": "tables",
    "conflicts": "search",
    "console": "terminal",
    "contractor": "bounds",
    "count_domain": "question",
    "cover": "search",
    "derivatives": "nlp",
    "description": "analysis",
    "dives": "search",
    "elasticity": "search",
    "enclosure": "proof",
    "explanation": "studies",
    "fingerprint": "results",
    "fired_guards": "analysis",
    "formulation": "search",
    "front_record": "results",
    "given": "terminal",
    "hooks": "analysis",
    "improvement": "search",
    "inputs": "question",
    "instance": "question",
    "interior_point": "nlp",
    "intervals": "bounds",
    "lanes": "nlp",
    "loading": "results",
    "native": "nlp",
    "native_boxes": "bounds",
    "native_general": "nlp",
    "native_rules": "bounds",
    "native_source": "nlp",
    "native_templates": "nlp",
    "native_tree": "bounds",
    "near": "studies",
    "operating_state": "analysis",
    "outer": "search",
    "pieces": "nlp",
    "posed": "robust",
    "price_list": "studies",
    "pricing": "studies",
    "problem": "model",
    "program": "model",
    "prooftree": "proof",
    "propagation": "bounds",
    "proven_gap": "search",
    "purposes": "search",
    "question": "analysis",
    "rated": "results",
    "rating": "robust",
    "recall": "search",
    "refused_cells": "search",
    "request": "question",
    "relaxation": "studies",
    "resolution": "search",
    "resolve": "studies",
    "robust_commands": "terminal",
    "robust_console": "terminal",
    "scatter": "robust",
    "search_range": "question",
    "search_settings": "question",
    "seeker": "search",
    "settle": "search",
    "sheet": "studies",
    "slot_comparison": "model",
    "spec": "question",
    "spec_keys": "question",
    "spec_patch": "question",
    "statistics": "results",
    "steps": "search",
    "structure": "bounds",
    "study": "studies",
    "study_commands": "terminal",
    "study_console": "terminal",
    "study_questions": "studies",
    "study_store": "studies",
    "sweeps": "nlp",
    "tape": "proof",
    "terminal_options": "terminal",
    "told": "results",
    "together": "parametric",
    "together_fronts": "parametric",
    "together_look": "parametric",
    "together_search": "parametric",
    "uncertainty": "question",
    "vary": "studies",
    "verification": "results",
    "verify": "verification",
    "verify_comparison": "verification",
    "what_if": "studies",
}
# What may not be and is nevertheless.
EXCEPTIONS: set[tuple[str, str]] = {
    ("synth.analysis", "synth.formulation"),
    ("synth.jobs.commands", "synth.terminal"),
    ("synth.jobs.commands", "synth.terminal_options"),
    ("synth.jobs.console", "synth.console"),
    ("synth.jobs.console", "synth.terminal"),
    ("synth.native_boxes", "synth.native"),
    ("synth.native_boxes", "synth.native_source"),
    ("synth.nlp", "synth.intervals"),
    ("synth.pieces", "synth.intervals"),
    ("synth.posed", "synth.description"),
    ("synth.propagation", "synth.native"),
    ("synth.results", "synth.resolution"),
    ("synth.results", "synth.verify"),
    ("synth.study", "synth.terminal"),
    ("synth.variants.commands", "synth.terminal"),
    ("synth.variants.commands", "synth.terminal_options"),
    ("synth.variants.console", "synth.console"),
}


@cache
def modules() -> dict[str, Path]:
    """Return all modules of the engine by dotted name; migrations are run by their own tool."""
    found = {}
    for path in ENGINE.rglob("*.py"):
        steps = path.relative_to(ROOT).with_suffix("").parts
        if "migrations" not in steps:
            found[".".join(steps[:-1] if steps[-1] == "__init__" and len(steps) > 2 else steps)] = path
    return found


def imports(text: str, known: set[str]) -> set[str]:
    """Return the modules that a source text imports, wherever the import stands."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    found = set()
    for name in names:
        steps = name.split(".")
        found |= {next((m for k in range(len(steps), 0, -1) if (m := ".".join(steps[:k])) in known), "")}
    return found - {""}


def place_of(module: str) -> str:
    """Return the place that a module belongs to."""
    steps = module.split(".")
    return FLAT.get(steps[1], steps[1]) if len(steps) == 2 else steps[1]


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
    )
    assert imports(text, {"synth.a", "synth.a.b", "synth.d", "synth.g"}) == {
        "synth.a", "synth.a.b", "synth.d", "synth.g",
    }  # fmt: skip


def test_every_place_has_a_level_and_every_level_a_place() -> None:
    found = {place_of(module) for module in modules()}
    assert found == set(LEVELS)


def test_only_results_ask_the_facade() -> None:
    asking = {
        place_of(module)
        for module, path in modules().items()
        if "import synth" in map(str.strip, path.read_text().split("\n"))
    }
    assert asking <= {"results"}  # a method of a front that needs what stands above results


def test_imports_point_one_way() -> None:
    wrong = {pair for ends, pairs in arrows().items() if LEVELS[ends[1]] >= LEVELS[ends[0]] for pair in pairs}
    assert wrong == EXCEPTIONS
