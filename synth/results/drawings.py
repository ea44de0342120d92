"""Reports of results that are installed, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from typing import Any

from synth.plugins import installed

REPORTS = "clutchsynth.reports"
PLOT = "front.svg"  # the picture of a front in its folder
# Format of a report -> the package that makes it, the option that asks for it, the extra that brings the package.
EXTRAS = {
    "pdf": ("typst", "--pdf", "pdf"),
    "xlsx": ("xlsxwriter", "--xlsx", "excel"),
    "dxf": ("ezdxf", "--dxf", "dxf"),
    "step": ("build123d", "--step", "step"),
    "glb": ("build123d", "--step", "step"),
}


def can_make(word: str) -> bool:
    """True if a format of reports needs no extra, or its extra is installed."""
    return word not in EXTRAS or find_spec(EXTRAS[word][0]) is not None


def report(name: str) -> Callable[..., Any] | None:
    """Return a report by its registered name; None where it is not installed."""
    for point in installed(REPORTS):
        if point.name == name:
            found: Callable[..., Any] = point.load()
            return found
    return None


def front_picture(
    designs: Sequence[Any],
    objectives: Mapping[str, str],
    title: str,
    proven: str,
    interrupted: str,
    families: Sequence[str] = (),
) -> str:
    """Return ranked designs as an SVG file; nothing where there is no front, or reports are not installed.

    Parameters
    ----------
    designs : list of Design
    objectives : mapping
        Names and senses.
    title : str
        What was designed.
    proven : str
        How far that is proven.
    interrupted : str
        Why the search was stopped, where it was.
    families : list of str
        The family of each design, where there are several.
    """
    draw = report("plot_file")
    stopped = f"stopped: {interrupted}; " if interrupted else ""
    return "" if draw is None else str(draw(designs, objectives, title, stopped + proven, families))
