"""Dominance, spreading and ranking of a front."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth
from synth.order.pareto import Scale, knee_of, non_dominated, rank, senses_of, spread_subset


def dominated_by_hand(phi):
    """Return the mask of the non-dominated rows, row against row."""
    keep = []
    for k, row in enumerate(phi):
        better = np.all(phi <= row, axis=1) & np.any(phi < row, axis=1)
        earlier_twin = np.all(phi[:k] == row, axis=1).any()
        keep.append(not better.any() and not earlier_twin)
    return np.array(keep, dtype=bool)


# -- dominance ---------------------------------------------------------------------------------------


@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(0, 60))
@settings(deadline=None, derandomize=True, max_examples=150)
def test_non_dominated_rows(seed, objectives, count):
    rng = np.random.default_rng(seed)
    phi = rng.integers(0, 6, (count, objectives)) / 5.0
    assert non_dominated(phi).tolist() == dominated_by_hand(phi).tolist()


def test_rows_that_differ_by_rounding_are_one():
    phi = np.array([[1.0, 2.0], [1.0 + 1e-13, 2.0 - 1e-13], [2.0, 1.0]])
    assert non_dominated(phi).sum() == 2


def test_nothing_is_not_dominated():
    assert non_dominated(np.empty((0, 2))).tolist() == []


# -- spreading ---------------------------------------------------------------------------------------


def test_a_short_front_is_kept_whole():
    assert spread_subset(np.array([[1.0, 2.0], [2.0, 1.0]]), 5).tolist() == [0, 1]


@given(st.integers(0, 10**6), st.integers(2, 3), st.integers(2, 8))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_spread_subset_has_the_extremes_and_no_row_twice(seed, objectives, count):
    phi = np.random.default_rng(seed).random((40, objectives)) * 10 ** np.arange(objectives)
    chosen = spread_subset(phi, count)
    assert len(set(chosen.tolist())) == count
    if count >= objectives:
        assert set(np.argmin(phi, axis=0).tolist()) <= set(chosen.tolist())


def test_a_spread_subset_spreads():
    x = np.linspace(0, 1, 101)
    chosen = spread_subset(np.stack([x, 1 - x], axis=1), 5)
    assert np.diff(x[chosen]) == pytest.approx([0.25] * 4, abs=0.02)


# -- ranking -----------------------------------------------------------------------------------------

SENSES = {"mass": "min", "force": "min"}


def test_rank_orders_by_distance_to_the_ideal():
    values = np.array([[1.0, 10.0], [2.0, 2.0], [5.0, 1.0]])
    ranking = rank(SENSES, values, [1, 1])
    assert ranking.order == [1, 2, 0]
    assert ranking.scores == pytest.approx([np.log(10) / np.sqrt(2), np.log(2), np.log(5) / np.sqrt(2)])
    assert ranking.notes == ["smallest mass", "knee", "smallest force"]


def test_weights_tilt_the_rank():
    values = np.array([[1.0, 10.0], [2.0, 2.0], [5.0, 1.0]])
    assert rank(SENSES, values, [1, 0]).order == [0, 1, 2]
    assert rank(SENSES, values, [0, 1]).order == [2, 1, 0]
    assert rank(SENSES, values, [1, 0]).scores == pytest.approx([0, np.log(2), np.log(5)])


def test_equal_scores_are_ordered_by_the_objectives():
    values = np.array([[2.0, 1.0], [1.0, 2.0]])
    assert rank(SENSES, values, [1, 1]).order == [1, 0]


def test_what_is_to_be_large_is_ideal_when_large():
    values = np.array([[1.0, 3.0], [2.0, 4.0], [3.0, 9.0]])
    ranking = rank({"mass": "min", "margin": "max"}, values, [1, 3])
    assert ranking.notes[2].startswith("largest margin")
    assert ranking.notes[0].startswith("smallest mass")
    assert ranking.scores[0] == pytest.approx(np.log(3) * np.sqrt(0.75))
    assert ranking.scores[2] == pytest.approx(np.log(3) * 0.5)


def test_a_single_design_is_ideal():
    assert rank(SENSES, np.array([[3.0, 4.0]]), [1, 1], complete=True).notes == ["only non-dominated design"]
    assert rank(SENSES, np.array([[3.0, 4.0]]), [1, 1]).notes == [""]  # there may be others
    single = rank({"mass": "min"}, np.array([[3.0]]), [1])
    assert (single.order, single.scores.tolist(), single.notes) == ([0], [0.0], ["optimum"])


@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 20))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_scores_tell_how_far_from_the_ideal_designs_are(seed, objectives, count):
    rng = np.random.default_rng(seed)
    senses = {f"o{k}": rng.choice(["min", "max"]) for k in range(objectives)}
    values, weights = rng.normal(size=(count, objectives)), rng.random(objectives) + 0.1
    ranking = rank(senses, values, weights)
    assert sorted(ranking.order) == list(range(count))
    assert np.all(np.diff(ranking.scores[ranking.order]) >= 0)
    signed = values * senses_of(senses)
    linear = ~ranking.scale.has_ratios
    within = np.all((signed <= ranking.scale.nadir)[:, linear], axis=1)
    distances = ranking.scale.distances(signed)
    assert np.all((distances[within][:, linear] >= 0) & (distances[within][:, linear] <= np.log(2) * (1 + 1e-12)))
    best = signed.min(axis=0)
    ratios = np.maximum(signed / best, 1e-9)  # what has changed its sign is as far as can be
    assert distances[:, ~linear] == pytest.approx(np.abs(np.log(ratios))[:, ~linear])
    assert np.all((ranking.scores == 0) == np.all(distances == 0, axis=1))
    told = (ranking.scale.nadir > ranking.scale.ideal) & (linear | (ratios > 1e-9))
    assert ranking.scale.at(distances)[told] == pytest.approx(signed[told])


def test_scores_are_distances_of_logarithms():
    values = np.array([[40.85, 0.005677], [6.594, 0.001706], [4.77, 0.0035]])
    ranking = rank({"mass": "min", "inertia": "min"}, values, [1, 1])
    assert ranking.scores == pytest.approx([1.74032653, 0.228970960, 0.508135080], rel=1e-8)
    assert ranking.order == [1, 2, 0]
    # The reciprocal of what is to be small is as far from the ideal where it is to be large.
    larger = rank({"mass": "max", "inertia": "min"}, values ** [-1, 1], [1, 1])
    assert larger.scores == pytest.approx(ranking.scores)


def test_what_has_no_ratios_is_half_as_good_at_the_nadir():
    for best, sense in ((0.0, "min"), (-1.0, "min"), (1e-10, "min"), (1.0, "max")):
        worst = -1.0 if sense == "max" else 1.0
        values = np.array([[1.0, worst], [2.0, best]])
        ranking = rank({"mass": "min", "margin": sense}, values, [1, 1])
        assert ranking.scale.has_ratios.tolist() == [True, False]
        assert ranking.scores == pytest.approx([np.log(2) / np.sqrt(2)] * 2)


@given(st.integers(0, 10**6), st.integers(2, 3), st.integers(4, 20))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_designs_listed_beside_the_best_keep_their_order_and_scores(seed, objectives, count):
    rng = np.random.default_rng(seed)
    senses = {f"o{k}": rng.choice(["min", "max"]) for k in range(objectives)}
    values, weights = np.exp(rng.normal(size=(count, objectives))), rng.random(objectives) + 0.1
    every = rank(senses, values, weights)
    bests = np.argmin(values * senses_of(senses), axis=0)
    kept = np.unique(np.concatenate([bests, np.flatnonzero(rng.random(count) < 0.5)]))
    for scale in (None, every.scale):
        listed = rank(senses, values[kept], weights, scale=scale)
        assert listed.scores == pytest.approx(every.scores[kept], abs=1e-12)
        assert [int(kept[k]) for k in listed.order] == [k for k in every.order if k in kept]


def test_an_end_that_costs_much_for_little_stretches_no_scale():
    chosen = {"diameter": "min", "mass": "min"}
    front = np.array([[1.0, 40.0], [1.0004, 7.0], [1.2, 5.0], [1.5, 4.0]])
    ranking = rank(chosen, front, [1.0, 1.0])
    assert ranking.scale.nadir.tolist() == [1.5, 7.0]
    assert ranking.notes == ["smallest diameter, whose last 0.5 % costs much", "", "knee", "smallest mass"]
    assert (ranking.order[0], ranking.order[-1]) == (2, 0)
    # A front all of which is as good in an objective is ranked by what else it has.
    flat = rank(chosen, np.array([[1.0, 40.0], [1.004, 7.0]]), [1.0, 1.0])
    assert flat.order == [1, 0]


def test_a_scale_is_told_and_read_with_the_signs_of_the_objectives():
    chosen = {"mass": "min", "torque": "max"}
    scale = Scale.of(np.array([[1.0, -10.0], [2.0, -30.0]]))
    assert scale.as_record(chosen) == {"mass": [1.0, 2.0], "torque": [30.0, 10.0]}
    again = Scale.read(scale.as_record(chosen), chosen)
    assert np.array_equal([again.ideal, again.nadir], [scale.ideal, scale.nadir])


# -- whole fronts of discrete problems ---------------------------------------------------------------


def discrete(points):
    """Return a problem whose designs are the given points, one per count."""

    class Discrete(synth.DesignProblem):
        name = "discrete"

        def declare(self, d):
            n = d.count("number", 1, len(points))
            for k in range(len(points[0])):
                value = points[-1][k]
                for j, point in enumerate(points[:-1]):
                    value = np.where(n == j + 1, point[k], value)
                d.derive(f"objective_{k}", "-", value + 0 * n)
                d.objective(f"objective_{k}")

    return Discrete()


def found(designs, **more):
    front = synth.synthesize(discrete(designs), {}, **more)
    names = list(front.frame.objectives)
    return front, sorted(tuple(round(d.values[n], 9) for n in names) for d in front.designs)


def test_a_front_of_three_objectives_reaches_beyond_the_extremes():
    # The last point is worse in objective 2 than every design that is best in one objective.
    points = [(1.0, 1.5, 1.5), (1.5, 1.0, 1.5), (1.5, 1.5, 1.0), (1.2, 1.2, 1.9), (1.6, 1.6, 1.6)]
    front, values = found(points)
    assert values == sorted(points[:4])
    assert front.complete


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [2, 3])
@pytest.mark.parametrize("seed", range(4))
def test_a_discrete_front_is_found_whole(seed, objectives):
    points = np.round(1 + np.random.default_rng(seed).random((14, objectives)), 3)
    front, values = found([tuple(p) for p in points.tolist()], points=50)
    wanted = sorted(map(tuple, points[dominated_by_hand(points)].tolist()))
    assert values == wanted
    assert front.complete
    assert front.status.value == "optimal"


def test_objectives_that_may_be_zero_or_negative_are_traded_too():
    points = [(-2.0, 3.0), (-1.0, 0.0), (0.0, -1.0), (1.0, -2.0), (1.0, 3.0)]
    front, values = found(points)
    assert values == sorted(points[:4])
    assert front.complete


def test_fewer_points_than_there_are():
    points = [(1 + 0.1 * k, 2 - 0.1 * k) for k in range(9)]
    front, values = found(points, points=3)
    assert len(values) == 3
    assert not front.complete
    assert {values[0], values[-1]} == {(1.0, 2.0), (1.8, 1.2)}


def test_the_largest_numbers_there_are_have_their_place() -> None:
    largest = np.finfo(float).max
    phi = np.array([[-largest, 2.0], [-largest, 3.0], [1.0, 1.0], [largest, 0.5], [np.inf, 0.5]])
    assert non_dominated(phi).tolist() == [True, False, True, True, False]


def test_every_ranked_front_has_a_knee() -> None:
    assert knee_of(["smallest mass", "", "knee; smallest force"]) == 2
    for count in (1, 2, 3, 6):
        for width in (1, 2, 3):
            names = {f"f{k}": "min" for k in range(width)}
            values = np.random.default_rng(count).random((count, width))
            ranking = rank(names, values, [1.0] * width)
            notes = [ranking.notes[k] for k in ranking.order]
            named = [k for k, note in enumerate(notes) if "knee" in note]
            assert knee_of(notes) == (named[0] if named else 0)
            assert bool(named) == (count > 2 and width > 1)
