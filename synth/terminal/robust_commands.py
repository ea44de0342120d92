"""The command that asks how designs stand what scatters: rate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from synth.errors import InputError
from synth.folders.csv_style import csv_style
from synth.folders.output_folder import RATING
from synth.terminal.options import Csv, Folder, Quiet, takes
from synth.terminal.session import blamed_on, claim_output, end, hand_over, tell_readings
from synth.verbs.requests import RateRequest

if TYPE_CHECKING:
    from synth.results import Design, ParetoFront

FILES = (".yaml", ".yml", ".json")


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command(name="rate")(rate)


@takes(RateRequest)
def rate(
    asked: RateRequest,
    *,
    source: Annotated[Path, typer.Argument(help="A folder that run has written, or a DESIGN.yaml.", metavar="SOURCE")],
    folder: Folder = None,
    csv: Csv = "en",
    quiet: Quiet = False,
) -> None:
    """Tell the worst limit and the yield of designs whose friction, duty or sizes scatter."""
    style = csv_style(csv, "--csv")
    claim_output(folder, RATING, source=source)
    from synth.robust.rate import rate as rate_designs
    from synth.terminal.console import output, progress_display
    from synth.terminal.robust_console import print_ratings

    designs, problem, catalogs, known = _designs(source, quiet)
    block = asked.block(known)
    if not block:
        right = "what scatters, for example --over 'friction=catalogue range' (the question has no robust block)"
        raise InputError("--over", None, right)
    with progress_display(quiet) as progress:
        limits: dict[str, Any] = {"progress": progress, "time_limit": asked.time_limit}
        found = rate_designs(designs, block, problem=problem, catalogs=catalogs, **limits)
    hand_over(found, folder, style, None if quiet else lambda: print_ratings(found, output()))
    end(found.interrupted, any(d.robust["holds"] for d in found.designs))


def _designs(source: Path, quiet: bool) -> tuple[ParetoFront | Design, Any, Any, dict[str, Any]]:
    """Return the designs of a folder or of a DESIGN.yaml, their problem and tables, and what scatters by their own."""
    if source.suffix.lower() not in FILES or source.is_dir():
        from synth.results.loading import load_front

        front = load_front(source)
        return front, None, None, dict(front.frame.restated.get("robust") or {})
    from synth.analysis.design_spec import design_of_spec, must_be_a_design
    from synth.question.spec import read_spec

    asked = read_spec(source)
    must_be_a_design(asked)
    with blamed_on(asked.file):
        problem, catalogs, design = design_of_spec(asked)
    if not quiet:
        tell_readings(catalogs)
    return design, problem, catalogs, dict(asked.robust)
