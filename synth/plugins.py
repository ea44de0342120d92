"""What installed packages bring by their entry points."""

from __future__ import annotations

from functools import cache
from importlib.metadata import EntryPoint, entry_points

FAMILIES = "clutchsynth.problems"  # the group of families
# Packages inside the installed one that are not the engine; in the sources they are folders beside it.
SHIPPED_FAMILIES = "synth.problems"
AROUND_THE_ENGINE = (SHIPPED_FAMILIES, "synth.catalogs", "synth.reports")


def family_names() -> list[str]:
    """Names of all registered families, sorted; none of them is imported."""
    return sorted({point.name for point in installed(FAMILIES)})


@cache
def installed(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, sorted; the packages of an environment are looked through but once."""
    return tuple(sorted(set(entry_points(group=group)), key=lambda point: (point.name, point.value)))
