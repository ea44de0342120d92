"""What a worker process shows of the group that it is at: how many of its rows have designs by now."""

from __future__ import annotations

from typing import Any

from synth.question.settings import ProgressState

_shown: list[Any] = []  # the number that this process shares with its master, if it has one


def share(number: object) -> None:
    """Show from now on in a number that another process reads."""
    _shown[:] = [number]


def show(state: ProgressState) -> None:
    """Show the progress of a search; where nobody looks, nothing."""
    for number in _shown:
        number.value = int(state["incumbents"])
