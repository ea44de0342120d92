"""What the methods of a front ask of whoever stands above results: they know the facade, and it alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from synth.results.calculation import Calculation
    from synth.results.front import ParetoFront
    from synth.results.notebook import NotebookFrame
    from synth.results.verification import Verification


class Report(Protocol):
    """A report that is written."""

    def complete(self) -> Path:
        """Folder of the report; an InputError where an extra is not installed."""
        ...


class Door(Protocol):
    """Verbs about a front, as the facade has them; options are those of the methods of a front."""

    def calculation(self, front: ParetoFront, /) -> Calculation:
        """How every number of the designs is computed."""
        ...

    def verify(self, front: ParetoFront, problem: object, catalogs: object, time_limit: float, /) -> Verification:
        """Check without help of the search."""
        ...

    def improve(self, front: ParetoFront, /, **options: object) -> ParetoFront:
        """Search on from the designs."""
        ...

    def report(self, front: ParetoFront, folder: str | Path, /, **options: object) -> Report:
        """Write report and sheets."""
        ...

    def explore(self, front: ParetoFront, height: int, /, **options: object) -> NotebookFrame:
        """Frame of the explorer for a notebook."""
        ...


def door() -> Door:
    """The facade, which imports what is asked on first use."""
    import synth

    return cast("Door", synth)
