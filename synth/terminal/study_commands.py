"""The commands that vary a question: whatif."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from synth.analysis.design_spec import must_be_a_question, must_be_one_family
from synth.folders.csv_style import csv_style
from synth.folders.output_folder import STUDY
from synth.terminal.options import Csv, Folder, Quiet, SpecFile, WhatIfOptions, takes
from synth.terminal.session import blamed_on, claim_output, end, stopped_as, tell_not_kept, tell_readings, tell_written

if TYPE_CHECKING:
    from synth.question.spec import Spec
    from synth.studies.whatif.study import Study


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command(name="whatif")(whatif)


@takes(WhatIfOptions)
def whatif(
    options: WhatIfOptions, *, spec: SpecFile, folder: Folder = None, csv: Csv = "en", quiet: Quiet = False
) -> None:
    """Answer a spec for many values of a requirement, limit, weight, part or option; run again to go on."""
    from synth.question.spec import read_spec

    style = csv_style(csv, "--csv")
    asked = read_spec(spec).merged(**options.of_spec())
    must_be_a_question(asked)
    must_be_one_family(asked)
    claim_output(folder, STUDY)
    tell_not_kept(folder, quiet)
    study = _study(asked, options, folder, quiet)
    target = None if folder is None else study.save(folder, style)
    if not quiet:
        from synth.studies.study_store import STEPS
        from synth.terminal.console import output
        from synth.terminal.study_console import print_study

        print_study(study, output(), folder is not None)
        files = [] if target is None else sorted(study.files())
        if target is not None and (target / STEPS).is_dir():  # not before the first step is finished
            files.append(f"{STEPS}/")
        tell_written(target, folder, files)
    end(study.interrupted, study.feasible)


def _study(asked: Spec, options: WhatIfOptions, folder: Path | None, quiet: bool) -> Study:
    from synth.studies.whatif.run import POINTS, study_of
    from synth.terminal.console import progress_display

    with blamed_on(asked.file):
        request, settings = asked.request(), asked.settings(points=POINTS)
        if not quiet:
            tell_readings(request.catalogs)
        stopped = stopped_as("stopped before the first step was begun; nothing is written")
        with progress_display(quiet) as progress, stopped:
            return study_of(request, settings, options.vary, progress, options.breaks, folder)
