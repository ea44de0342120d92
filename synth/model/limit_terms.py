"""Terms of limits: how large the numbers are that a limit compares, where its two sides do not tell.

A limit holds within a share of its size. Where terms cancel (``a - b <= 0``), or both sides vanish (a unit that is
switched off), the size of the sides says nothing, so that the same limit would hold or not with the side on which
somebody writes the zero. The size of the terms is a node of the program like any other: evaluation, bounds and proofs
read it.

It is what each number that enters the limit would move it by, to first order, if it moved by its own size; of sums the
largest summand, of products and powers their value, of a function of a sum its slope times the largest summand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from synth.model.program import EXPONENTS, NUMBERS, OP_SELECT, OPERATIONS, TRAITS, Program
from synth.operations.record import NO_TRAIT, Trait
from synth.order.feasibility import SMALLEST

# Share of the range of a variable around zero: within it all values count as equally large.
NEAR_ZERO = 1e-6
# Terms count up to so many times a side that is given: what is asked for tells a size as well.
MOST_TIMES = 1e3

_POWERS = {ca.OP_POW, ca.OP_CONSTPOW}


class LimitTerms:
    """Nodes that hold the size of terms, added to a program where they are needed.

    Parameters
    ----------
    program : Program
        Gets the nodes that it lacks.
    variables : int
        How many inputs, from the first, are variables.
    near_zero : mapping
        Input number -> size in SI below which its values count as equally large; of inputs that can be zero.
    not_negative : set of int
        Input numbers that are never negative.
    """

    def __init__(
        self, program: Program, variables: int, near_zero: Mapping[int, float], not_negative: frozenset[int]
    ) -> None:
        self.program, self._near_zero = program, near_zero
        self._not_negative: list[bool] = []
        for node in program.nodes:
            known = self._not_negative
            if node.op == ca.OP_CONST:
                sure = node.constant >= 0
            elif node.op == ca.OP_INPUT:
                sure = int(node.constant) in not_negative
            elif node.op == OP_SELECT:
                sure = all(known[a] for a in node.args[1:])
            elif node.op in _POWERS:
                sure = known[node.args[0]]  # whatever the exponent is
            else:
                traits = TRAITS[node.op]
                keeps = Trait.KEEPS_SIGN in traits and all(known[a] for a in node.args)
                sure = keeps or Trait.NEVER_NEGATIVE in traits
            known.append(sure)
        self._made: dict[int, int | None] = {}
        self._moves = program.downstream(program.input_nodes[:variables])

    def of(self, sides: Sequence[int], least: float = SMALLEST) -> int | None:
        """Node of the largest term of some sides; None where the sides themselves tell.

        Parameters
        ----------
        sides : list of int
            Nodes.
        least : float
            Smallest size that counts, in SI.
        """
        sizes = [made for k in sides if (made := self._size(k)) is not None]
        if not sizes:
            return None
        largest = self._largest(sizes)
        for k in sides:
            largest = self._capped(largest, k)
        return self._largest([largest, self.number(least)]) if least > SMALLEST else largest

    def _capped(self, size: int, side: int) -> int:
        """Node of a size that is at most so many times that of a side that no variable moves, unless that is zero.

        Such a side may cancel as well: counts, columns and requirements enter it.
        """
        node = self.program.nodes[side]
        if self._moves[side] or (node.op == ca.OP_CONST and node.constant == 0):
            return size
        most = self._node(ca.OP_MUL, self.number(MOST_TIMES), self._terms(side))
        capped = self._node(ca.OP_FMIN, size, most)
        if node.op == ca.OP_CONST:
            return capped
        return self._node(OP_SELECT, self._node(ca.OP_EQ, side, self.number(0.0)), size, capped)

    def _size(self, k: int) -> int | None:
        """Node of the size of one node; None where that is its magnitude."""
        stack = [k]
        while stack:  # formulas may be nested more deeply than Python calls
            top = stack[-1]
            open_arguments = [a for a in self.program.nodes[top].args if a not in self._made]
            if open_arguments:
                stack += open_arguments
            else:
                stack.pop()
                if top not in self._made:
                    self._made[top] = self._made_of(top)
        return self._made[k]

    def _made_of(self, k: int) -> int | None:
        node = self.program.nodes[k]
        op, args = node.op, node.args
        if op == ca.OP_INPUT:
            least = self._near_zero.get(int(node.constant))
            return None if least is None else self._node(ca.OP_FMAX, self.size(k), self.number(least))
        sizes = [self._made[a] for a in args]
        cancels = any(size is not None for size in sizes)
        if Trait.ADDS in TRAITS.get(op, NO_TRAIT):
            keeps = op not in (ca.OP_SUB, ca.OP_ADD) or (op == ca.OP_ADD and all(self._not_negative[a] for a in args))
            return None if keeps and not cancels else self._largest([self._terms(a) for a in args])
        if op in (ca.OP_FMIN, ca.OP_FMAX):
            smaller, larger = args if op == ca.OP_FMIN else args[::-1]
            first = self._node(ca.OP_LE, smaller, larger)
            return self._node(OP_SELECT, first, *(self._terms(a) for a in args)) if cancels else None
        if op == OP_SELECT:
            return self._node(op, args[0], self._terms(args[1]), self._terms(args[2])) if cancels else None
        if op == ca.OP_IF_ELSE_ZERO:
            return None if sizes[1] is None else self._node(op, args[0], self._terms(args[1]))
        if not cancels and Trait.CROSSES_ZERO not in TRAITS.get(op, NO_TRAIT):
            return None
        if op == ca.OP_MUL:
            first = self._node(ca.OP_MUL, self._terms(args[0]), self.size(args[1]))
            return self._largest([first, self._node(ca.OP_MUL, self.size(args[0]), self._terms(args[1]))])
        if op == ca.OP_DIV:
            first = self._node(ca.OP_DIV, self._terms(args[0]), self.size(args[1]))
            share = self._node(ca.OP_DIV, self._terms(args[1]), self.size(args[1]))
            return self._largest([first, self._node(ca.OP_MUL, self.size(k), share)])
        if op in (ca.OP_NEG, ca.OP_FABS):
            return self._terms(args[0])
        if op == ca.OP_TWICE:
            return self._node(op, self._terms(args[0]))
        if op == ca.OP_SQ:
            return self._node(ca.OP_MUL, self.size(args[0]), self._terms(args[0]))
        if op in _POWERS or EXPONENTS.get(op) == 0.5:
            return self._power(k)
        slope = self._slope(k)
        if slope is None:
            return None
        return self._largest([self.size(k), self._node(ca.OP_MUL, slope, self._terms(args[0]))])

    def _power(self, k: int) -> int | None:
        """Node of the size of a power of something that cancels; None where its exponent is no positive number."""
        node = self.program.nodes[k]
        base = self._terms(node.args[0])
        if node.op not in _POWERS:
            return self._node(node.op, base)
        exponent = self.program.nodes[node.args[1]]
        if exponent.op != ca.OP_CONST or exponent.constant <= 0:
            return None
        if exponent.constant < 1:
            return self._node(ca.OP_CONSTPOW, base, node.args[1])
        # Without the exponent as a factor, so that a power counts as the product that it is.
        one_less = self.number(exponent.constant - 1.0)
        others = self._node(ca.OP_CONSTPOW, self.size(node.args[0]), one_less)
        return self._node(ca.OP_MUL, others, base)

    def _slope(self, k: int) -> int | None:
        """Node of the magnitude of the derivative by the first argument; None where it is not needed."""
        node = self.program.nodes[k]
        slope = OPERATIONS[node.op].slope if node.op in OPERATIONS else None
        return None if slope is None else slope(self, k, node.args[0])

    # -- nodes

    def _terms(self, k: int) -> int:
        """Node of the size of one node, its magnitude where that is it."""
        made = self._made[k]
        return self.size(k) if made is None else made

    def put(self, name: str, *args: int) -> int:
        """Node of an operation, by its name."""
        return self._node(NUMBERS[name], *args)

    def size(self, node: int) -> int:
        """Node of the size of another."""
        return node if node < len(self._not_negative) and self._not_negative[node] else self._node(ca.OP_FABS, node)

    def _largest(self, nodes: Sequence[int]) -> int:
        largest = nodes[0]
        for k in nodes[1:]:
            largest = largest if k == largest else self._node(ca.OP_FMAX, largest, k)
        return largest

    def number(self, value: float) -> int:
        """Node of a constant."""
        return self.program.node(ca.OP_CONST, (), value)

    def _node(self, op: int, *args: int) -> int:
        return self.program.node(op, args)
