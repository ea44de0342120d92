"""Runs of instructions as one: recognised whatever the registers are, and nothing else is."""

from __future__ import annotations

import numpy as np

from synth.bounds.box_instructions import WIDTH, operations
from synth.bounds.fused_instructions import REPEATED, RUNS, fused

NUMBER = operations()


def rows_of(name: str, registers: dict[str, int]) -> list[tuple[int, ...]]:
    """Instructions of a run, with registers for its letters."""
    rows = []
    for operation, letters in RUNS[name].steps:
        row = (NUMBER[operation], *(registers[x.rstrip("+")] + x.endswith("+") for x in letters.split()))
        rows.append((*row, *[0] * (WIDTH - len(row))))
    return rows


def test_each_run_becomes_one_instruction() -> None:
    rng, end = np.random.default_rng(1), (NUMBER["END"], *[0] * (WIDTH - 1))
    for name, run in RUNS.items():
        letters = {x.rstrip("+") for _, registers in run.steps for x in registers.split()}
        registers = dict(zip(sorted(letters), (2 * rng.permutation(40)).tolist(), strict=False))
        rows = rows_of(name, registers)
        operands = [registers[x] for x in run.operands.split()]
        if name in REPEATED:
            operands = [1, *operands]
        expected = (NUMBER[name], registers["x"], *operands)
        assert fused([*rows, end], NUMBER, WIDTH) == [(*expected, *[0] * (WIDTH - len(expected))), end]
        for step in range(len(rows)):  # with another register anywhere it is another computation
            for place in range(2, len(run.steps[step][1].split()) + 1):
                other = [list(row) for row in rows]
                other[step][place] += 100
                read = [tuple(row) for row in other]
                found = fused([*read, end], NUMBER, WIDTH)
                again = [row for row in found if row[0] == NUMBER[name] and row[1] == registers["x"]]
                assert not again or again[0] != (*expected, *[0] * (WIDTH - len(expected)))


def test_nodes_side_by_side_are_put_in_order_at_once() -> None:
    def order(*targets: int) -> list[tuple[int, ...]]:
        return [(NUMBER["IN_ORDER"], target, *[0] * (WIDTH - 2)) for target in targets]

    end = (NUMBER["END"], *[0] * (WIDTH - 1))
    found = fused([*order(4, 6, 8, 20, 22), end], NUMBER, WIDTH)
    assert [row[:3] for row in found] == [(NUMBER["IN_ORDER"], 4, 3), (NUMBER["IN_ORDER"], 20, 2), end[:3]]
