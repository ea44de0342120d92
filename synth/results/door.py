"""What the methods of a front ask of whoever stands above results: they know the facade, and it alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar, cast

if TYPE_CHECKING:
    from synth.results.calculation import Calculation
    from synth.results.notebook import NotebookFrame
    from synth.results.report_request import ReportOptions
    from synth.results.verification import Verification


Front = TypeVar("Front")  # the class of fronts imports this module


class ReportOnDisk(Protocol):
    """A report that is written."""

    def complete(self) -> Path:
        """Folder of the report; an InputError where an extra is not installed."""
        ...


class Door(Protocol):
    """Verbs about a front, as the facade has them; options are those of the methods of a front."""

    def calculation(self, front: object, /) -> Calculation:
        """How every number of the designs is computed."""
        ...

    def verify(self, front: object, problem: object, catalogs: object, time_limit: float, /) -> Verification:
        """Check without help of the search."""
        ...

    def improve(self, front: Front, /, **options: object) -> Front:
        """Search on from the designs."""
        ...

    def report(self, front: object, folder: str | Path, how: ReportOptions, /, **options: object) -> ReportOnDisk:
        """Write report and sheets."""
        ...

    def explore(self, front: object, height: int, /, **options: object) -> NotebookFrame:
        """Frame of the explorer for a notebook."""
        ...


def door() -> Door:
    """The facade, which imports what is asked on first use."""
    import synth

    return cast("Door", synth)
