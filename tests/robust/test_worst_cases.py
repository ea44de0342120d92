"""Limits that are not monotone over a range: never said to hold where an independent search finds that they do not."""

import csv
import io
import json
from collections import Counter

import numpy as np
import pytest
from rich.console import Console
from scipy.optimize import minimize

import synth
from synth.order.feasibility import SMALLEST, TOLERANCE
from synth.results.rating_tables import robust_sentence
from synth.results.ratings import DesignRating
from synth.terminal.robust_console import print_ratings
from tests.repetitions import repetitions
from tests.sample_problems.scattered_limit import HIGH, LOW, ScatteredLimit, ridged, wavy

pytestmark = pytest.mark.slow


def test_the_worst_corner_of_monotone_directions_meets_a_worst_point_between_ends():
    told = ScatteredLimit(wavy, 4, 40.0).rated(15)
    assert told["holds"] is False
    assert told["verdict"] == "no"
    assert told["worst_at"] == pytest.approx({"q0": 1.2, "q1": 1.2, "q2": 0.8, "q3": 1.05}, abs=1e-6)
    assert told["limits"]["limit"]["value"] == pytest.approx(43.2)
    # All samples hold; the violation is known all the same.
    assert told["yield_low"] <= told["yield"] < 1
    assert told["yield_high"] < 1


@pytest.mark.parametrize("factor", [10, 13.88, 13.8888])
def test_bounds_prove_a_worst_point_between_ends(factor):
    told = ScatteredLimit(wavy, 4, 40.0).rated(factor)
    assert (told["holds"], told["verdict"], told["proof"]) == (True, "yes", "proven")
    assert told["limits"]["limit"]["proof"] == "bounded"
    assert told["limits"]["limit"]["value"] == pytest.approx(2.88 * factor)
    assert told["yield"] == told["yield_low"] == 1


def test_a_front_is_held_at_a_worst_point_between_ends():
    problem = ScatteredLimit(wavy, 4, 40.0)
    front = synth.synthesize(problem, problem.needed, robust=problem.block)
    assert [d.robust["verdict"] for d in front.designs] == ["yes"]
    assert front.designs[0].values["factor"] == pytest.approx(40 / 2.88, rel=1e-6)
    assert front.certificate.kind == "global"


@pytest.mark.parametrize(
    ("formula", "count"),
    [
        (lambda q: np.sqrt(q[0] - 0.81), 1),
        (lambda q: -np.sqrt(q[0] * q[1] - 0.641), 2),
        (lambda q: -np.log(q[0] - q[1] + 0.39), 2),
        (lambda q: np.arcsin(0.84 * q[0]), 1),
        (lambda q: (q[0] - 0.81) ** 1.5, 1),
        (lambda q: np.where(q[1] > 1, np.sqrt(q[0] - 0.81), 1), 2),
    ],
)
def test_a_limit_that_cannot_be_computed_somewhere_does_not_hold(formula, count):
    # Each rises or falls wherever it is defined, and is undefined at another corner than its worst.
    told = ScatteredLimit(formula, count, 50.0).rated()
    assert told["holds"] is False
    assert told["worst_residual"] is None


def test_a_side_that_is_not_taken_may_be_undefined():
    told = ScatteredLimit(lambda q: np.where(q[0] > 2, np.sqrt(q[0] - 2), q[0]), 1, 2.0).rated()
    assert told["limits"]["limit"]["proof"] == "proven"
    assert told["holds"]


@pytest.mark.parametrize(
    "formula", [lambda q: 1 / (0.9137 - q[0]), lambda q: np.tan(1.571 * q[0]), lambda q: 1 / (q[0] - q[1] + 0.0137)]
)
def test_a_pole_within_the_range_is_never_said_to_hold(formula):
    told = ScatteredLimit(formula, 2, 1e9).rated()
    assert told["holds"] is not True
    assert told["yield"] < 1


def test_a_requirement_that_is_negative_scatters_in_the_other_direction():
    class Negative(synth.DesignProblem):
        name, title, sources = "negative", "Negative", ("made up",)

        def declare(self, d):
            size = d.variable("size", "-", -10, 10)
            d.at_most("limit", size, -0.95, "-")
            d.objective("size")

    design = synth.evaluate(Negative(), {}, values={"size": "-1"})
    told = synth.rate(design, {"size": "+-10 %"}, problem=Negative()).designs[0].robust
    assert (told["holds"], told["proof"]) == (False, "proven")
    assert told["worst_at"] == {"size": -0.9}


