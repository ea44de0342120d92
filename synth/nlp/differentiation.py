"""First and second derivatives of instructions, by a forward and a backward sweep over logarithms and values.

Formulas of machine parts are mostly products of powers, whose logarithms are linear in those of their factors: a
derivative of the logarithm of a product costs nothing at all, and a sum bends its logarithm by one rank. So each
instruction may have two faces, its value and the logarithm of its size, and the sweeps use whichever is asked for:
logarithms where the result is asked for by its logarithm (and so cannot be zero) or cannot be zero by its form.

With gradients of all faces known from the forward sweep, and the weight of each face in the result from the backward
sweep, the second derivatives of the result are the sum over all faces of weight times local curvature.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from synth.model.program import COMMUTATIVE, COMPARISONS, EXPONENTS, OP_SELECT, Node, Program

FLAT = {*COMPARISONS, ca.OP_FLOOR, ca.OP_CEIL, ca.OP_SIGN}
SUMS = {ca.OP_ADD, ca.OP_SUB}
POWER = {ca.OP_POW, ca.OP_CONSTPOW}
CHOICES = {OP_SELECT, ca.OP_IF_ELSE_ZERO, ca.OP_FMIN, ca.OP_FMAX}

STRIDE = 100  # operations inside each other that are differentiated by functions inside each other

VALUE, LOG = "value", "log"
Face = tuple[str, int]  # VALUE or LOG of a node
Gradient = dict[int, int]  # nodes of the derivatives that are not zero, by variable


class Graph:
    """A growing list of instructions in which each is there once, and the trivial ones are not.

    Parameters
    ----------
    n_variables : int
        The first inputs are the variables to differentiate by.
    """

    def __init__(self, n_variables: int) -> None:
        self.n = n_variables
        self.nodes: list[Node] = []
        self.moving: list[bool] = []
        self._numbers: dict[Node, int] = {}

    def take(self, program: Program, outputs: Sequence[int]) -> list[int]:
        """Add the instructions of a program and return the places of some of its nodes."""
        place: dict[int, int] = {}
        for k in program.needed([*program.input_nodes, *outputs]):
            node = program.nodes[k]
            place[k] = self.node(node.op, *(place[a] for a in node.args), constant=node.constant)
        return [place[k] for k in outputs]

    def node(self, op: int, *args: int, constant: float = 0.0) -> int:
        """Return an instruction as it stands."""
        node = Node(op, tuple(sorted(args)) if op in COMMUTATIVE else args, constant)
        if node not in self._numbers:
            self._numbers[node] = len(self.nodes)
            self.nodes.append(node)
            is_variable = op == ca.OP_INPUT and constant < self.n
            self.moving.append(is_variable or any(self.moving[a] for a in args))
        return self._numbers[node]

    def constant(self, value: float) -> int:
        """Return a number."""
        return self.node(ca.OP_CONST, constant=float(value))

    def number(self, k: int) -> float | None:
        """Return the value of a node if it is a number."""
        return self.nodes[k].constant if self.nodes[k].op == ca.OP_CONST else None

    def add(self, a: int, b: int) -> int:
        """Return a sum."""
        x, y = self.number(a), self.number(b)
        if x is not None and y is not None:
            return self.constant(x + y)
        if x == 0:
            return b
        if y == 0:
            return a
        if self.nodes[b].op == ca.OP_NEG:
            return self.node(ca.OP_SUB, a, self.nodes[b].args[0])
        if self.nodes[a].op == ca.OP_NEG:
            return self.node(ca.OP_SUB, b, self.nodes[a].args[0])
        return self.node(ca.OP_ADD, a, b)

    def negative(self, a: int) -> int:
        """Return minus a node."""
        x = self.number(a)
        if x is not None:
            return self.constant(-x)
        return self.nodes[a].args[0] if self.nodes[a].op == ca.OP_NEG else self.node(ca.OP_NEG, a)

    def times(self, a: int, b: int) -> int:
        """Return a product."""
        x, y = self.number(a), self.number(b)
        if x is not None and y is not None:
            return self.constant(x * y)
        for factor, other in ((x, b), (y, a)):
            if factor == 0:
                return self.constant(0.0)
            if factor == 1:
                return other
            if factor == -1:
                return self.negative(other)
        for one, two in ((a, b), (b, a)):
            if self.nodes[one].op == ca.OP_NEG:
                return self.negative(self.times(self.nodes[one].args[0], two))
        return self.node(ca.OP_MUL, a, b)

    def inverse(self, a: int) -> int:
        """Return one over a node."""
        x = self.number(a)
        return self.node(ca.OP_INV, a) if x is None or x == 0 else self.constant(1 / x)

    def choice(self, condition: int, a: int, b: int) -> int:
        """Return one of two nodes."""
        if a == b:
            return a
        if self.number(b) == 0:
            return self.node(ca.OP_IF_ELSE_ZERO, condition, a)
        return self.node(OP_SELECT, condition, a, b)

    def total(self, nodes: Iterable[int]) -> int:
        """Return the sum of nodes."""
        result = self.constant(0.0)
        for k in nodes:
            result = self.add(result, k)
        return result


@dataclass
class Rule:
    """How one face depends on others.

    Parameters
    ----------
    parents : list of (Face, int)
        Faces and the derivatives by them.
    curvature : list of (int, Gradient, Gradient or None)
        Second derivatives: a coefficient times the outer product of two gradients, both ways round, or of one alone.
    condition : int, optional
        The result is that of the first parent where this holds, of the second elsewhere; None is a constant.
    choices : tuple
        The two faces of a condition.
    """

    parents: list[tuple[Face, int]] = field(default_factory=list)
    curvature: list[tuple[int, Gradient, Gradient | None]] = field(default_factory=list)
    condition: int | None = None
    choices: tuple[Face | None, Face | None] = (None, None)


class DerivativeSweeps:
    """Gradients of some nodes, and second derivatives of their weighted sum.

    Parameters
    ----------
    graph : Graph
        Grows by what is derived.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.gradients: dict[Face, Gradient] = {}
        self.rules: dict[Face, Rule] = {}  # in an order in which parents come first
        self._never_zero: dict[int, bool] = {}
        self._depths: list[int] = []

    def gradient(self, k: int) -> Gradient:
        """Return the derivatives of a node by the variables."""
        self._prepare(k)
        return self._gradient((VALUE, k))

    def define(self, k: int, rule: Rule) -> None:
        """Set how the value of a node depends on other faces, where that is known better than from its instructions."""
        self.gradients[VALUE, k] = self._combined(rule)
        self.rules[VALUE, k] = rule

    def log_gradient(self, k: int) -> Gradient:
        """Return the derivatives of the logarithm of the size of a node by the variables."""
        self._prepare(k)
        return self._gradient((LOG, k))

    def hessian(self, weighted: Sequence[tuple[int, int]]) -> dict[tuple[int, int], int]:
        """Return the lower triangle of the second derivatives of a sum of nodes times weights.

        Parameters
        ----------
        weighted : list of (node, weight)
        """
        g = self.graph
        weight: dict[Face, int] = {}

        def more(face: Face, amount: int) -> None:
            weight[face] = g.add(weight[face], amount) if face in weight else amount

        for k, w in weighted:
            self._gradient((VALUE, k))
            more((VALUE, k), w)
        terms: dict[Any, tuple[list[int], Gradient, Gradient | None]] = {}
        for face in reversed(self.rules):
            if face not in weight:
                continue
            rule, adjoint = self.rules[face], weight[face]
            for parent, derivative in rule.parents:
                more(parent, g.times(adjoint, derivative))
            if rule.condition is not None:
                zero = g.constant(0.0)
                for chosen, pair in zip(rule.choices, ((adjoint, zero), (zero, adjoint)), strict=True):
                    if chosen is not None:
                        more(chosen, g.choice(rule.condition, *pair))
            for coefficient, first, second in rule.curvature:
                key = (tuple(sorted(first.items())), None if second is None else tuple(sorted(second.items())))
                terms.setdefault(key, ([], first, second))[0].append(g.times(adjoint, coefficient))
        result: dict[tuple[int, int], int] = {}
        for coefficients, first, second in terms.values():
            self._add_outer(result, g.total(coefficients), first, second)
        return {place: k for place, k in sorted(result.items()) if g.number(k) != 0}

    def _add_outer(
        self, result: dict[tuple[int, int], int], coefficient: int, first: Gradient, second: Gradient | None
    ) -> None:
        g = self.graph
        scaled = {i: g.times(coefficient, u) for i, u in first.items()}
        for i, slope in scaled.items():
            for j, other_slope in (first if second is None else second).items():
                if second is None and j > i:
                    continue
                place = (max(i, j), min(i, j))
                entry = g.times(slope, other_slope)
                if second is not None and i == j:
                    entry = g.times(g.constant(2.0), entry)
                result[place] = g.add(result.get(place, g.constant(0.0)), entry)

    # -- forward -------------------------------------------------------------------------------

    def _prepare(self, k: int) -> None:
        """Differentiate nodes on the way to a deep one first: functions inside each other are few then."""
        nodes, depths = self.graph.nodes, self._depths
        for node in nodes[len(depths) :]:
            depths.append(1 + max((depths[a] for a in node.args), default=0))
        if depths[k] <= STRIDE:
            return
        below, stack = {k}, [k]
        while stack:
            for a in nodes[stack.pop()].args:
                if a not in below:
                    below.add(a)
                    stack.append(a)
        for a in sorted(below):
            self._sized(a)
            if depths[a] % STRIDE == 0 and self._moves(a):
                self._gradient((VALUE, a))

    def _gradient(self, face: Face) -> Gradient:
        if face not in self.gradients:
            g, node = self.graph, self.graph.nodes[face[1]]
            if node.op == ca.OP_INPUT and face[0] == VALUE:
                self.gradients[face] = {int(node.constant): g.constant(1.0)}
            else:
                rule = self._log_rule(face[1]) if face[0] == LOG else self._value_rule(face[1])
                gradient = self._combined(rule)
                self.gradients[face], self.rules[face] = gradient, rule
        return self.gradients[face]

    def _combined(self, rule: Rule) -> Gradient:
        """Return the gradient that follows from those of the parents."""
        g = self.graph
        result: Gradient = {}
        for parent, derivative in rule.parents:
            for i, k in self._gradient(parent).items():
                result[i] = g.add(result.get(i, g.constant(0.0)), g.times(derivative, k))
        if rule.condition is not None:
            first, second = (self._gradient(f) if f is not None else {} for f in rule.choices)
            zero = g.constant(0.0)
            for i in sorted({*first, *second}):
                result[i] = g.choice(rule.condition, first.get(i, zero), second.get(i, zero))
        return {i: k for i, k in sorted(result.items()) if g.number(k) != 0}

    def _moves(self, k: int) -> bool:
        return self.graph.moving[k] and self.graph.nodes[k].op not in FLAT

    def _sized(self, k: int) -> bool:
        """True if a node is by its form either never zero or zero for all values of the variables."""
        if k not in self._never_zero:
            node = self.graph.nodes[k]
            moving = [a for a in node.args if self._moves(a)]
            if not self._moves(k) or node.op == ca.OP_EXP:
                answer = True
            elif node.op in (ca.OP_MUL, ca.OP_DIV) or node.op in EXPONENTS:
                answer = all(self._sized(a) for a in moving)
            elif node.op in POWER:
                answer = self._sized(node.args[0])
            else:
                answer = False
            self._never_zero[k] = answer
        return self._never_zero[k]

    def _log_rule(self, k: int) -> Rule:
        """Return the rule of the logarithm of a node."""
        g, node = self.graph, self.graph.nodes[k]
        one, minus = g.constant(1.0), g.constant(-1.0)
        moving = [a for a in node.args if self._moves(a)]
        if node.op == ca.OP_EXP:
            return Rule([((VALUE, node.args[0]), one)])
        if node.op in EXPONENTS:
            return Rule([((LOG, node.args[0]), g.constant(EXPONENTS[node.op]))])
        if node.op == ca.OP_MUL:
            return Rule([((LOG, a), one) for a in node.args if self._moves(a)])
        if node.op == ca.OP_DIV:
            return Rule([((LOG, a), s) for a, s in zip(node.args, (one, minus), strict=True) if self._moves(a)])
        if node.op in POWER:
            base, exponent = node.args
            rule = Rule()
            if self._moves(base):
                rule.parents.append(((LOG, base), exponent))
            if self._moves(exponent):
                rule.parents.append(((VALUE, exponent), g.node(ca.OP_LOG, base)))
            if len(rule.parents) == 2:
                rule.curvature.append((one, self._gradient((VALUE, exponent)), self._gradient((LOG, base))))
            return rule
        if node.op in SUMS:
            rule_of_sum = self._log_of_sum(k)
            if rule_of_sum is not None:
                return rule_of_sum
        if node.op in CHOICES and len(moving) > 0:
            return self._choice(node, LOG)
        rule = Rule([((VALUE, k), g.inverse(k))])
        rule.curvature.append((minus, self._combined(rule), None))
        return rule

    def _terms(self, k: int) -> list[tuple[int, int]]:
        """Terms of a sum of sums with their signs."""
        terms, stack = list[tuple[int, int]](), [(k, 1)]
        while stack:
            place, sign = stack.pop()
            node = self.graph.nodes[place]
            if node.op in SUMS and self._moves(place):
                first, second = node.args
                stack += [(second, -sign if node.op == ca.OP_SUB else sign), (first, sign)]
            else:
                terms.append((place, sign))
        return terms

    def _log_of_sum(self, k: int) -> Rule | None:
        """Rule of the logarithm of a sum by those of its terms; None where one of them may be zero."""
        g = self.graph
        every = self._terms(k)
        terms = [(a, s) for a, s in every if self._moves(a)]
        if not all(self._sized(a) for a, _ in terms):
            return None
        if not terms:
            return Rule()  # all of them are steps
        inverse, rule = g.inverse(k), Rule()
        for a, s in terms:
            share = g.times(a, inverse)
            rule.parents.append(((LOG, a), share if s > 0 else g.negative(share)))
        shares, gradients = [s for _, s in rule.parents], [self._gradient(face) for face, _ in rule.parents]
        if len(terms) == 1:
            # The variance of the gradients of all terms, weighted by their shares; two terms have but one difference.
            complement = g.add(g.constant(1.0), g.negative(shares[0]))
            rule.curvature.append((g.times(shares[0], complement), gradients[0], None))
        elif len(every) == 2:
            rule.curvature.append((g.times(*shares), self._difference(*gradients), None))
        else:
            rule.curvature += [(share, gradient, None) for share, gradient in zip(shares, gradients, strict=True)]
            rule.curvature.append((g.constant(-1.0), self._combined(rule), None))
        return rule

    def _difference(self, first: Gradient, second: Gradient) -> Gradient:
        g = self.graph
        zero = g.constant(0.0)
        result = {i: g.add(first.get(i, zero), g.negative(second.get(i, zero))) for i in sorted({*first, *second})}
        return {i: k for i, k in result.items() if g.number(k) != 0}

    def _value_rule(self, k: int) -> Rule:
        """Return the rule of the value of a node."""
        g, node = self.graph, self.graph.nodes[k]
        one = g.constant(1.0)
        moving = [a for a in node.args if self._moves(a)]
        if not self._moves(k):
            return Rule()
        if node.op == ca.OP_LOG:
            return Rule([((LOG, node.args[0]), one)])
        if node.op in SUMS:
            factors = (one, g.constant(-1.0) if node.op == ca.OP_SUB else one)
            return Rule([((VALUE, a), s) for a, s in zip(node.args, factors, strict=True) if self._moves(a)])
        if node.op in (ca.OP_NEG, ca.OP_TWICE):
            return Rule([((VALUE, node.args[0]), g.constant(-1.0 if node.op == ca.OP_NEG else 2.0))])
        if node.op == ca.OP_EXP:
            return Rule([((VALUE, node.args[0]), k)], [(k, self._gradient((VALUE, node.args[0])), None)])
        if self._sized(k) or EXPONENTS.get(node.op, 1.0) < 1.0 or (node.op in POWER and self._moves(node.args[1])):
            return Rule([((LOG, k), k)], [(k, self._gradient((LOG, k)), None)])
        if node.op == ca.OP_MUL:
            return self._product(node.args[0], node.args[1], k)
        if node.op == ca.OP_DIV:
            return self._quotient(node.args[0], node.args[1], k)
        if node.op in CHOICES:
            return self._choice(node, VALUE)
        return self._any(node, moving)

    def _product(self, a: int, b: int, k: int) -> Rule:
        g = self.graph
        if not self._moves(a) or not self._moves(b):
            a, b = (a, b) if self._moves(a) else (b, a)
            return Rule([((VALUE, a), b)])
        if self._sized(a):
            a, b = b, a
        first = self._gradient((VALUE, a))
        if self._sized(b):
            second = self._gradient((LOG, b))
            return Rule([((VALUE, a), b), ((LOG, b), k)], [(b, first, second), (k, second, None)])
        second = self._gradient((VALUE, b))
        return Rule([((VALUE, a), b), ((VALUE, b), a)], [(g.constant(1.0), first, second)])

    def _quotient(self, a: int, b: int, k: int) -> Rule:
        g = self.graph
        inverse = g.inverse(b)
        if not self._moves(b):
            return Rule([((VALUE, a), inverse)])
        second, less = self._gradient((LOG, b)), g.negative(k)
        rule = Rule([((LOG, b), less)], [(k, second, None)])
        if self._moves(a):
            rule.parents.append(((VALUE, a), inverse))
            rule.curvature.append((g.negative(inverse), self._gradient((VALUE, a)), second))
        return rule

    def _choice(self, node: Node, kind: str) -> Rule:
        g = self.graph
        if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            condition, sides = node.args[0], node.args[1:]
        else:
            sides = node.args if node.op == ca.OP_FMIN else node.args[::-1]
            condition = g.node(ca.OP_LT, *node.args)
        faces = [(kind, a) if self._moves(a) else None for a in sides]
        return Rule(condition=condition, choices=(faces[0], faces[1] if len(faces) > 1 else None))

    def _any(self, node: Node, moving: Sequence[int]) -> Rule:
        """Rule of an instruction that has no shorter one, by its derivatives."""
        g = self.graph
        symbols = [ca.SX.sym(f"a{k}") for k in range(len(node.args))]
        if len(node.args) == 2:
            result = ca.SX.binary(node.op, *symbols)
        else:
            result = ca.SX.unary(node.op, symbols[0])
        active = [k for k, a in enumerate(node.args) if a in moving]
        firsts = [ca.jacobian(result, symbols[k]) for k in active]
        seconds = {(i, j): ca.jacobian(firsts[i], symbols[active[j]]) for i in range(len(active)) for j in range(i + 1)}
        program = Program(symbols, [*firsts, *seconds.values()])
        numbers: dict[int, int] = {}
        for k in program.needed(program.outputs):
            local = program.nodes[k]
            if local.op == ca.OP_INPUT:
                numbers[k] = node.args[int(local.constant)]
            else:
                numbers[k] = g.node(local.op, *(numbers[a] for a in local.args), constant=local.constant)
        places = [numbers[k] for k in program.outputs]
        rule = Rule([((VALUE, node.args[k]), place) for k, place in zip(active, places, strict=False)])
        for (i, j), place in zip(seconds, places[len(active) :], strict=True):
            first, second = (self._gradient((VALUE, node.args[active[m]])) for m in (i, j))
            if g.number(place) != 0:
                rule.curvature.append((place, first, None if i == j else second))
        return rule


