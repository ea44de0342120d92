"""Waits for what happens at last: a busy machine may take its time, and only what never happens fails."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

PATIENCE = 600.0  # s
SOON, OFTEN = 0.02, 0.1  # s until another look, and as a share of how long it was waited: looks take work from others


def until(look: Callable[[], Any], right: Callable[[Any], bool] = bool) -> Any:
    """First value looked at that is right."""
    begun = time.monotonic()
    while not right(value := look()):
        waited = time.monotonic() - begun
        assert waited < PATIENCE, f"not within {PATIENCE:.0f} s: {value}"
        time.sleep(min(SOON + OFTEN * waited, 1.0))
    return value
