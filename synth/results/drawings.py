"""Reports of results that are installed, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from synth.plugins import installed

REPORTS = "clutchsynth.reports"


def report(name: str) -> Callable[..., Any] | None:
    """Return a report by its registered name; None where it is not installed."""
    for point in installed(REPORTS):
        if point.name == name:
            found: Callable[..., Any] = point.load()
            return found
    return None
