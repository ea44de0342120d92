"""Waits for what happens at last: a busy machine may take its time, and only what never happens fails."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

PATIENCE = 600.0  # s


def until(look: Callable[[], Any], right: Callable[[Any], bool] = bool) -> Any:
    """First value looked at that is right."""
    end = time.monotonic() + PATIENCE
    while not right(value := look()):
        assert time.monotonic() < end, f"not within {PATIENCE:.0f} s: {value}"
        time.sleep(0.02)
    return value
