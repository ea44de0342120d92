"""Regions proven by levels: what is true closes, what is wrong is refuted, and what stays open is told."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

import synth
from synth.proof.levels import prove_regions
from synth.proof.questions import Point
from synth.proof.settings import ProofLimits
from synth.proof.tree import ProofTree
from synth.question.catalogs import as_catalogs
from synth.special import special
from tests.asking import instance_of

# The proof of all regions at once does nothing, so that levels have to.
LEVELS = ProofLimits(at_once=0, at_once_each=0, behind=0.0)
SENSES = {"effort": "min", "gain": "max", "drift": "min"}


@special((0.0, 1.0))
def settled(pull):
    """Rise with the pull, ever less."""
    return pull / (1 + pull)


class Pulled(synth.DesignProblem):
    """Makeable sizes of which one objective sees only a product; the others are to be large, or negative and zero."""

    name = "pulled"

    def __init__(self, seed):
        self.seed = seed
        super().__init__()

    def declare(self, d):
        a, b, c = np.random.default_rng(self.seed).uniform(0.5, 2, 3).tolist()
        x = d.variable("x", "-", 1, 4, grid=[1, 1.5, 2, 2.5, 3, 3.5, 4])
        y = d.variable("y", "-", 1, 3, grid=[1, 1.25, 1.5, 2, 2.5, 3])
        n = d.count("n", 1, 4)
        pull = d.derive("pull", "-", x * y * n)
        d.at_least("enough", pull, 4 * a + 0 * x, "-")
        d.derive("effort", "-", a * x + y * y + b * n)
        d.derive("gain", "-", settled(pull) / settled(x * pull / c))
        d.derive("drift", "-", x - y + (n - 2) / 2)
        for name, sense in SENSES.items():
            d.objective(name, sense)


def every_design(instance):
    """Return all designs as points, their objectives to be made small, and which are feasible."""
    points = []
    for x, y in itertools.product(*instance.ranges.grids()):
        points += [Point(np.array([x, y]), [float(n)], {}) for n in instance.selection.counts["n"]]
    results = [instance.model.evaluate(p.variables[None], p.data) for p in points]
    feasible = np.array([bool(np.all(r.feasible)) for r in results])
    signs = {"min": 1.0, "max": -1.0}
    values = [[float(np.ravel(r.values[n])[0]) * signs[s] for n, s in SENSES.items()] for r in results]
    return points, np.array(values), feasible


class Claim:
    """The front over two objectives of a question by enumeration, and proofs of regions."""

    def __init__(self, seed, names, limits=LEVELS):
        self.names = names
        self.instance = instance_of(Pulled(seed), {}, as_catalogs(None))
        columns = [list(SENSES).index(name) for name in names]
        points, values, feasible = every_design(self.instance)
        self.every = values[feasible][:, columns]
        good = np.flatnonzero(feasible)
        self.room = 1e-6 * np.maximum(np.ptp(self.every, axis=0), 1e-3)
        best = [
            k
            for k, v in enumerate(self.every)
            if not np.any(np.all(self.every <= v, axis=1) & np.any(self.every < v, axis=1))
        ]
        _, once = np.unique(np.round(self.every[best], 9), axis=0, return_index=True)
        self.front = self.every[best][once]
        self.points = [points[good[best[k]]] for k in once]
        senses = {name: SENSES[name] for name in names}
        self.tree = ProofTree(self.instance, senses, limits)
        self.guided = ProofTree(self.instance, senses, limits, guided=True)

    def prove(self, ends, near=None, deadline=math.inf):
        signs = np.array([1.0 if SENSES[n] == "min" else -1.0 for n in self.names])

        def confirm(point):
            result = self.instance.model.evaluate(point.variables[None], point.data)
            own = np.array([float(np.ravel(result.values[n])[0]) for n in self.names]) * signs
            return bool(np.all(result.feasible)) and bool(np.any(np.all(own < ends, axis=1)))

        near = [[p] for p in self.points] if near is None else near
        return prove_regions(self.tree, lambda: self.guided, ends, near, confirm, deadline)


PAIRS = [("effort", "gain"), ("effort", "drift"), ("gain", "drift")]


@pytest.mark.slow
@pytest.mark.parametrize("names", PAIRS, ids="-".join)
@pytest.mark.parametrize("seed", range(4))
def test_levels_close_where_enumeration_finds_nothing_better(seed, names):
    claim = Claim(seed, names)
    assert len(claim.front) > (0 if seed == 3 else 2)
    outcome = claim.prove(claim.front - claim.room)
    assert outcome.closed
    assert outcome.open_regions == ()
    assert outcome.nodes > 0


@pytest.mark.slow
@pytest.mark.parametrize("names", PAIRS, ids="-".join)
@pytest.mark.parametrize("seed", range(4))
def test_a_design_that_is_worse_than_told_is_refuted_by_levels(seed, names):
    claim = Claim(seed, names)
    for k in range(len(claim.front)):
        ends = claim.front - claim.room
        ends[k] += 2 * claim.room  # so that the design itself is better by more than the gap
        outcome = claim.prove(ends)
        assert not outcome.closed
        assert outcome.witness is not None


@pytest.mark.parametrize("seed", range(4))
def test_an_end_that_is_not_the_best_is_refuted_by_levels(seed):
    claim = Claim(seed, ("effort", "drift"))
    ends = claim.front[1:] - claim.room
    ends[0, 1] = math.inf  # nothing is told to be better in the first objective than the second best
    outcome = claim.prove(ends, [[p] for p in claim.points[1:]])
    assert outcome.witness is not None


def test_boxes_carry_what_an_objective_sees():
    claim = Claim(0, ("effort", "gain"))
    assert len(claim.guided._lifted) == 1
    assert not claim.tree._lifted
    assert not Claim(0, ("effort", "drift")).guided._lifted


@pytest.mark.slow
def test_what_stays_open_is_told_and_what_is_proven_of_others_stays():
    left = []
    for most in (0, 20, 40, 80, 160, 320, 640, 1_000_000):
        few = dataclasses.replace(LEVELS, most_nodes=most, turn=10, chunk=16, few_guided=1)
        claim = Claim(1, ("effort", "gain"), few)
        outcome = claim.prove(claim.front - claim.room)
        assert outcome.closed == (not outcome.open_regions)
        left.append(set(outcome.open_regions))
    every = set(range(len(claim.front)))
    assert left[0] == every
    assert left[-1] == set()
    assert any(set() < some < every for some in left)
    assert claim.prove(claim.front - claim.room, deadline=0.0).open_regions == tuple(sorted(every))


def test_regions_without_a_design_near_are_proven_by_levels_too():
    claim = Claim(2, ("effort", "gain"))
    outcome = claim.prove(claim.front - claim.room, [[] for _ in claim.front])
    assert outcome.closed
    assert outcome.nodes > 0
