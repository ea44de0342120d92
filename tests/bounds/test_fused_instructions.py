"""Runs of instructions as one: recognised whatever the registers are, and nothing else is."""

from __future__ import annotations

import numpy as np

from synth.bounds.fused_instructions import REPEATED, RUNS, fused
from synth.bounds.instructions import WIDTH, Op, Row

END = (Op.END, *[0] * (WIDTH - 1))


def rows_of(op: Op, registers: dict[str, int]) -> list[Row]:
    """Instructions of a run, with registers for its letters."""
    return [(own, *(registers[x.rstrip("+")] + x.endswith("+") for x in text.split())) for own, text in RUNS[op].steps]


def test_each_run_becomes_one_instruction() -> None:
    rng = np.random.default_rng(1)
    for op, run in RUNS.items():
        letters = {x.rstrip("+") for _, registers in run.steps for x in registers.split()}
        registers = dict(zip(sorted(letters), (2 * rng.permutation(40)).tolist(), strict=False))
        rows = rows_of(op, registers)
        operands = [registers[x] for x in run.operands.split()]
        if op in REPEATED:
            operands = [1, *operands]
        expected = (op, registers["x"], *operands)
        expected = (*expected, *[0] * (WIDTH - len(expected)))
        assert fused([*rows, END]).tolist() == [list(expected), list(END)]
        for step in range(len(rows)):  # with another register anywhere it is another computation
            for place in range(2, len(run.steps[step][1].split()) + 1):
                other = [list(row) for row in rows]
                other[step][place] += 100
                found = fused([*(tuple(row) for row in other), END]).tolist()
                again = [row for row in found if row[0] == op and row[1] == registers["x"]]
                assert not again or tuple(again[0]) != expected


def test_nodes_side_by_side_are_put_in_order_at_once() -> None:
    found = fused([*((Op.IN_ORDER, target) for target in (4, 6, 8, 20, 22)), END])
    assert found[:, :3].tolist() == [[Op.IN_ORDER, 4, 3], [Op.IN_ORDER, 20, 2], list(END[:3])]
