"""Arguments and options that several commands share; ``Grid`` and ``Seed`` take their type in brackets."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeVar

import typer

from synth.text.notices import ignore_notices

T = TypeVar("T")


def _families(begun: str) -> list[str]:
    from synth.model.registry import families

    return [name for name in families() if name.startswith(begun)]


def _without_notices(quiet: bool) -> bool:
    if quiet:
        ignore_notices()
    return quiet


Family = Annotated[
    str, typer.Argument(help="Name of a family.", metavar="FAMILY", autocompletion=_families, show_default=False)
]
SpecFile = Annotated[Path, typer.Argument(help="A spec, YAML or JSON.", metavar="SPEC.yaml")]
FrontFolder = Annotated[Path, typer.Argument(help="A folder that run has written.", metavar="DIR")]

# Without -o a result is shown and nothing is written; of a table that is worked off the result is files, see session.
Folder = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Folder for the results; without one nothing is written.", metavar="DIR"),
]
RowsFolder = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", help="Folder for the results; by default ROWS_batch beside the table.", metavar="DIR"
    ),
]
RowFamily = Annotated[str | None, typer.Option(help="Family of the rows that name none.", metavar="FAMILY")]
Headings = Annotated[
    Path | None, typer.Option(help="YAML: headings of the table and the names they stand for.", metavar="FILE")
]
RowPoints = Annotated[int | None, typer.Option(help="At most this many designs per row.")]
Encoding = Annotated[
    str | None, typer.Option(help="Of CSV files where it is not recognised, such as cp1250.", metavar="NAME")
]
VisibleRows = Annotated[bool, typer.Option("--visible-rows", help="Leave out hidden and filtered rows of workbooks.")]
Gap = Annotated[float | None, typer.Option(help="How far from proven a design may be, as a fraction.")]
Grid = Annotated[T, typer.Option("--grid/--no-grid", help="Makeable sizes only.")]
Seed = Annotated[T, typer.Option(help="Seed of the random starts.")]
TimeLimit = Annotated[str | None, typer.Option(help="Stop after this time, in seconds or such as '2 min'.")]
Objectives = Annotated[
    list[str] | None,
    typer.Option("--objective", help="An objective, name or name=min or name=max; repeat it.", metavar="NAME[=SENSE]"),
]
Plot = Annotated[bool, typer.Option("--plot", help="Draw the front here, and with -o into front.svg as well.")]
Csv = Annotated[
    str,
    typer.Option("--csv", help="How CSV is written: en, or de (semicolons, decimal commas).", metavar="en|de"),
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Show nothing; files and exit code tell.", callback=_without_notices)
]
