"""One unit of work: questions in, answers out. Nothing here knows of the database, of other units or of the time.

The answer to a question depends on the question alone (a teacher that it names is part of it), not on what it is
solved together with, where or when: that is why a batch gives the same bytes however it is spread and interrupted.
"""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from synth.errors import InputError

if TYPE_CHECKING:
    from synth.bounds.branching import BranchingStatistics
    from synth.model.problem import DesignProblem
    from synth.results import Design, ParetoFront
    from synth.search.question import Question
    from synth.tables.catalogs import Catalogs

LIKE = "like"  # where a question names the one whose experience helps
LONGEST_ERROR = 2000


class OtherCodeError(RuntimeError):
    """A worker has another version of the program than whoever asks it."""


def solve_unit(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Answer the questions of a unit.

    Parameters
    ----------
    work : mapping
        ``job``, ``questions`` by key, ``settings`` of the search, ``catalogs``, ``own`` (the class of a problem that is
        not registered, or None) and ``code``, the hash of the program that asks.

    Returns
    -------
    dict
        Per key what :func:`answer` returns, or ``{"error": text}`` where the search failed.

    Raises
    ------
    OtherCodeError
        When this process has other code than the one that asks.
    """
    from synth.results.provenance import code_digest  # this module must be light: workers import it first

    if work["code"] != code_digest():
        raise OtherCodeError("the worker has another version of clutchsynth, or of a package that decides its numbers")
    shared = Shared(work["job"], work["catalogs"], work["own"])
    found: dict[str, dict[str, Any]] = {}
    for key, question in work["questions"].items():
        try:
            found[key] = answer(question, work["settings"], shared)
        except (Exception, SystemExit) as error:
            last = traceback.extract_tb(error.__traceback__)[-1:]
            place = f" ({last[0].filename.rsplit('/', 1)[-1]}, line {last[0].lineno})" if last else ""
            found[key] = {"error": f"{type(error).__name__}: {error}{place}"[:LONGEST_ERROR]}
    return found


def answer(question: Mapping[str, Any], settings: Mapping[str, Any], shared: Shared) -> dict[str, Any]:
    """Search the designs for one question.

    Parameters
    ----------
    question : mapping
        ``family``, ``options``, ``requirements``, ``limits``, ``fix``, ``parts``, and ``like`` where the experience
        with a similar question helps: that question.
    settings : mapping
        ``objectives``, ``points``, ``gap``, ``grid``, ``seed``, ``time_limit``.
    shared : Shared
        What all questions of a job have in common.

    Returns
    -------
    dict
        ``status``, ``seconds``, ``layout`` (the columns of the designs; None without any) and ``content``.
    """
    begin = time.monotonic()
    known: Sequence[Design] = ()
    branching: BranchingStatistics | None = None
    if LIKE in question:
        known, branching = _experience(shared, json.dumps(question[LIKE], sort_keys=True), json.dumps(settings))
    try:
        posed = _posed(question, settings, shared)
        front = posed.answer(known=known, branching=branching)
    except InputError as refusal:
        # The rows were checked; what only the search can see is still said in its words.
        seconds = time.monotonic() - begin
        return {"status": "refused", "seconds": seconds, "layout": None, "content": {"explanation": str(refusal)}}
    if front.interrupted == "interrupted":
        raise KeyboardInterrupt  # whoever pressed Ctrl-C wants the batch to stop, not half an answer
    return record(front, time.monotonic() - begin)


def _posed(question: Mapping[str, Any], settings: Mapping[str, Any], shared: Shared) -> Question:
    """Check a question as a whole."""
    from synth.question.request import Request
    from synth.question.settings import SearchSettings
    from synth.search.question import pose

    problem = _problem(shared, question["family"], tuple(sorted(question["options"].items())))
    content = {**{key: value for key, value in question.items() if key != LIKE}, **settings}
    request = Request.from_json(content, problem=problem, catalogs=_catalogs(shared))
    return pose(request, SearchSettings.from_json(content))


@lru_cache(maxsize=8)
def _experience(shared: Shared, question: str, settings: str) -> tuple[Sequence[Design], BranchingStatistics | None]:
    """Return what the search for a similar question has found and learned; nothing where it fails."""
    try:
        front, branching = _posed(json.loads(question), json.loads(settings), shared).experience()
    except Exception:  # its own row tells why
        return (), None
    if front.interrupted == "interrupted":
        raise KeyboardInterrupt
    return front.designs, branching


def record(front: ParetoFront, seconds: float) -> dict[str, Any]:
    """Return what is kept of a front."""
    certificate = front.certificate
    content: dict[str, Any] = {
        "certificate": certificate.kind,
        "gap": certificate.gap,
        "combinations": certificate.combinations,
        "complete": front.complete,
        "interrupted": front.interrupted,
        "nlp_solves": front.statistics.get("nlp_solves"),
        "nlp_solves_to_find": front.statistics.get("nlp_solves_to_find"),
        "explanation": "" if front.explanation is None else " ".join(str(front.explanation.get("message", "")).split()),
    }
    if not front.designs:
        return {"status": str(front.status.value), "seconds": seconds, "layout": None, "content": content}
    layout, rows = _table(front)
    content["rows"] = rows
    content["designs"] = [_unknowns(design) for design in front.designs]
    return {"status": str(front.status.value), "seconds": seconds, "layout": layout, "content": content}


def _table(front: ParetoFront) -> tuple[dict[str, Any], list[list[Any]]]:
    """Return the columns of designs.csv by group, and the cells of each design as text.

    A limit that a row adds has a name of its own (``mass <= 20 kg``); per quantity they share a column.
    """
    from synth.results import shown_value
    from synth.units import header

    frame = front.frame
    first = front.designs[0]
    extra = {name: name.split(" ", 1)[0] for name in frame.limit_units if " " in name}
    searched = [n for n, kind in frame.kinds.items() if kind in ("variable", "count") and n not in frame.objectives]
    derived = [n for n, kind in frame.kinds.items() if kind == "derived" and n not in frame.objectives]
    own = [n for n in frame.limit_units if n not in extra]
    added = list(dict.fromkeys(extra.values()))
    layout = {
        "family": frame.family,
        "objectives": [header(n, frame.units[n]) for n in frame.objectives],
        "senses": dict(frame.objectives),
        "searched": [header(n, frame.units[n]) for n in searched],
        "choices": list(first.choices),
        "parts": list(first.parts),
        "derived": [header(n, frame.units[n]) for n in derived],
        "limits": [f"utilisation: {n}" for n in own] + [f"utilisation: limits on {n}" for n in added],
    }
    rows = []
    for d in front.designs:
        cells: list[Any] = [d.rank, d.score, d.status.value, d.gap, d.note, "; ".join(d.alternatives)]
        cells += [shown_value(d.values[n], frame.units[n]) for n in [*frame.objectives, *searched]]
        cells += [*d.choices.values(), *(str(part) for part in d.parts.values())]
        cells += [shown_value(d.values[n], frame.units[n]) for n in derived]
        cells += [d.utilisation.get(n) for n in own]
        for quantity in added:
            used = [u for n, of in extra.items() if of == quantity and (u := d.utilisation.get(n)) is not None]
            cells.append(max(used, default=None))
        rows.append(["" if x is None else repr(x) if isinstance(x, float) else str(x) for x in cells])
    return layout, rows


def _unknowns(design: Design) -> dict[str, Any]:
    """Return what makes a design again: its unknowns in SI, and its objectives."""
    kinds = design.frame.kinds
    return {
        "values": {n: v for n, v in design.values.items() if kinds[n] in ("variable", "count")},
        "choices": dict(design.choices),
        "parts": {slot: str(part) for slot, part in design.parts.items()},
        "objectives": dict(design.objectives),
    }


# ---- what a worker keeps --------------------------------------------------------------------------------------------


class Shared:
    """What all questions of a job share: tables, and a problem that is not registered.

    Caches know it by the job, whose name is made of the formulas and the tables: what arrives a second time, as a copy,
    is the same.
    """

    def __init__(self, job: str, catalogs: Any, own: Any) -> None:
        self.job, self.catalogs, self.own = job, catalogs, own

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Shared) and self.job == other.job

    def __hash__(self) -> int:
        return hash(self.job)


@lru_cache(maxsize=2)
def _catalogs(shared: Shared) -> Catalogs:
    """Return the tables; made once per process, so that problems are traced once."""
    from synth.question.catalogs import as_catalogs

    return as_catalogs(shared.catalogs)


@lru_cache(maxsize=64)
def _problem(shared: Shared, family: str, options: tuple[tuple[str, str], ...]) -> DesignProblem:
    """Return a problem that is ready to use; it keeps its traces, so it is made once per process."""
    from synth.model.registry import load

    own = shared.own
    return load(own if own is not None and own.name == family else family, **dict(options))
