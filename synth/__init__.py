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
    from synth.comparing import compare
    from synth.comparison import Comparison, FamilyOutcome
    from synth.description import describe
    from synth.explanation import Explanation, Relaxation, explain
    from synth.hooks import curves, second_opinion, simulate
    from synth.improvement import improve
    from synth.jobs.run import BatchResult, batch
    from synth.loading import load_front
    from synth.near import NearEquals, near_equals
    from synth.operating_state import state
    from synth.price_list import Price, Prices
    from synth.pricing import prices
    from synth.problem import DesignProblem, families, load
    from synth.results import Design, ParetoFront
    from synth.robust import Ratings, rate
    from synth.search import synthesize
    from synth.study import Study
    from synth.variants.run import SizeRange, size_range
    from synth.what_if import whatif

__all__ = [
    "BatchResult",
    "Comparison",
    "Design",
    "DesignProblem",
    "Explanation",
    "FamilyOutcome",
    "InputError",
    "NearEquals",
    "ParetoFront",
    "Price",
    "Prices",
    "Ratings",
    "Relaxation",
    "SizeRange",
    "Study",
    "batch",
    "compare",
    "curves",
    "describe",
    "evaluate",
    "explain",
    "families",
    "improve",
    "load",
    "load_front",
    "near_equals",
    "prices",
    "rate",
    "second_opinion",
    "simulate",
    "size_range",
    "state",
    "synthesize",
    "whatif",
]

# CasADi and pandas are costly to import; the command line must answer --help without them.
_HOME = {
    "BatchResult": "synth.jobs.run",
    "Comparison": "synth.comparison",
    "Design": "synth.results",
    "DesignProblem": "synth.problem",
    "Explanation": "synth.explanation",
    "FamilyOutcome": "synth.comparison",
    "NearEquals": "synth.near",
    "ParetoFront": "synth.results",
    "Price": "synth.price_list",
    "Prices": "synth.price_list",
    "Ratings": "synth.robust",
    "Relaxation": "synth.explanation",
    "SizeRange": "synth.variants.run",
    "Study": "synth.study",
    "batch": "synth.jobs.run",
    "compare": "synth.comparing",
    "curves": "synth.hooks",
    "describe": "synth.description",
    "evaluate": "synth.analysis",
    "explain": "synth.explanation",
    "families": "synth.problem",
    "improve": "synth.improvement",
    "load": "synth.problem",
    "load_front": "synth.loading",
    "near_equals": "synth.near",
    "prices": "synth.pricing",
    "rate": "synth.robust",
    "second_opinion": "synth.hooks",
    "simulate": "synth.hooks",
    "size_range": "synth.variants.run",
    "state": "synth.operating_state",
    "synthesize": "synth.search",
    "whatif": "synth.what_if",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'synth' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
