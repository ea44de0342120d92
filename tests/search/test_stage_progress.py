"""What a search tells while it is at work."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from synth.search.stage_progress import StageProgress


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
