"""Waits for what happens at last: a busy machine may take its time, and only what never happens fails."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

PATIENCE = 600.0  # s
SOON, LATER = 0.02, 0.1  # s until another look, at first and after a second: looks take work from others


def until(look: Callable[[], Any], right: Callable[[Any], bool] = bool) -> Any:
    """First value looked at that is right."""
    begun = time.monotonic()
    while not right(value := look()):
        waited = time.monotonic() - begun
        assert waited < PATIENCE, f"not within {PATIENCE:.0f} s: {value}"
        time.sleep(SOON if waited < 1.0 else LATER)
    return value
