"""Design synthesis: requirement in, ranked Pareto designs out.

>>> import synth
>>> "multi_plate_clutch" in synth.families()
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from synth.errors import InputError

if TYPE_CHECKING:
    from synth.analysis.calculation import calculation
    from synth.analysis.describe import describe
    from synth.analysis.drawing import draw
    from synth.analysis.evaluate import evaluate
    from synth.analysis.hooks import curves, second_opinion, simulate
    from synth.analysis.operating_state import state
    from synth.batches.batch import BatchResult, batch
    from synth.client.connection import connect
    from synth.kinds.run import run
    from synth.model.problem import DesignProblem
    from synth.model.registry import families, load
    from synth.results import Design, ParetoFront
    from synth.results.loading import load_front
    from synth.robust.rate import Ratings, rate
    from synth.search.improvement import improve
    from synth.search.synthesize import synthesize
    from synth.studies.families.compare import compare
    from synth.studies.families.comparison import Comparison, FamilyOutcome
    from synth.studies.infeasibility.explain import explain
    from synth.studies.infeasibility.explanation import Explanation, Relaxation
    from synth.studies.near_optimal import NearEquals, near_equals
    from synth.studies.prices.price_list import Price, Prices
    from synth.studies.prices.run import prices
    from synth.studies.whatif.run import whatif
    from synth.studies.whatif.study import Study
    from synth.variants.size_range import SizeRange, size_range
    from synth.verification.verify import verify

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
    "calculation",
    "compare",
    "connect",
    "curves",
    "describe",
    "draw",
    "evaluate",
    "explain",
    "families",
    "improve",
    "load",
    "load_front",
    "near_equals",
    "prices",
    "rate",
    "run",
    "second_opinion",
    "simulate",
    "size_range",
    "state",
    "synthesize",
    "verify",
    "whatif",
]

# CasADi and pandas are costly to import; the command line must answer --help without them.
_HOME = {
    "BatchResult": "synth.batches.batch",
    "Comparison": "synth.studies.families.comparison",
    "Design": "synth.results",
    "DesignProblem": "synth.model.problem",
    "Explanation": "synth.studies.infeasibility.explanation",
    "FamilyOutcome": "synth.studies.families.comparison",
    "NearEquals": "synth.studies.near_optimal",
    "ParetoFront": "synth.results",
    "Price": "synth.studies.prices.price_list",
    "Prices": "synth.studies.prices.price_list",
    "Ratings": "synth.robust.rate",
    "Relaxation": "synth.studies.infeasibility.explanation",
    "SizeRange": "synth.variants.size_range",
    "Study": "synth.studies.whatif.study",
    "batch": "synth.batches.batch",
    "calculation": "synth.analysis.calculation",
    "compare": "synth.studies.families.compare",
    "connect": "synth.client.connection",
    "curves": "synth.analysis.hooks",
    "describe": "synth.analysis.describe",
    "draw": "synth.analysis.drawing",
    "evaluate": "synth.analysis.evaluate",
    "explain": "synth.studies.infeasibility.explain",
    "explore": "synth.analysis.reporting",
    "families": "synth.model.registry",
    "improve": "synth.search.improvement",
    "load": "synth.model.registry",
    "load_front": "synth.results.loading",
    "near_equals": "synth.studies.near_optimal",
    "prices": "synth.studies.prices.run",
    "rate": "synth.robust.rate",
    "report": "synth.analysis.reporting",
    "run": "synth.kinds.run",
    "second_opinion": "synth.analysis.hooks",
    "simulate": "synth.analysis.hooks",
    "size_range": "synth.variants.size_range",
    "state": "synth.analysis.operating_state",
    "synthesize": "synth.search.synthesize",
    "verify": "synth.verification.verify",
    "whatif": "synth.studies.whatif.run",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'synth' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
