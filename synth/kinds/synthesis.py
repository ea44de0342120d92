"""The kind ``synthesis``: the keys of a spec, or ``of`` an earlier job with the entries that change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.kinds.asked import front_summary, of_files, question_of, read_json, spec_of, stated_spec, titled
from synth.question.request import Request
from synth.question.settings import SearchSettings
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results.calculation import CALCULATION
from synth.results.front_record import FRONT_FILE
from synth.results.offered import OFFERED
from synth.robust.rating import Rater
from synth.search.question import pose
from synth.search.synthesize import find_front


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    spec, _ = spec_of(request, sources)
    asked, settings = question_of(spec, sources)
    checked(asked, settings)
    stated = stated_spec(asked, settings)
    return CheckedRequest(request=stated, title=titled(asked), families=(asked.problem.name,))


def checked(asked: Request, settings: SearchSettings) -> None:
    """Refuse what a search would refuse before it begins.

    Raises
    ------
    InputError
    """
    pose(asked, settings)
    if asked.robust is not None:
        Rater(asked, asked.robust)


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Search the designs; every other file of a front is rendered from these records."""
    asked, settings = question_of(request, sources)
    front = find_front(asked, settings, tell)
    return of_files(front.files(), (FRONT_FILE, CALCULATION, OFFERED))


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a front."""
    return front_summary(read_json(records, FRONT_FILE))
