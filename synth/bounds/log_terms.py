"""Quantities as products of powers of atoms, with the curvature and the elasticities of their logarithms.

Atoms are inputs, sums, differences and functions. What cancels in a quotient is gone before anything is said of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.curvature import BOTH, INF, Curvature, Ends
from synth.model.program import Node
from synth.order.margins import Numbers


@dataclass(frozen=True)
class Term:
    """A quantity of known sign as sign * factor * product of atoms (by node number) to powers."""

    sign: int
    factor: float
    powers: dict[int, float]


@dataclass(frozen=True)
class Atom:
    """What is known of the size of an atom."""

    curvature: Curvature
    elasticity: np.ndarray
    ends: Ends
    nonzero: bool


def times(a: Term, b: Term, power: float = 1.0) -> Term:
    """Return a * b**power; for a power of -1 the sign is right as well."""
    powers = dict(a.powers)
    for atom, p in b.powers.items():
        powers[atom] = powers.get(atom, 0.0) + power * p
    powers = {atom: p for atom, p in powers.items() if p != 0.0}
    return Term(a.sign * b.sign, a.factor * b.factor**power, powers)


def raised(a: Term, power: float, sign: int = 1) -> Term:
    """Return the size of a term to a power, with a sign."""
    return Term(sign, a.factor**power, {atom: power * p for atom, p in a.powers.items() if power != 0.0})


def without_common(a: Term, b: Term) -> tuple[Term, Term, Term]:
    """Common part of two terms, and the remainder of each."""
    common = {atom: min(p, b.powers[atom]) for atom, p in a.powers.items() if atom in b.powers}
    shared = Term(1, 1.0, common)
    return shared, times(a, shared, -1.0), times(b, shared, -1.0)


def _product(a: Numbers, b: Numbers) -> Any:
    """Multiply; zero times infinity is zero, because every factor is finite and only its range has no end."""
    return np.where((np.asarray(a) == 0) | (np.asarray(b) == 0), 0.0, np.asarray(a) * np.asarray(b))


def scaled(elasticity: np.ndarray, ends: Ends) -> np.ndarray:
    """Return the product of intervals."""
    if ends[0] == ends[1]:
        product: np.ndarray = _product(elasticity, ends[0])
        return product if ends[0] >= 0 else product[:, ::-1]
    corners = np.stack([_product(elasticity[:, i], x) for i in (0, 1) for x in ends])
    return np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1)


def hull(*elasticities: np.ndarray) -> np.ndarray:
    """Return the least intervals that hold all of those given, per input."""
    stacked = np.stack(elasticities)
    return np.stack([stacked[:, :, 0].min(axis=0), stacked[:, :, 1].max(axis=0)], axis=1)


def difference_elasticity(large: np.ndarray, small: np.ndarray, ratio: Ends) -> np.ndarray:
    """Return the elasticity of a difference from those of its terms.

    It is small + w (large - small), where w = 1/(1 - ratio) is the larger term over the difference.
    """
    weights = [1 / (1 - r) if r < 1 else INF for r in ratio]
    lows = [small[:, 1] + _product(w, large[:, 0] - small[:, 1]) for w in weights]
    highs = [small[:, 0] + _product(w, large[:, 1] - small[:, 0]) for w in weights]
    return without_nan(np.stack([np.minimum(*lows), np.maximum(*highs)], axis=1))


def without_nan(elasticity: np.ndarray) -> np.ndarray:
    """Return the interval with what is not a number taken as unknown."""
    low, high = elasticity[:, 0], elasticity[:, 1]
    return np.stack([np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)], axis=1)


class AtomTable:
    """The atoms of a program, and what they say of products of their powers.

    Parameters
    ----------
    nodes : list of Node
        Of the program; atoms are known by their numbers in it.
    n : int
        Inputs of the program.
    """

    def __init__(self, nodes: Sequence[Node], n: int) -> None:
        self._nodes, self._n = nodes, n
        self._atoms: dict[int, Atom] = {}
        self._squares: dict[int, np.ndarray] = {}  # of a difference: the elasticity of the difference of both squares

    def add(self, k: int, sign: int, atom: Atom) -> Term:
        """Make a node an atom, and return it as a term."""
        self._atoms[k] = replace(atom, elasticity=without_nan(atom.elasticity))
        return Term(sign, 1.0, {k: 1.0})

    def add_square(self, k: int, elasticity: np.ndarray) -> None:
        """Note the elasticity of a**2 - b**2 for the atom a - b."""
        self._squares[k] = without_nan(elasticity)

    def settle(self, k: int, ends: Ends, sign: int) -> None:
        """Take the interval of a node of this sign, if it is an atom: that of an atom is that of its size."""
        if k in self._atoms:
            a, b = ends
            self._atoms[k] = replace(self._atoms[k], ends=(a, b) if sign > 0 else (0.0 - b, 0.0 - a))

    def nonzero(self, term: Term) -> bool:
        """True if a term is surely not zero."""
        return all(self._atoms[atom].nonzero for atom, p in term.powers.items() if p > 0)

    def elasticity(self, term: Term) -> np.ndarray:
        """Return the interval of the elasticity per input."""
        powers, squares = self._squared(term)
        total, plain = np.zeros((self._n, 2)), np.zeros((self._n, 2))
        for atom, p in term.powers.items():
            plain = plain + scaled(self._atoms[atom].elasticity, (p, p))
        if not squares:
            return without_nan(plain)
        for atom, p in powers.items():
            total = total + scaled(self._atoms[atom].elasticity, (p, p))
        for atom, p in squares.items():
            total = total + scaled(self._squares[atom], (p, p))
        plain, total = without_nan(plain), without_nan(total)
        return np.stack([np.maximum(plain[:, 0], total[:, 0]), np.minimum(plain[:, 1], total[:, 1])], axis=1)

    def curvature(self, term: Term) -> Curvature:
        """Return the curvature of a product of powers."""
        powers, squares = self._squared(term)
        result = BOTH
        for atom, p in [*powers.items(), *squares.items()]:
            if p != 0.0:
                curvature = self._atoms[atom].curvature
                result = result & (curvature if p > 0 else curvature.opposite())
        return result

    def _squared(self, term: Term) -> tuple[dict[int, float], dict[int, float]]:
        """Return powers of atoms, and those of products (a + b)(a - b) by their difference.

        Such a product is a**2 - b**2, which has the curvature of a - b.
        """
        powers, squares = dict(term.powers), dict[int, float]()
        for atom in term.powers:
            operands = sorted(self._nodes[atom].args)
            for other in term.powers if atom in self._squares else ():
                partner = self._nodes[other]
                matches = partner.op == ca.OP_ADD and sorted(partner.args) == operands
                if matches and powers[atom] * powers[other] > 0:
                    p = min(powers[atom], powers[other], key=abs)
                    powers[atom] -= p
                    powers[other] -= p
                    squares[atom] = p
        return powers, squares

    def size(self, term: Term) -> Ends:
        """Return the range of the size of a term, from those of its atoms."""
        low = high = np.float64(term.factor)
        for atom, p in term.powers.items():
            a, b = (np.float64(x) ** p for x in self._atoms[atom].ends)
            low, high = low * min(a, b), high * max(a, b)
        return (0.0 if np.isnan(low) else float(low)), (INF if np.isnan(high) else float(high))

    def ratio(self, a: Term, b: Term, cofactor_a: Term, cofactor_b: Term) -> Ends:
        """Range of a/b: the intersection of what their ranges and their cofactors after cancelling give."""
        (a_low, a_high), (b_low, b_high) = (np.asarray(self.size(t)) for t in (a, b))
        low, high = self.size(times(cofactor_a, cofactor_b, -1.0))
        low, high = np.fmax(low, a_low / b_high), np.fmin(high, a_high / b_low)
        return float(low), float(high)
