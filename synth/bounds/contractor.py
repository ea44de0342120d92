"""Tightening of many boxes at once: forward-backward interval propagation as a list of instructions.

A box is a range per variable and a cluster of rows per slot (a count or choice is a slot with one column).
The program of a problem is read once: what depends on requirements only is a constant of the question, what
depends on a single slot is tabulated per cluster, and the rest becomes two registers per node. Signs that hold
over the whole question are settled when instructions are emitted, so that a product of positive nodes is two
multiplications and no test. Not-a-number stands for "nothing known" and never excludes a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from synth.bounds.array_reader import ArrayReader
from synth.bounds.box_emitter import BoxEmitter
from synth.bounds.instructions import InstructionList
from synth.bounds.propagated_nodes import PropagatedNodes
from synth.bounds.root_propagation import Root


@dataclass
class Code:
    """The instructions of one sign pattern, and who carries them out: arrays, and the kernel where there is one.

    ``kernel`` is kept here by who makes it.
    """

    nodes: PropagatedNodes
    instructions: InstructionList
    reader: ArrayReader
    kernel: Any = None


class Contractor:
    """Instructions for some limits and objectives of one program.

    Parameters
    ----------
    nodes : PropagatedNodes

    Attributes
    ----------
    tabulate, constant_values : callable
        Return the values of the tabulated and of the constant nodes for the inputs of the program.
    """

    def __init__(self, nodes: PropagatedNodes) -> None:
        self.nodes = nodes
        self.tabulate = nodes.program.compile(nodes.tables)
        self.constant_values = nodes.program.compile(nodes.constants)
        self._codes: dict[object, Code] = {}

    def code(self, root: Root, capped: bool) -> Code:
        """Instructions for the signs that hold over the question; emitted once per sign pattern.

        Parameters
        ----------
        root : Root
        capped : bool
            Whether objectives have cutoffs.
        """
        sides = [(k, c.scale) for c in self.nodes.constraints for k in (c.value, c.limit) if k is not None]
        large = tuple(bool(root.low[k] > scale) for k, scale in sides)
        key = (capped, (root.low > 0).tobytes(), (root.low >= 0).tobytes(), large)
        if key not in self._codes:
            instructions = BoxEmitter(self.nodes, root, capped).emitted()
            self._codes[key] = Code(self.nodes, instructions, ArrayReader(instructions))
        return self._codes[key]
