"""Units that fail in the ways that real ones do; worker processes import them by name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from synth.batches.solve import solve_unit

DEADLY, FAULTY = "13 kN", "14 kN"


def deadly_unit(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Die on one force, fail on another, and solve the rest."""
    forces = {key: question["requirements"]["force"] for key, question in work["questions"].items()}
    if DEADLY in forces.values():
        os._exit(9)
    return faulty_unit(work)


def faulty_unit(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Fail on one force, and solve the rest."""
    good = {k: q for k, q in work["questions"].items() if q["requirements"]["force"] != FAULTY}
    found = solve_unit({**work, "questions": good})
    return found | {k: {"error": "ZeroDivisionError: division by zero"} for k in work["questions"] if k not in good}
