"""Studies: each step is what its question has alone, and what is finished is kept, however a study was stopped."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.order.feasibility import Status
from synth.results import Design, ParetoFront
from synth.studies.whatif.study import Study
from synth.studies.whatif.vary import Varied
from tests.sample_problems.ropes import Ropes, best_ropes, ropes
from tests.sample_problems.strut import RODS, Strut

GAP = 1e-3
FOUR = ropes((10, 2), (20, 1), (35, 0.5), (5, 4), most=[100, 200, 400, 20])
FREE, GIVEN = Ropes(), Ropes(thick="given")

Progress = Callable[[Mapping[str, Any]], None]


def study(vary: Any, problem: Any = FREE, requirements: Any = None, objectives: Any = ("cost",), **more: Any) -> Study:
    found = synth.whatif(
        problem,
        {"load": "10 kN", **(requirements or {})},
        vary,
        list(objectives),
        **{"catalogs": FOUR, "breaks": False, "points": 6, **more},
    )
    assert [step.number for step in found.steps] == list(range(1, len(found.steps) + 1))
    return found


def fronts_of(found: Study) -> list[ParetoFront]:
    """Return the fronts of all steps of a study that was not stopped."""
    assert not found.interrupted
    assert len(found.fronts) == len(found.steps) == found.statistics["answered"]
    return found.fronts


def alone(
    requirements: Mapping[str, Any], problem: Any = FREE, objectives: Any = ("cost",), **more: Any
) -> ParetoFront:
    return synth.synthesize(problem, requirements, list(objectives), **{"catalogs": FOUR, "points": 6, **more})


def made_of(design: Design) -> tuple[Any, ...]:
    return *(str(row) for row in design.parts.values()), design.values["strands"], *design.choices.values()


def check_same(step: ParetoFront, own: ParetoFront, rel: float = GAP) -> None:
    """Check that the front of a step is that of the same question asked alone."""
    assert (step.status, step.complete) == (own.status, own.complete)
    assert (step.certificate.kind, step.certificate.gap) == (own.certificate.kind, own.certificate.gap)
    assert step.certificate.combinations == own.certificate.combinations
    assert step.frame == own.frame
    assert step.settings == own.settings
    assert (step.explanation is None) == (own.explanation is None)
    assert len(step.designs) == len(own.designs)
    for one, other in zip(step.designs, own.designs, strict=True):
        assert made_of(one) == made_of(other)
        assert (one.rank, one.note, one.status) == (other.rank, other.note, other.status)
        assert one.values == pytest.approx(other.values, rel=rel, abs=1e-6)


# ---- steps ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("problem", [FREE, GIVEN], ids=["free", "no_variable"])
def test_steps_with_one_objective_are_those_asked_alone(problem: Ropes) -> None:
    found = study({"load": "4, 14, 34, 390 kN"}, problem, {"most_cost": 200})
    for step, load in zip(fronts_of(found), (4, 14, 34, 390), strict=True):
        own = alone({"load": f"{load} kN", "most_cost": 200}, problem)
        check_same(step, own)
        true = best_ropes(problem, own.question.values.requirements, FOUR)
        if load == 390:
            assert true is None
            assert not step.designs
            assert "budget" in found.steps[3].reason
            continue
        assert true is not None
        assert step.designs[0].values["cost"] == pytest.approx(true.cost, rel=GAP)
        assert step.statistics["searched_together"] == 4
        assert step.verify().holds
    assert [s.status for s in found.steps] == [Status.OPTIMAL] * 3 + [Status.INFEASIBLE]
    assert found.feasible
    assert [s.values for s in found.steps] == [(4.0,), (14.0,), (34.0,), (390.0,)]


def test_steps_with_two_objectives_are_those_asked_alone() -> None:
    both = ("cost", "bulk")
    found = study({"load": "4:34:15 kN"}, GIVEN, objectives=both)
    for step, load in zip(fronts_of(found), (4, 19, 34), strict=True):
        check_same(step, alone({"load": f"{load} kN"}, GIVEN, both))
        assert "searched_together" not in step.statistics
        rows = ((10, 2, 100), (20, 1, 200), (35, 0.5, 400), (5, 4, 20))
        costs = {(f + r * load, 1 / f) for f, r, most in rows if load <= most}
        true = {x for x in costs if not any(a <= x[0] and b <= x[1] and (a, b) != x for a, b in costs)}
        known = sorted((d.values["cost"], d.values["bulk"]) for d in step.designs)
        assert known == [pytest.approx(x) for x in sorted(true)]


def test_a_front_of_continuous_designs_is_found_at_every_step() -> None:
    asked = {"load": "20 kN", "room": "90 mm"}
    found = synth.whatif(
        Strut(),
        asked,
        {"load": "10, 40 kN"},
        ["mass", "flexibility"],
        catalogs={"rods": RODS},
        points=4,
        gap=0.01,
        parts={"plate": ["core 1", "core 2"]},
        breaks=False,
    )
    for step, load in zip(fronts_of(found), (10, 40), strict=True):
        assert step.certificate.kind == "global"
        assert step.verify().holds
        own = synth.synthesize(
            Strut(),
            {**asked, "load": f"{load} kN"},
            ["mass", "flexibility"],
            catalogs={"rods": RODS},
            points=4,
            gap=0.01,
            parts={"plate": ["core 1", "core 2"]},
        )
        for name in ("mass", "flexibility"):
            ends = [min(d.values[name] for d in front.designs) for front in (step, own)]
            assert ends[0] == pytest.approx(ends[1], rel=0.01)


def test_a_limit_takes_the_place_of_what_was_said_and_leaves_the_rest() -> None:
    limits = {"strength": ["<= 500 kN", ">= 12 kN"], "strands": "<= 2"}
    found = study({"strength >=": "9, 30 kN"}, limits=limits)
    costs = [front.designs[0].values["cost"] for front in fronts_of(found)]
    assert costs == pytest.approx([10 + 20, 20 + 30], rel=GAP)
    for step, text in zip(found.fronts, ("9", "30"), strict=True):
        assert step.settings["limits"] == {"strands": "<= 2", "strength": ["<= 500 kN", f">= {text} kN"]}
        own = alone({"load": "10 kN"}, limits={"strands": "<= 2", "strength": ["<= 500 kN", f">= {text} kN"]})
        check_same(step, own)


def test_parts_options_and_both() -> None:
    rope = study({"parts.rope": ["rope c", "rate > 1.5", ["rope b", "rope c"]]}, parts={"rope": ["rope d"]})
    assert [made_of(f.designs[0])[0] for f in fronts_of(rope)] == ["rope c", "rope a", "rope b"]
    assert [s.values for s in rope.steps] == [("rope c",), ("rate > 1.5",), (("rope b", "rope c"),)]
    assert rope.along is None
    price = study({"options.price": "indexed,fixed", "load": "5, 20, 60 kN"})
    for step, front in zip(price.steps, fronts_of(price), strict=True):
        word, load = step.values
        true = best_ropes(
            FREE,
            {
                "load": 1e3 * float(load),
                "jolt": 1.0,
                "share": 1.0,
                "index": 1.5 if word == "indexed" else 1.0,  # type: ignore[arg-type]
            },
            FOUR,
        )
        assert true is not None
        assert front.designs[0].values["cost"] == pytest.approx(true.cost, rel=GAP)
        assert made_of(front.designs[0]) in true.made
        assert front.frame.options == {"price": word}


def test_of_two_the_second_runs_through_for_each_of_the_first() -> None:
    found = study({"share": "0.5, 2", "load": "5, 25, 45 kN"})
    assert [s.values for s in found.steps] == [(a, b) for a in (0.5, 2.0) for b in (5.0, 25.0, 45.0)]
    for step, front in zip(found.steps, fronts_of(found), strict=True):
        share, load = step.values
        check_same(front, alone({"load": f"{load} kN", "share": share}))


def test_weights_change_the_order_alone() -> None:
    both = ("cost", "bulk")
    found = study({"weights.cost": "0, 1, 99"}, GIVEN, {"load": "20 kN"}, both)
    designs = [{made_of(d) for d in f.designs} for f in fronts_of(found)]
    assert designs[0] == designs[1] == designs[2]
    for step, weight in zip(found.fronts, (0.0, 1.0, 99.0), strict=True):
        check_same(step, alone({"load": "20 kN"}, GIVEN, both, weights={"cost": weight}))
        scores = [d.score for d in step.designs]
        assert all(a is not None and b is not None and a <= b for a, b in pairwise(scores))
        assert step.settings["weights"]["cost"] == weight
    assert made_of(found.fronts[0].designs[0])[0] == "rope c"
    assert made_of(found.fronts[2].designs[0])[0] == "rope b"


def test_symbols_and_units_mean_what_names_and_numbers_mean() -> None:
    by_name = study({"load": "4, 24 kN"}).to_frame()
    by_symbol = study({"F": ["4000 N", "24000 N"]}, requirements={}).to_frame()
    assert by_name["cost [-]"].tolist() == by_symbol["cost [-]"].tolist()
    assert by_symbol["load [N]"].tolist() == [4000.0, 24000.0]


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ({"load": "5, 450 kN"}, ["load = 450 kN", "heavy"]),
        ({"load": "5, 5000 kN"}, ["load = 5000 kN", "0.5 kN to 500 kN"]),
        ({"strength <=": "0.1, 20 kN"}, ["strength <= 0.1 kN"]),
        ({"parts.rope": "rope a, rope z"}, ["parts.rope = rope z", "rope z"]),
        ({"weights.bulk": "1, 2"}, ["bulk", "a chosen objective"]),
        ({}, ["vary"]),
        ({"load": "1, 2 kN", "share": "1, 2", "income": "1, 2"}, ["one or two"]),
    ],
)
def test_what_is_wrong_at_any_step_is_said_before_the_first(tmp_path: Path, vary: Any, words: Sequence[str]) -> None:
    with pytest.raises(synth.InputError) as fault:
        study(vary, folder=tmp_path / "never")
    assert all(word in str(fault.value) for word in words), str(fault.value)
    assert not (tmp_path / "never").exists()


# ---- the table ------------------------------------------------------------------------------------------------------


def test_the_table_says_what_the_fronts_say() -> None:
    found = study({"load": "4, 14, 390 kN"}, requirements={"most_cost": 200})
    table = found.to_frame()
    assert table["load [kN]"].tolist() == [4, 14, 390]
    assert table["status"].tolist() == ["optimal", "optimal", "infeasible"]
    # Tables show a number of at most 15 digits where one stands for the value.
    cost = [f.designs[0].values["cost"] for f in found.fronts[:2]]
    assert table["cost [-]"].tolist()[:2] == pytest.approx(cost, rel=1e-15)
    assert table["strength [kN]"].tolist()[:2] == pytest.approx([4, 14], rel=1e-5)
    assert table["rope"].tolist()[:2] == ["rope a", "rope b"]
    assert table["binding"].tolist()[:2] == ["hold", "hold"]
    # Of 18 to pay 8 go with the load, of 34 there are 14.
    column = next(c for c in table.columns if "load" in c and "cost" in c)
    assert table[column].tolist()[:2] == pytest.approx([8 / 18, 14 / 34], rel=1e-3)
    assert "budget" in table["reason"].tolist()[2]


# ---- what is kept ---------------------------------------------------------------------------------------------------

ONE = {"load": "4, 14, 34, 64, 390 kN"}
TWO = {"share": "1, 3", "load": "4, 24, 44 kN"}


def csv_of(found: Study, folder: Path) -> bytes:
    """Return whatif.csv as it is written."""
    found.save(folder)
    return (folder / "whatif.csv").read_bytes()


def asked(kind: str, folder: Path | None, **more: Any) -> Study:
    if kind == "one":
        return study(ONE, FREE, {"most_cost": 200}, folder=folder, **more)
    return study(TWO, GIVEN, objectives=("cost", "bulk"), folder=folder, **more)


KINDS = pytest.mark.parametrize("kind", ["one", "two"])


@pytest.fixture(scope="module", params=["one", "two"])
def whole(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, int, bytes]:
    """Return a kind of study, how many steps it has, and what it writes when nothing stops it, without a folder."""
    found = asked(request.param, None)
    return request.param, len(found.steps), csv_of(found, tmp_path_factory.mktemp("whole"))


@pytest.mark.slow
def test_a_study_run_again_keeps_every_step(whole: tuple[str, int, bytes], tmp_path: Path) -> None:
    kind, count, text = whole
    first = asked(kind, tmp_path)
    assert first.statistics["kept"] == 0
    assert csv_of(first, tmp_path) == text
    again = asked(kind, tmp_path)
    assert again.statistics["kept"] == count
    assert csv_of(again, tmp_path) == text
    assert [s.fingerprint for s in again.steps] == [s.fingerprint for s in first.steps]
    assert len(set(s.fingerprint for s in first.steps)) == count


@pytest.mark.slow
@pytest.mark.parametrize("lost", [[1], [2, 3]])
def test_steps_that_were_lost_are_searched_again(
    whole: tuple[str, int, bytes], tmp_path: Path, lost: Sequence[int]
) -> None:
    kind, count, text = whole
    asked(kind, tmp_path)
    before = {k: (tmp_path / "steps" / f"step_{k:04d}.json").read_bytes() for k in range(1, count + 1)}
    for k in lost:
        (tmp_path / "steps" / f"step_{k:04d}.json").unlink()
    again = asked(kind, tmp_path)
    assert again.statistics["kept"] == count - len(lost)
    assert csv_of(again, tmp_path) == text
    for k in before:
        known, found = (json.loads(x) for x in (before[k], (tmp_path / "steps" / f"step_{k:04d}.json").read_bytes()))
        assert found["designs"] == known["designs"]


@pytest.mark.slow
def test_steps_that_were_changed_are_not_believed(tmp_path: Path) -> None:
    text = csv_of(asked("one", None), tmp_path / "whole")
    asked("one", tmp_path)
    path = tmp_path / "steps" / "step_0002.json"
    path.write_text(path.read_text().replace("rope b", "rope a"))
    again = asked("one", tmp_path)
    assert again.statistics["kept"] == 4
    assert csv_of(again, tmp_path) == text
    (tmp_path / "study.json").write_text("no record")
    last = asked("one", tmp_path)
    assert last.statistics["kept"] == 0
    assert csv_of(last, tmp_path) == text


def test_another_question_keeps_nothing_of_a_folder(tmp_path: Path) -> None:
    asked("one", tmp_path)
    other = study(ONE, FREE, {"most_cost": 201}, folder=tmp_path)
    assert other.statistics["kept"] == 0
    assert csv_of(other, tmp_path) == csv_of(study(ONE, FREE, {"most_cost": 201}), tmp_path / "alone")
    # Of the same steps in another order none is where it was.
    turned = study({"load": "390, 64, 34, 14, 4 kN"}, FREE, {"most_cost": 201}, folder=tmp_path)
    assert turned.statistics["kept"] == 0
    assert turned.steps[-1].front is not None
    assert made_of(turned.steps[-1].front.designs[0])[0] == "rope a"


@pytest.mark.slow
def test_too_little_time_leaves_steps_that_a_second_run_finishes(whole: tuple[str, int, bytes], tmp_path: Path) -> None:
    kind, count, text = whole
    short = asked(kind, tmp_path, time_limit=1e-6)
    assert short.interrupted == "time limit"
    assert [s.front for s in short.steps] == [None] * count
    assert {s.reason for s in short.steps} == {"not reached: time limit"}
    assert {s.status for s in short.steps} == {Status.NOT_SOLVED}
    assert short.statistics["answered"] == 0
    assert "not reached: time limit" in csv_of(short, tmp_path).decode()
    second = asked(kind, tmp_path)
    assert not second.interrupted
    assert csv_of(second, tmp_path) == text


class Stopper:
    """Stops a study when it tells of its progress for the so-many-th time."""

    def __init__(self, left: int) -> None:
        self.left = left

    def __call__(self, state: Mapping[str, Any]) -> None:
        assert 0 <= state["done"] <= 1
        self.left -= 1
        if self.left < 0:
            raise KeyboardInterrupt


@pytest.mark.slow
def test_a_study_that_is_interrupted_goes_on(whole: tuple[str, int, bytes], tmp_path: Path) -> None:
    kind, count, text = whole
    seen = list[int]()
    stopped = 0
    for number in range(0, 60, 8):
        found = asked(kind, tmp_path, progress=Stopper(number))
        seen.append(sum(s.front is not None for s in found.steps))
        assert found.statistics["kept"] == (seen[-2] if number else 0)
        if not found.interrupted:
            break
        stopped += 1
        assert found.interrupted == "interrupted"
        assert [s.front is not None for s in found.steps] == [k < seen[-1] for k in range(count)]
        assert all(s.reason == "not reached: interrupted" for s in found.steps[seen[-1] :])
    else:
        found = asked(kind, tmp_path)
    assert stopped
    assert seen == sorted(seen)
    assert csv_of(found, tmp_path) == text


def test_progress_is_told_of_every_step() -> None:
    told: dict[str, list[float]] = {}

    def tell(state: Mapping[str, Any]) -> None:
        told.setdefault(str(state["stage"]).split(":")[0], []).append(float(state["done"]))

    study(TWO, GIVEN, objectives=("cost", "bulk"), progress=tell)
    places = [(share, load) for share in (1, 3) for load in (4, 24, 44)]
    # Together they are not answered, for none has as many designs as are asked for.
    first, *alone = told
    assert first == "6 steps at once"
    assert alone == [f"step {k} of 6, share = {s}, load = {f} kN" for k, (s, f) in enumerate(places, 1)]
    for k, done in enumerate(told[name] for name in alone):
        assert k / 6 - 1e-9 <= min(done) <= max(done) <= (k + 1) / 6 + 1e-9


# ---- drawings -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_drawing_says_where_there_is_no_design() -> None:
    weak = ropes((10, 2), (20, 1), most=[20, 60])
    drawn = {
        breaks: study({"load": "20, 40, 80, 100, 120 kN"}, GIVEN, catalogs=weak, breaks=breaks).curves()["whatif"].attrs
        for breaks in (False, True)
    }
    # Three strands bear 90 kN. Without breaks half the way between two steps is a guess.
    assert drawn[False]["spans"] == [{"from": 90.0, "to": 120.0, "shaded": True, "label": "no design"}]
    (span,) = drawn[True]["spans"]
    assert span["from"] == pytest.approx(90, rel=1e-3)
    assert span["to"] == 120
    assert "grey: no design" in drawn[True]["source"]
    everywhere = study({"load": "20, 40 kN"}, GIVEN, catalogs=weak).curves()["whatif"].attrs
    assert everywhere["spans"] == []
    assert "grey" not in everywhere["source"]


def test_break_points_are_numbered_and_told_in_words_below() -> None:
    found = study({"load": "20, 40, 80 kN"}, GIVEN, breaks=True)
    attrs = found.curves()["whatif"].attrs
    assert attrs["title"].endswith(": cost over load")
    assert [mark["label"] for mark in attrs["marks"]] == [str(n) for n in range(1, len(found.breaks) + 1)]
    places = [b.value for b in sorted(found.breaks, key=lambda b: b.value)]
    assert [mark["x"] for mark in attrs["marks"]] == places
    for number, (note, value) in enumerate(zip(attrs["notes"], places, strict=True), start=1):
        told, _, change = note.partition(": ")
        assert told == f"{number}\t{value:.4g} kN, best cost"
        assert re.fullmatch(r"(rope|strands) .+ → [^,]+(, strands \d+ → \d+)?", change)
    assert "vertical lines: break points" in attrs["source"]


def test_what_is_varied_is_drawn_in_words() -> None:
    varied = {
        Varied("limit", "outer_diameter", "<=", "mm", (1.0,)): "largest outer diameter allowed",
        Varied("limit", "wear_life", ">=", "h", (1.0,)): "least wear life asked for",
        Varied("part", "friction_pair", "", "", ("a_b",)): "friction pair",
        Varied("weight", "mass", "", "-", (1.0,)): "weight of mass",
        Varied("scatter", "friction", "", "", ("none",)): "scatter of friction",
        Varied("requirement", "load_torque", "", "N*m", (1.0,)): "load torque",
    }
    assert [v.in_words for v in varied] == list(varied.values())
    *_, torque = varied
    assert torque.valued(500.0) == "500 N m"
    assert next(v for v in varied if v.kind == "part").valued("a_b") == "a_b"


def test_steps_that_were_not_reached_do_not_count_as_without_design() -> None:
    found = study({"load": "20, 40 kN"}, GIVEN, time_limit=1e-6)
    assert found.interrupted
    assert found.curves()["whatif"].attrs["spans"] == []


@pytest.mark.parametrize(("sense", "stairs"), [({"cost": "min"}, "post"), ({"gain": "max"}, "pre")])
def test_fronts_are_drawn_as_what_their_designs_reach(sense: dict[str, str], stairs: str) -> None:
    found = synth.whatif(GIVEN, {"load": "10 kN"}, {"load": "4, 19 kN"}, {**sense, "bulk": "min"}, 6, catalogs=FOUR)
    frame = found.curves()["fronts"]
    assert [panel["stairs"] for panel in frame.attrs["panels"]] == [stairs]
    assert "what the designs reach" in frame.attrs["source"]
