"""What each node of a program is for the propagation of some limits and objectives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import Program

CONSTANT, TABLE, VARIABLE, INNER = range(4)


@dataclass(frozen=True)
class MovingInputs:
    """Which inputs of a program move, and with what.

    Parameters
    ----------
    n_variables : int
        The first inputs.
    factor_of : tuple of int
        Per data input: the number of the factor (slot, count or choice) it belongs to, -1 for constants.
    may_lack : tuple of int
        Data inputs that some rows have no value for: limits that read them are void there.
    """

    n_variables: int
    factor_of: tuple[int, ...]
    may_lack: tuple[int, ...] = ()


class PropagatedNodes:
    """The nodes of a program that some limits and objectives read.

    What depends on requirements only is a constant of the question, what depends on a single factor is tabulated per
    cluster, and the rest moves with boxes.

    Parameters
    ----------
    program : Program
    layout : MovingInputs
    constraints : list of NodeConstraint
        Limits; ``bound`` of a constant right side is handed over with each question.
    goals : list of Goal
    auxiliary : list of int
        Inner nodes whose ends belong to a box as those of a variable do: they are handed over, met with what the
        arguments say, and handed back.

    Attributes
    ----------
    order : list of int
        All that are read, arguments first.
    kind, factor : list of int
        Per node of the program: ``CONSTANT``, ``TABLE``, ``VARIABLE`` or ``INNER``, and for tables the factor.
    sizes : list of bool
        Per node of the program: whether it only tells how large a limit is, from which nothing follows.
    narrows : list of bool
        Per node of the program: whether anything may be concluded about it.
    tables, constants, inner, variables : list of int
        Those of each kind, as far as propagation meets them.
    """

    def __init__(
        self,
        program: Program,
        layout: MovingInputs,
        constraints: Sequence[NodeConstraint],
        goals: Sequence[Goal],
        auxiliary: Sequence[int] = (),
    ) -> None:
        self.program, self.layout, self.auxiliary = program, layout, tuple(auxiliary)
        self.constraints, self.goals = list(constraints), list(goals)
        targets = [k for c in constraints for k in c.nodes] + [g.node for g in goals]
        self.order = program.needed(targets) if targets else []
        compared = [k for c in constraints for k in (c.value, c.limit) if k is not None]
        shaping = set(program.needed([*compared, *(g.node for g in goals)])) if targets else set()
        self.sizes = [k not in shaping for k in range(len(program.nodes))]
        self.kind, self.factor = self._kinds()
        # What a limit says of a column that may lack a value holds only for rows that have one: it is read, never cut.
        lacking = [program.input_nodes[layout.n_variables + k] for k in layout.may_lack]
        untouchable = program.downstream(lacking)
        self.narrows = [
            kind != CONSTANT and not void and not size
            for kind, void, size in zip(self.kind, untouchable, self.sizes, strict=True)
        ]
        read = {a for k in self.order if self.kind[k] == INNER for a in program.nodes[k].args} | set(targets)
        self.tables = [k for k in self.order if self.kind[k] == TABLE and k in read]
        self.constants = [k for k in self.order if self.kind[k] == CONSTANT and k in read]
        self.inner = [k for k in self.order if self.kind[k] == INNER]
        self.variables = [k for k in self.order if self.kind[k] == VARIABLE]

    def position(self, variable: int) -> int:
        """Number of the variable of a node."""
        return int(self.program.nodes[variable].constant)

    def _kinds(self) -> tuple[list[int], list[int]]:
        """Return, per node, what it is and (for tables) of which factor."""
        n = self.layout.n_variables
        kinds, factors = list[int](), list[int]()
        for node in self.program.nodes:
            if node.op == ca.OP_CONST:
                kind, factor = CONSTANT, -1
            elif node.op == ca.OP_INPUT:
                position = int(node.constant)
                factor = -1 if position < n else self.layout.factor_of[position - n]
                kind = VARIABLE if position < n else CONSTANT if factor < 0 else TABLE
            else:
                below = {kinds[a] for a in node.args}
                owners = {factors[a] for a in node.args if kinds[a] == TABLE}
                factor = -1
                if below <= {CONSTANT}:
                    kind = CONSTANT
                elif below <= {CONSTANT, TABLE} and len(owners) == 1:
                    kind, factor = TABLE, owners.pop()
                else:
                    kind = INNER
            kinds.append(kind)
            factors.append(factor)
        return kinds, factors
