"""Design synthesis: requirement in, ranked Pareto designs out.

>>> import synth
>>> "multi_plate_clutch" in synth.families()
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from synth.errors import InputError

if TYPE_CHECKING:
    from synth.analysis import evaluate
    from synth.description import describe
    from synth.hooks import curves, second_opinion, simulate
    from synth.problem import DesignProblem, families, load
    from synth.results import Design, ParetoFront, load_front
    from synth.search import synthesize

__all__ = [
    "Design",
    "DesignProblem",
    "InputError",
    "ParetoFront",
    "curves",
    "describe",
    "evaluate",
    "families",
    "load",
    "load_front",
    "second_opinion",
    "simulate",
    "synthesize",
]

# CasADi and pandas are costly to import; the command line must answer --help without them.
_HOME = {
    "Design": "synth.results",
    "DesignProblem": "synth.problem",
    "ParetoFront": "synth.results",
    "curves": "synth.hooks",
    "describe": "synth.description",
    "evaluate": "synth.analysis",
    "families": "synth.problem",
    "load": "synth.problem",
    "load_front": "synth.results",
    "second_opinion": "synth.hooks",
    "simulate": "synth.hooks",
    "synthesize": "synth.search",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'synth' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
