"""Questions that are asked with tuning numbers of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import synth
from synth.tuning import TUNING, Tuning
from tests.asking import pose


def tuned(**changes: Mapping[str, Any]) -> Tuning:
    """Return the numbers that everybody gets but for some: record -> field -> value."""
    return replace(TUNING, **{name: replace(getattr(TUNING, name), **own) for name, own in changes.items()})


def synthesize(tuning: Tuning, *question: Any, progress: Any = None, **more: Any) -> synth.ParetoFront:
    """Do what ``synth.synthesize`` does, with these numbers."""
    return pose(*question, **more, tuning=tuning).answer(progress)