def with_shared_inverses(graph: Graph, outputs: Sequence[int]) -> tuple[list[Node], list[int]]:
    """Return instructions and outputs in which several divisions by one node share its inverse."""
    needed = reached(graph.nodes, outputs)
    divided: dict[int, int] = {}
    for k in needed:
        node = graph.nodes[k]
        if node.op in (ca.OP_DIV, ca.OP_INV):
            divided[node.args[-1]] = divided.get(node.args[-1], 0) + 1
    result = Graph(graph.n)
    place: dict[int, int] = {}
    for k in needed:
        node = graph.nodes[k]
        args = [place[a] for a in node.args]
        if node.op == ca.OP_DIV and (divided[node.args[1]] > 1 or not graph.moving[node.args[1]]):
            place[k] = result.times(args[0], result.inverse(args[1]))
        else:
            place[k] = result.node(node.op, *args, constant=node.constant)
    return result.nodes, [place[k] for k in outputs]


def reached(nodes: Sequence[Node], targets: Iterable[int]) -> list[int]:
    """Nodes needed for the targets, in order of evaluation."""
    marked = np.zeros(len(nodes), dtype=bool)
    marked[list(targets)] = True
    for k in range(len(nodes) - 1, -1, -1):
        if marked[k]:
            marked[list(nodes[k].args)] = True
    return [int(k) for k in np.flatnonzero(marked)]
