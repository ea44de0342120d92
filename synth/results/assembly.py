"""How a front is put together: designs in order of rank, what its status is, and what its search tells in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from synth.order.feasibility import Status
from synth.order.pareto import LISTED, Scale, merged, rank, senses_of
from synth.results.certificate import Certificate
from synth.results.design import Design, Frame
from synth.results.front import ParetoFront
from synth.results.least_infeasible import LeastInfeasible
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics


def ranked(
    designs: Sequence[Design],
    objectives: Mapping[str, str],
    weights: Sequence[float],
    complete: bool = False,
    scale: Scale | None = None,
) -> tuple[list[int], list[Design]]:
    """Return designs in order of rank, with rank, score, note and group.

    Parameters
    ----------
    designs : list of Design
    objectives : mapping
        Names and senses.
    weights : list of float
        One per objective.
    complete : bool
        Whether there are no other non-dominated designs.
    scale : Scale, optional
        Of the whole front; by default that of the designs.

    Returns
    -------
    tuple
        The positions that the designs had, and the designs.
    """
    if not designs:
        return [], []
    values = _objectives(designs, objectives)
    ranking = rank(objectives, values, weights, complete, scale)
    kinds = [_kind(designs[k]) for k in ranking.order]
    groups = merged(values[ranking.order], kinds, range(len(designs)), LISTED.merge_within)
    leaders = {k: group[0] + 1 for group in groups for k in group[1:]}
    return ranking.order, [
        replace(designs[k], rank=j + 1, score=float(ranking.scores[k]), note=ranking.notes[k], group=leaders.get(j))
        for j, k in enumerate(ranking.order)
    ]


def _kind(design: Design) -> tuple[object, ...]:
    """Family, options, parts, counts and choices of a design."""
    counts = [design.values[name] for name, kind in design.frame.kinds.items() if kind == "count"]
    frame, parts = design.frame, {slot: row.key for slot, row in design.parts.items()}
    return frame.family, dict(frame.options), parts, counts, dict(design.choices)


def scale_of(designs: Sequence[Design], objectives: Mapping[str, str], scale: Scale | None = None) -> Scale | None:
    """Scale by which designs are ranked; None where there is nothing to measure.

    ``scale``: of the whole front, where that is known.
    """
    if not designs or len(objectives) < 2:
        return None
    signed = _objectives(designs, objectives) * senses_of(objectives)
    return Scale.of(signed) if scale is None else scale.begun_at(signed)


def _objectives(designs: Sequence[Design], objectives: Mapping[str, str]) -> np.ndarray:
    return np.array([[d.values[n] for n in objectives] for d in designs])


def without_design(certificate: Certificate, interrupted: str) -> Status:
    """Status of a front without designs: infeasible only where that is proven."""
    if certificate.kind == "global":
        return Status.INFEASIBLE
    return Status.NOT_SOLVED if interrupted else Status.NOT_FOUND


def front_of(
    question: object,
    frame: Frame,
    designs: Sequence[Design],
    certificate: Certificate,
    statistics: SearchStatistics,
    settings: SettingsRecord,
    *,
    complete: bool,
    explanation: LeastInfeasible | None = None,
    interrupted: str = "",
    scale: Scale | None = None,
) -> ParetoFront:
    """Return the front of a question that was searched; its status follows from designs and certificate.

    Parameters
    ----------
    question : Instance
    frame : Frame
    designs : list of Design
        In order of rank.
    certificate : Certificate
    statistics : SearchStatistics
    settings : SettingsRecord
        As they were asked for.
    complete : bool
        Whether all non-dominated designs are listed.
    explanation : LeastInfeasible, optional
        Why there is no design.
    interrupted : str
        What stopped the search; nothing where it was finished.
    scale : Scale, optional
        What the designs are measured by; by default what they tell themselves.
    """
    if designs:
        status = Status.OPTIMAL if certificate.kind == "global" else Status.FEASIBLE
    else:
        status = without_design(certificate, interrupted)
    return ParetoFront(
        frame=frame,
        designs=list(designs),
        status=status,
        complete=complete and not interrupted,
        statistics=statistics,
        certificate=certificate,
        explanation=explanation,
        settings=settings,
        interrupted=interrupted,
        question=question,
        scale=scale_of(designs, frame.objectives, scale),
    )
