"""The ranking of a front read again: what its designs are measured by, their scores, their order and their notes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from synth.proof.settings import ProofLimits
from synth.text.numbers import typed_number

if TYPE_CHECKING:
    from synth.results import ParetoFront

DEARLY = ", whose last 0.5 % costs much"


def ranking_faults(front: ParetoFront, signed: np.ndarray, limits: ProofLimits) -> Iterator[str]:
    """Yield what is wrong with the ranking: a weighted distance to the ideal in logarithms of objectives.

    Parameters
    ----------
    front : ParetoFront
        With designs.
    signed : array (designs, objectives)
        Their objectives in SI, with a sign that makes smaller ones better.
    limits : ProofLimits
    """
    designs = front.designs
    if [d.rank for d in designs] != list(range(1, len(designs) + 1)):
        yield "ranks are not 1, 2, 3, ... in the order of the designs"
    weights = front.settings.get("weights", {})
    shares = np.array([float(weights.get(name, 1.0)) for name in front.frame.objectives])
    low, high = signed.min(axis=0), signed.max(axis=0)
    if front.scale is not None:  # fronts of earlier versions were measured from their best to their worst
        yield from _scale_faults(front, signed, limits)
        high = front.scale.nadir
    span = high - low
    unit = np.where(span > 0, (signed - low) / np.where(span > 0, span, 1.0), 0.0)
    apart = unit if front.scale is None else _apart(signed, low, high, unit, limits)
    scores = np.sqrt((apart**2 * shares).sum(axis=1) / shares.sum())
    for design, score in zip(designs, scores, strict=True):
        if design.score is None or abs(design.score - score) > limits.same:
            yield f"design {design.rank}: score {design.score}, ranked again it is {score}"
    if np.any(np.diff(scores) < -limits.same):
        yield "the designs are not in the order of their scores"
    yield from _note_faults(front, signed, unit, limits)


def _apart(signed: np.ndarray, low: np.ndarray, high: np.ndarray, unit: np.ndarray, limits: ProofLimits) -> np.ndarray:
    """Distances from the best in each objective: by ratio, or ln 2 from end to end of a scale that has none."""
    smaller, larger = np.sort(np.abs([low, high]), axis=0)
    by_ratio = ((low > 0) | (high < 0)) & (smaller >= limits.least_ratio * larger)
    ratios = np.maximum(np.where(by_ratio, signed, 1.0) / np.where(by_ratio, low, 1.0), limits.least_ratio)
    return np.where(by_ratio, np.abs(np.log(ratios)), np.log(2.0) * unit)


def _scale_faults(front: ParetoFront, signed: np.ndarray, limits: ProofLimits) -> Iterator[str]:
    """Yield where the scale begins or ends elsewhere than the designs listed show.

    What an objective must cost at most, for another one to be nearly as good as it can be, is no more than it costs a
    design listed that is; and no less than what is nearly as good as its own best.
    """
    assert front.scale is not None
    low, high = signed.min(axis=0), signed.max(axis=0)
    worst = low.copy()
    for k in range(len(low)):
        worst = np.maximum(worst, signed[signed[:, k] <= low[k]].min(axis=0))
    near = low + limits.nearly * np.where(low > 0, low, worst - low)
    most = near.copy()
    for k in range(len(low)):
        most = np.maximum(most, signed[signed[:, k] <= near[k]].min(axis=0))
    reach = limits.same * np.maximum(np.abs(low), np.abs(high))
    for k, name in enumerate(front.frame.objectives):
        begin, end = float(front.scale.ideal[k]), float(front.scale.nadir[k])
        first, last = typed_number(abs(begin)), typed_number(abs(end))
        if not abs(begin - low[k]) <= reach[k]:
            yield f"scale of {name}: it begins at {first}, the best design listed has {typed_number(abs(low[k]))}"
        if not low[k] - reach[k] <= end <= most[k] + reach[k]:
            yield f"scale of {name}: it ends at {last}, the designs listed say {typed_number(abs(most[k]))} at most"


def _note_faults(front: ParetoFront, signed: np.ndarray, unit: np.ndarray, limits: ProofLimits) -> Iterator[str]:
    """Yield notes that stand at a design that does not deserve them, or at none or several."""
    designs, objectives = front.designs, front.frame.objectives
    all_notes = [[note for note in d.note.split("; ") if note] for d in designs]
    deserving: dict[str, np.ndarray] = {}
    low = signed.min(axis=0)
    reach = limits.same * np.maximum(np.abs(low), np.abs(signed.max(axis=0)))
    if len(designs) > 1:
        for k, (name, sense) in enumerate(objectives.items()):
            words = f"{'smallest' if sense == 'min' else 'largest'} {name}"
            dear = np.any(np.delete(unit, k, axis=1) > limits.costly, axis=1) & (front.scale is not None)
            dearly = any(words + DEARLY in notes for notes in all_notes)
            deserving[words + DEARLY * dearly] = (signed[:, k] <= low[k] + reach[k]) & (dear == dearly)
        if len(designs) > 2 and len(objectives) > 1:
            total = unit.sum(axis=1)
            deserving["knee"] = total <= total.min() + limits.same
    elif len(objectives) == 1:
        deserving["optimum"] = np.ones(1, dtype=bool)
    elif front.complete:
        deserving["only non-dominated design"] = np.ones(1, dtype=bool)
    for words, right in deserving.items():
        at = [k for k, notes in enumerate(all_notes) if words in notes]
        if len(at) != 1 or not right[at[0]]:
            yield f"the note {words!r} is not at the design that deserves it"
    for design, notes in zip(designs, all_notes, strict=True):
        if strange := [note for note in notes if note not in deserving]:
            yield f"design {design.rank}: note {strange[0]!r} means nothing here"
