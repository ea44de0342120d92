"""Questions that are asked with tuning numbers of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import synth
from synth.question.request import Request
from synth.question.request_fields import SEARCHED
from synth.question.settings import SearchSettings
from synth.search.settings import TUNING, Tuning
from synth.search.synthesize import find_front


def tuned(**changes: Mapping[str, Any]) -> Tuning:
    """Return the numbers that everybody gets but for some: record -> field -> value."""
    return replace(TUNING, **{name: replace(getattr(TUNING, name), **own) for name, own in changes.items()})


def synthesize(
    tuning: Tuning,
    p: Any,
    requirements: Mapping[str, Any],
    objectives: Any = None,
    points: int = 30,
    catalogs: Any = None,
    robust: Any = None,
    progress: Any = None,
    **more: Any,
) -> synth.ParetoFront:
    """Do what ``synth.synthesize`` does, with these numbers."""
    how = {name: more.pop(name) for name in SEARCHED if name in more}
    request = Request.of(p, requirements, catalogs, robust, objectives=objectives, **more)
    return find_front(request, SearchSettings(points=points, **how), progress, tuning)
