"""What a search tells while it is at work."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from synth.search.front_state import FrontState
from synth.search.settings import ProgressLimits
from synth.search.shown_designs import ShownDesigns
from synth.search.stage_progress import StageProgress
from synth.units import parse_quantity
from tests.asking import pose
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import tuned


def test_a_stage_tells_when_it_begins_and_ends_and_what_is_open_between() -> None:
    told: list[Mapping[str, Any]] = []
    progress = StageProgress(told.append, 12, lambda: len(told))
    with progress.stage("front"):
        progress.say("front", 0.5)
        progress.working(7)
        progress.working(0)
    assert [state["stage"] for state in told] == ["front"] * 4
    assert [state["done"] for state in told] == [0.0, 0.5, 0.5, 1.0]
    assert [state["message"] for state in told] == ["", "", "7 boxes open", ""]
    assert [state["incumbents"] for state in told] == [0, 1, 2, 3]
    assert {state["combinations"] for state in told} == {12}


def test_seconds_of_a_stage_add_up_although_it_is_stopped() -> None:
    progress = StageProgress(None, 1, lambda: 0)
    with progress.stage("front"):
        pass
    before = progress.seconds["front"]
    with pytest.raises(KeyboardInterrupt), progress.stage("front"):
        raise KeyboardInterrupt
    assert list(progress.seconds) == ["front"]
    assert before <= progress.seconds["front"] <= progress.elapsed


def test_a_stage_that_is_entered_tells_of_its_boxes_alone() -> None:
    told: list[Mapping[str, Any]] = []
    progress = StageProgress(told.append, 1, lambda: 0)
    progress.enter("against the others")
    assert not told
    progress.working(3)
    assert (told[0]["stage"], told[0]["done"]) == ("against the others", 0.0)


def test_designs_are_told_no_more_often_than_it_is_asked() -> None:
    told: list[Mapping[str, Any]] = []
    often = StageProgress(told.append, 1, lambda: 1, lambda: {"points": [[1.0]]}, ProgressLimits(pause=0.0))
    seldom = StageProgress(told.append, 1, lambda: 1, lambda: {"points": [[1.0]]}, ProgressLimits(pause=1e6))
    for progress in (often, seldom):
        told.clear()
        for _ in range(3):
            progress.say("front", 0.0)
        assert sum("points" in state for state in told) == (3 if progress is often else 1)


def test_the_designs_of_a_front_were_told_in_display_units() -> None:
    told: list[Mapping[str, Any]] = []
    asked = pose(Strut(), NEEDED, catalogs={"rods": RODS}, tuning=tuned(progress={"pause": 0.0}))
    front = asked.answer(told.append)
    shown = [state for state in told if "points" in state]
    last, frame = shown[-1], front.frame
    assert [heading.split(" [")[0] for heading in last["columns"]] == list(frame.objectives)
    units = [frame.units[n] for n in frame.objectives]
    points = np.array([[parse_quantity(x, u, u) for x, u in zip(p, units, strict=True)] for p in last["points"]])
    designs = np.array([list(design.objectives.values()) for design in front.designs])
    # What was known then beats nothing of what was found in the end, and spans as much.
    assert not any((point * 1.002 < design).all() for point in points for design in designs)
    assert points.min(axis=0) == pytest.approx(designs.min(axis=0), rel=0.01)
    assert len({id(state["points"]) for state in shown}) == len(shown) < len(told)


def test_of_many_designs_some_are_told_with_the_ends_among_them() -> None:
    state = FrontState(pose(Strut(), NEEDED, catalogs={"rods": RODS}).search().state.task)
    form, width = state.form, state.form.archive.phi.shape[1]
    phi = np.zeros((50, width))
    phi[:, 0], phi[:, 1] = np.arange(50) / 50, -np.arange(50) / 50
    form.archive.add(np.arange(50), np.zeros((50, form.n)), phi)
    shown = ShownDesigns(list(state.task.chosen), ProgressLimits(points=7))
    found = shown.of(form)["points"]
    assert len(found) == 7
    whole = ShownDesigns(list(state.task.chosen), ProgressLimits()).of(form)["points"]
    assert (found[0], found[-1], len(whole)) == (whole[0], whole[-1], 50)
    assert shown.of(form) == {}  # they are the same as before
