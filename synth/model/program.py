"""The traced formulas as a list of instructions, and the NumPy code generated from it.

CasADi records what a family computes; here the record becomes a value-numbered list (each distinct
sub-expression once), which everything else reads: the batch evaluator below, the interval
propagation of the search, the splitting of min, max and where into smooth branches.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType
from typing import Any

import casadi as ca
import numpy as np

from synth.operations.record import Operation, Trait
from synth.operations.records import BY_NAME
from synth.special import SpecialCall

InputValue = float | np.ndarray  # of a program: one number for all designs of a batch, or one for each

OP_SELECT = -1
OP_SPECIAL = -2  # a special function; the constant of the node is its position in ``Program.specials``
NUMBERS = {name: OP_SELECT if name == "SELECT" else getattr(ca, f"OP_{name}") for name in BY_NAME}  # of operations
OPERATIONS: Mapping[int, Operation] = {NUMBERS[name]: operation for name, operation in BY_NAME.items()}
# The logarithm of the result is so many times that of the argument; twice something adds a constant.
EXPONENTS = {op: known.exponent for op, known in OPERATIONS.items() if known.exponent is not None}
TRAITS = {op: known.traits for op, known in OPERATIONS.items()} | {OP_SPECIAL: Trait.NEVER_NEGATIVE}
COMMUTATIVE = {op for op, traits in TRAITS.items() if Trait.COMMUTES in traits}
COMPARISONS = {op for op, traits in TRAITS.items() if Trait.TRUTH in traits}


class UnsupportedOperation(TypeError):
    """A formula uses an operation that cannot be evaluated over arrays."""


@lru_cache(maxsize=128)  # questions of one family have many programs in common
def _compiled(source: str) -> CodeType:
    return compile(source, "<generated from the trace>", "exec")


@dataclass(frozen=True)
class Node:
    """One instruction: its operation, the nodes it reads, and its constant or input number."""

    op: int
    args: tuple[int, ...]
    constant: float = 0.0


class Program:
    """A value-numbered instruction list with scalar inputs and outputs.

    Parameters
    ----------
    inputs : list of SX
        Scalar symbols, in the order in which values are handed over.
    outputs : list of SX
        Scalar expressions.
    calls : list of SpecialCall
        Special functions among the sub-expressions, which stay one instruction each.
    """

    def __init__(self, inputs: Sequence[Any], outputs: Sequence[Any], calls: Sequence[SpecialCall] = ()) -> None:
        self.n_inputs = len(inputs)
        self.nodes: list[Node] = []
        self._numbers: dict[tuple[int, tuple[int, ...], float], int] = {}
        self._dependent: dict[tuple[int, ...], np.ndarray] = {}
        self.input_nodes = [self.node(ca.OP_INPUT, (), float(k)) for k in range(self.n_inputs)]
        self.specials = list(dict.fromkeys(call.function for call in calls))
        symbols, numbers = list(inputs), list(self.input_nodes)
        for call in calls:
            args = self._read(symbols, numbers, call.arguments)
            position = float(self.specials.index(call.function))
            symbols.append(call.symbol)
            numbers.append(self.node(OP_SPECIAL, tuple(args), position))
        self.outputs = self._read(symbols, numbers, outputs)

    def node(self, op: int, args: tuple[int, ...], constant: float = 0.0) -> int:
        """Number of an instruction, which is added where the program lacks it.

        Parameters
        ----------
        op : int
            Of CasADi, or one of those of this module.
        args : tuple of int
            Nodes.
        constant : float
            Value of a constant in SI.
        """
        if op == ca.OP_ADD and (select := self._as_select(*args)):
            op, args = OP_SELECT, select
        # Operands stay as they are written, for people who read formulas; which comes first makes no other number.
        key = (op, tuple(sorted(args)) if op in COMMUTATIVE else args, constant)
        if key not in self._numbers:
            self._numbers[key] = len(self.nodes)
            self.nodes.append(Node(op, args, constant))
            self._dependent.clear()
        return self._numbers[key]

    def _as_select(self, first: int, second: int) -> tuple[int, int, int] | None:
        yes, no = self.nodes[first], self.nodes[second]
        if yes.op != ca.OP_IF_ELSE_ZERO or no.op != ca.OP_IF_ELSE_ZERO:
            return None
        if self.nodes[no.args[0]] == Node(ca.OP_NOT, (yes.args[0],)):
            return yes.args[0], yes.args[1], no.args[1]
        if self.nodes[yes.args[0]] == Node(ca.OP_NOT, (no.args[0],)):
            return no.args[0], no.args[1], yes.args[1]
        return None

    def _read(self, symbols: Sequence[Any], numbers: Sequence[int], expressions: Sequence[Any]) -> list[int]:
        """Return the nodes of some expressions of symbols whose own nodes are known."""
        function = ca.Function("trace", [ca.vertcat(*symbols)], [ca.vertcat(*expressions)])
        # Structural zeros are not instructions, so every output starts as the constant 0.
        outputs = [self.node(ca.OP_CONST, (), 0.0)] * len(expressions)
        work: dict[int, int] = {}
        for k in range(function.n_instructions()):
            op = function.instruction_id(k)
            source, target = function.instruction_input(k), function.instruction_output(k)
            if op == ca.OP_CONST:
                work[target[0]] = self.node(op, (), float(function.instruction_constant(k)))
            elif op == ca.OP_INPUT:
                work[target[0]] = numbers[source[1]]
            elif op == ca.OP_OUTPUT:
                outputs[target[1]] = work[source[0]]
            elif op in OPERATIONS:
                work[target[0]] = self.node(op, tuple(work[a] for a in source[: OPERATIONS[op].arity]))
            elif op == ca.OP_ASSIGN:
                work[target[0]] = work[source[0]]
            else:
                raise UnsupportedOperation(f"a formula uses CasADi operation number {op}, which has no NumPy form")
        return outputs

    def symbolic(self, inputs: Sequence[Any]) -> list[Any]:
        """Return the outputs as CasADi expressions of the given inputs, special functions written out."""
        values: list[Any] = []
        for node in self.nodes:
            values.append(self._symbolic_node(node, [values[a] for a in node.args], inputs))
        return [values[k] for k in self.outputs]

    def _symbolic_node(self, node: Node, args: Sequence[Any], inputs: Sequence[Any]) -> Any:
        if node.op == ca.OP_CONST:
            return ca.SX(node.constant)
        if node.op == ca.OP_INPUT:
            return inputs[int(node.constant)]
        return self.apply(node, args)

    def apply(self, node: Node, args: Sequence[Any]) -> Any:
        """Return one instruction carried out on CasADi symbols."""
        if node.op == OP_SPECIAL:
            return self.specials[int(node.constant)].formula(*args)
        if node.op == OP_SELECT:
            return ca.if_else(*args)
        return ca.SX.unary(node.op, args[0]) if len(args) == 1 else ca.SX.binary(node.op, args[0], args[1])

    def dependence(self, inputs: Sequence[int]) -> np.ndarray:
        """Return, for every node, whether it depends on any of the inputs (given by number); the array is kept."""
        key = tuple(inputs)
        if key not in self._dependent:
            self._dependent[key] = self.downstream([self.input_nodes[k] for k in key])
            self._dependent[key].setflags(write=False)
        return self._dependent[key]

    def downstream(self, sources: Iterable[int]) -> np.ndarray:
        """Return, for every node, whether it is one of the given nodes or depends on one."""
        marked = bytearray(len(self.nodes))  # an array takes three times as long
        marked_sources = set(sources)
        for k, node in enumerate(self.nodes):
            marked[k] = k in marked_sources or any(map(marked.__getitem__, node.args))
        return np.frombuffer(marked, dtype=bool)

    def empty_without(self, inputs: Sequence[int], node: int) -> int:
        """Node that is not-a-number where an input (given by number) is, and else the same as a node.

        Most nodes that depend on an input are so by themselves; what a condition chooses, or compares, may not be.
        """
        for k in inputs:
            if not self.lost_without(k)[node]:
                nothing = self.node(ca.OP_MUL, (self.node(ca.OP_CONST, (), 0.0), self.input_nodes[k]))
                node = self.node(ca.OP_ADD, (node, nothing))
        return node

    def lost_without(self, position: int) -> np.ndarray:
        """Nodes that are surely not-a-number where an input (given by number) is, each."""
        lost = np.zeros(len(self.nodes), dtype=bool)
        lost[self.input_nodes[position]] = True
        for k, node in enumerate(self.nodes):
            if node.op == OP_SELECT:
                lost[k] = lost[node.args[1]] and lost[node.args[2]]
            elif node.op == ca.OP_COPYSIGN:
                lost[k] = lost[node.args[0]]
            elif node.args and node.op not in COMPARISONS and node.op != ca.OP_IF_ELSE_ZERO:
                lost[k] = any(lost[a] for a in node.args)
        return lost

    def with_inputs(self, nodes: Sequence[int]) -> Program:
        """Return the same program with some inner nodes as further inputs, behind the others."""
        result = copy.copy(self)
        result._dependent = {}
        result.nodes = list(self.nodes)
        for position, k in enumerate(nodes):
            result.nodes[k] = Node(ca.OP_INPUT, (), float(self.n_inputs + position))
        return result

    def needed(self, outputs: Sequence[int]) -> list[int]:
        """Return the nodes needed for the given nodes, in order of evaluation."""
        nodes = set(outputs)
        for k in range(len(self.nodes) - 1, -1, -1):
            if k in nodes:
                nodes.update(self.nodes[k].args)
        return sorted(nodes)

    def compile(self, outputs: Sequence[int] | None = None) -> Callable[[Sequence[Any]], list[Any]]:
        """Return a NumPy function of a list of inputs (numbers or arrays that broadcast).

        Parameters
        ----------
        outputs : list of node numbers, optional
            What to compute; all outputs of the program by default.
        """
        targets = list(self.outputs if outputs is None else outputs)
        order = self.needed(targets)
        last_use = {a: k for k in order for a in self.nodes[k].args}
        last_use.update(dict.fromkeys(targets, len(self.nodes)))
        register: dict[int, int] = {}
        free: list[int] = []
        names: dict[int, str] = {}
        # Plain numbers of Python raise where a formula has no value; those of NumPy are infinite or not-a-number.
        lines = ["def evaluate(inputs):", "    inputs = [np.float64(x) if type(x) is float else x for x in inputs]"]
        lines.append('    with np.errstate(all="ignore"):')
        for k in order:
            node = self.nodes[k]
            if node.op == ca.OP_CONST:
                names[k] = f"({node.constant!r})" if np.isfinite(node.constant) else f"float('{node.constant}')"
                continue
            if node.op == ca.OP_INPUT:
                names[k] = f"inputs[{int(node.constant)}]"
                continue
            if node.op == OP_SPECIAL:
                code = f"specials[{int(node.constant)}](" + ", ".join(names[a] for a in node.args) + ")"
            else:
                code = OPERATIONS[node.op].numeric.format(*(names[a] for a in node.args))
            # Registers are handed on as soon as their last reader is done, so big batches stay small in memory.
            done = [a for a in dict.fromkeys(node.args) if a in register and last_use[a] == k]
            free.extend(register.pop(a) for a in done)
            slot = register[k] = free.pop() if free else len(register)
            names[k] = f"r{slot}"
            lines.append(f"        r{slot} = {code}")
        lines.append("        return [" + ", ".join(names[k] for k in targets) + "]")
        scope: dict[str, Any] = {"np": np, "specials": [f.formula for f in self.specials]}
        if any("erf(" in line for line in lines):
            from scipy.special import erf  # costly to import; few formulas name it

            scope["erf"] = erf
        exec(_compiled("\n".join(lines)), scope)
        return scope["evaluate"]  # type: ignore[no-any-return]
