"""The headers of the kernels that are made from Python: operations, rules and records that both sides must agree on.

``python -m tests.kernels.headers`` writes them; a test compares.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import casadi as ca

from synth.bounds import box_instructions as lists
from synth.bounds import kernel_boxes
from synth.bounds.box_batches import GIVEN, NUMBERS, SCORE_WIDTH, TAKEN
from synth.bounds.intervals import CANCELLATION
from synth.kernels.expressions import EXPRESSIONS
from synth.model.program import COMPARISONS, OP_SELECT
from synth.nlp import interior_point, kernel_solver
from synth.tuning import InteriorPointSettings

FOLDER = Path(__file__).parents[2] / "synth" / "kernels" / "c"
ENDS = ("CONVERGED", "INFEASIBLE", "STUCK", "STOPPED")
MADE = "/* Made by `make kernels`; edits are lost. */"


def headers() -> dict[str, str]:
    """Name of each header -> its text."""
    bodies = {
        "box_record.h": box_record(),
        "box_rules.h": box_rules(),
        "box_cases.h": box_cases(),
        "solver_record.h": solver_record(),
        "solver_cases.h": solver_cases(),
    }
    return {name: "\n".join([MADE, *lines]) + "\n" for name, lines in bodies.items()}


def box_record() -> list[str]:
    """Record of a batch, sizes and numbers."""
    numbers = {
        "WIDTH": lists.WIDTH,
        **{f"MOST_{name}": most for name, most in kernel_boxes.MOST.items()},
        "SCORE_WIDTH": SCORE_WIDTH,
        "CANCELLATION": CANCELLATION,
        "PI": math.pi,
        "TWO_PI": 2 * math.pi,
    }
    labels = (f"&&L_{name if name in lists.BUILT_IN else k}" for name, k in lists.operations().items())
    defined = [*(f"#define {name} {value!r}" for name, value in numbers.items()), f"#define LABELS {', '.join(labels)}"]
    return [*defined, structure_source()]


def structure_source() -> str:
    """Record of a batch, as a structure in C."""
    lines = [f"    {kind} {name};" for name, kind in NUMBERS.items()]
    lines += [f"    const {kind} *{name};" for name, kind in GIVEN.items()]
    lines += [f"    {kind} *{name};" for name, kind in TAKEN.items()]
    return "\n".join(["typedef struct {", *lines, "} Batch;"])


def box_rules() -> list[str]:
    """Rules that are functions in C."""
    lines = []
    for name, body in lists.rule_functions():
        arguments = ", ".join(f"Interval {x}" for x in _letters(body))
        lines.append(f"static __attribute__((noinline)) Interval {name}({arguments}) {{ return {body}; }}")
    return lines


def _letters(body: str) -> Iterator[str]:
    return (x for x in "rabc" if re.search(rf"\b{x}\b", body))


def box_cases() -> list[str]:
    """What is done for each operation of the list of boxes but those that are written out by hand."""
    number, lines = lists.operations(), list[str]()

    def add(name: str, read: str, body: str) -> None:
        given = [f"*const {x} = f[code[{2 + k}]]" for k, x in enumerate(lists.LETTERS) if re.search(rf"\b{x}\b", read)]
        each = re.sub(rf"\b([{lists.LETTERS}]|target|target_1)\b", r"\1[w]", body)
        lines.append(f"L_{number[name]}: {{ const vd {', '.join(given)}; EACH_REGISTER {{ {each} }} NEXT; }}")

    for name, text in lists.forms().items():
        add(name, name, f"target = {text};")
    for text in ("a", *lists.MASKS):
        add(f"kill {text}", text, f"dead[w] |= {'(vi)a' if text == 'a' else text};")
    for how in lists.ENDS.values():
        for text in lists.TWICE:
            other = text.replace("b", "d").replace("a", "c")
            ends = (text, other) if how == "both ends" else (f"v_fmax(target, {text})", f"v_fmin(target_1, {other})")
            body = f"const vd low = {ends[0]}, high = {ends[1]}; target = low; target_1 = high;"
            add(f"{how} {text}", "a b c d", body)
    for name, body in lists.rule_functions():
        places = [2 + ("rabc" if name.startswith("backward") else "abc").index(x) for x in _letters(body)]
        pairs = ", ".join(f"both(f[code[{k}]][w], f[code[{k}] + 1][w])" for k in places)
        found = f"const Interval i = {name}({pairs}); target[w] = i.low; target_1[w] = i.high;"
        lines.append(f"L_{number[name]}: {{ EACH_REGISTER {{ {found} }} NEXT; }}")
    return lines


def solver_record() -> list[str]:
    """Sizes, numbers, and where the settings of the method stand."""
    numbers = {
        "WIDTH": kernel_solver.WIDTH,
        **{f"MOST_{name}": most for name, most in kernel_solver.MOST.items()},
        **{name: getattr(interior_point, name) for name in ENDS},
    }
    lines = [f"#define {name} {value}" for name, value in numbers.items()]
    for k, field in enumerate(fields(InteriorPointSettings)):
        whole = "(long long)" if field.type == "int" else ""
        lines.append(f"#define {field.name.upper()} ({whole}shape->method[{k}])")
    return lines


def solver_cases() -> list[str]:
    """What is done for each operation of the list of row functions."""
    code = {op: text.format("a", "b") for op, text in EXPRESSIONS.items()}
    code |= {op: f"keep({code[op]}, all(1.0))" for op in COMPARISONS if op in code}
    code |= {
        ca.OP_NOT: "keep(a == 0.0, all(1.0))",
        ca.OP_AND: "keep((a != 0.0) & (b != 0.0), all(1.0))",
        ca.OP_OR: "keep((a != 0.0) | (b != 0.0), all(1.0))",
        ca.OP_IF_ELSE_ZERO: "keep(a != 0.0, b)",
        OP_SELECT: "choose(a != 0.0, b, r[code[4]])",
    }
    return [f"case {op}: result = {text}; break;" for op, text in code.items()]


if __name__ == "__main__":
    for name, text in headers().items():
        (FOLDER / name).write_text(text, encoding="utf-8", newline="\n")
