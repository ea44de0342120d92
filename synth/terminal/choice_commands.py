"""The commands that help to choose: near-equals, prices, and run where several families are asked."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from synth.errors import derived
from synth.folders.csv_style import CsvStyle, csv_style
from synth.folders.output_folder import EXPLANATION_TEXT, FRONT, NEAR_EQUALS, PRICES, place_for_stopped, save_result
from synth.results.drawings import PLOT
from synth.terminal.options import Csv, Folder, FrontFolder, Quiet, takes
from synth.terminal.session import (
    HELPS,
    blamed_on,
    claim_output,
    end,
    hand_over,
    say,
    stopped_as,
    tell,
    tell_not_kept,
    tell_readings,
    tell_written,
)
from synth.verbs.requests import NearEqualsRequest, PricesRequest

if TYPE_CHECKING:
    from synth.question.spec import Spec
    from synth.studies.families.comparison import Comparison


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command(name="near-equals")(near_equals)
    app.command(name="prices")(prices)


@takes(NearEqualsRequest)
def near_equals(
    asked: NearEqualsRequest, *, source: FrontFolder, folder: Folder = None, csv: Csv = "en", quiet: Quiet = False
) -> None:
    """Find designs of other parts, counts or choices that are nearly as good as a chosen one."""
    style = csv_style(csv, "--csv")
    claim_output(folder, NEAR_EQUALS, source=source)
    from synth.results.loading import load_front
    from synth.studies.near_optimal import near_equals as find
    from synth.terminal.choice_console import print_near_equals
    from synth.terminal.console import output, progress_display

    front = load_front(source)
    with progress_display(quiet) as progress:
        found = find(front, progress=progress, **vars(asked))
    hand_over(found, folder, style, None if quiet else lambda: print_near_equals(found, output()))
    end(found.interrupted, bool(found.designs))


@takes(PricesRequest)
def prices(
    asked: PricesRequest,
    *,
    source: FrontFolder,
    folder: Folder = None,
    every: Annotated[bool, typer.Option("--all", help="Show all designs, not the first alone.")] = False,
    csv: Csv = "en",
    quiet: Quiet = False,
) -> None:
    """Tell what a per cent of each requirement and limit costs, confirmed by solving again; run again to go on."""
    style = csv_style(csv, "--csv")
    claim_output(folder, PRICES)
    tell_not_kept(folder, quiet)
    from synth.results.loading import load_front
    from synth.studies.prices.run import prices as find
    from synth.terminal.choice_console import print_prices
    from synth.terminal.console import output, progress_display

    front = load_front(source)
    stopped = stopped_as("stopped before the first design was begun; nothing is written")
    with progress_display(quiet) as progress, stopped:
        found = find(front, progress=progress, folder=folder, **vars(asked))
    show = None if quiet else lambda: print_prices(found, front, output(), every, folder is not None)
    hand_over(found, folder, style, show)
    end(found.interrupted)


def show_common() -> None:
    """Show the requirements that may stand in a sheet for several families, with those that understand them."""
    from synth.studies.families.requirement_sheet import understood

    names = understood()
    wide, units = max(map(len, names), default=0), max((len(unit) for unit, _ in names.values()), default=0)
    for name, (unit, families) in names.items():
        print(f"{name:{wide}}  {unit:{units}}  {', '.join(families)}")


def compare_families(asked: Spec, folder: Path | None, every: bool, quiet: bool, plot: bool, csv: CsvStyle) -> None:
    """Search the families of a spec, show their common front and save it where a folder is named; end as ``run``."""
    from synth.question.request_fields import ASKED, SEARCHED
    from synth.studies.families.compare import compare
    from synth.tables.catalogs import Catalogs
    from synth.terminal.choice_console import comparison_explanation, how_long, print_comparison
    from synth.terminal.console import output, progress_display

    def keep(comparison: Comparison, at: Path) -> None:
        save_result(at, csv.files({**comparison.files(at), **comparison.family_files(at)}), FRONT, False)

    # What is found stands there until all families are searched.
    place = None if folder is None else place_for_stopped(folder, FRONT)
    with blamed_on(asked.file), progress_display(quiet) as progress:
        tables = Catalogs(asked.catalogs, base=asked.folder)
        if not quiet:
            tell_readings(tables)
        apart = ("family", "options", "requirements", "catalogs")
        stated = asked.stated([key for key in (*ASKED, *SEARCHED) if key not in apart])
        found = compare(
            asked.family if isinstance(asked.family, str) else list(asked.family),
            asked.requirements,
            catalogs=tables,
            options=asked.options,
            progress=progress,
            so_far=None if place is None else lambda comparison: keep(comparison, place),
            serving=None if quiet else lambda labels: tell(how_long(labels, asked.time_limit)),
            **stated,
        )
    where = place if found.interrupted else folder
    texts = {**found.files(where), **found.family_files(where)}
    if not found.designs and not found.interrupted:
        told = derived(EXPLANATION_TEXT, lambda: comparison_explanation(found))
        texts |= {} if told is None else {EXPLANATION_TEXT: told}
    picture = derived(PLOT, found.svg) if plot else None
    if picture:
        texts[PLOT] = picture
    target = None
    if where is not None and place is not None:
        target = save_result(where, csv.files(texts), FRONT, False)
        if place not in (target, folder):
            shutil.rmtree(place, ignore_errors=True)  # all of it stands in the result now
    if not quiet:
        print_comparison(found, output(), every, plot)
        if not found.designs:
            say(f"{HELPS}: clutchsynth explain, with one of these families in the spec")
        folders = [f"{x.family}/" for x in found.outcomes if x.front is not None]
        files = [name for name in sorted(texts) if "/" not in name and not name.startswith("design_")]
        files += [f"design_{d.rank:02d}.yaml" for d in found.designs[:1]]
        if len(found.designs) > 1:
            files[-1] += f" .. design_{len(found.designs):02d}.yaml"
        tell_written(target, folder, [*files, *folders])
    end(found.interrupted, bool(found.designs))
