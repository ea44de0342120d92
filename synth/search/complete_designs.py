"""The designs that a search has found, as records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from synth.analysis.designs import design_of, design_records, lookup_rows
from synth.model.model import Evaluation
from synth.question.selection import part_row
from synth.results import Design, Frame, PartRow
from synth.results.design import DesignSteps

if TYPE_CHECKING:
    from synth.search.archive import Candidate
    from synth.search.formulation import Formulation


def complete_designs(
    form: Formulation,
    frames: Sequence[Frame],
    candidates: Sequence[Candidate],
    result: Evaluation,
    more: Sequence[Mapping[str, object]],
) -> list[Design]:
    """Return the designs that a search has found, with what it knows of them.

    Parameters
    ----------
    frames : list of Frame
        One per candidate.
    candidates : list of Candidate
    result : Evaluation
        Of the candidates.
    more : list of mapping
        Fields of Design, as for make_design.
    """
    points = np.array([c.variables for c in candidates]).reshape(len(candidates), form.n)
    # Questions that are searched together have their model and limits in common.
    calculated = design_records(form.instance, result, points, range(len(candidates)))
    known: dict[tuple[str, int], PartRow] = {}
    data = form.instance.data(np.array([c.combination for c in candidates], dtype=np.int64))
    derived = [
        {"steps": DesignSteps(steps), "next_rows": rows, "rows": lookup_rows(form.model, rows)}
        for steps, rows in zip(form.model.steps(points, data), form.model.next_rows(points, data), strict=True)
    ]
    designs = []
    for frame, candidate, point, unsearched, extra in zip(frames, candidates, calculated, derived, more, strict=True):
        parts, _, choices = form.instance.combinations.describe(candidate.combination)
        for slot, (table, number) in parts.items():
            if (slot, number) not in known:
                known[slot, number] = part_row(table, number)
        rows = {slot: known[slot, number] for slot, (_, number) in parts.items()}
        designs.append(design_of(frame, point, rows, choices, {**unsearched, **extra}))
    return designs
