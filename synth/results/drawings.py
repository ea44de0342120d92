"""Reports of results that are installed, by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal, overload

from synth.plugins import installed
from synth.results import hookspecs as specs

if TYPE_CHECKING:
    from synth.results import Design

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


@overload
def report(name: Literal["batch_files"]) -> specs.BatchFiles | None: ...
@overload
def report(name: Literal["comparison"]) -> specs.ComparisonFiles | None: ...
@overload
def report(name: Literal["comparison_table"]) -> specs.CommonFrontTable | None: ...
@overload
def report(name: Literal["explorer_comparison"]) -> specs.ExplorerComparison | None: ...
@overload
def report(name: Literal["explorer_files"]) -> specs.ExplorerFiles | None: ...
@overload
def report(name: Literal["explorer_frame"]) -> specs.ExplorerFrame | None: ...
@overload
def report(name: Literal["explorer_record"]) -> specs.ExplorerRecord | None: ...
@overload
def report(name: Literal["files"]) -> specs.FrontFiles | None: ...
@overload
def report(name: Literal["front_workbook"]) -> specs.FrontWorkbook | None: ...
@overload
def report(name: Literal["plot"]) -> specs.FrontPlot | None: ...
@overload
def report(name: Literal["plot_file"]) -> specs.FrontPlotFile | None: ...
@overload
def report(name: Literal["figure"]) -> specs.FrameFigure | None: ...
@overload
def report(name: Literal["table"]) -> specs.FrontTable | None: ...
@overload
def report(name: Literal["terminal_plot"]) -> specs.TerminalPlot | None: ...
@overload
def report(name: Literal["workbook"]) -> specs.LiveWorkbook | None: ...
def report(name: str) -> Any:
    """Report by its registered name; None where it is not installed."""
    return next((point.load() for point in installed(REPORTS) if point.name == name), None)


def front_picture(
    designs: Sequence[Design],
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
    return "" if draw is None else draw(designs, objectives, title, stopped + proven, families)
