"""Rows that are answered together: the groups follow from the rows alone, and what they give is what each row gives."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import synth
from synth.batches import runner
from synth.batches.executors import Processes
from synth.batches.row_groups import RowGroups, neighbourhoods
from synth.batches.row_questions import alikeness
from synth.batches.settings import BatchSettings, GroupSettings, RunnerSettings
from synth.batches.signs import show
from synth.batches.solve import GROUP, UNGROUPED, Shared, answered_together, is_group, solve_unit
from synth.batches.store import Outcome, Store
from synth.batches.warm_starts import place
from synth.queue.database import digest
from synth.search.joint.joint_search import JointSearch
from synth.system import deadline
from synth.system.deadline import Stopped
from tests.batches.asked import batch
from tests.sample_problems.rod import Rod
from tests.waiting import PATIENCE

SMALL = BatchSettings(groups=GroupSettings(least=4, most=9))
SETTINGS = {"objectives": ["mass"], "points": 1}
SEARCHED = {**SETTINGS, "gap": 1e-3, "grid": True, "seed": 0, "time_limit": None}
FORCES = [10 + 3 * k for k in range(20)]


def question(force: Any, room: Any = 30, **more: Any) -> dict[str, Any]:
    return {
        "family": "rod",
        "options": {},
        "requirements": {"diameter_limit": f"{room} mm", "force": f"{force} kN"},
        "limits": {},
        "fix": {},
        "parts": {},
        **more,
    }


def rows(forces: Sequence[float] = FORCES) -> list[dict[str, Any]]:
    """Return rows of which every fifth has no design, as the room is too small."""
    return [
        {"id": f"R{k}", "force [kN]": f, "diameter_limit [mm]": 1 if k % 5 == 3 else 30 + k % 2}
        for k, f in enumerate(forces)
    ]


def contents(result: Any) -> list[dict[str, Any]]:
    with Store(f"sqlite:///{result.folder / 'jobs.sqlite'}") as store:
        return [content for _, _, content in store.questions(result.job)]


def without_seconds(result: Any) -> list[dict[str, Any]]:
    return list(result.rows().drop(columns="seconds").sort_values("id").drop(columns="line").to_dict("records"))


# ---- which rows -----------------------------------------------------------------------------------------------------


def groups(asked: Sequence[Mapping[str, Any]], settings: GroupSettings = SMALL.groups) -> dict[str, set[str]]:
    """Return the keys of questions by the name of their group."""
    found: dict[str, set[str]] = {}
    with closing(RowGroups(settings)) as own:
        keys = [(digest(q), alikeness(q)) for q in asked]
        for (key, alike), q in zip(keys, asked, strict=True):
            own.show(key, alike, place([float(text.split()[0]) for text in q["requirements"].values()]))
        for key, alike in keys:
            member = own.member(key, alike)
            if member is not None:
                found.setdefault(member.name, set()).add(key)
    return found


def test_groups_do_not_depend_on_the_order_of_rows() -> None:
    asked = [question(f, 20 + f % 7) for f in range(1, 80)]
    shuffled = list(asked)
    random.Random(0).shuffle(shuffled)
    assert groups(asked) == groups(shuffled)
    sizes = [len(own) for own in groups(asked).values()]
    assert 2 <= min(sizes) <= max(sizes) <= 9
    assert sum(sizes) > 70  # a row that has a cell of space to itself is alone


def test_a_row_more_changes_one_group() -> None:
    asked = [question(f, 20 + f % 7) for f in range(1, 80)]
    before, after = groups(asked), groups([*asked, question(33.3, 22)])
    changed = [own for name, own in before.items() if name not in after]
    assert len(changed) == 1
    assert len(changed[0]) < 10


def test_few_rows_and_rows_that_ask_other_things_stay_alone() -> None:
    few, other = [question(f) for f in range(1, 4)], [question(f, fix={"length": "50 mm"}) for f in range(1, 6)]
    assert groups(few) == {}
    found = groups([*few, *other, question(9, limits={"mass": ["<= 3 kg"]})])
    assert list(found.values()) == [{digest(q) for q in other}]


def test_a_number_that_is_written_in_two_ways_is_in_the_group_twice() -> None:
    same = [question(text) for text in ("10", "10.0", "10.00", "1e1", "1.0e1", "1E1", "10e0", "+10", "100e-1", "010")]
    found = groups(same)
    assert sorted(map(len, found.values())) == [5, 5]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "units"), [(32, 2), (200, 12), (1024, 64), (1100, 64), (2047, 64), (2048, 64), (3000, 64)]
)
def test_rows_are_units_for_many_workers(rows: int, units: int) -> None:
    """The size of a group follows from the rows: 64 or more, where each can have 16 rows."""
    asked = [question(round(10 * 1.003**k, 3), 20 + k % 7) for k in range(rows)]
    found = groups(asked, GroupSettings())
    sizes = [len(own) for own in found.values()]
    assert len(sizes) >= units
    assert max(sizes) <= GroupSettings().size(rows)
    assert sum(sizes) > 0.9 * rows


def test_rows_that_ask_in_several_ways_are_counted_together() -> None:
    asked = [question(10 + k, limits={"mass": [f"<= {k % 40} kg"]}) for k in range(1600)]
    sizes = [len(own) for own in groups(asked, GroupSettings()).values()]
    assert len(sizes) >= 64
    assert sum(sizes) > 1400


@given(st.integers(1, 3_000_000), st.integers(1, 200))
def test_a_row_more_rarely_changes_the_size_of_groups(rows: int, more: int) -> None:
    settings = GroupSettings()
    before, after = settings.size(rows), settings.size(rows + more)
    assert settings.smallest <= before <= after <= settings.most
    assert before & (before - 1) == 0
    assert rows < settings.smallest * settings.units or rows // before >= settings.units


@pytest.mark.parametrize("seed", range(4))
def test_groups_do_not_depend_on_how_much_is_in_memory(seed: int) -> None:
    chance = random.Random(seed)
    asked = [question(chance.choice([5, 5.0, chance.uniform(1, 900)]), chance.choice([9, 30.5])) for _ in range(300)]
    whole = groups(asked, GroupSettings(least=4, most=9))
    assert len(whole) > 12
    for portion in (1, 9, 40, 299):
        assert groups(asked, GroupSettings(least=4, most=9, portion=portion, cache=1)) == whole


@pytest.mark.parametrize("seed", range(5))
def test_neighbourhoods_hold_every_point_once_and_are_cells_of_space(seed: int) -> None:
    chance = np.random.default_rng(seed)
    points = chance.normal(scale=[1, 30, 0], size=(300, 3))
    found = list(neighbourhoods(points, 20))
    assert sorted(np.concatenate(found).tolist()) == list(range(300))
    assert max(map(len, found)) <= 20
    corners = [(points[own].min(axis=0), points[own].max(axis=0)) for own in found]
    for k, (low, high) in enumerate(corners):
        for other_low, other_high in corners[:k]:
            assert np.any((high < other_low) | (other_high < low)), "cells overlap"


def test_neighbours_in_a_group_stand_side_by_side() -> None:
    points = np.arange(16.0)[[3, 8, 1, 15, 0, 7, 12, 5, 2, 9, 4, 11, 6, 13, 10, 14], None]
    (order,) = neighbourhoods(points, 16)
    assert points[order, 0].tolist() == list(range(16))


# ---- what they give -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def together(tmp_path_factory: pytest.TempPathFactory) -> synth.BatchResult:
    return batch(SMALL, Rod, rows(), tmp_path_factory.mktemp("together"), **SETTINGS)


@pytest.mark.slow
def test_rows_in_groups_have_the_answers_that_they_have_alone(together: synth.BatchResult, tmp_path: Path) -> None:
    assert all(GROUP in content for content in contents(together))
    alone = batch(BatchSettings(groups=GroupSettings(least=99)), Rod, rows(), tmp_path, **SETTINGS)
    assert not any(GROUP in content for content in contents(alone))
    assert together.counts == alone.counts == {"infeasible": 4, "optimal": 16}
    ours, theirs = (result.rows().set_index("id") for result in (together, alone))
    for column in ("line", "family", "status", "designs", "certificate", "gap", "explanation", "remarks"):
        assert list(ours[column]) == list(theirs[column]), column
    masses, others = (result.designs().set_index("id")["mass [kg]"] for result in (together, alone))
    for name, mass in masses.items():
        assert mass == pytest.approx(others[name], rel=1e-3)


def test_the_time_and_the_work_of_a_row_are_its_share(together: synth.BatchResult) -> None:
    with Store(f"sqlite:///{together.folder / 'jobs.sqlite'}") as store:
        answers = list(store.rows(together.job, canonical=False))
        groups_of_rows = {key: content[GROUP]["name"] for key, _, content in store.questions(together.job)}
    spent: dict[str, set[tuple[Any, ...]]] = {}
    for row in answers:
        assert row.content is not None
        spent.setdefault(groups_of_rows[row.key or ""], set()).add((row.seconds, row.content["nlp_solves"]))
    assert all(len(shares) == 1 for shares in spent.values())


def test_order_does_not_change_a_byte(together: synth.BatchResult, tmp_path: Path) -> None:
    shuffled = rows()
    random.Random(1).shuffle(shuffled)
    other = batch(SMALL, Rod, shuffled, tmp_path, **SETTINGS)
    assert (other.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()
    assert without_seconds(other) == without_seconds(together)


@pytest.mark.slow
def test_workers_do_not_change_a_byte(together: synth.BatchResult, tmp_path: Path) -> None:
    other = batch(SMALL, Rod, rows(), tmp_path, workers=2, **SETTINGS)
    assert (other.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()
    assert without_seconds(other) == without_seconds(together)


@pytest.mark.slow
def test_a_batch_that_is_stopped_within_a_group_ends_with_the_same_bytes(
    together: synth.BatchResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = [2]

    def stopped_in_the_third(search: JointSearch) -> Any:
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return settled(search)

    settled = JointSearch.settled
    monkeypatch.setattr(JointSearch, "settled", stopped_in_the_third)
    first = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert first.stopped == "interrupted"
    assert 0 < first.counts["not_solved"] < 20
    monkeypatch.undo()
    again = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert again.stopped == ""
    assert (again.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()
    assert without_seconds(again) == without_seconds(together)


def test_a_row_more_leaves_the_answers_of_other_groups(together: synth.BatchResult, tmp_path: Path) -> None:
    first = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    more = batch(
        SMALL, Rod, [*rows(), {"id": "new", "force [kN]": 11, "diameter_limit [mm]": 30}], tmp_path, **SETTINGS
    )
    assert more.job != first.job
    with Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}") as store:
        created = [text for _, kind, text in store.events(more.job) if kind == "created"]
    known = int(created[0].split(", ")[1].split()[0])
    assert 8 <= known < 20
    alone = synth.synthesize(Rod, {"force": "11 kN", "diameter_limit": "30 mm"}, objectives=["mass"], points=1)
    assert more.designs().set_index("id")["mass [kg]"]["new"] == pytest.approx(
        alone.designs[0].values["mass"], rel=1e-3
    )


def test_answers_that_are_known_in_part_are_completed_alone(tmp_path: Path) -> None:
    """What is left of a group cannot be answered as the group was: it is cut into units of few rows."""
    group = {"name": "g", "rows": 9}
    questions = [
        {"key": f"{k:064d}", "structure": "s", "position": b"%d" % k, "content": {"n": k, GROUP: group}}
        for k in range(9)
    ]
    table = [
        {
            "line": k,
            "position": b"",
            "key": q["key"],
            "family": "",
            "cells": [],
            "remarks": "",
            "faults": [],
            "question": q,
        }
        for k, q in enumerate(questions, start=2)
    ]
    about = {"basis": "b", "source": "", "folder": "", "content": {}}
    with Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}") as store:
        assert store.create({"id": "first", **about}, table, 4)
        (claim,) = store.claim("first", "me", 10)
        assert list(claim.questions) == [q["key"] for q in questions]
        known = {key: Outcome("optimal", 0.0, None, {}) for key in list(claim.questions)[:3]}
        store.finish("first", claim, "me", known, {}, 1, dict.fromkeys(list(claim.questions)[3:], ""))
        assert [len(unit.questions) for unit in store.claim("first", "me", 10)] == [1] * 6
        assert store.create({"id": "second", **about}, table, 4)
        assert [len(unit.questions) for unit in store.claim("second", "me", 10)] == [4, 2]


def test_progress_shows_within_a_group(tmp_path: Path) -> None:
    every = BatchSettings(groups=SMALL.groups, runner=RunnerSettings(pause=0.0, report_share=math.inf))  # however slow
    states: list[Mapping[str, Any]] = []
    batch(every, Rod, rows(), tmp_path, progress=states.append, **SETTINGS)
    assert max(state["found"] for state in states) > 1
    assert states[-1]["found"] == 0
    assert states[-1]["done"] == 20


@pytest.mark.slow
def test_a_job_that_is_cancelled_stops_within_a_group(
    together: synth.BatchResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def endless(search: JointSearch) -> None:
        with Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}") as store:
            (job,) = store.jobs()
            store.cancel(job.id)
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            deadline.check()
            time.sleep(0.01)

    monkeypatch.setattr(JointSearch, "settled", endless)
    stopped = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert stopped.stopped == "cancelled"
    assert stopped.counts == {"not_solved": 20}
    monkeypatch.undo()
    again = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert (again.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()


def test_worker_processes_show_how_far_they_are() -> None:
    pool = Processes(1)
    try:
        pool.submit(show, {"incumbents": 7}).result(timeout=PATIENCE)
        assert pool.with_designs() == 7
        pool.submit(show, {"incumbents": 0}).result(timeout=PATIENCE)
        assert pool.with_designs() == 0
    finally:
        pool.shutdown()
    show({"incumbents": 7})  # of no master


# ---- what goes wrong ------------------------------------------------------------------------------------------------


def of_a_group(questions: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    group = {"name": "g", "rows": len(questions)}
    return {f"key {k}": {**q, GROUP: group} for k, q in enumerate(questions)}


def test_what_a_group_cannot_settle_is_left_to_be_asked_alone() -> None:
    asked = of_a_group([question(10), question(-5), question(20), question("x"), question(30, 1)])
    found = answered_together(asked, SEARCHED, Shared("job", None, Rod), None)
    assert [found[key].get("status", found[key].get(UNGROUPED)) for key in asked] == [
        "optimal",
        "",
        "optimal",
        "",
        "infeasible",
    ]


def test_an_error_in_one_question_is_its_own() -> None:
    asked = of_a_group([question(10), question(20), {**question(30), "family": "nothing such"}, question(40)])
    del asked["key 1"]["parts"]
    asked["key 1"]["fix"] = 7
    found = answered_together(asked, SEARCHED, Shared("job", None, Rod), None)
    assert [UNGROUPED in found[key] for key in asked] == [False, True, True, False]


@pytest.mark.slow
def test_an_error_of_the_search_leaves_all_to_be_asked_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, together: synth.BatchResult
) -> None:
    def broken(search: JointSearch) -> None:
        raise ZeroDivisionError("no such thing")

    monkeypatch.setattr(JointSearch, "settled", broken)
    result = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert result.counts == together.counts
    with Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}") as store:
        told = [text for _, kind, text in store.events(result.job) if kind == "alone"]
        assert "failed" not in [kind for _, kind, _ in store.events(result.job)]
    assert told
    assert all("questions of a group: ZeroDivisionError: no such thing" in text for text in told)


def test_time_that_is_over_leaves_all_to_be_asked_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(search: JointSearch) -> None:
        raise Stopped("time limit")

    asked = of_a_group([question(10), question(20)])
    found = answered_together(asked, {**SEARCHED, "time_limit": 60.0}, Shared("job", None, Rod), None)
    assert [found[key]["status"] for key in asked] == ["optimal", "optimal"]
    monkeypatch.setattr(JointSearch, "settled", late)
    found = answered_together(asked, {**SEARCHED, "time_limit": 60.0}, Shared("job", None, Rod), None)
    assert list(found.values()) == [{UNGROUPED: ""}] * 2


def failing_groups(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    if is_group(work["questions"]):
        raise MemoryError("too many at once")
    return solve_unit(work)


def failing_once(times: list[int]) -> Any:
    def unit(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        times.append(len(work["questions"]))
        return failing_groups(work) if len(times) == 1 else solve_unit(work)

    return unit


def test_a_group_that_fails_once_is_tried_again_and_gives_the_same_bytes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, together: synth.BatchResult
) -> None:
    times: list[int] = []
    monkeypatch.setattr(runner, "solve_unit", failing_once(times))
    result = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert (result.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()
    assert times.count(times[0]) >= 2
    assert min(times) > 1


@pytest.mark.slow
def test_a_group_that_fails_again_and_again_is_answered_row_by_row(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, together: synth.BatchResult
) -> None:
    monkeypatch.setattr(runner, "solve_unit", failing_groups)
    result = batch(SMALL, Rod, rows(), tmp_path, **SETTINGS)
    assert result.counts == together.counts
    with Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}") as store:
        failed = [text for _, kind, text in store.events(result.job) if kind == "failed"]
    assert failed[0].startswith("attempt 1 of ")
    assert all(text.startswith("attempt 2 of question ") for text in failed if not text.startswith("attempt 1 of "))


def test_bad_rows_beside_a_group_are_told(together: synth.BatchResult, tmp_path: Path) -> None:
    bad = [{"id": "bad", "force [kN]": "x", "diameter_limit [mm]": 30}]
    result = batch(SMALL, Rod, [*rows()[:9], *bad, *rows()[9:]], tmp_path, **SETTINGS)
    assert result.counts == {**together.counts, "bad_input": 1}
    assert (result.folder / "designs.csv").read_bytes() == (together.folder / "designs.csv").read_bytes()