def test_what_is_not_shown_is_said_so_everywhere():
    problem = ScatteredLimit(ridged, 4, 1.0)
    found = synth.rate(problem.design(), problem.block, problem=problem)
    told = found.designs[0].robust
    assert told["holds"] is None
    assert not told.holds
    assert (told["verdict"], told["proof"]) == ("not shown", "sampled")
    assert (told["limits"]["limit"]["holds"], told["limits"]["limit"]["verdict"]) == (None, "not shown")
    assert told["yield"] == told["yield_low"] < told["yield_high"] == 1
    files = found.files()
    for name in ("rating.csv", "robust.csv"):
        assert [row["robust"] for row in csv.DictReader(io.StringIO(files[name]))] == ["not shown"]
    assert float(next(csv.DictReader(io.StringIO(files["rating.csv"])))["yield"]) < 1
    written = json.loads(files["rating.json"])
    assert written["designs"][0]["verdict"] == "not shown"
    assert "not shown" in written["sentence"]
    screen = io.StringIO()
    print_ratings(found, Console(file=screen, width=100))
    assert "not shown" in screen.getvalue()
    for words in ("yes", "(proven)", "1 of 1"):
        assert words not in screen.getvalue()


def test_what_is_not_shown_stays_on_a_front():
    problem = ScatteredLimit(ridged, 4, 1.0)
    front = synth.synthesize(problem, problem.needed, robust=problem.block, fix={"factor": "1"})
    assert [d.robust["verdict"] for d in front.designs] == ["not shown"]
    assert front.statistics["robust"]["taken_off"] == 0
    assert robust_sentence(front.designs).startswith("not shown that the design keeps all limits")
    assert front.verify().holds


def test_designs_of_all_verdicts_are_counted_in_one_sentence():
    problem, other = ScatteredLimit(ridged, 4, 1.0), ScatteredLimit(ridged, 4, 1.5)
    unknown = synth.rate(problem.design(), problem.block, problem=problem).designs[0]
    holds = synth.rate(other.design(), other.block, problem=other).designs[0]
    fails = synth.rate(problem.design(1.1), problem.block, problem=problem).designs[0]
    assert robust_sentence([holds, fails]) == "1 of 2 designs keeps all limits over the whole range (proven)"
    assert robust_sentence([holds, fails, unknown]).startswith(
        "1 of 3 designs keeps all limits over the whole range (proven); not shown of 1: no violation was found"
    )
    assert robust_sentence([fails, unknown]).startswith("none of 2 designs is shown to keep all limits")
    assert robust_sentence([fails]) == "the design does not keep all limits over the whole range"


def test_ratings_of_older_files_claim_no_more_than_they_show():
    old = {"holds": True, "proof": "sampled", "yield": 1.0, "yield_low": 0.999, "yield_high": 1.0}
    told = DesignRating.from_json({**old, "limits": {"a": {"holds": True, "proof": "sampled"}}})
    assert (told["holds"], told["verdict"], told["yield"]) == (None, "not shown", 0.999)
    assert told["limits"]["a"]["verdict"] == "not shown"
    told = DesignRating.from_json({**old, "proof": "proven", "limits": {"a": {"holds": True, "proof": "bounded"}}})
    assert (told["verdict"], told["yield"], told["limits"]["a"]["verdict"]) == ("yes", 1.0, "yes")
    assert DesignRating.from_json({**old, "holds": False})["verdict"] == "no"


# ---- against an independent search ----------------------------------------------------------------------------------


def smooth_term(rng, count):
    """A random term of what scatters, most of them not monotone; defined and continuous."""
    i, j, k = rng.integers(count, size=3)
    a, b, c = rng.uniform(0.8, 1.2), rng.uniform(2, 20), rng.uniform(-1, 1)
    return [
        lambda q: 1 + 0.6 * np.cos(b * (q[i] - a)),
        lambda q: q[i] * q[j] / q[k],
        lambda q: np.exp(-b * (q[i] - a) ** 2),
        lambda q: 1 / (0.05 * a + (q[i] - a * q[j]) ** 2),
        lambda q: np.abs(q[i] - a * q[j]),
        lambda q: np.fmax(q[i] * a, q[j] ** 3),
        lambda q: q[k] * np.sin(b * (q[i] + c * q[j])),
        lambda q: (q[i] + c * q[j] - a * q[k]) ** 2,
        lambda q: np.arctan(b * (q[i] - a * q[j])),
        lambda q: np.sqrt(q[i] * q[j] + a),
    ][rng.integers(10)]


