"""What installed packages bring by their entry points."""

from __future__ import annotations

from functools import cache
from importlib.metadata import EntryPoint, entry_points


@cache
def installed(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, sorted; the packages of an environment are looked through but once."""
    return tuple(sorted(set(entry_points(group=group)), key=lambda point: (point.name, point.value)))
