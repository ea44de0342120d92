"""The terms of all nodes of a program, by the composition rules of disciplined geometric programming."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from synth.bounds.curvature import BOTH, CONCAVE, CONVEX, INF, NEITHER, UNKNOWN, Curvature, Ends
from synth.bounds.feasible_intervals import FeasibleIntervals, natural
from synth.bounds.log_terms import (
    Atom,
    AtomTable,
    Term,
    difference_elasticity,
    hull,
    raised,
    scaled,
    times,
    without_common,
)
from synth.bounds.shapes import FLAT, Shape
from synth.model.model import Model
from synth.model.program import EXPONENTS, OP_SELECT, OP_SPECIAL, OPERATIONS, TRAITS, Node, Program
from synth.operations.record import Elasticity, Trait
from synth.operations.records import LOG_BELOW_ONE


class TermComposition:
    """Terms of all nodes of a program, put together by the rules of disciplined geometric programming.

    Parameters
    ----------
    model : Model
    low, high : array (inputs,)
        Range of every input of the program.
    """

    def __init__(self, model: Model, low: np.ndarray, high: np.ndarray) -> None:
        self.model = model
        self.program: Program = model.program
        self.nodes = self.program.nodes
        self.n = n = self.program.n_inputs
        self.input_low, self.input_high = low, high
        self.depends = np.zeros((len(self.nodes), n), dtype=bool)
        for k, node in enumerate(self.nodes):
            if node.op == ca.OP_INPUT:
                self.depends[k, int(node.constant)] = True
            elif node.args:
                self.depends[k] = self.depends[list(node.args)].any(axis=0)
        choices = [len(model.variables) + k for k, e in enumerate(model.data_inputs) if e.kind == "choice"]
        self.choice = np.zeros(n, dtype=bool)
        self.choice[choices] = True
        self.feasible = FeasibleIntervals(model, low, high)
        self.ends: list[Ends] = []
        self.terms: list[Term | None] = []
        self.atoms = AtomTable(self.nodes, n)
        for k, node in enumerate(self.nodes):
            self.ends.append(natural(self.program, node, self.ends, low, high))
            term = self._term(k, node)
            self.terms.append(term)
            if term is not None:
                a, b = self.ends[k]  # the zero comes first, because a negative zero would turn a quotient round
                self.ends[k] = (max(0.0, a), max(0.0, b)) if term.sign > 0 else (min(0.0, a), min(0.0, b))
                self.atoms.settle(k, self.ends[k], term.sign)

    # -- what a term says

    def shape(self, term: Term | None, nodes: Sequence[int]) -> Shape:
        """Sign and monotonicity of a term made of some nodes."""
        if term is None:
            reached: np.ndarray = np.logical_or.reduce(self.depends[list(nodes)])
            return Shape(0, False, UNKNOWN, self._jumps(reached))
        return Shape(term.sign, self.atoms.nonzero(term), self.atoms.curvature(term).word, self.atoms.elasticity(term))

    def quotient(self, value: int, limit: int) -> Term | None:
        """Return one node over another, where both are surely positive."""
        above, below = self.terms[value], self.terms[limit]
        if above is None or below is None or above.sign < 0 or below.sign < 0:
            return None
        return times(above, below, -1.0)

    # -- terms of nodes

    def _sign(self, k: int) -> int:
        """Return the sign of a node where its intervals tell."""
        low, high = self.ends[k]
        if low > 0 or self.feasible.low[k] > 0 or k in self.feasible.above_zero:
            return 1
        return -1 if high < 0 or self.feasible.high[k] < 0 else 0

    def _atom(self, k: int, sign: int, curvature: Curvature, elasticity: np.ndarray, nonzero: bool) -> Term:
        return self.atoms.add(k, sign, Atom(curvature, elasticity, self.ends[k], nonzero))

    def _anything(self, k: int) -> Term | None:
        """Return a node of which only the sign may be known."""
        sign, (low, high) = self._sign(k), self.ends[k]
        nonzero = bool(low > 0 or high < 0)
        return None if not sign else self._atom(k, sign, NEITHER, self._jumps(self.depends[k]), nonzero)

    def _jumps(self, inputs: np.ndarray) -> np.ndarray:
        return np.where(inputs[:, None], np.array([-np.inf, np.inf]), 0.0)

    def _term(self, k: int, node: Node) -> Term | None:
        op = node.op
        if op == ca.OP_CONST:
            return Term(int(np.sign(node.constant)), abs(node.constant), {}) if node.constant else None
        if op == ca.OP_INPUT:
            return self._input(k, int(node.constant))
        terms = [self.terms[a] for a in node.args]
        if op in (ca.OP_ADD, ca.OP_SUB):
            return self._sum(k, node, terms[0], terms[1])
        if op in (ca.OP_FMAX, ca.OP_FMIN):
            return self._extreme(k, node, terms)
        if op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            return self._select(k, node, terms)
        if op == OP_SPECIAL:
            return self._special(k, node, terms)
        known = [t for t in terms if t is not None]
        if len(known) == len(terms):
            term = self._arithmetic(node, known) or self._function(k, node, known)
            if term is not None:
                return term
        return self._anything(k)

    def _input(self, k: int, position: int) -> Term | None:
        if not (self.input_low[position] >= 0 or self._sign(k) > 0):
            return None
        elasticity = np.zeros((self.n, 2))
        elasticity[position] = 1.0
        return self._atom(k, 1, BOTH, elasticity, bool(self.input_low[position] > 0 or self._sign(k) > 0))

    def _arithmetic(self, node: Node, terms: Sequence[Term]) -> Term | None:
        """Return products and powers."""
        op, a = node.op, terms[0]
        if op == ca.OP_MUL:
            return times(a, terms[1])
        if op == ca.OP_DIV:
            return times(a, terms[1], -1.0)
        if op == ca.OP_NEG:
            return Term(-a.sign, a.factor, a.powers)
        if op == ca.OP_TWICE:
            return Term(a.sign, 2 * a.factor, a.powers)
        if op in EXPONENTS and (a.sign > 0 or OPERATIONS[op].domain is None):
            return raised(a, EXPONENTS[op], a.sign if op == ca.OP_INV else 1)
        if op in (ca.OP_POW, ca.OP_CONSTPOW) and self.nodes[node.args[1]].op == ca.OP_CONST:
            exponent = self.nodes[node.args[1]].constant
            if a.sign > 0:
                return raised(a, exponent)
            if exponent.is_integer():
                return raised(a, exponent, -1 if exponent % 2 else 1)
        return None

    def _function(self, k: int, node: Node, terms: Sequence[Term]) -> Term | None:
        """Return functions whose elasticity is known."""
        op, a = node.op, terms[0]
        if Trait.ADDS in TRAITS[op]:
            rule = Curvature(all(self.atoms.curvature(t).convex for t in terms), False)
            elasticity = hull(*(self.atoms.elasticity(t) for t in terms))
            return self._atom(k, 1, rule, elasticity, any(self.atoms.nonzero(t) for t in terms))
        low, high = (abs(x) for x in self.ends[node.args[0]])
        low, high = min(low, high), max(low, high)
        if op in (ca.OP_FLOOR, ca.OP_CEIL):
            sign = self._sign(k)
            steps = scaled(self.atoms.elasticity(a), (0.0, INF))
            return self._atom(k, sign, NEITHER, steps, True) if sign == a.sign else None
        if op == ca.OP_LOG and high < 1:
            outer: Elasticity | None = LOG_BELOW_ONE if a.sign > 0 else None
        else:
            outer = OPERATIONS[op].elasticity if a.sign > 0 else OPERATIONS[op].mirrored
        if outer is None or low < outer.domain[0] or high > outer.domain[1]:
            return None
        curvature = self._composed(curvature_of(outer), [(outer.rising, outer.falling, self.atoms.curvature(a))])
        elasticity = scaled(self.atoms.elasticity(a), outer.ends((low, high)))
        at_first = low <= outer.domain[0] and (outer.domain[0] > 0 or not self.atoms.nonzero(a))
        at_last = high >= outer.domain[1] and outer.domain[1] < INF
        zero = (outer.first > 0 and at_first) or (outer.last < 0 and at_last)
        return self._atom(k, outer.sign, curvature, elasticity, not zero)

    @staticmethod
    def _composed(outer: Curvature, arguments: Sequence[tuple[bool, bool, Curvature]]) -> Curvature:
        """Return the curvature of a function of arguments, each with whether it rises or falls in them."""
        convex, concave = outer.convex, outer.concave
        for rising, falling, inner in arguments:
            affine = inner.convex and inner.concave
            convex = convex and (affine or (rising and inner.convex) or (falling and inner.concave))
            concave = concave and (affine or (rising and inner.concave) or (falling and inner.convex))
        return Curvature(convex, concave)

    def _special(self, k: int, node: Node, terms: Sequence[Term | None]) -> Term | None:
        function = self.program.specials[int(node.constant)]
        known = [t for t in terms if t is not None and t.sign > 0]
        if len(known) < len(terms):
            return self._anything(k)
        declared = Curvature(function.curvature == CONVEX, function.curvature == CONCAVE)
        curvatures = [self.atoms.curvature(t) for t in known]
        curvature = self._composed(
            declared, [(a >= 0, b <= 0, c) for (a, b), c in zip(function.elasticity, curvatures, strict=True)]
        )
        if function.above is not None:
            first, second = (curvatures[i] for i in function.above)
            if not (first.concave and second.convex):
                curvature = NEITHER  # the inputs for which it exists are no convex set
        elasticity = np.zeros((self.n, 2))
        for ends, t in zip(function.elasticity, known, strict=True):
            elasticity = elasticity + scaled(self.atoms.elasticity(t), ends)
        # It is positive for positive arguments, and where it falls with one, even larger at zero.
        grows = [t for (_, most), t in zip(function.elasticity, known, strict=True) if most > 0]
        nonzero = self.ends[k][0] > 0 or all(self.atoms.nonzero(t) for t in grows)
        return self._atom(k, 1, curvature, elasticity, nonzero)

    def _sum(self, k: int, node: Node, a: Term | None, b: Term | None) -> Term | None:
        if a is None or b is None:
            return self._anything(k)
        if node.op == ca.OP_SUB:
            b = Term(-b.sign, b.factor, b.powers)
        if a.sign == b.sign:
            if a.powers == b.powers:
                return Term(a.sign, a.factor + b.factor, a.powers)
            return self._positive_sum(k, a, b)
        if a.powers == b.powers and a.factor != b.factor:
            return Term(a.sign if a.factor > b.factor else b.sign, abs(a.factor - b.factor), a.powers)
        sign = self._sign(k)
        if not sign and node.op == ca.OP_SUB:
            first, second = node.args
            sign = (
                1 if (first, second) in self.feasible.larger else -1 if (second, first) in self.feasible.larger else 0
            )
        nonzero = bool(sign)
        if not sign:
            low, high = self.atoms.ratio(b, a, *reversed(without_common(a, b)[1:]))
            sign = a.sign if high < 1 - FLAT else b.sign if low > 1 + FLAT else 0
        if not sign:
            return None
        large, small = (a, b) if a.sign == sign else (b, a)
        return self._difference(k, sign, large, small, nonzero or self.atoms.nonzero(large))

    def _positive_sum(self, k: int, a: Term, b: Term) -> Term:
        shared, cofactor_a, cofactor_b = without_common(a, b)
        direct = self.atoms.curvature(a).convex and self.atoms.curvature(b).convex
        factored = self.atoms.curvature(cofactor_a).convex and self.atoms.curvature(cofactor_b).convex
        curvature = Curvature(direct, False) | (self.atoms.curvature(shared) & Curvature(factored, False))
        # A convex combination with the shares of both terms as weights.
        low, high = self.atoms.ratio(a, b, cofactor_a, cofactor_b)
        e_a, e_b = self.atoms.elasticity(cofactor_a), self.atoms.elasticity(cofactor_b)
        shares = [1.0 if r == INF else r / (1 + r) for r in (low, high)]
        mixed = hull(*(scaled(e_a, (s, s)) + scaled(e_b, (1 - s, 1 - s)) for s in shares))
        nonzero = self.atoms.nonzero(a) or self.atoms.nonzero(b)
        return self._atom(k, a.sign, curvature, self.atoms.elasticity(shared) + mixed, nonzero)

    def _difference(self, k: int, sign: int, large: Term, small: Term, nonzero: bool) -> Term:
        shared, cofactor_large, cofactor_small = without_common(large, small)
        direct = self.atoms.curvature(large).concave and self.atoms.curvature(small).convex
        factored = self.atoms.curvature(cofactor_large).concave and self.atoms.curvature(cofactor_small).convex
        curvature = Curvature(False, direct) | (self.atoms.curvature(shared) & Curvature(False, factored))
        low, high = self.atoms.ratio(small, large, cofactor_small, cofactor_large)
        e_large, e_small = self.atoms.elasticity(cofactor_large), self.atoms.elasticity(cofactor_small)
        e_shared = self.atoms.elasticity(shared)
        if self.nodes[k].op == ca.OP_SUB:
            squares = e_shared + difference_elasticity(e_large, e_small, (low * low, high * high))
            self.atoms.add_square(k, scaled(squares, (2.0, 2.0)))
        return self._atom(k, sign, curvature, e_shared + difference_elasticity(e_large, e_small, (low, high)), nonzero)

    def _extreme(self, k: int, node: Node, terms: Sequence[Term | None]) -> Term | None:
        """Return the larger or smaller of two."""
        (a, b), want_larger = node.args, node.op == ca.OP_FMAX
        if self.ends[a][0] >= self.ends[b][1]:
            return terms[0] if want_larger else terms[1]
        if self.ends[b][0] >= self.ends[a][1]:
            return terms[1] if want_larger else terms[0]
        first, second = terms
        if first is None or second is None or first.sign != second.sign:
            return self._anything(k)
        largest_size = want_larger == (first.sign > 0)
        curvatures = self.atoms.curvature(first) & self.atoms.curvature(second)
        curvature = Curvature(curvatures.convex and largest_size, curvatures.concave and not largest_size)
        elasticity = hull(self.atoms.elasticity(first), self.atoms.elasticity(second))
        nonzero = (any if largest_size else all)(self.atoms.nonzero(t) for t in (first, second))
        return self._atom(k, first.sign, curvature, elasticity, nonzero)

    def _select(self, k: int, node: Node, terms: Sequence[Term | None]) -> Term | None:
        """Shape of where: one of two; a condition on choices alone selects, without a jump in the inputs."""
        condition = node.args[0]
        low, high = self.ends[condition]
        if low > 0.5:
            return terms[1]
        if len(terms) == 2:
            return self._anything(k)
        if high < 0.5:
            return terms[2]
        yes, no = terms[1], terms[2]
        if yes is None or no is None or yes.sign != no.sign:
            return self._anything(k)
        jumping = self.depends[condition]
        by_label = bool(np.all(self.choice[jumping]))
        curvature = self.atoms.curvature(yes) & self.atoms.curvature(no) if by_label else NEITHER
        smooth = hull(self.atoms.elasticity(yes), self.atoms.elasticity(no))
        elasticity = np.where(jumping[:, None], self._jumps(jumping), smooth)
        return self._atom(k, yes.sign, curvature, elasticity, self.atoms.nonzero(yes) and self.atoms.nonzero(no))


def curvature_of(outer: Elasticity) -> Curvature:
    """Curvature of the logarithm of a function in that of its argument: that of an elasticity that rises or falls."""
    return Curvature(outer.last > outer.first, outer.last < outer.first)
