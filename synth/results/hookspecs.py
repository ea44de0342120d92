"""Hooks of reports: what each entry point of the group ``clutchsynth.reports`` is called with, and what it returns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from synth.errors import ExtraNeededError

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console

    from synth.results import Design, ParetoFront, PartRow
    from synth.results.calculation import Calculation
    from synth.results.report_request import About, BatchReportRequest, ComparisonRequest, ReportRequest


Made = tuple[dict[str, str | bytes], list[str], tuple[ExtraNeededError, ...]]  # files by name, notes, missing extras


class FrontOfFamilies(Protocol):
    """Ranked designs of several families; ``families`` are those of the designs."""

    @property
    def objectives(self) -> Mapping[str, str]: ...
    @property
    def designs(self) -> Sequence[Design]: ...
    @property
    def families(self) -> Sequence[str]: ...


class FrontFiles(Protocol):
    """Files of the report of a front, or of one design that was checked."""

    def __call__(self, request: ReportRequest) -> Made: ...


class ComparisonFiles(Protocol):
    """Files of the report of several families."""

    def __call__(self, request: ComparisonRequest) -> Made: ...


class BatchFiles(Protocol):
    """Files of the report of a batch."""

    def __call__(self, request: BatchReportRequest) -> Made: ...


class FrontTable(Protocol):
    """Prints the ranked designs of a front."""

    def __call__(
        self, front: ParetoFront, console: Console, every: bool = False, calculation: Calculation | None = None
    ) -> None: ...


class CommonFrontTable(Protocol):
    """Prints the common front of several families."""

    def __call__(self, front: FrontOfFamilies, console: Console, every: bool = False) -> None: ...


class TerminalPlot(Protocol):
    """Draws designs on a terminal."""

    def __call__(
        self,
        designs: Sequence[Design],
        objectives: Mapping[str, str],
        console: Console,
        families: Sequence[str] = (),
        braille: bool | None = None,
    ) -> None: ...


class FrontPlot(Protocol):
    """Front as SVG for a page; empty where there are no two objectives."""

    def __call__(self, front: ParetoFront, chosen: Sequence[int] = (), linked: bool = True) -> str: ...


class FrontPlotFile(Protocol):
    """Designs as an SVG file that says by itself what it shows; empty where there are no two objectives."""

    def __call__(
        self,
        designs: Sequence[Design],
        objectives: Mapping[str, str],
        title: str,
        proven: str = "",
        families: Sequence[str] = (),
    ) -> str: ...


class FrameFigure(Protocol):
    """Curves or a simulation as SVG."""

    def __call__(self, frame: pd.DataFrame) -> str: ...


class FrontWorkbook(Protocol):
    """Workbook of all designs of a front."""

    def __call__(self, front: ParetoFront, calculation: Calculation | None = None) -> bytes: ...


class LiveWorkbook(Protocol):
    """Workbook in which one design can be changed and is computed again."""

    def __call__(
        self,
        calculation: Calculation,
        design: Design,
        rows: Mapping[str, Sequence[PartRow]],
        about: About | Mapping[str, str] | None = None,
        certificate: str = "",
    ) -> bytes: ...


class ExplorerRecord(Protocol):
    """Record of a front that the explorer shows, as JSON holds it."""

    def __call__(
        self, request: ReportRequest, files: Mapping[int, Mapping[str, str]] | None = None
    ) -> dict[str, Any]: ...


class ExplorerComparison(Protocol):
    """Record of the common front of several families that the explorer shows, as JSON holds it."""

    def __call__(self, request: ComparisonRequest) -> dict[str, Any]: ...


class ExplorerFrame(Protocol):
    """Explorer of a record as a frame for a notebook."""

    def __call__(self, record: Mapping[str, Any], height: int = 760) -> str: ...


class ExplorerFiles(Protocol):
    """Scripts and style sheets of the explorer, by file name."""

    def __call__(self) -> dict[str, str]: ...
