"""Warm start from designs of a similar question: solved again for this one, they are where a search begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.bounds.branching import BranchingStatistics
from synth.results import Design
from synth.search.formulation import Formulation
from synth.search.one_exchange import OneExchange
from synth.search.pruning import PruningRule
from synth.search.refused_cells import not_refused


@dataclass(frozen=True, kw_only=True)
class WarmStart:
    """What is known of similar questions: it tells where to look first, and proves nothing.

    Parameters
    ----------
    designs : list of Design
        Of a similar question.
    branching : BranchingStatistics, optional
        What its search has learned about splitting boxes.
    """

    designs: Sequence[Design] = ()
    branching: BranchingStatistics | None = None


def warm_start(form: Formulation, rule: PruningRule, designs: Sequence[Design], rng: np.random.Generator) -> bool:
    """Put designs of a similar question into the archive, as they are or solved again; tell whether any is feasible.

    Each goes straight up from the objectives it had: what the new question takes from it or gives to it, it loses or
    gains in all objectives alike.
    """
    names = [v.name for v in form.model.variables]
    rows = [(c, d) for d in designs if (c := form.instance.combinations.find(d)) is not None]
    combinations = np.array([c for c, _ in rows], dtype=np.int64)
    keep = not_refused(form.instance, combinations) if len(rows) else np.zeros(0, dtype=bool)
    points = np.array([[d.values.get(n, np.nan) for n in names] for _, d in rows]).reshape(len(rows), form.n)
    keep &= np.all(np.isfinite(points), axis=1)
    combinations, points = combinations[keep], np.clip(points[keep], form.lower, form.upper)
    if len(combinations):
        OneExchange(form, rule, rng).again(combinations, points)
    return bool(len(form.archive))
