"""Questions that are asked with tuning numbers of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import synth
from synth.search import pose
from synth.tuning import TUNING, Tuning


def tuned(**changes: Mapping[str, Any]) -> Tuning:
    """Return the numbers that everybody gets but for some: record -> field -> value."""
    return replace(TUNING, **{name: replace(getattr(TUNING, name), **own) for name, own in changes.items()})


def synthesize(
    tuning: Tuning, *question: Any, workers: int = 1, progress: Any = None, time_limit: float | None = None, **more: Any
) -> synth.ParetoFront:
    """Do what ``synth.synthesize`` does, with these numbers."""
    return pose(*question, **more, tuning=tuning).answer(workers, progress, time_limit)
