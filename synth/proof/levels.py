"""Regions proven all at once or level by level, whichever ends.

A region is a level: what lies below a design in one objective, asked for what is better in the others. All regions as
one tree are cheap where boxes soon lie beyond every region. Where they do not, guided trees go on beside it, which are
split where the limits that hold designs in their place are spread: one for each end of the front, where other limits
count than between, and one for all other regions. What is proven of a region stays when another one stays open.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from synth.proof.questions import Point, ProofOutcome
from synth.proof.tree import ProofGrowth, ProofTree


def prove_regions(
    at_once: ProofTree,
    guided: Callable[[], ProofTree],
    ends: np.ndarray,
    near: Sequence[Sequence[Point]],
    confirm: Callable[[Point], bool],
    deadline: float,
) -> ProofOutcome:
    """Prove that no feasible design lies in any region, by turns all at once and by levels.

    Parameters
    ----------
    at_once : ProofTree
    guided : callable
        Returns the guided tree of the same question; asked for where it is needed.
    ends : array (regions, objectives)
        See ``ProofTree.prove``.
    near : list of list of Point
        Per region: the designs next to it, in whose place the limits are looked at.
    confirm : callable
        Takes a design that may refute the claim and tells whether it does.
    deadline : float
        On the clock of ``time.monotonic``.
    """
    limits = at_once.limits
    every = at_once.growth(ends, confirm)
    every.go_on(limits.at_once + limits.at_once_each * len(ends), deadline)
    levels = ends_and_others(ends) if every.under_way else []
    each = [guided().growth(ends[group], confirm, [near[k] for k in group]) for group in levels]
    turn = limits.turn
    while (growing := _growing(every, each)) and time.monotonic() <= deadline:
        if every.nodes + sum(one.nodes for one in each) > limits.most_nodes:
            break
        share = limits.behind if any(one.under_way for one in each) else 1.0
        for one in growing:
            if _growing(every, each):
                one.go_on(turn * (share if one is every else 1.0), deadline)
        turn *= 2
    nodes = every.nodes + sum(one.nodes for one in each)
    witness = next((one.witness for one in (*each, every) if one.witness is not None), None)
    unproven = {int(group[k]) for group, one in zip(levels, each, strict=True) for k in one.open_regions}
    unproven = (unproven if levels else set(range(len(ends)))) & every.open_regions
    return ProofOutcome(witness is None and not unproven, nodes, witness, tuple(sorted(unproven)))


def ends_and_others(ends: np.ndarray) -> list[list[int]]:
    """Regions in groups: each extreme point of an objective by itself, then all others.

    Examples
    --------
    >>> ends_and_others(np.array([[2.0, 2.0], [1.0, 9.0], [3.0, 1.5], [9.0, 1.0]]))
    [[1], [3], [0, 2]]
    """
    extreme = sorted({int(k) for k in np.argmin(ends, axis=0)})
    others = [k for k in range(len(ends)) if k not in extreme]
    return [*([k] for k in extreme), *([others] if others else [])]


def _growing(every: ProofGrowth, each: Sequence[ProofGrowth]) -> list[ProofGrowth]:
    """Return the proofs that may still tell something; none where it is told already."""
    if every.closed or any(one.witness is not None for one in (*each, every)):
        return []
    if each and all(one.closed for one in each):
        return []
    return [one for one in (*each, every) if one.under_way]
