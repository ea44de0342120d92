"""Break points against closed form: every one between two steps that differ is found, placed and proven."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import synth
from synth.order.pareto import rank
from synth.studies.whatif.study import Study
from synth.studies.whatif.study_answers import Break
from synth.tables.catalogs import Catalogs
from tests.sample_problems.ropes import Ropes, best_ropes, ropes

WIDTH = 1e-3  # of a value: so closely breaks are located
FREE, GIVEN = Ropes(), Ropes(thick="given")
BOTH = pytest.mark.parametrize("problem", [FREE, GIVEN], ids=["free", "no_variable"])


def study(problem: Ropes, vary: Mapping[str, Any], catalogs: Catalogs, objective: str = "cost", **more: Any) -> Study:
    requirements = {"load": "10 kN", **more.pop("requirements", {})}
    found = synth.whatif(problem, requirements, vary, [objective], catalogs=catalogs, **more)
    assert not found.interrupted
    return found


def sides(b: Break) -> tuple[str, str]:
    """Return what is best before and after a break, in short: ``a1`` are ropes of a single strand of rope a."""
    made = [None if s is None else f"{s.parts['rope'][-1]}{s.counts['strands']:g}" for s in (b.before, b.after)]
    return made[0] or "-", made[1] or "-"


def check(breaks: Sequence[Break], true: Sequence[tuple[float, str, str]], objective: str = "cost") -> None:
    """Check that breaks are those expected: value, before and after."""
    assert [sides(b) for b in breaks] == [(before, after) for _, before, after in true]
    for b, (value, _, _) in zip(breaks, true, strict=True):
        assert b.objective == objective
        assert b.proven
        assert b.remark == ""
        assert 0 < b.high - b.low <= WIDTH * max(abs(b.low), abs(b.high)) * (1 + 1e-9)
        # Parts that tie do not change: what counts as equal may move an end by a little.
        slack = 2e-4 * abs(value)
        assert b.low - slack <= value <= b.high + slack
        assert b.value == pytest.approx(value, rel=WIDTH)


# ---- along a requirement --------------------------------------------------------------------------------------------


@BOTH
def test_two_costs_cross(problem: Ropes) -> None:
    found = study(problem, {"load": "3:23:5 kN"}, ropes((10, 2), (20, 1)))
    check(found.breaks, [(10, "a1", "b1")])
    (b,) = found.breaks
    assert b.kind == "parts"
    assert b.change == "rope rope a -> rope b"
    assert b.before is not None
    assert b.after is not None
    assert b.before.value == pytest.approx(10 + 2 * b.low, rel=1e-4)
    assert b.after.value == pytest.approx(20 + b.high, rel=1e-4)
    assert found.statistics["breaks"] == 1
    told = found.breaks_frame().iloc[0]
    assert (told["change"], told["from"], told["to"], told["proven"]) == (b.change, b.low, b.high, "yes")


@pytest.mark.slow
def test_several_changes_within_one_step() -> None:
    # Each is the cheapest somewhere: changes at 10, 20, 40 and 80 kN.
    chain = ropes((10, 4), (30, 2), (50, 1), (70, 0.5), (90, 0.25))
    true = [(10, "a1", "b1"), (20, "b1", "c1"), (40, "c1", "d1"), (80, "d1", "e1")]
    check(study(GIVEN, {"load": ["2 kN", "200 kN"]}, chain).breaks, true)
    check(study(GIVEN, {"load": "200, 30, 2 kN"}, chain).breaks, true)


def test_a_part_that_is_best_only_in_the_middle() -> None:
    # The first and the last cross at 100 kN; the second is cheaper than both from 98 to 102 kN.
    narrow = ropes((10, 2), (108, 1), (208, 0.0196078))
    true_end = (208 - 108) / (1 - 0.0196078)
    check(study(GIVEN, {"load": "20, 300 kN"}, narrow).breaks, [(98, "a1", "b1"), (true_end, "b1", "c1")])


def test_an_objective_that_is_made_large_and_may_be_negative() -> None:
    table = ropes((10, 2), (20, 1), (35, 0.5))
    for income, first in ((20, -10), (90, 60)):
        found = study(GIVEN, {"load": "7:49:14 kN"}, table, "gain", requirements={"income": income})
        check(found.breaks, [(10, "a1", "b1"), (30, "b1", "c1")], "gain")
        assert found.breaks[0].before is not None
        assert found.breaks[0].before.value == pytest.approx(first, rel=1e-2)


def test_breaks_on_both_sides_of_zero() -> None:
    # The gain is zero at 20 kN, between the breaks, which one step holds.
    found = study(GIVEN, {"load": "3, 63 kN"}, ropes((10, 2), (20, 1), (35, 0.5)), "gain", requirements={"income": 40})
    check(found.breaks, [(10, "a1", "b1"), (30, "b1", "c1")], "gain")


@pytest.mark.slow
def test_feasibility_begins_and_ends() -> None:
    weak = ropes((10, 2), (20, 1), most=[20, 60])
    # Three strands bear half as much again; costs: a1 to 10, b1 to 60, then b2 to 75 and b3 to 90.
    true = [(10, "a1", "b1"), (60, "b1", "b2"), (75, "b2", "b3"), (90, "b3", "-")]
    check(study(GIVEN, {"load": "5, 300 kN"}, weak).breaks, true)
    budget = study(GIVEN, {"most_cost": "1:61:20"}, ropes((10, 2), (20, 1)), requirements={"load": "15 kN"})
    check(budget.breaks, [(35, "-", "b1")])
    assert [b.change for b in budget.breaks] == ["feasible from here on"]
    assert budget.breaks[0].kind == "feasible"


def test_changes_of_counts() -> None:
    found = study(GIVEN, {"load": "30, 80 kN"}, ropes((20, 1), most=[60]))
    check(found.breaks, [(60, "a1", "a2"), (75, "a2", "a3")])
    assert [b.kind for b in found.breaks] == ["counts", "counts"]
    assert found.breaks[0].change == "strands 1 -> 2"


@pytest.mark.slow
def test_refusals_begin_somewhere() -> None:
    # The cheaper rope may not be used beyond 33 kN, nor in two strands beyond 25.
    worn = ropes((10, 1), (30, 1), worn=[33, 1000])
    check(study(GIVEN, {"load": "20, 50 kN"}, worn).breaks, [(33, "a1", "b1")])
    tied = ropes((10, 1), (50, 1), most=[20, 1000], bundle=[24, 1000])
    check(study(GIVEN, {"load": "10, 50 kN"}, tied).breaks, [(20, "a1", "a2"), (24, "a2", "b1")])
    # Of all that bear enough nothing is allowed: refused questions are steps without a design.
    none = ropes((10, 1), worn=[33])
    with pytest.raises(synth.InputError, match="worn"):
        study(GIVEN, {"load": "20, 50 kN"}, none)


@pytest.mark.slow
def test_a_default_that_is_made_of_what_is_varied() -> None:
    # The jolt is 1.25 times the load.
    stiff = ropes((10, 1), (30, 1), jolt=[40, 100])
    check(study(GIVEN, {"load": "20, 90 kN"}, stiff).breaks, [(32, "a1", "b1"), (80, "b1", "-")])
    check(study(FREE, {"jolt": "20, 90 kN"}, stiff).breaks, [(40, "a1", "b1")])


def test_nothing_changes() -> None:
    assert study(FREE, {"load": "2, 8 kN"}, ropes((10, 2), (20, 1))).breaks == ()
    assert study(FREE, {"idle": "2, 8"}, ropes((10, 2), (20, 1))).breaks == ()
    # What costs the same does not change at random.
    assert study(FREE, {"load": "2, 80 kN"}, ropes((20, 1), (20, 1))).breaks == ()


def crossing(words: Callable[[float], str], low: float, high: float) -> float:
    """Return where words change, by halving."""
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if words(middle) == words(low) else (low, middle)
    return low


@pytest.mark.slow
def test_against_a_dense_scan() -> None:
    limits: dict[str, list[float]] = {
        "most": [14, 300, 22, 55, 70],
        "worn": [1000, 25, 1000, 48, 1000],
        "bundle": [13, 1000, 24, 1000, 80],
    }
    table = ropes((12, 5), (21, 3.4), (33, 2.2), (46, 1.3), (71, 0.6), **limits)
    steps = [2.0, 31.0, 57.0, 86.0]
    found = study(GIVEN, {"load": [f"{x} kN" for x in steps]}, table)

    def words(load: float) -> str:
        best = best_ropes(GIVEN, {"load": 1e3 * load, "jolt": 1.25e3 * load, "share": 1.0}, table)
        return "-" if best is None else f"{best.made[0][0][-1]}{best.made[0][1]:g}"

    scan = np.arange(2.0, 86.0, 0.1)
    true = [
        (0.5 * (a + b), one, other)
        for (a, one), (b, other) in pairwise((x, words(x)) for x in scan.tolist())
        if one != other
    ]
    true = [(crossing(words, x - 0.05, x + 0.05), one, other) for x, one, other in true]
    assert len(true) > 5
    check(found.breaks, true)


# ---- two things varied ----------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("first", ["load", "share"])
def test_breaks_with_two_things_varied(first: str) -> None:
    both = {"load": "4:44:20 kN", "share": "0.5, 1, 2"}
    table = ropes((10, 2), (20, 1))
    found = study(FREE, {k: both[k] for k in sorted(both, key=lambda k: k != first)}, table)
    assert found.along == 0
    if first == "load":
        # The cheaper one to buy loses at ten times the share.
        for share in (0.5, 1.0, 2.0):
            own = [b for b in found.breaks if b.others == (share,)]
            check(own, [(10 * share, "a1", "b1")])
        assert len(found.breaks) == 3
    else:
        check([b for b in found.breaks if b.others == (4.0,)], [])
        check([b for b in found.breaks if b.others == (24.0,)], [])
        check([b for b in found.breaks if b.others == (44.0,)], [])
        assert found.breaks == ()
        wider = study(FREE, {"share": "0.2, 1, 3", "load": "4, 24 kN"}, table)
        check([b for b in wider.breaks if b.others == (4.0,)], [(0.4, "b1", "a1")])
        check([b for b in wider.breaks if b.others == (24.0,)], [(2.4, "b1", "a1")])


@pytest.mark.slow
def test_breaks_within_parts_and_options() -> None:
    table = ropes((10, 2), (20, 1), (35, 0.5))
    found = study(GIVEN, {"parts.rope": [["rope a", "rope b"], ["rope a", "rope c"]], "load": "3, 60 kN"}, table)
    assert found.along == 1
    check([b for b in found.breaks if b.others == (("rope a", "rope b"),)], [(10, "a1", "b1")])
    check([b for b in found.breaks if b.others == (("rope a", "rope c"),)], [(50 / 3, "a1", "c1")])
    for order in ("fixed,indexed", "indexed,fixed"):
        priced = study(GIVEN, {"options.price": order, "load": "3, 28 kN"}, table)
        check([b for b in priced.breaks if b.others == ("fixed",)], [(10, "a1", "b1")])
        check([b for b in priced.breaks if b.others == ("indexed",)], [(15, "a1", "b1")])


def test_a_thing_that_nothing_reads_changes_no_break() -> None:
    table = ropes((10, 2), (20, 1))
    found = study(GIVEN, {"load": "3, 23 kN", "idle": "1, 2"}, table)
    assert [b.others for b in found.breaks] == [(1.0,), (2.0,)]
    for b in found.breaks:
        check([b], [(10, "a1", "b1")])


@pytest.mark.slow
def test_several_objectives_have_breaks_of_their_own() -> None:
    # The second is the least bulky as long as it may be used.
    table = ropes((10, 2), (20, 1), (16, 1.5), worn=[1000, 17, 1000])
    found = synth.whatif(GIVEN, {}, {"load": "3, 23 kN"}, ["cost", "bulk"], catalogs=table, points=4)
    assert not found.interrupted
    check([b for b in found.breaks if b.objective == "cost"], [(10, "a1", "b1"), (17, "b1", "c1")])
    check([b for b in found.breaks if b.objective == "bulk"], [(17, "b1", "c1")], "bulk")


# ---- along a limit and along weights --------------------------------------------------------------------------------


@pytest.mark.slow
def test_breaks_along_a_limit() -> None:
    table = ropes((10, 2), (20, 1), (35, 0.5))
    below = study(FREE, {"strength <=": "10, 20 kN"}, table, requirements={"load": "15 kN"})
    check(below.breaks, [(15, "-", "b1")])
    capped = study(GIVEN, {"cost <=": "34, 36"}, table, requirements={"load": "15 kN"})
    check(capped.breaks, [(35, "-", "b1")])


@pytest.mark.slow
def test_breaks_along_weights() -> None:
    # At 15 kN the costs are 45, 38, 35, 36 and 44; the dearer to buy, the less bulky.
    table = ropes((10, 7 / 3), (16, 22 / 15), (20, 1), (25, 11 / 15), (36, 8 / 15))
    more: dict[str, Any] = {"catalogs": table, "points": 8, "parts": {}, "limits": {"strands": "<= 1"}}
    found = synth.whatif(
        GIVEN, {"load": "15 kN"}, {"weights.bulk": "0:9:3"}, ["cost", "bulk"], fix={"end": "knot"}, **more
    )
    front = found.fronts[0]
    assert [f.certificate.kind for f in found.fronts] == ["global"] * 4
    assert sorted(d.parts["rope"]["designation"][-1] for d in front.designs) == ["c", "d", "e"]
    names = list(front.frame.objectives)
    values = np.array([[d.values[n] for n in names] for d in front.designs])
    scan = np.geomspace(1e-3, 9, 4001)
    leaders = [int(rank(front.frame.objectives, values, [1.0, w]).order[0]) for w in scan]
    words = [front.designs[k].parts["rope"]["designation"][-1] + "1" for k in leaders]
    true = [(0.5 * (scan[k] + scan[k + 1]), words[k], words[k + 1]) for k in range(4000) if words[k] != words[k + 1]]
    assert len(true) == 2
    assert [sides(b) for b in found.breaks] == [(before, after) for _, before, after in true]
    for b, (value, _, _) in zip(found.breaks, true, strict=True):
        assert b.objective == "score"
        assert b.proven
        assert b.value == pytest.approx(value, rel=3e-3)
        assert b.high - b.low <= 2 * WIDTH * b.high
    # The leading designs of the steps are those that the weights say.
    for step in found.steps:
        k = int(np.argmin(np.abs(scan - float(step.values[0]))))  # type: ignore[arg-type]
        assert step.front is not None
        assert step.front.designs[0].parts["rope"]["designation"][-1] + "1" == words[k]
    both = synth.whatif(
        GIVEN, {}, {"weights.bulk": "0, 9", "load": "15, 16 kN"}, ["cost", "bulk"], fix={"end": "knot"}, **more
    )
    assert both.along == 0
    first = [b for b in both.breaks if b.others == (15.0,)]
    assert [b.value for b in first] == pytest.approx([b.value for b in found.breaks], rel=2e-3)
    assert [b.others for b in both.breaks] == [(15.0,)] * 2 + [(16.0,)] * (len(both.breaks) - 2)
    assert len(both.breaks) > 2


# ---- what is kept ---------------------------------------------------------------------------------------------------

CHAIN = ropes((10, 4), (30, 2), (50, 1), (70, 0.5), (90, 0.25))


def kept(folder: Path | None, progress: Callable[[Mapping[str, Any]], None] | None = None) -> Study:
    return synth.whatif(GIVEN, {}, {"load": "2:114:16 kN"}, ["cost"], catalogs=CHAIN, folder=folder, progress=progress)


@pytest.mark.slow
def test_breaks_that_are_kept_are_not_searched_again(tmp_path: Path) -> None:
    first = kept(tmp_path)
    check(first.breaks, [(10, "a1", "b1"), (20, "b1", "c1"), (40, "c1", "d1"), (80, "d1", "e1")])
    record = json.loads((tmp_path / "study.json").read_text())
    own = [name for name in record["known"] if name.startswith("breaks")]
    assert len(own) == 7
    # What the record says is believed: a break that no search would find stands.
    entry = record["known"]["breaks 1 2"]
    assert len(entry["value"]) == 1
    entry["value"][0]["remark"] = "as it was kept"
    (tmp_path / "study.json").write_text(json.dumps(record))
    again = kept(tmp_path)
    assert again.statistics["kept"] == 8
    assert [b.remark for b in again.breaks] == ["as it was kept", "", "", ""]
    assert [replace(b, remark="") for b in again.breaks] == list(first.breaks)
    # Kept breaks of another question are not.
    entry["fingerprint"] = "another"
    (tmp_path / "study.json").write_text(json.dumps(record))
    assert kept(tmp_path).breaks == first.breaks


@pytest.mark.slow
def test_breaks_after_an_interruption_are_the_same(tmp_path: Path) -> None:
    whole = kept(None).files()["breaks.csv"]

    def stop(state: Mapping[str, Any]) -> None:
        if "break points" in str(state["stage"]):
            raise KeyboardInterrupt

    short = kept(tmp_path, stop)
    assert short.interrupted == "interrupted"
    assert all(s.front is not None for s in short.steps)
    assert short.breaks == ()
    finished = kept(tmp_path)
    assert not finished.interrupted
    assert finished.statistics["kept"] == 8
    assert finished.files()["breaks.csv"] == whole


@pytest.mark.slow
def test_intervals_that_were_finished_are_kept(tmp_path: Path) -> None:
    def stop(state: Mapping[str, Any]) -> None:
        if "break points" in str(state["stage"]) and state["done"] > 0.5:
            raise KeyboardInterrupt

    def narrow(progress: Callable[[Mapping[str, Any]], None] | None, folder: Path | None) -> Study:
        return synth.whatif(
            GIVEN, {}, {"load": "2.5:90.5:1 kN"}, ["cost"], catalogs=CHAIN, folder=folder, progress=progress
        )

    short = narrow(stop, tmp_path)
    assert short.interrupted == "interrupted"
    check(short.breaks, [(10, "a1", "b1"), (20, "b1", "c1"), (40, "c1", "d1")])
    whole = narrow(None, tmp_path)
    check(whole.breaks, [(10, "a1", "b1"), (20, "b1", "c1"), (40, "c1", "d1"), (80, "d1", "e1")])
    assert whole.files()["breaks.csv"] == narrow(None, None).files()["breaks.csv"]
