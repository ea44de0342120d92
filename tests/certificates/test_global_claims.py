"""What a front claims, against an independent reference, on random small problems of many structures.

A failing id names structure and seed; ``pytest tests/certificates -k "waves-3]"`` runs that one alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest

import synth
from synth.bounds.log_relaxation import LogRelaxation
from synth.bounds.settings import TogetherLimits
from synth.search.joint.joint_fronts import JointFrontSearch
from synth.search.joint.joint_groups import joint_key
from synth.search.joint.joint_heuristics import JointHeuristics
from synth.search.joint.levels import LevelProof
from synth.search.settings import LevelLimits, SearchEffort
from synth.search.stages import choosing
from synth.tables.catalogs import Catalogs
from tests.asking import pose
from tests.certificates.__main__ import tried
from tests.certificates.claims import PATIENT, Answer, answer, faults, refuted, run, signed, weak_reference
from tests.certificates.kinks import KINKS
from tests.certificates.reference import Reference
from tests.certificates.signs import SIGNS
from tests.certificates.structures import STRUCTURES, Case, RandomProblem, make
from tests.certificates.sums import SUMS
from tests.repetitions import repetitions
from tests.tuned import tuned

pytestmark = pytest.mark.slow  # hundreds of searches

# Seeds enough for every kind that a structure tells apart by its seed; ``python -m tests.certificates`` tries more.
INSTANCES = (
    dict.fromkeys(STRUCTURES, repetitions(2, 3))
    | dict.fromkeys(("waves", "maximised", "continuous", "pieces", "scales", "signs_poles"), 3)
    | dict.fromkeys(("signed", "guards", "mixed", "poles", "mismatch", "knife_edge", "refusals", *KINKS, *SUMS), 4)
    | dict.fromkeys(("infeasible", "equality", "alternatives"), 6)
    | {"discrete": repetitions(3, 6), "degenerate": 5, "expressions": repetitions(6, 9), "hard": 0}
)
CASES = [(structure, seed) for structure, count in INSTANCES.items() for seed in range(count)]
# Bounds of these are valid and cheap: every front must be proven.
PROVABLE = (
    "posynomial",
    "three_objectives",
    "one_feasible",
    "discrete",
    "choices",
    "optional",
    "guards",
    "refusals",
    "gridded",
    "grid_off",
    "alternatives",
    "asked",
    "knife_edge",
    "degenerate",
    "infeasible",
    "zero_sided",
    "scales",
    "signs_gridded",
    "signs_pinned",
)
HANDFUL = [("posynomial", 1), ("gridded", 3), ("polynomials", 1), ("maximised", 1), ("alternatives", 1), ("pieces", 1)]


@pytest.mark.parametrize(("structure", "seed"), CASES)
def test_a_front_claims_nothing_that_is_wrong(structure, seed):
    a = answer(structure, seed)
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
    assert not weak_reference(a)


@pytest.mark.parametrize(
    ("structure", "seed"),
    [(s, k) for s, kinds in (("signs_gridded", 2), ("signs_pinned", 2), ("signs_poles", 3)) for k in range(kinds)],
)
def test_arrays_lose_no_value_of_any_sign(structure, seed, monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    case = make(structure, 4 + seed)
    a = Answer(case, run(case, time_limit=PATIENT), Reference(case))
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{4 + seed}: {a.front.certificate}", *wrong])


@pytest.mark.parametrize("structure", SIGNS)
def test_what_is_proven_of_values_of_any_sign_is_proven_again(structure):
    seeds = range(20, 20 + repetitions(2, 3))
    count = tried(structure, seeds, verify=True)
    assert count["tried"] == len(seeds)
    assert not count["wrong"]
    assert count["verified"] == count["proven"] >= 1


@pytest.mark.parametrize("structure", PROVABLE)
def test_what_bounds_can_prove_is_proven(structure):
    kinds = Counter(answer(structure, seed).front.certificate.kind for seed in range(INSTANCES[structure]))
    assert kinds["global"] == INSTANCES[structure], f"{structure}: {dict(kinds)}"


# -- all limits together -----------------------------------------------------------------------------

TOGETHER = TogetherLimits(
    after=3, soon=2000, boxes=1000
)  # nearly every one of a single objective that limits matter to


@pytest.fixture
def relaxed(monkeypatch):
    """Return how many boxes each call has bounded by all limits together."""
    counts, run_all = [], LogRelaxation.run

    def counted(relaxation, boxes, *arguments):
        counts.append(len(boxes))
        return run_all(relaxation, boxes, *arguments)

    monkeypatch.setattr(LogRelaxation, "run", counted)
    return counts


@pytest.mark.parametrize("structure", [s for s in INSTANCES if s != "hard"])
def test_one_best_by_all_limits_together_claims_nothing_that_is_wrong(relaxed, structure):
    first = {"posynomial": 2}.get(structure, 0)  # those before are proven without
    for seed in range(first, first + repetitions(1, 2)):
        made = make(structure, seed)
        case = replace(made, objectives=dict(list(made.objectives.items())[:1]), points=1)
        front = run(case, tuned(tree={"first_try": 3, "together": TOGETHER}), time_limit=PATIENT)
        a = Answer(case, front, Reference(case))
        wrong = faults(a)
        assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
    if structure in ("posynomial", "signomial", "polynomials", "continuous"):
        assert relaxed


# -- fronts level by level ---------------------------------------------------------------------------

TWO_OBJECTIVES = (
    "posynomial",
    "signomial",
    "waves",
    "pieces",
    "polynomials",
    "discrete",
    "choices",
    "optional",
    "gridded",
    "grid_off",
    "alternatives",
    "maximised",
    "knife_edge",
    "equality",
    "scales",
    "one_feasible",
    "signed",
    "mismatch",
    "signs_gridded",
    "degenerate",
)
LEVELS = {"by_levels": LevelLimits(soon=0, stays_open=0.0)}  # every front of two objectives goes level by level


def several(structure: str, seeds: Iterable[int]) -> list[int]:
    """Return those seeds whose cases have two objectives or more."""
    return [seed for seed in seeds if len(make(structure, seed).objectives) >= 2]


BY_LEVELS = [
    (structure, seed) for structure in TWO_OBJECTIVES for seed in several(structure, range(3))[: repetitions(1, 3)]
]


@pytest.fixture
def levels(monkeypatch):
    """Return how many levels each proof speaks of."""
    counts, sooner, prove = [], LevelProof.prove_soon, LevelProof.prove

    def counted_soon(proof, budget, first):
        counts.append(len(proof.cutoffs))
        return sooner(proof, budget, first)

    def counted(proof, budget, first):
        counts.append(len(proof.cutoffs))
        return prove(proof, budget, first)

    monkeypatch.setattr(LevelProof, "prove_soon", counted_soon)
    monkeypatch.setattr(LevelProof, "prove", counted)
    return counts


@pytest.mark.parametrize("before_looking", [0, 50, LevelLimits().before_looking])
@pytest.mark.parametrize(("structure", "seed"), BY_LEVELS)
def test_a_front_level_by_level_claims_nothing_that_is_wrong(levels, structure, seed, before_looking):
    case = make(structure, seed)
    limits = {"by_levels": replace(LEVELS["by_levels"], before_looking=before_looking)}
    a = Answer(case, run(case, tuned(tree=LEVELS | limits)), answer(structure, seed).reference)
    # The first look covers signed objectives within the gap at times.
    assert levels or len(a.front.designs) < 3 or len(a.case.objectives) != 2 or not case.positive
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
    if a.front.certificate.kind == "global" and answer(structure, seed).front.complete:
        assert a.front.complete, "all designs of a front that has no more are found"


def of_two(structure: str, seed: int, points: int) -> Case:
    """Return a case with its first two objectives."""
    case = make(structure, seed)
    return replace(case, objectives=dict(list(case.objectives.items())[:2]), points=points)


@cache
def reference(structure: str, seed: int) -> Reference:
    """Return the reference of a case with its first two objectives, whatever the number of points asked for."""
    return Reference(of_two(structure, seed, 2))


@pytest.mark.parametrize(("effort", "points"), [(100, 20), (5000, 5)])
@pytest.mark.parametrize(
    ("structure", "seed"),
    [("gridded", 3), ("waves", 0), ("waves", 1), ("products", 1), ("hard", 0)][: repetitions(4, 5)],
)
def test_levels_that_are_given_up_claim_nothing_that_is_wrong(levels, effort, points, structure, seed):
    given_up = {
        "boxes": effort,
        "by_levels": LevelLimits(soon=0, stays_open=0.0, first=20, first_of_one=50, before_looking=effort),
        "further": SearchEffort(seconds=60.0 if points == 20 else 0.0, spell=100, patience=2),
        "few_combinations": 0,  # what stays open is left to chance, and said so
    }
    case = of_two(structure, seed, points)
    a = Answer(case, run(case, tuned(tree=LEVELS | given_up)), reference(structure, seed))
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])


@pytest.mark.parametrize(("before_looking", "looked"), [(0, True), (LevelLimits().before_looking, False)])
def test_levels_that_few_boxes_settle_are_not_looked_at(monkeypatch, before_looking, looked):
    improved, look = [], JointHeuristics.first
    monkeypatch.setattr(JointHeuristics, "first", lambda *given: improved.append(1) or look(*given))
    case = of_two("discrete", 2, 20)
    limits = {"by_levels": replace(LEVELS["by_levels"], before_looking=before_looking)}
    a = Answer(case, run(case, tuned(tree=LEVELS | limits), time_limit=PATIENT), reference("discrete", 2))
    assert bool(improved) == looked
    assert not faults(a)
    assert a.front.certificate.kind == "global"
    assert a.front.complete


@pytest.fixture
def fills(monkeypatch):
    """Return how many designs were known before and after each time that more were looked for between levels."""
    counts, fill = [], choosing.fill_levels

    def counted(state):
        before = len(state.form.archive)
        result = fill(state)
        counts.append((before, len(state.form.archive)))
        return result

    monkeypatch.setattr(choosing, "fill_levels", counted)
    return counts


@pytest.mark.parametrize(
    ("structure", "seed", "points", "enough"),
    [("discrete", 2, 8, True), ("discrete", 2, 20, False), ("gridded", 1, 20, False)],
)
def test_what_lies_between_levels_is_found_until_it_is_enough_or_all(fills, structure, seed, points, enough):
    case = of_two(structure, seed, points)
    # Where few boxes settle the first levels, these find all that there is.
    limits = {"by_levels": replace(LEVELS["by_levels"], before_looking=0)}
    a = Answer(case, run(case, tuned(tree=LEVELS | limits), time_limit=PATIENT), reference(structure, seed))
    assert any(before < after for before, after in fills)
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
    assert a.front.certificate.kind == "global"
    assert (len(a.front.designs) == points) == enough
    assert a.front.complete or enough


@pytest.mark.parametrize(("structure", "seed"), [("discrete", 2), ("gridded", 1)])
def test_what_lies_between_levels_and_stays_open_is_not_claimed(monkeypatch, structure, seed):
    told, fill = [], choosing.fill_levels

    def without_effort(state):
        state.budget.boxes = state.budget.seconds = 0.0
        told.append(fill(state))
        return told[-1]

    monkeypatch.setattr(choosing, "fill_levels", without_effort)
    case = of_two(structure, seed, 20)
    a = Answer(case, run(case, tuned(tree=LEVELS), time_limit=PATIENT), reference(structure, seed))
    assert told == [False]
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
    assert not a.front.complete


@pytest.mark.parametrize("seconds", [0.05, 0.15, 0.5])
@pytest.mark.parametrize("seed", range(3))
def test_a_front_that_was_stopped_between_levels_claims_nothing_that_is_wrong(levels, seconds, seed):
    case = of_two("hard", seed, 5)
    a = Answer(case, run(case, tuned(tree=LEVELS), time_limit=seconds), reference("hard", seed))
    assert a.proven or a.front.interrupted == "time limit"
    wrong = faults(a)
    assert not wrong, "\n".join([f"hard-{seed}: {a.front.certificate}", *wrong])


# -- one best design by turns ------------------------------------------------------------------------


@pytest.mark.parametrize("structure", ["waves", "signed", "gridded", "mismatch", "hard", "infeasible"])
@pytest.mark.parametrize("boxes", [300, 20_000])
def test_one_best_design_that_is_sought_by_turns_is_as_good_as_is_claimed(structure, boxes):
    case = make(structure, 1)
    case = replace(case, objectives=dict(list(case.objectives.items())[:1]), points=1)
    effort = {"first_try": 10, "boxes": boxes, "boxes_of_many": boxes, "boxes_of_few_parts": boxes}
    a = Answer(case, run(case, tuned(tree=effort)), Reference(case))
    wrong = faults(a)
    assert not wrong, "\n".join([f"{structure}: {a.front.certificate}", *wrong])


# -- fronts of several questions together ---------------------------------------------------------


@cache
def together(structure: str, seed: int, points: int) -> synth.ParetoFront | None:
    """Return the front of a case that was searched together with others, whose requirements are a little larger."""
    case = of_two(structure, seed, points)
    if len(case.objectives) != 2:
        return None
    problem = RandomProblem(structure=case.structure, seed=str(case.seed))
    more = {k: v for k, v in case.question().items() if k != "time_limit"}
    catalogs = Catalogs(more.pop("catalogs")) if "catalogs" in more else None
    questions = []
    for factor in (1.0, 1.02, 1.1):
        with suppress(synth.InputError):
            moved = {name: factor * value for name, value in case.requirements.items()}
            questions.append(pose(problem, moved, catalogs=catalogs, **more))
    first = joint_key(questions[0])
    return JointFrontSearch([q for q in questions if joint_key(q) == first], time_limit=PATIENT).answers()[0]


# Few and many designs, each of other cases: how many there are has little to do with what may go wrong.
JOINT = [
    (structure, seed, points)
    for structure in TWO_OBJECTIVES
    for seed, points in zip(several(structure, range(6))[:2], (3, 6), strict=False)
]


@pytest.mark.parametrize(("structure", "seed", "points"), JOINT)
def test_a_front_searched_with_others_claims_nothing_that_is_wrong(structure, seed, points):
    front = together(structure, seed, points)
    if front is not None:
        a = Answer(of_two(structure, seed, points), front, reference(structure, seed))
        wrong = faults(a)
        assert not wrong, "\n".join([f"{structure}-{seed}: {a.front.certificate}", *wrong])
        assert a.proven


def test_there_are_enough_fronts_searched_with_others():
    answered = [together(*case) is not None for case in JOINT]
    assert sum(answered) >= 11, f"{sum(answered)} of {len(answered)}"


def test_there_are_enough_instances_of_every_kind():
    answers = [answer(*case) for case in CASES]
    kinds = Counter((a.front.certificate.kind, bool(a.front.designs)) for a in answers)
    assert len(answers) >= 110
    assert kinds["global", True] >= 0.75 * len(answers), dict(kinds)
    assert kinds["global", False] >= 5, dict(kinds)


# -- the check itself ------------------------------------------------------------------------------


@pytest.mark.parametrize("structure", ["posynomial", "discrete", "gridded", "optional"])
def test_a_front_that_leaves_out_the_best_rows_is_refuted(structure):
    """The front of a narrower question, taken for that of the whole, claims what is wrong."""
    noticed = 0
    for seed in range(INSTANCES[structure]):
        a = answer(structure, seed)
        best = {str(d.parts["rod"]) for d in a.front.designs}
        others = [n for n in a.case.tables["table_rod"]["designation"] if n not in best]
        if not best or not others:
            continue
        narrower = Answer(a.case, run(a.case, parts={"rod": others}), a.reference)
        assert narrower.proven
        ideal = signed(a).min(axis=0)
        worse = not narrower.front.designs or np.any(signed(narrower).min(axis=0) > ideal + 3 * a.case.gap * abs(ideal))
        if worse:
            assert refuted(narrower), f"{structure}-{seed} without {best}"
        noticed += bool(worse)
    assert noticed >= 2


# -- stopping and repeating ------------------------------------------------------------------------


@cache
def whole_reference(structure: str, seed: int) -> Reference:
    """Return the reference of a case with all its objectives."""
    return Reference(make(structure, seed))


@pytest.mark.parametrize("seconds", [1e-3, 0.2, 1.0])
def test_a_front_that_was_stopped_claims_nothing_that_is_wrong(seconds):
    case = make("hard", 0)
    a = Answer(case, run(case, time_limit=seconds), whole_reference("hard", 0))
    assert a.front.interrupted == "time limit"
    assert a.front.certificate.kind == "heuristic"
    assert not a.front.complete
    assert not faults(a)  # a gap may be told, but then it must hold


def told(front: synth.ParetoFront, folder) -> tuple:
    """Return all that a front tells about designs and proof."""
    certificate = front.certificate
    proof = (certificate.kind, certificate.gap, certificate.combinations, front.complete, front.status)
    return (proof, (front.save(folder) / "designs.csv").read_bytes())


@pytest.mark.parametrize(("structure", "seed"), HANDFUL)
def test_the_same_question_gets_the_same_answer(structure, seed, tmp_path):
    a = answer(structure, seed)
    assert told(a.front, tmp_path / "first") == told(run(a.case, time_limit=PATIENT), tmp_path / "again")


@pytest.mark.parametrize(("structure", "seed"), HANDFUL[:3])
def test_the_answer_does_not_depend_on_the_number_of_workers(structure, seed, tmp_path):
    a = answer(structure, seed)
    assert told(a.front, tmp_path / "one") == told(run(a.case, workers=2), tmp_path / "two")


# -- rows that are equal in all that is used -------------------------------------------------------


@pytest.mark.parametrize("seed", range(INSTANCES["alternatives"]))
def test_equal_rows_are_named_as_alternatives(seed):
    a = answer("alternatives", seed)
    named = 0
    for d in a.front.designs:
        equal = {slot: _equal_rows(a.case, slot, str(row)) for slot, row in d.parts.items()}
        for rows in product(*equal.values()):
            differing = [f"{s} {r}" for s, r in zip(equal, rows, strict=True) if r != str(d.parts[s])]
            assert not differing or ", ".join(differing) in d.alternatives, f"alternatives-{seed}: design {d.rank}"
            named += bool(differing)
    assert named >= len(a.front.designs) > 0


def _equal_rows(case: Case, slot: str, designation: str) -> list[str]:
    table = case.tables[case.slots[slot]]
    used = table[["k", "s"]].to_numpy()
    own = used[np.flatnonzero(table["designation"] == designation)[0]]
    return list(table["designation"][np.all(used == own, axis=1)])


def test_limits_that_nearly_agree_are_shown_to_conflict_with_little_work():
    # Jerk and slip time miss each other by 0.12 % over all parts: parts and rings must hardly be told apart.
    hoist = {
        "load_torque": "730.93 N*m",
        "driver_speed": "22.567 rad/s",
        "driven_inertia": "22.2245 kg*m2",
        "engagements_per_hour": "50 1/h",
        "jerk_limit": "14.612 rad/s3",
    }
    front = synth.synthesize(
        synth.load("multi_plate_clutch", practice="off"), hoist, objectives=["mass"], points=1, time_limit=60
    )
    assert front.status.value == "infeasible"
    assert front.certificate.kind == "global"
    assert front.statistics["boxes"] < 300_000
