"""Generated code that tightens many boxes at once: forward-backward interval propagation as straight-line NumPy.

A box is a range per variable and a cluster of rows per slot (a count or choice is a slot with one column).
The program of a problem is read once: what depends on requirements only is a constant of the question, what
depends on a single slot is tabulated per cluster, and the rest becomes two arrays per node. Signs that hold
over the whole question are settled when the code is written, so that a product of positive nodes is two
multiplications and no test. Not-a-number stands for "nothing known" and never excludes a box.

The rules are written once, as statements whose expressions read the same in Python and in C; the Python is made
here; :mod:`synth.bounds.box_instructions` makes the list that the kernel reads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from synth.bounds.numpy_code import python_function, python_text
from synth.bounds.propagated_nodes import PropagatedNodes
from synth.bounds.root_propagation import Root
from synth.bounds.statements import SweepStatements
from synth.bounds.sweep_writer import SweepWriter


@dataclass
class Code:
    """The generated code of one sign pattern.

    ``kernel`` is the kernel with its instructions, kept here by who makes it.
    """

    nodes: PropagatedNodes
    sweeps: SweepStatements
    kernel: Any = None
    _functions: dict[bytes, Callable[..., Any]] = field(default_factory=dict)

    def function(self, root: Root) -> Callable[..., Any]:
        """Return the code as a Python function; it holds those nodes alone of which the root tells more.

        Signs that hold over the root are settled in it: boxes of variables must lie within the root.
        """
        key = root.narrowed.tobytes()
        if key not in self._functions:
            text = python_text(self.sweeps, root.narrowed)
            self._functions[key] = python_function(text, self.nodes.program)
        return self._functions[key]


class Contractor:
    """Generated code for some limits and objectives of one program.

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
        """Return the generated code for the signs that hold over the question; written once per sign pattern.

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
            self._codes[key] = Code(self.nodes, SweepWriter(self.nodes, root, capped).sweeps)
        return self._codes[key]
