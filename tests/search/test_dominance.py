"""Which known designs cover boxes: every form against brute force, bit by bit, and a whole search by each of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth import load
from synth.kernels.loading import best_variant
from synth.search import archive as archive_module
from synth.search import pruning
from synth.search.archive import Archive, Candidate, distinct
from synth.search.dominance import CornerTable, CoverSets, sorted_points
from synth.search.dominance_code import dominance_code
from synth.search.pruning import NonImprovement
from synth.search.settings import TUNING, DominanceSettings, Tuning
from tests.tuned import synthesize, tuned

BUILT = pytest.mark.skipif(best_variant("dominance") is None, reason="no kernel was built")
COMPILED = [False, pytest.param(True, marks=BUILT)]


def code(wanted: bool) -> Any:
    """The kernel, if it is wanted."""
    return dominance_code() if wanted else None


def least_by_hand(points: np.ndarray, lower: np.ndarray, strict: bool) -> np.ndarray:
    """Return, per box, the least value of each objective among the points that cover it in all others."""
    result = np.full(lower.shape, np.inf)
    for first in range(0, len(lower), 100):
        own, least = lower[first : first + 100], result[first : first + 100]
        under = points[None] < own[:, None] if strict else points[None] <= own[:, None]
        for k in range(lower.shape[1]):
            covers = np.delete(under, k, axis=2).all(axis=2)
            least[:, k] = np.where(covers, points[None, :, k], np.inf).min(axis=1, initial=np.inf)
    return result


def some_numbers(rng: np.random.Generator, shape: tuple[int, int], *rare: float) -> np.ndarray:
    """Return numbers with many ties, some of them infinite or not a number."""
    numbers = np.round(rng.uniform(-1, 1, shape), int(rng.integers(1, 4)))
    for value in rare:
        numbers[rng.random(shape) < 0.05] = value
    return numbers


@pytest.mark.slow
@pytest.mark.parametrize("compiled", COMPILED)
@pytest.mark.parametrize(("form", "m"), [(CornerTable, 3), (CoverSets, 3), (CoverSets, 4), (CoverSets, 5)])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=80)
def test_every_form_tells_what_brute_force_tells(form, m, compiled, seed):
    rng = np.random.default_rng(seed)
    count, boxes, strict = int(rng.integers(1, 250)), int(rng.integers(0, 80)), bool(rng.integers(2))
    points = some_numbers(rng, (count, m), -np.inf, np.inf)
    points = points[rng.integers(0, count, count)] if rng.random() < 0.3 else points  # some of them twice
    lower = some_numbers(rng, (boxes, m), -np.inf, np.inf, np.nan)
    sizes = {"rows": int(rng.integers(1, 300)), "boxes": int(rng.integers(1, 100))}
    own = replace(TUNING.dominance, block=float(rng.uniform(0.1, 3)), **sizes)
    found = form(points, own, strict).least(lower, code(compiled))
    np.testing.assert_array_equal(found, least_by_hand(points, lower, strict))


@pytest.mark.parametrize("compiled", COMPILED)
@pytest.mark.parametrize("m", [3, 4])
def test_many_points_in_general_position(m, compiled):
    rng = np.random.default_rng(m)
    points = rng.exponential(size=(2500, m))
    points /= np.linalg.norm(points, axis=1)[:, None]
    lower = np.array(points[:300]) + rng.normal(0, 0.05, (300, m))
    found = sorted_points(points, TUNING.dominance).least(lower, code(compiled))
    np.testing.assert_array_equal(found, least_by_hand(points, lower, False))
    assert 0.3 < np.isfinite(found).mean() < 1.0


@pytest.mark.parametrize("m", [3, 4, 5])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_steps_above_a_box_against_brute_force(m, seed):
    rng = np.random.default_rng(seed)
    archive = Archive(range(m), 0, m, TUNING)
    phi = some_numbers(rng, (int(rng.integers(1, 60)), m))
    archive.add(np.arange(len(phi)), np.empty((len(phi), 0)), phi)
    tolerance = np.round(rng.uniform(0.0, 0.3, m), 2)
    rule = NonImprovement(list(archive), range(m), tolerance, archive)
    lower = some_numbers(rng, (40, m), -np.inf, np.inf, np.nan)
    cutoffs = rule.cutoffs(lower)
    known = least_by_hand(archive.phi - tolerance, lower, False)
    for own, found, covered in zip(lower, cutoffs, known, strict=True):
        below = rule.steps[(own < rule.steps).all(axis=1)]
        np.testing.assert_array_equal(found, np.minimum(below.max(axis=0, initial=-np.inf), covered))


def test_designs_that_come_later_count_and_so_does_another_tolerance():
    archive, lower = Archive(range(3), 0, 3, TUNING), np.full((1, 3), 0.5)
    for phi, tolerance in (((0.4, 0.4, 0.4), 0.1), ((0.4, 0.4, 0.4), 0.0), ((0.3, 0.45, 0.5), 0.0)):
        archive.add(np.arange(1), np.empty((1, 0)), np.array([phi]))
        least = archive.cutoffs(lower, np.full(3, tolerance))
        np.testing.assert_array_equal(least, least_by_hand(archive.phi - tolerance, lower, False))
    assert least.tolist() == [[0.3, 0.4, 0.4]]


def beaten_by_hand(phi: np.ndarray, margin: np.ndarray) -> list[int]:
    """Return which rows none beats; of those that beat each other by the margin the first stays."""

    def beats(a: int, b: int) -> bool:
        return bool(np.all(phi[a] <= phi[b] + margin[b]))

    every = range(len(phi))
    return [b for b in every if not any(beats(a, b) and (a < b or not beats(b, a)) for a in every)]


@pytest.mark.parametrize("m", [2, 3, 4])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_distinct_designs_against_brute_force(m, seed):
    rng = np.random.default_rng(seed)
    phi = np.round(rng.uniform(0, 1, (int(rng.integers(1, 60)), m)), 1)
    phi += rng.choice([0.0, 1e-9, 1e-8], phi.shape)
    tuning = tuned(arrays={"compared": int(rng.integers(1, 70))})
    equal = float(rng.choice([0.0, 1e-7]))
    margin = np.maximum(TUNING.tolerances.rounded * np.maximum(np.abs(phi), 1.0), equal)
    kept = distinct([Candidate(k, np.zeros(0), row) for k, row in enumerate(phi)], m, tuning, equal)
    assert [c.combination for c in kept] == beaten_by_hand(phi, margin)


def test_arrays_tell_dominance_where_no_kernel_is_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    assert dominance_code() is None


class ByHand:
    """Points compared with all boxes, one by one."""

    def __init__(self, points: np.ndarray, settings: DominanceSettings, strict: bool = False) -> None:
        self.points, self.strict = points, strict

    def least(self, lower: np.ndarray, code: object = None) -> np.ndarray:
        return least_by_hand(self.points, lower, self.strict)


DRIVE = {
    "load_torque": "60 N*m",
    "driver_speed": "1500 1/min",
    "driven_inertia": "0.7 kg*m2",
    "engagements_per_hour": "20 1/h",
    "jerk_limit": "300 rad/s3",
}
GOALS = ["mass", "actuation_force", "outer_diameter", "volume"]


def front_by(tuning: Tuning, m: int) -> tuple[list[list[float]], str, int]:
    """Return the objectives of a front, its certificate and the boxes that it took."""
    front = synthesize(tuning, load("disc_clutch", practice="off"), DRIVE, objectives=GOALS[:m], points=10, gap=0.2)
    values = [[design.values[name] for name in GOALS] for design in front.designs]
    return values, front.certificate.kind, front.statistics["boxes"]


@pytest.mark.slow
@pytest.mark.parametrize("m", [3, 4])
def test_a_search_takes_the_same_way_whatever_tells_dominance(m, monkeypatch):
    by_kernel = front_by(TUNING, m)
    assert len(by_kernel[0]) == 10
    assert by_kernel[1] == "global"
    with monkeypatch.context() as patch:
        for module in (archive_module, pruning):
            patch.setattr(module, "dominance_code", lambda: None)
        assert front_by(TUNING, m) == by_kernel
    monkeypatch.setattr(archive_module, "sorted_points", ByHand)
    monkeypatch.setattr(pruning, "sorted_points", ByHand)
    assert front_by(TUNING, m) == by_kernel
