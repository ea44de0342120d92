"""What comes back from a unit of rows, sorted into what is kept, what is tried again and what is asked alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.batches.solve import ALONE
from synth.batches.store import Outcome


def sorted_out(found: Mapping[str, Mapping[str, Any]]) -> tuple[dict[str, Outcome], dict[str, str], dict[str, str]]:
    """Return the answers, errors, and reasons for asking alone, of what ``solve_unit`` returns; by question."""
    outcomes: dict[str, Outcome] = {}
    errors: dict[str, str] = {}
    alone: dict[str, str] = {}
    for key, answer in found.items():
        if "error" in answer:
            errors[key] = answer["error"]
        elif ALONE in answer:
            alone[key] = answer[ALONE]
        else:
            outcomes[key] = Outcome(answer["status"], answer["seconds"], answer["layout"], answer["content"])
    return outcomes, errors, alone
