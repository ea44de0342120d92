"""Results of a unit of rows: answers to keep, errors to retry, and questions that leave their group."""

from __future__ import annotations

from collections.abc import Mapping

from synth.batches.entries import RowAnswer
from synth.batches.solve import UNGROUPED
from synth.batches.store import Outcome


def sorted_out(results: Mapping[str, RowAnswer]) -> tuple[dict[str, Outcome], dict[str, str], dict[str, str]]:
    """Answers, errors, and reasons to leave the group, of what ``solve_unit`` returns; by question."""
    outcomes: dict[str, Outcome] = {}
    errors: dict[str, str] = {}
    ungrouped: dict[str, str] = {}
    for key, answer in results.items():
        if "error" in answer:
            errors[key] = answer["error"]
        elif UNGROUPED in answer:
            ungrouped[key] = answer[UNGROUPED]
        else:
            outcomes[key] = Outcome(answer["status"], answer["seconds"], answer["layout"], answer["content"])
    return outcomes, errors, ungrouped