def rough_term(rng, count):
    """A random term that jumps, has a pole, or is not defined everywhere."""
    i, j = rng.integers(count, size=2)
    a, b, c = rng.uniform(0.75, 1.25), rng.uniform(2, 8), rng.uniform(0.5, 0.9)
    return [
        lambda q: np.floor(b * q[i]),
        lambda q: np.sign(q[i] - a),
        lambda q: np.where(q[i] > a, q[j], b * q[i] * c),
        lambda q: np.where(q[i] > q[j], q[i], 2 * q[j]),
        lambda q: np.sqrt(q[i] - c),
        lambda q: np.log(q[i] + q[j] - 2 * c),
        lambda q: 1 / (q[i] - c),
        lambda q: np.arcsin(c * q[i]),
    ][rng.integers(8)]


def random_formula(rng, count, rough):
    terms = [smooth_term(rng, count) for _ in range(rng.integers(1, 4))]
    if rough:
        terms.append(rough_term(rng, count))
    joins = rng.integers(3, size=len(terms))

    def formula(q):
        result = terms[0](q)
        for term, join in zip(terms[1:], joins[1:], strict=True):
            own = term(q)
            result = result * own if join == 0 else result + own if join == 1 else result - own
        return result

    return formula


def largest(formula, count, rng):
    """The largest value that a dense search finds, infinite where there is none at some point."""
    points = rng.random((20000, count))
    axes = np.meshgrid(*[np.linspace(0, 1, {1: 20001, 2: 161, 3: 29}.get(count, 9))] * count)
    grid = np.stack(axes, axis=-1).reshape(-1, count)
    points = LOW + (HIGH - LOW) * np.concatenate([points, np.clip(2 * points - 0.5, 0, 1), grid])
    with np.errstate(all="ignore"):
        values = np.broadcast_to(formula(points.T), len(points))
        if np.isnan(values).any():
            return np.inf
        best = values.max()
        for k in np.argsort(-values)[:100:20]:
            done = minimize(
                lambda p: -float(formula(np.clip(p, LOW, HIGH))),
                points[k],
                method="Nelder-Mead",
                options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 300},
            )
            best = max(best, -done.fun)
    return float(best)


def missed(value, bound, sense):
    """By how much of its size the limit is missed; infinite where its value is no number."""
    if not np.isfinite(value):
        return np.inf
    sides = (value, bound) if sense == "at_most" else (2 * bound + 10 - value, bound + 10)
    return (value - bound) / max(*map(abs, sides), SMALLEST)


@pytest.mark.parametrize("rough", [False, True])
def test_no_limit_is_said_to_hold_that_a_dense_search_breaks(rough):
    """The bound lies a little above or below the worst value, so that samples alone would often be wrong."""
    counts: Counter[tuple[bool, bool | None]] = Counter()
    for seed in range(repetitions(25, 600)):
        rng = np.random.default_rng([seed, rough])
        count = int(rng.integers(1, 5))
        formula = random_formula(rng, count, rough)
        worst = largest(formula, count, rng)
        by = float(rng.choice([0.5, 0.97, 0.999, 0.99999, 1.00001, 1.001, 1.03, 1.5]))
        bound = worst + (by - 1) * abs(worst) if np.isfinite(worst) else 1.0
        sense = str(rng.choice(["at_most", "at_least"]))
        told = ScatteredLimit(formula, count, bound, sense).rated()
        broken = missed(worst, bound, sense) > 1.01 * TOLERANCE
        if told["holds"] is False:  # at a point that is told, where it can be seen
            with np.errstate(all="ignore"):
                value = float(formula([told["worst_at"].get(f"q{k}", 1.0) for k in range(count)]))
            assert missed(value, bound, sense) > 0.99 * TOLERANCE, (seed, rough)
            broken = True
        counts[broken, told["holds"]] += 1
        assert not (broken and told["holds"]), (seed, rough)
        assert told["holds"] or told["yield"] < 1, (seed, rough)
    # Neither answer is given up: most of what breaks is found, most of what holds is proven.
    for broken in (True, False):
        answers = {holds: n for (b, holds), n in counts.items() if b is broken}
        assert answers[not broken] >= 0.8 * sum(answers.values()), counts
