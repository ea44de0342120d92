"""Rows of the continuous problem with their first and second derivatives, as instructions over arrays.

Limits and objectives of a program become rows ``F(y)``: the logarithm of value over limit where both are
positive, a scaled difference otherwise. Their Jacobian and the Hessian of a weighted sum of the rows are
derived once, and everything that depends on neither variables nor weights is set apart, so that it is
computed once per problem and not at every point.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from synth.model.program import OPERATIONS, Node, Program
from synth.nlp.differentiation import LOG, DerivativeSweeps, Graph, Rule, reached, with_shared_inverses
from synth.nlp.rows import Rows

# A lower limit of a positive quantity is continued linearly below this ratio of value to limit, far from where it
# holds: points beyond zero then know the way back.
SMALLEST_RATIO = 1e-3


class RowFunctions:
    """Rows of limits and objectives with derivatives, in the variables as the solver sees them.

    The inputs of the instructions are, in this order: variables y (logarithms where positive, otherwise over their
    scale), data, constant right sides, inverse row sizes, scales of the variables, weights of the rows in the Hessian.

    Parameters
    ----------
    program : Program
    n_variables : int
    rows : Rows
    edge : float
        By which share the edge of max and min is rounded off.

    Attributes
    ----------
    row, column : array of int
        Places of the structurally nonzero derivatives, column by column.
    hessian : list of (int, int)
        Places of the structurally nonzero second derivatives, lower triangle.
    stored : list of int
        Nodes that depend on neither y nor weights and that the others read.
    """

    def __init__(self, program: Program, n_variables: int, rows: Rows, edge: float = 0.0) -> None:
        self.n = n = n_variables
        self.edge = edge
        self.rows = rows
        self.n_constraints, self.n_goals = len(rows.constraints), len(rows.goals)
        self.n_rows = self.n_constraints + self.n_goals
        self.n_data = program.n_inputs - n
        y, scales = ca.SX.sym("y", n), ca.SX.sym("scales", n)
        data, bounds = ca.SX.sym("data", self.n_data), ca.SX.sym("bounds", self.n_constraints)
        sizes = ca.SX.sym("inverse_sizes", self.n_rows)
        variables = [ca.exp(y[i]) if rows.log_variables[i] else scales[i] * y[i] for i in range(n)]
        sides = self._sides(program, [*variables, *_scalars(data)], bounds, sizes)
        inputs = [s for group in (y, data, bounds, sizes, scales) for s in _scalars(group)]
        written = Program(inputs, sides)
        graph = Graph(n)
        sweeps = DerivativeSweeps(graph)
        forms = [self._form(sweeps, j, k) for j, k in enumerate(graph.take(written, written.outputs))]
        gradients = [sweeps.gradient(k) for k in forms]
        places = sorted((i, j) for j, gradient in enumerate(gradients) for i in gradient)
        self.row = np.array([j for _, j in places], dtype=np.int64)
        self.column = np.array([i for i, _ in places], dtype=np.int64)
        weights = [graph.node(ca.OP_INPUT, constant=float(len(inputs) + j)) for j in range(self.n_rows)]
        hessian = sweeps.hessian(list(zip(forms, weights, strict=True)))
        self.hessian = list(hessian)
        outputs = [*forms, *(gradients[j][i] for i, j in places), *hessian.values()]
        self.nodes, self.outputs = with_shared_inverses(graph, outputs)
        self.n_inputs = len(inputs) + self.n_rows
        self.moving = self._moving()
        order = reached(self.nodes, self.outputs)
        self.point_order = [k for k in order if self.moving[k]]
        read = {a for k in self.point_order for a in self.nodes[k].args} | set(self.outputs)
        self.stored = sorted(k for k in read if not self.moving[k] and self.nodes[k].op != ca.OP_CONST)
        self.fixed_order = [k for k in reached(self.nodes, self.stored) if self.nodes[k].op != ca.OP_CONST]

    def _sides(self, program: Program, inputs: Sequence[Any], bounds: ca.SX, sizes: ca.SX) -> list[Any]:
        """Kind of each row: value over limit, a scaled difference, or an objective."""
        rows = self.rows
        values: dict[int, Any] = {}
        moving = program.dependence(range(self.n))
        for k in program.needed(rows.nodes):
            node = program.nodes[k]
            if node.op == ca.OP_CONST:
                values[k] = ca.SX(node.constant)
            elif node.op == ca.OP_INPUT:
                values[k] = inputs[int(node.constant)]
            elif self.edge and moving[k] and node.op in (ca.OP_FMAX, ca.OP_FMIN):
                first, second = (values[a] for a in node.args)
                values[k] = _rounded_edge(node.op, first, second, self.edge)
            else:
                values[k] = program.apply(node, [values[a] for a in node.args])
        sides = []
        for j, constraint in enumerate(rows.constraints):
            limit = bounds[j] if constraint.limit is None else values[constraint.limit]
            value = values[constraint.value]
            sides.append(value / limit if rows.log_constraints[j] else (value - limit) * sizes[j])
        for j, goal in enumerate(rows.goals):
            sides.append(values[goal.node] if rows.log_goals[j] else values[goal.node] * sizes[self.n_constraints + j])
        return sides

    def _form(self, sweeps: DerivativeSweeps, j: int, side: int) -> int:
        """Return a row as a node."""
        graph, rows = sweeps.graph, self.rows
        if j >= self.n_constraints:
            log, sign = rows.log_goals[j - self.n_constraints], rows.goals[j - self.n_constraints].sign
        else:
            log, sign = rows.log_constraints[j], -1 if rows.constraints[j].sense == "at_least" else 1
        if log and sign < 0 and j < self.n_constraints:
            return _continued_logarithm(sweeps, side)
        form = graph.node(ca.OP_LOG, side) if log else side
        return graph.negative(form) if sign < 0 else form

    def input_number(self, group: str, k: int) -> int:
        """Return the number of one input: group y, data, bounds, sizes, scales or weights."""
        lengths = {
            "y": self.n,
            "data": self.n_data,
            "bounds": self.n_constraints,
            "sizes": self.n_rows,
            "scales": self.n,
            "weights": self.n_rows,
        }
        first = 0
        for name, length in lengths.items():
            if name == group:
                return first + k
            first += length
        raise KeyError(group)

    def _moving(self) -> list[bool]:
        first = self.input_number("weights", 0)
        moving: list[bool] = []
        for node in self.nodes:
            if node.op == ca.OP_INPUT:
                moving.append(node.constant < self.n or node.constant >= first)
            else:
                moving.append(any(moving[a] for a in node.args))
        return moving

    # -- NumPy ---------------------------------------------------------------------------------

    def compile_stored(self) -> Callable[[Sequence[Any]], list[Any]]:
        """Return a function of all inputs but y and weights (their places are not read) that gives the stored nodes."""
        names = {k: f"inputs[{int(self.nodes[k].constant)}]" for k in self.fixed_order if _is_input(self.nodes[k])}
        code = _numpy_code(self.nodes, self.fixed_order, self.stored, names)
        return _function("def evaluate(inputs):", code)

    def compile_point(self, curved: bool = True) -> Callable[[Sequence[Any], Sequence[Any], Sequence[Any]], list[Any]]:
        """Return a function of y, weights and stored nodes that gives rows, derivatives and second derivatives.

        Without the latter weights are not read.
        """
        first = self.input_number("weights", 0)
        outputs = self.outputs if curved else self.outputs[: self.n_rows + len(self.row)]
        order = self.point_order if curved else [k for k in reached(self.nodes, outputs) if self.moving[k]]
        names = {k: f"stored[{position}]" for position, k in enumerate(self.stored)}
        for k in order:
            if _is_input(self.nodes[k]):
                number = int(self.nodes[k].constant)
                names[k] = f"y[{number}]" if number < self.n else f"weights[{number - first}]"
        code = _numpy_code(self.nodes, order, outputs, names)
        return _function("def evaluate(y, weights, stored):", code)


def _continued_logarithm(sweeps: DerivativeSweeps, ratio: int) -> int:
    """Return minus the logarithm of a ratio, continued linearly below a small one."""
    graph = sweeps.graph
    edge, zero = graph.constant(SMALLEST_RATIO), graph.constant(0.0)
    usual = graph.node(ca.OP_LT, edge, ratio)
    share = graph.times(ratio, graph.constant(1 / SMALLEST_RATIO))
    smooth = graph.node(ca.OP_LOG, graph.node(ca.OP_FMAX, ratio, edge))
    straight = graph.add(share, graph.constant(np.log(SMALLEST_RATIO) - 1))
    form = graph.negative(graph.choice(usual, smooth, straight))
    # By the logarithm of the ratio the first derivative is 1 or the share, the second 0 or the share.
    first = graph.negative(graph.choice(usual, graph.constant(1.0), share))
    second = graph.negative(graph.choice(usual, zero, share))
    sweeps.define(form, Rule([((LOG, ratio), first)], [(second, sweeps.log_gradient(ratio), None)]))
    return form


def _rounded_edge(op: int, a: ca.SX, b: ca.SX, edge: float) -> Any:
    """Return the larger or smaller of two with a round edge: where both are equal, Newton steps need a curvature."""
    apart = ca.sqrt((a - b) ** 2 + edge**2 * (a**2 + b**2))
    return 0.5 * (a + b + (apart if op == ca.OP_FMAX else -apart))


def _scalars(vector: ca.SX) -> list[Any]:
    return [vector[k] for k in range(vector.shape[0])]


def _is_input(node: Node) -> bool:
    return bool(node.op == ca.OP_INPUT)


def _numpy_code(
    nodes: Sequence[Node], order: Sequence[int], outputs: Sequence[int], names: dict[int, str]
) -> list[str]:
    """Lines that compute the outputs from named nodes; constants are written out."""
    last_use = {a: k for k in order for a in nodes[k].args}
    last_use.update(dict.fromkeys(outputs, len(nodes)))
    names = dict(names)
    register: dict[int, int] = {}
    free: list[int] = []
    lines: list[str] = []

    def name(k: int) -> str:
        constant = nodes[k].constant
        if nodes[k].op != ca.OP_CONST:
            return names[k]
        return f"({constant!r})" if np.isfinite(constant) else f"float('{constant}')"

    for k in order:
        if k in names or nodes[k].op == ca.OP_CONST:
            continue
        code = OPERATIONS[nodes[k].op].numeric.format(*(name(a) for a in nodes[k].args))
        # Registers are handed on as soon as their last reader is done: what is in use stays in the cache.
        free += [register.pop(a) for a in dict.fromkeys(nodes[k].args) if a in register and last_use[a] == k]
        slot = free.pop() if free else len(register)
        register[k] = slot
        names[k] = f"r{slot}"
        lines.append(f"    r{slot} = {code}")
    lines.append("    return [" + ", ".join(name(k) for k in outputs) + "]")
    return lines


def _function(head: str, lines: Sequence[str]) -> Callable[..., list[Any]]:
    scope: dict[str, Any] = {"np": np}
    if any("erf(" in line for line in lines):
        from scipy.special import erf  # costly to import; few formulas name it

        scope["erf"] = erf
    exec(compile("\n".join([head, *lines]), "<generated from the trace>", "exec"), scope)
    return scope["evaluate"]  # type: ignore[no-any-return]
