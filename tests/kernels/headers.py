"""The headers of the kernels that are made from Python: records and numbers that both sides must agree on.

``python -m tests.kernels.headers`` writes them; a test compares.
"""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path

from synth.bounds import kernel_boxes
from synth.bounds.box_batches import INPUT_ARRAYS, NUMBERS, OUTPUT_ARRAYS, SCORE_WIDTH
from synth.bounds.instructions import OP_NAMES, WIDTH, labels
from synth.model.program import OPERATIONS
from synth.nlp import interior_point, kernel_solver
from synth.nlp.settings import InteriorPointSettings
from synth.operations.enclosures import CANCELLATION

FOLDER = Path(__file__).parents[2] / "synth" / "kernels" / "c"
ENDS = ("CONVERGED", "INFEASIBLE", "STUCK", "STOPPED")
MADE = "/* Made by `make kernels`; edits are lost. */"


def headers() -> dict[str, str]:
    """Name of each header -> its text."""
    bodies = {"box_record.h": box_record(), "solver_record.h": solver_record()}
    return {name: "\n".join([MADE, *lines]) + "\n" for name, lines in bodies.items()}


def box_record() -> list[str]:
    """Record of a batch, sizes and numbers."""
    numbers = {
        "WIDTH": WIDTH,
        **{f"MOST_{name}": most for name, most in kernel_boxes.MOST.items()},
        "SCORE_WIDTH": SCORE_WIDTH,
        "CANCELLATION": CANCELLATION,
        "PI": math.pi,
        "TWO_PI": 2 * math.pi,
    }
    named = ", ".join(f"&&L_{name}" for name in labels())
    defined = [*(f"#define {name} {value!r}" for name, value in numbers.items()), f"#define LABELS {named}"]
    return [*defined, structure_source()]


def structure_source() -> str:
    """Record of a batch, as a structure in C."""
    lines = [f"    {kind} {name};" for name, kind in NUMBERS.items()]
    lines += [f"    const {kind} *{name};" for name, kind in INPUT_ARRAYS.items()]
    lines += [f"    {kind} *{name};" for name, kind in OUTPUT_ARRAYS.items()]
    return "\n".join(["typedef struct {", *lines, "} Batch;"])


def solver_record() -> list[str]:
    """Sizes, numbers of operations and others, and where the settings of the method stand."""
    numbers = {
        "WIDTH": kernel_solver.WIDTH,
        **{f"MOST_{name}": most for name, most in kernel_solver.MOST.items()},
        **{name: getattr(interior_point, name) for name in ENDS},
        **{f"OP_{name}": op for op, name in OP_NAMES.items() if op in OPERATIONS},
    }
    lines = [f"#define {name} {value}" for name, value in numbers.items()]
    for k, field in enumerate(fields(InteriorPointSettings)):
        whole = "(long long)" if field.type == "int" else ""
        lines.append(f"#define {field.name.upper()} ({whole}shape->method[{k}])")
    return lines


if __name__ == "__main__":
    for name, text in headers().items():
        (FOLDER / name).write_text(text, encoding="utf-8", newline="\n")
