"""What kind of function each limit and objective is, found from the trace alone.

Every node of the program gets its sign, the curvature of log(node) as a function of the logarithms of all
inputs together (variables, counts, columns, requirements), and per input the interval of its elasticity
d log(node) / d log(input). The rules are those of disciplined geometric programming (Boyd et al. 2007, "A
tutorial on geometric programming"; Agrawal, Diamond and Boyd 2019, "Disciplined geometric programming"):
products and powers of log-affine quantities are log-affine, a sum of log-convex ones is log-convex, a
log-concave one minus a log-convex one is log-concave where it is positive, and a function that rises (falls)
keeps the curvature (the opposite curvature) of its argument where it has it itself. Special functions bring the
curvature and the elasticities that they declare.

A quantity is kept as a product of powers of *atoms* (inputs, sums, differences, functions), so that what cancels
in a quotient is gone before the rules are applied.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.curvature import AFFINE, BOTH, CONCAVE, CONVEX, INF, NEITHER, UNKNOWN, Curvature, Ends
from synth.bounds.elementary import LOG_BELOW_ONE, MIRRORED, OUTER, _Outer
from synth.bounds.intervals import BACKWARD, FORWARD, loosened
from synth.model.model import Model
from synth.model.program import OP_SELECT, OP_SPECIAL, Node, Program

NAMED = 4  # inputs that a text names per direction
LONGEST = 100  # characters of a text
SWEEPS = 3
ROUNDING = 1e-12
CROSSED = 1e-8  # ends of an interval that pass each other by less do so by rounding


@dataclass(frozen=True)
class Shape:
    """What is known of one quantity, or of the quotient of both sides of a limit.

    Parameters
    ----------
    sign : int
        +1 or -1 where it surely has that sign, 0 where that is not known; then nothing else is known.
    nonzero : bool
        Whether it is surely not zero either, for no value of the inputs.
    curvature : str
        ``log-affine``, ``log-convex``, ``log-concave`` or ``unknown``: of the logarithm of its size.
    elasticity : array (inputs, 2)
        Least and largest d log / d log per input; of an input that it jumps with, everything.
    text : str
        The same for people, in short.
    """

    sign: int
    nonzero: bool
    curvature: str
    elasticity: np.ndarray
    text: str = ""

    def rising(self) -> np.ndarray:
        """Return which inputs it rises with."""
        return (self.elasticity[:, 0] >= -ROUNDING) & (self.elasticity[:, 1] > 0)

    def falling(self) -> np.ndarray:
        """Return which inputs it falls with."""
        return (self.elasticity[:, 1] <= ROUNDING) & (self.elasticity[:, 0] < 0)

    def open(self) -> np.ndarray:
        """Return the inputs with which it may rise or fall."""
        return (self.elasticity[:, 0] < -ROUNDING) & (self.elasticity[:, 1] > ROUNDING)


@dataclass(frozen=True)
class Structure:
    """What kind of function each node, quantity, limit and objective of a model is.

    Limits are judged by log(value) - log(limit), with the opposite sign for ``at_least``; objectives by
    log(value), with the opposite sign for ``max``: what must be small. So log-convex is what a convex problem
    allows. Everything holds where the nodes that have a sign here do have it, which every feasible design
    does. Choices have no logarithm: what is said holds for each of their labels.
    """

    inputs: tuple[str, ...]
    nodes: tuple[Shape, ...]
    quantities: dict[str, Shape]
    limits: dict[str, Shape]
    objectives: dict[str, Shape]


def classify(model: Model, low: np.ndarray, high: np.ndarray) -> Structure:
    """Classify all limits, objectives and quantities of a model.

    Differences are often positive in feasible designs only (the width of a ring). Therefore the intervals of
    all nodes are tightened once by the limits, and a node that is positive in every feasible design counts as
    positive. Nothing else is taken from the limits: elasticities and curvature hold over the whole ranges,
    as far as the nodes that count as positive are positive there.

    Parameters
    ----------
    model : Model
    low, high : array (inputs,)
        Range of every input of the program (variables, then data); not-a-number where there is no value. Inputs
        that may be 0 are taken as positive, and quantities that can be 0 for that reason are marked.

    Returns
    -------
    Structure
    """
    with np.errstate(all="ignore"):
        return _structure(_Analysis(model, low, high))


def _structure(analysis: _Analysis) -> Structure:
    model = analysis.model
    labels = tuple([v.name for v in model.variables] + [e.label for e in model.data_inputs])
    kinds = ["variable"] * len(model.variables) + [e.kind for e in model.data_inputs]
    # What cannot move is not worth a word, and a choice has no order.
    moving = ~(analysis.input_low == analysis.input_high)
    order = ("variable", "count", "part", "requirement", "row")
    named = [(k, labels[k]) for kind in order for k in range(len(labels)) if kinds[k] == kind and moving[k]]
    nodes = tuple(analysis.shape(term, [k]) for k, term in enumerate(analysis.terms))
    quantities = {name: _worded(nodes[k], named) for name, k in model.quantity_node.items()}
    limits, objectives = dict[str, Shape](), dict[str, Shape]()
    for limit in model.constraints:
        sides = limit.nodes
        shape = analysis.shape(analysis.quotient(*(sides if limit.sense != "at_least" else reversed(sides))), sides)
        # A side that can be zero has no logarithm there.
        shape = replace(shape, nonzero=all(nodes[k].nonzero for k in sides))
        limits[limit.name] = _worded(shape, named, equal=limit.sense == "equal")
    for goal in model.declaration.objectives.values():
        k = model.quantity_node[goal.name]
        term = analysis.terms[k]
        turned = term if term is None or goal.sense == "min" else _power(term, -1.0, term.sign)
        objectives[goal.name] = _worded(replace(analysis.shape(turned, [k]), nonzero=nodes[k].nonzero), named)
    return Structure(labels, nodes, quantities, limits, objectives)


# -- words -------------------------------------------------------------------------------------


def _worded(shape: Shape, named: Sequence[tuple[int, str]], equal: bool = False) -> Shape:
    """Return a shape with its text."""
    if shape.sign != 1:
        text = "equality" if equal else "not surely positive"
    elif equal:
        text = f"equality, {AFFINE}" if shape.curvature == AFFINE and shape.nonzero else "equality"
    else:
        ending = "" if shape.nonzero else ", can be 0"
        text = shape.curvature if shape.curvature != UNKNOWN else _directions(shape, named, LONGEST - len(ending))
        text += ending
    return replace(shape, text=text)


def _directions(shape: Shape, named: Sequence[tuple[int, str]], longest: int) -> str:
    """Say in which inputs a quantity is monotone, with as many names as there is room for."""
    rising, falling, unknown = (
        [label for k, label in named if which[k]] for which in (shape.rising(), shape.falling(), shape.open())
    )
    if not rising and not falling:
        return UNKNOWN
    for count in range(NAMED, -1, -1):
        if not unknown:
            ways = [("rises", rising), ("falls", falling)]
            text = "monotone: " + ", ".join(f"{verb} with {_some(names, count)}" for verb, names in ways if names)
        elif len(unknown) <= count:
            text = f"monotone in all but {_some(unknown, count)}"
        else:
            text = f"monotone in {_some(rising + falling, count)}, unknown in {_some(unknown, count)}"
        if len(text) <= longest:
            break
    return text


def _some(names: Sequence[str], count: int) -> str:
    """Return names as a list; all beyond ``count`` as a number.

    Examples
    --------
    >>> _some(["a", "b", "c"], 2), _some(["a", "b", "c"], 3), _some(["a"], 0)
    ('a, b and 1 more', 'a, b, c', '1 input')
    """
    rest = len(names) - count
    if rest <= 0:
        return ", ".join(names)
    if not count:
        return f"{rest} input{'s' if rest > 1 else ''}"
    return f"{', '.join(names[:count])} and {rest} more"


# -- products of powers of atoms ---------------------------------------------------------------


@dataclass(frozen=True)
class _Term:
    """A quantity of known sign as sign * factor * product of atoms (by node number) to powers."""

    sign: int
    factor: float
    powers: dict[int, float]


@dataclass(frozen=True)
class _Atom:
    """What is known of the size of an atom."""

    curvature: Curvature
    elasticity: np.ndarray
    ends: Ends
    nonzero: bool


def _times(a: _Term, b: _Term, power: float = 1.0) -> _Term:
    """Return a * b**power; for a power of -1 the sign is right as well."""
    powers = dict(a.powers)
    for atom, p in b.powers.items():
        powers[atom] = powers.get(atom, 0.0) + power * p
    powers = {atom: p for atom, p in powers.items() if p != 0.0}
    return _Term(a.sign * b.sign, a.factor * b.factor**power, powers)


def _power(a: _Term, power: float, sign: int = 1) -> _Term:
    return _Term(sign, a.factor**power, {atom: power * p for atom, p in a.powers.items() if power != 0.0})


def _split(a: _Term, b: _Term) -> tuple[_Term, _Term, _Term]:
    """Return what two terms have in common, and what is left of each."""
    common = {atom: min(p, b.powers[atom]) for atom, p in a.powers.items() if atom in b.powers}
    shared = _Term(1, 1.0, common)
    return shared, _times(a, shared, -1.0), _times(b, shared, -1.0)


def _product(a: Any, b: Any) -> Any:
    """Multiply; zero times infinity is zero, because every factor is finite and only its range has no end."""
    return np.where((np.asarray(a) == 0) | (np.asarray(b) == 0), 0.0, np.asarray(a) * np.asarray(b))


def _scaled(elasticity: np.ndarray, ends: Ends) -> np.ndarray:
    """Return the product of intervals."""
    if ends[0] == ends[1]:
        scaled: np.ndarray = _product(elasticity, ends[0])
        return scaled if ends[0] >= 0 else scaled[:, ::-1]
    corners = np.stack([_product(elasticity[:, i], x) for i in (0, 1) for x in ends])
    return np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1)


def _hull(*elasticities: np.ndarray) -> np.ndarray:
    stacked = np.stack(elasticities)
    return np.stack([stacked[:, :, 0].min(axis=0), stacked[:, :, 1].max(axis=0)], axis=1)


def _weighted(large: np.ndarray, small: np.ndarray, ratio: Ends) -> np.ndarray:
    """Return the elasticity of a difference from those of its terms.

    It is small + w (large - small), where w = 1/(1 - ratio) is the larger term over the difference.
    """
    weights = [1 / (1 - r) if r < 1 else INF for r in ratio]
    lows = [small[:, 1] + _product(w, large[:, 0] - small[:, 1]) for w in weights]
    highs = [small[:, 0] + _product(w, large[:, 1] - small[:, 0]) for w in weights]
    return _sound(np.stack([np.minimum(*lows), np.maximum(*highs)], axis=1))


def _sound(elasticity: np.ndarray) -> np.ndarray:
    """Return the interval with what is not a number taken as unknown."""
    low, high = elasticity[:, 0], elasticity[:, 1]
    return np.stack([np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)], axis=1)


# -- the analysis ------------------------------------------------------------------------------


class _Analysis:
    """Terms of all nodes of a program."""

    def __init__(self, model: Model, low: np.ndarray, high: np.ndarray) -> None:
        self.model = model
        self.program: Program = model.program
        self.nodes = self.program.nodes
        n = self.program.n_inputs
        self.n = n
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
        self.least, self.most, self.above_zero, self.larger = _feasible(model, low, high)
        self.ends: list[Ends] = []
        self.terms: list[_Term | None] = []
        self.atoms: dict[int, _Atom] = {}
        self.squares: dict[int, np.ndarray] = {}  # of a difference: the elasticity of the difference of both squares
        for k, node in enumerate(self.nodes):
            self.ends.append(_natural(self.program, node, self.ends, low, high))
            term = self._term(k, node)
            self.terms.append(term)
            if term is not None:
                a, b = self.ends[k]  # the zero comes first, because a negative zero would turn a quotient round
                self.ends[k] = (max(0.0, a), max(0.0, b)) if term.sign > 0 else (min(0.0, a), min(0.0, b))
            if k in self.atoms:
                # The interval of an atom is that of its size, which the term has just fixed.
                atom, (a, b) = self.atoms[k], self.ends[k]
                ends = (a, b) if term is not None and term.sign > 0 else (0.0 - b, 0.0 - a)
                self.atoms[k] = _Atom(atom.curvature, atom.elasticity, ends, atom.nonzero)

    # -- what a term says

    def shape(self, term: _Term | None, nodes: Sequence[int]) -> Shape:
        """Return what is known of a term made of some nodes."""
        if term is None:
            reached: np.ndarray = np.logical_or.reduce(self.depends[list(nodes)])
            return Shape(0, False, UNKNOWN, self._jumps(reached))
        return Shape(term.sign, self._nonzero(term), self.curvature(term).word, self.elasticity(term))

    def _nonzero(self, term: _Term) -> bool:
        return all(self.atoms[atom].nonzero for atom, p in term.powers.items() if p > 0)

    def quotient(self, value: int, limit: int) -> _Term | None:
        """Return one node over another, where both are surely positive."""
        above, below = self.terms[value], self.terms[limit]
        if above is None or below is None or above.sign < 0 or below.sign < 0:
            return None
        return _times(above, below, -1.0)

    def elasticity(self, term: _Term) -> np.ndarray:
        """Return the interval of the elasticity per input."""
        powers, squares = self._squared(term)
        total, plain = np.zeros((self.n, 2)), np.zeros((self.n, 2))
        for atom, p in term.powers.items():
            plain = plain + _scaled(self.atoms[atom].elasticity, (p, p))
        if not squares:
            return _sound(plain)
        for atom, p in powers.items():
            total = total + _scaled(self.atoms[atom].elasticity, (p, p))
        for atom, p in squares.items():
            total = total + _scaled(self.squares[atom], (p, p))
        plain, total = _sound(plain), _sound(total)
        return np.stack([np.maximum(plain[:, 0], total[:, 0]), np.minimum(plain[:, 1], total[:, 1])], axis=1)

    def curvature(self, term: _Term) -> Curvature:
        """Return the curvature of a product of powers."""
        powers, squares = self._squared(term)
        result = BOTH
        for atom, p in [*powers.items(), *squares.items()]:
            if p != 0.0:
                own = self.atoms[atom].curvature
                result = result & (own if p > 0 else own.opposite())
        return result

    def _squared(self, term: _Term) -> tuple[dict[int, float], dict[int, float]]:
        """Return powers of atoms, and those of products (a + b)(a - b) by their difference.

        Such a product is a**2 - b**2, which has the curvature of a - b.
        """
        powers, squares = dict(term.powers), dict[int, float]()
        for atom in term.powers:
            operands = sorted(self.nodes[atom].args)
            for other in term.powers if atom in self.squares else ():
                partner = self.nodes[other]
                matches = partner.op == ca.OP_ADD and sorted(partner.args) == operands
                if matches and powers[atom] * powers[other] > 0:
                    p = min(powers[atom], powers[other], key=abs)
                    powers[atom] -= p
                    powers[other] -= p
                    squares[atom] = p
        return powers, squares

    def _size(self, term: _Term) -> Ends:
        """Return the range of the size of a term, from those of its atoms."""
        low = high = np.float64(term.factor)
        for atom, p in term.powers.items():
            a, b = (np.float64(x) ** p for x in self.atoms[atom].ends)
            low, high = low * min(a, b), high * max(a, b)
        return (0.0 if np.isnan(low) else float(low)), (INF if np.isnan(high) else float(high))

    # -- terms of nodes

    def _sign(self, k: int) -> int:
        """Return the sign of a node where its intervals tell."""
        low, high = self.ends[k]
        if low > 0 or self.least[k] > 0 or k in self.above_zero:
            return 1
        return -1 if high < 0 or self.most[k] < 0 else 0

    def _atom(self, k: int, sign: int, curvature: Curvature, elasticity: np.ndarray, nonzero: bool) -> _Term:
        self.atoms[k] = _Atom(curvature, _sound(elasticity), self.ends[k], nonzero)
        return _Term(sign, 1.0, {k: 1.0})

    def _anything(self, k: int) -> _Term | None:
        """Return a node of which only the sign may be known."""
        sign, (low, high) = self._sign(k), self.ends[k]
        nonzero = bool(low > 0 or high < 0)
        return None if not sign else self._atom(k, sign, NEITHER, self._jumps(self.depends[k]), nonzero)

    def _jumps(self, inputs: np.ndarray) -> np.ndarray:
        return np.where(inputs[:, None], np.array([-np.inf, np.inf]), 0.0)

    def _term(self, k: int, node: Node) -> _Term | None:
        op = node.op
        if op == ca.OP_CONST:
            return _Term(int(np.sign(node.constant)), abs(node.constant), {}) if node.constant else None
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
            found = self._arithmetic(node, known) or self._function(k, node, known)
            if found is not None:
                return found
        return self._anything(k)

    def _input(self, k: int, position: int) -> _Term | None:
        if not (self.input_low[position] >= 0 or self._sign(k) > 0):
            return None
        elasticity = np.zeros((self.n, 2))
        elasticity[position] = 1.0
        return self._atom(k, 1, BOTH, elasticity, bool(self.input_low[position] > 0 or self._sign(k) > 0))

    def _arithmetic(self, node: Node, terms: Sequence[_Term]) -> _Term | None:
        """Return products and powers."""
        op, a = node.op, terms[0]
        if op == ca.OP_MUL:
            return _times(a, terms[1])
        if op == ca.OP_DIV:
            return _times(a, terms[1], -1.0)
        if op == ca.OP_NEG:
            return _Term(-a.sign, a.factor, a.powers)
        if op == ca.OP_TWICE:
            return _Term(a.sign, 2 * a.factor, a.powers)
        if op == ca.OP_SQ:
            return _power(a, 2.0)
        if op == ca.OP_INV:
            return _power(a, -1.0, a.sign)
        if op == ca.OP_FABS:
            return _power(a, 1.0)
        if op == ca.OP_SQRT and a.sign > 0:
            return _power(a, 0.5)
        if op in (ca.OP_POW, ca.OP_CONSTPOW) and self.nodes[node.args[1]].op == ca.OP_CONST:
            exponent = self.nodes[node.args[1]].constant
            if a.sign > 0:
                return _power(a, exponent)
            if exponent.is_integer():
                return _power(a, exponent, -1 if exponent % 2 else 1)
        return None

    def _function(self, k: int, node: Node, terms: Sequence[_Term]) -> _Term | None:
        """Return functions whose elasticity is known."""
        op, a = node.op, terms[0]
        if op == ca.OP_HYPOT:
            rule = Curvature(all(self.curvature(t).convex for t in terms), False)
            elasticity = _hull(*(self.elasticity(t) for t in terms))
            return self._atom(k, 1, rule, elasticity, any(self._nonzero(t) for t in terms))
        low, high = (abs(x) for x in self.ends[node.args[0]])
        low, high = min(low, high), max(low, high)
        if op in (ca.OP_FLOOR, ca.OP_CEIL):
            sign = self._sign(k)
            steps = _scaled(self.elasticity(a), (0.0, INF))
            return self._atom(k, sign, NEITHER, steps, True) if sign == a.sign else None
        if op == ca.OP_LOG and high < 1:
            outer: _Outer | None = LOG_BELOW_ONE if a.sign > 0 else None
        else:
            outer = (OUTER if a.sign > 0 else MIRRORED).get(op)
        if outer is None or low < outer.domain[0] or high > outer.domain[1]:
            return None
        curvature = self._composed(outer.curvature, [(outer.rising, outer.falling, self.curvature(a))])
        elasticity = _scaled(self.elasticity(a), outer.ends((low, high)))
        at_first = low <= outer.domain[0] and (outer.domain[0] > 0 or not self._nonzero(a))
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

    def _special(self, k: int, node: Node, terms: Sequence[_Term | None]) -> _Term | None:
        function = self.program.specials[int(node.constant)]
        known = [t for t in terms if t is not None and t.sign > 0]
        if len(known) < len(terms):
            return self._anything(k)
        declared = Curvature(function.curvature == CONVEX, function.curvature == CONCAVE)
        curvatures = [self.curvature(t) for t in known]
        curvature = self._composed(
            declared, [(a >= 0, b <= 0, c) for (a, b), c in zip(function.elasticity, curvatures, strict=True)]
        )
        if function.above is not None:
            first, second = (curvatures[i] for i in function.above)
            if not (first.concave and second.convex):
                curvature = NEITHER  # the inputs for which it exists are no convex set
        elasticity = np.zeros((self.n, 2))
        for ends, t in zip(function.elasticity, known, strict=True):
            elasticity = elasticity + _scaled(self.elasticity(t), ends)
        # It is positive for positive arguments, and where it falls with one, even larger at zero.
        grows = [t for (_, most), t in zip(function.elasticity, known, strict=True) if most > 0]
        nonzero = self.ends[k][0] > 0 or all(self._nonzero(t) for t in grows)
        return self._atom(k, 1, curvature, elasticity, nonzero)

    def _sum(self, k: int, node: Node, a: _Term | None, b: _Term | None) -> _Term | None:
        if a is None or b is None:
            return self._anything(k)
        if node.op == ca.OP_SUB:
            b = _Term(-b.sign, b.factor, b.powers)
        if a.sign == b.sign:
            if a.powers == b.powers:
                return _Term(a.sign, a.factor + b.factor, a.powers)
            return self._positive_sum(k, a, b)
        if a.powers == b.powers and a.factor != b.factor:
            return _Term(a.sign if a.factor > b.factor else b.sign, abs(a.factor - b.factor), a.powers)
        sign = self._sign(k)
        if not sign and node.op == ca.OP_SUB:
            first, second = node.args
            sign = 1 if (first, second) in self.larger else -1 if (second, first) in self.larger else 0
        nonzero = bool(sign)
        if not sign:
            low, high = self._ratio(b, a, *reversed(_split(a, b)[1:]))
            sign = a.sign if high < 1 - ROUNDING else b.sign if low > 1 + ROUNDING else 0
        if not sign:
            return None
        large, small = (a, b) if a.sign == sign else (b, a)
        return self._difference(k, sign, large, small, nonzero or self._nonzero(large))

    def _positive_sum(self, k: int, a: _Term, b: _Term) -> _Term:
        shared, rest_a, rest_b = _split(a, b)
        direct = self.curvature(a).convex and self.curvature(b).convex
        factored = self.curvature(rest_a).convex and self.curvature(rest_b).convex
        curvature = Curvature(direct, False) | (self.curvature(shared) & Curvature(factored, False))
        # A convex combination with the shares of both terms as weights.
        low, high = self._ratio(a, b, rest_a, rest_b)
        e_a, e_b = self.elasticity(rest_a), self.elasticity(rest_b)
        shares = [1.0 if r == INF else r / (1 + r) for r in (low, high)]
        mixed = _hull(*(_scaled(e_a, (s, s)) + _scaled(e_b, (1 - s, 1 - s)) for s in shares))
        nonzero = self._nonzero(a) or self._nonzero(b)
        return self._atom(k, a.sign, curvature, self.elasticity(shared) + mixed, nonzero)

    def _difference(self, k: int, sign: int, large: _Term, small: _Term, nonzero: bool) -> _Term:
        shared, rest_large, rest_small = _split(large, small)
        direct = self.curvature(large).concave and self.curvature(small).convex
        factored = self.curvature(rest_large).concave and self.curvature(rest_small).convex
        curvature = Curvature(False, direct) | (self.curvature(shared) & Curvature(False, factored))
        low, high = self._ratio(small, large, rest_small, rest_large)
        e_large, e_small = self.elasticity(rest_large), self.elasticity(rest_small)
        e_shared = self.elasticity(shared)
        if self.nodes[k].op == ca.OP_SUB:
            squares = e_shared + _weighted(e_large, e_small, (low * low, high * high))
            self.squares[k] = _sound(_scaled(squares, (2.0, 2.0)))
        return self._atom(k, sign, curvature, e_shared + _weighted(e_large, e_small, (low, high)), nonzero)

    def _ratio(self, a: _Term, b: _Term, rest_a: _Term, rest_b: _Term) -> Ends:
        """Return the range of a/b, by their own ranges and by what is left after cancelling."""
        (a_low, a_high), (b_low, b_high) = (np.asarray(self._size(t)) for t in (a, b))
        low, high = self._size(_times(rest_a, rest_b, -1.0))
        low, high = np.fmax(low, a_low / b_high), np.fmin(high, a_high / b_low)
        return float(low), float(high)

    def _extreme(self, k: int, node: Node, terms: Sequence[_Term | None]) -> _Term | None:
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
        curvatures = self.curvature(first) & self.curvature(second)
        curvature = Curvature(curvatures.convex and largest_size, curvatures.concave and not largest_size)
        elasticity = _hull(self.elasticity(first), self.elasticity(second))
        nonzero = (any if largest_size else all)(self._nonzero(t) for t in (first, second))
        return self._atom(k, first.sign, curvature, elasticity, nonzero)

    def _select(self, k: int, node: Node, terms: Sequence[_Term | None]) -> _Term | None:
        """Return where: one of two; a condition on choices alone says which, without a jump in the inputs."""
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
        curvature = self.curvature(yes) & self.curvature(no) if by_label else NEITHER
        smooth = _hull(self.elasticity(yes), self.elasticity(no))
        elasticity = np.where(jumping[:, None], self._jumps(jumping), smooth)
        return self._atom(k, yes.sign, curvature, elasticity, self._nonzero(yes) and self._nonzero(no))


# -- intervals ---------------------------------------------------------------------------------


def _natural(program: Program, node: Node, ends: Sequence[Ends], low: np.ndarray, high: np.ndarray) -> Ends:
    """Return the interval of a node from those of its arguments; not-a-number is unknown."""
    if node.op == ca.OP_CONST:
        return node.constant, node.constant
    if node.op == ca.OP_INPUT:
        a, b = low[int(node.constant)], high[int(node.constant)]
    else:
        args = [(np.float64(ends[i][0]), np.float64(ends[i][1])) for i in node.args]
        if node.op == OP_SPECIAL:
            a, b = program.specials[int(node.constant)].bounds(args)
        else:
            forward = FORWARD.get(node.op)
            a, b = forward(*args) if forward else (-INF, INF)
    return (-INF if np.isnan(a) else float(a)), (INF if np.isnan(b) else float(b))


def _feasible(
    model: Model, low: np.ndarray, high: np.ndarray
) -> tuple[list[float], list[float], set[int], set[tuple[int, int]]]:
    """Return what limits leave of the intervals of all nodes.

    Limits that a missing value may make void say nothing. A guard holds strictly: it also tells which nodes are above
    zero and which node is larger than another one.
    """
    program = model.program
    limits = [x for x in model.constraints if not x.void_without]
    above_zero: set[int] = set()
    larger: set[tuple[int, int]] = set()
    natural: list[Ends] = []
    for node in program.nodes:
        natural.append(_natural(program, node, natural, low, high))
    a, b = [x for x, _ in natural], [y for _, y in natural]
    for _ in range(SWEEPS):
        for limit in limits:
            value, bound = limit.nodes
            if limit.sense in ("at_most", "equal"):
                _order(value, bound, limit.scale, limit.guard, a, b, above_zero, larger)
            if limit.sense in ("at_least", "equal"):
                _order(bound, value, limit.scale, limit.guard, a, b, above_zero, larger)
        for k in range(len(program.nodes) - 1, -1, -1):
            _backward(program, k, a, b)
        ends: list[Ends] = []
        for k, node in enumerate(program.nodes):
            x, y = _natural(program, node, ends, low, high)
            x, y = max(a[k], x), min(b[k], y)
            if x > y + CROSSED * abs(y):  # nothing is feasible at all
                return [x for x, _ in natural], [y for _, y in natural], set(), set()
            a[k], b[k] = min(x, y), max(x, y)  # what crosses by rounding is one number
            ends.append((a[k], b[k]))
    return a, b, above_zero, larger


def _order(
    small: int,
    large: int,
    scale: float,
    guard: bool,
    a: list[float],
    b: list[float],
    above_zero: set[int],
    larger: set[tuple[int, int]],
) -> None:
    """Carry small <= large over to the intervals of both."""
    if np.isfinite(b[large]):
        b[small] = min(b[small], float(loosened(b[large], scale, +1)))
    if np.isfinite(a[small]):
        a[large] = max(a[large], float(loosened(a[small], scale, -1)))
    if guard:
        larger.add((large, small))
        if a[small] >= 0:
            above_zero.add(large)


def _backward(program: Program, k: int, a: list[float], b: list[float]) -> None:
    node = program.nodes[k]
    backward = BACKWARD.get(node.op)
    if backward is None:
        return
    args = [(np.float64(a[j]), np.float64(b[j])) for j in node.args]
    found = backward((np.float64(a[k]), np.float64(b[k])), *args)
    for j, bounds in zip(node.args, found, strict=True):
        if bounds is not None:
            a[j], b[j] = float(np.fmax(a[j], bounds[0])), float(np.fmin(b[j], bounds[1]))
