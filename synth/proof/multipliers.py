"""What holds a design in its place: which limits and objectives count near it, and the inner value they see.

All of this steers where boxes are split; it proves nothing, and whatever it says, what is proven holds.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np

from synth.model.program import OP_SPECIAL, Program
from synth.proof.interval_arithmetic import Pair
from synth.proof.tape import Ref, Tape
from synth.proof.tightening import ProofRow


def lifted_value(
    program: Program, goals: Sequence[int], certain: Mapping[int, Pair], moving: Set[int], void: Set[int]
) -> int | None:
    """Return the instruction that boxes had best carry along with ends of its own.

    A special function that an objective sees reads one number, a torque for instance, that many inputs make. Splitting
    that number says more of the objective than splitting any of them.

    Parameters
    ----------
    program : Program
    goals : list of int
        Instructions of the objectives.
    certain : mapping
        Ranges of instructions that every feasible design keeps.
    moving, void : set of int
        Inputs that move, and those that may be without a value: what they make need not exist.

    Returns
    -------
    int, optional
        None where there is no such number, or it is not surely positive.
    """
    nodes, inputs = program.nodes, {node: k for k, node in enumerate(program.input_nodes)}
    seen = {a for k in program.needed(goals) if nodes[k].op == OP_SPECIAL for a in nodes[k].args}
    readers = [set(nodes[k].args) & seen for k in program.needed(program.outputs) if nodes[k].op == OP_SPECIAL]
    for k, _ in Counter(a for read in readers for a in sorted(read)).most_common():
        made_of = {inputs[a] for a in program.needed([k]) if a in inputs}
        low, high = (float(end) for end in certain[k])
        if len(made_of & moving) > 1 and not made_of & void and 0 < low < high < np.inf:
            return k
    return None


class StraightRows:
    """Limits and objectives as straight as they nearly are in a small box.

    Parameters
    ----------
    tape : Tape
    rows : list of ProofRow
    handed : list of Ref
        What has to be known of boxes.
    width : int
        How many coordinates there are.
    """

    def __init__(self, tape: Tape, rows: Sequence[ProofRow], handed: Sequence[Ref], width: int) -> None:
        centers = [row.center if row.void is None else tape.where(row.void, -np.inf, row.center) for row in rows]
        self._at = [(i, k) for i, row in enumerate(rows) for k in row.slopes]
        slopes = [end for row in rows for pair in row.slopes.values() for end in pair]
        self._kernel = tape.kernel(handed, [*centers, *slopes])
        self._shape = len(rows), width

    def multipliers(self, box: Sequence[np.ndarray], halves: np.ndarray) -> np.ndarray:
        """Weights of the rows for which the largest row in a box is as small as it can be.

        They are the multipliers of that linear problem, which of the limits that do not touch are zero.

        Parameters
        ----------
        box : list of array (1,)
            What has to be known of the box.
        halves : array (coordinates,)
            Half of its width in each direction.
        """
        from scipy.optimize import linprog  # costly to import; few proofs need it

        outputs = [float(np.asarray(x).ravel()[0]) for x in self._kernel.run(box)]
        count, width = self._shape
        centers, slopes = np.minimum(outputs[:count], 0.0), np.zeros(self._shape)  # the design's offset counts as none
        for (i, k), low, high in zip(self._at, outputs[count::2], outputs[count + 1 :: 2], strict=True):
            slopes[i, k] = 0.5 * (low + high)
        with np.errstate(invalid="ignore"):
            across = slopes * halves  # where a design stands at an end of what a logarithm reaches nothing is told
        known = np.isfinite(centers) & np.isfinite(across).all(axis=1)
        result = np.zeros(count)
        if known.any():
            matrix = np.column_stack([across[known], -np.ones(np.count_nonzero(known))])
            ends: list[Any] = [*[(-1.0, 1.0)] * width, (None, None)]
            solved = linprog([*[0.0] * width, 1.0], matrix, -centers[known], bounds=ends)
            if solved.success:
                result[known] = np.abs(solved.ineqlin.marginals)
        return result
