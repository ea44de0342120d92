"""One unit of work: questions in, answers out. Nothing here knows of the database, of other units or of the time.

The answer to a question depends on the question alone (a teacher or a group that it names is part of it), not on what
else is solved, where or when: that is why a batch gives the same bytes however it is spread and interrupted.
"""

from __future__ import annotations

import json
import math
import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from synth.batches.entries import RowQuestion
from synth.errors import InputError
from synth.system.deadline import INTERRUPTED, NEEDLESS, Stopped, until

if TYPE_CHECKING:
    from synth.bounds.branching import BranchingStatistics
    from synth.model.problem import DesignProblem
    from synth.question.arguments import UserTables
    from synth.question.settings import Progress
    from synth.results import Design, ParetoFront
    from synth.search.question import Question
    from synth.tables.catalogs import Catalogs

LIKE = "like"  # where a question names the one whose experience helps
GROUP = "group"  # where it names those that it is answered together with
UNGROUPED = "ungrouped"  # in place of an answer: why it needs a search by itself; empty where nothing was proven
LONGEST_ERROR = 2000


class OtherCodeError(RuntimeError):
    """A worker computes other digits than whoever asks it: its program or its processor is another."""


def solve_unit(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Answer the questions of a unit.

    Parameters
    ----------
    work : mapping
        ``job``, ``questions`` by key, ``settings`` of the search, ``catalogs``, ``own`` (the class of a problem that is
        not registered, or None) and ``code``, the hash of what computes where it is asked; ``tell``, for
        progress.

    Returns
    -------
    dict
        Per key what :func:`answer` returns, or ``{"error": text}`` where the search failed, or ``{UNGROUPED: text}``
        where a group has left this question to be searched by itself.

    Raises
    ------
    OtherCodeError
        When this process computes with other code, or on another kind of processor, than the one that asks.
    """
    from synth.results.provenance import computing_digest  # this module must be light: workers import it first

    if work["code"] != computing_digest():
        raise OtherCodeError(
            "the worker has other code, another kind of processor, or no kernels where others have them"
        )
    shared = Shared(work["job"], work["catalogs"], work["own"])
    if is_group(work["questions"]):
        return answered_together(work["questions"], work["settings"], shared, work.get("tell"))
    answers: dict[str, dict[str, Any]] = {}
    for key, question in work["questions"].items():
        try:
            answers[key] = answer(question, work["settings"], shared)
        except (Exception, SystemExit) as error:
            answers[key] = {"error": error_text(error)}
    return answers


def is_group(questions: Mapping[str, RowQuestion]) -> bool:
    """True if questions are a group, and all of it; what is left of one is answered alone."""
    groups = [question.get(GROUP) for question in questions.values()]
    return bool(groups) and groups[0] is not None and groups.count(groups[0]) == len(groups) == groups[0]["rows"]


def error_text(error: BaseException) -> str:
    """Return an error in words, with the place where it came up."""
    last = traceback.extract_tb(error.__traceback__)[-1:]
    place = f" ({last[0].filename.rsplit('/', 1)[-1]}, line {last[0].lineno})" if last else ""
    return f"{type(error).__name__}: {error}{place}"[:LONGEST_ERROR]


def answered_together(
    questions: Mapping[str, RowQuestion], settings: Mapping[str, object], shared: Shared, progress: Progress | None
) -> dict[str, dict[str, Any]]:
    """Search the designs for the questions of a group at once.

    A question that is refused, differs from the others or is not proven is left to a search by itself: there it
    is refused, fails, or takes longer, with its own message.

    Parameters
    ----------
    questions : mapping
        By key, in the order of the group.
    settings, shared
        As for :func:`answer`. The time limit of each question counts for all of them together.
    progress : callable, optional
        Called with the progress of the search.

    Returns
    -------
    dict
        Per key what :func:`answer` returns, or ``{UNGROUPED: text}``.
    """
    from synth.search.joint.joint_groups import groups_of

    answers: dict[str, dict[str, Any]] = {key: {UNGROUPED: ""} for key in questions}
    checked: dict[str, Question] = {}
    for key, question in questions.items():
        try:
            checked[key] = _checked_question(question, settings, shared)
        except (Exception, SystemExit) as error:
            answers[key] = {UNGROUPED: "" if isinstance(error, InputError) else error_text(error)}
    keys = list(checked)
    for group in groups_of(list(checked.values())):
        group_questions = {keys[k]: checked[keys[k]] for k in group}
        try:
            answers |= _settled(group_questions, progress)
        except (Exception, SystemExit) as error:
            answers |= {key: {UNGROUPED: error_text(error)} for key in group_questions}
    if progress is not None:
        progress({"incumbents": 0})  # no group is under way any more
    return answers


def _settled(questions: Mapping[str, Question], progress: Progress | None) -> dict[str, dict[str, Any]]:
    """Search the designs for questions that are alike; what is not settled is left out, all of it if time is over."""
    from synth.search.joint.joint_search import JointSearch

    begin, each = time.monotonic(), list(questions.values())
    limit = each[0].settings.time_limit
    budget = None if limit is None else limit * len(each)
    try:
        with until(math.inf if budget is None else begin + budget):
            fronts = JointSearch(each, progress, budget).settled()
    except Stopped as stop:
        _give_up_unwanted(stop.reason)
        return {}
    settled = {key: front for key, front in zip(questions, fronts, strict=True) if front is not None}
    share = (time.monotonic() - begin) / max(len(settled), 1)
    return {key: record(front, share) for key, front in settled.items()}


def answer(question: RowQuestion, settings: Mapping[str, object], shared: Shared) -> dict[str, Any]:
    """Search the designs for one question.

    Parameters
    ----------
    question : mapping
        ``family``, ``options``, ``requirements``, ``limits``, ``fix``, ``parts``, and ``like`` where the experience
        with a similar question helps: that question. A ``group`` is of no use to a question that is asked alone.
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
        checked = _checked_question(question, settings, shared)
        front = checked.answer(known=known, branching=branching)
    except InputError as refusal:
        # The rows were checked; what only the search can see is still said in its words.
        seconds = time.monotonic() - begin
        return {"status": "refused", "seconds": seconds, "layout": None, "content": {"explanation": str(refusal)}}
    _give_up_unwanted(front.interrupted)
    return record(front, time.monotonic() - begin)


def _checked_question(question: RowQuestion, settings: Mapping[str, object], shared: Shared) -> Question:
    """Check a question as a whole."""
    from synth.question.request import Request
    from synth.question.settings import SearchSettings
    from synth.search.question import pose

    problem = _problem(shared, question["family"], tuple(sorted(question["options"].items())))
    content = {**{key: value for key, value in question.items() if key not in (LIKE, GROUP)}, **settings}
    request = Request.from_json(content, problem=problem, catalogs=_catalogs(shared))
    return pose(request, SearchSettings.from_json(content))


@lru_cache(maxsize=8)
def _experience(shared: Shared, question: str, settings: str) -> tuple[Sequence[Design], BranchingStatistics | None]:
    """Designs and branching knowledge of a similar question; nothing where that search fails."""
    try:
        front, branching = _checked_question(json.loads(question), json.loads(settings), shared).experience()
    except Exception:  # its own row tells why
        return (), None
    _give_up_unwanted(front.interrupted)
    return front.designs, branching


def _give_up_unwanted(reason: str) -> None:
    """Raise KeyboardInterrupt where Ctrl-C or a cancelled job has stopped a search: nobody wants half an answer."""
    if reason in (INTERRUPTED, NEEDLESS):
        raise KeyboardInterrupt


def record(front: ParetoFront, seconds: float) -> dict[str, Any]:
    """Stored record of a front; of the cost of a search for several questions, the share of one."""
    certificate, figures = front.certificate, front.statistics
    together = figures.get("searched_together") or 1
    content: dict[str, Any] = {
        "certificate": certificate.kind,
        "gap": certificate.gap,
        "combinations": certificate.combinations,
        "complete": front.complete,
        "interrupted": front.interrupted,
        **{name: _share(figures.get(name), together) for name in ("nlp_solves", "nlp_solves_to_find")},
        "explanation": "" if front.explanation is None else " ".join(str(front.explanation.get("message", "")).split()),
    }
    if not front.designs:
        return {"status": str(front.status.value), "seconds": seconds, "layout": None, "content": content}
    layout, rows = _table(front)
    content["rows"] = rows
    content["designs"] = [_unknowns(design) for design in front.designs]
    return {"status": str(front.status.value), "seconds": seconds, "layout": layout, "content": content}


def _share(count: int | None, together: int) -> int | None:
    return None if count is None else round(count / together)


def _table(front: ParetoFront) -> tuple[dict[str, Any], list[list[Any]]]:
    """Return the columns of designs.csv by group, and the cells of each design as text.

    A limit that a row adds has a name of its own (``mass <= 20 kg``); per quantity they share a column.
    """
    from synth.results import cell_value
    from synth.units import header

    frame = front.frame
    first = front.designs[0]
    extra = {name: name.split(" ", 1)[0] for name in frame.limit_units if " " in name}
    searched = [n for n, kind in frame.kinds.items() if kind in ("variable", "count") and n not in frame.objectives]
    derived = [n for n, kind in frame.kinds.items() if kind == "derived" and n not in frame.objectives]
    family_limits = [n for n in frame.limit_units if n not in extra]
    added = list(dict.fromkeys(extra.values()))
    layout = {
        "family": frame.family,
        "objectives": [header(n, frame.units[n]) for n in frame.objectives],
        "senses": dict(frame.objectives),
        "searched": [header(n, frame.units[n]) for n in searched],
        "choices": list(first.choices),
        "parts": list(first.parts),
        "derived": [header(n, frame.units[n]) for n in derived],
        "limits": [f"utilisation: {n}" for n in family_limits] + [f"utilisation: limits on {n}" for n in added],
    }
    rows = []
    for d in front.designs:
        cells: list[Any] = [d.rank, d.score, d.status.value, d.gap, d.note, "; ".join(d.alternatives)]
        cells += [cell_value(d.values[n], frame.units[n]) for n in [*frame.objectives, *searched]]
        cells += [*d.choices.values(), *(str(part) for part in d.parts.values())]
        cells += [cell_value(d.values[n], frame.units[n]) for n in derived]
        cells += [d.utilisation.get(n) for n in family_limits]
        for quantity in added:
            used = [u for n, of in extra.items() if of == quantity and (u := d.utilisation.get(n)) is not None]
            cells.append(max(used, default=None))
        rows.append(["" if x is None else repr(x) if isinstance(x, float) else str(x) for x in cells])
    return layout, rows


def _unknowns(design: Design) -> dict[str, Any]:
    """Data from which a design can be computed again: its unknowns in SI, and its objectives."""
    kinds = design.frame.kinds
    return {
        "values": {n: v for n, v in design.values.items() if kinds[n] in ("variable", "count")},
        "choices": dict(design.choices),
        "parts": {slot: str(part) for slot, part in design.parts.items()},
        "objectives": dict(design.objectives),
    }


# ---- what a worker keeps --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Shared:
    """What all questions of a job share: tables, and a problem that is not registered.

    Caches know it by the job, whose name is made of the formulas and the tables: what arrives a second time, as a copy,
    is the same.
    """

    job: str
    catalogs: UserTables = field(compare=False)
    user_family: type[DesignProblem] | None = field(compare=False)


@lru_cache(maxsize=2)
def _catalogs(shared: Shared) -> Catalogs:
    """Return the tables; made once per process, so that problems are traced once."""
    from synth.question.catalogs import as_catalogs

    return as_catalogs(shared.catalogs)


@lru_cache(maxsize=64)
def _problem(shared: Shared, family: str, options: tuple[tuple[str, str], ...]) -> DesignProblem:
    """Return a problem that is ready to use; it keeps its traces, so it is made once per process."""
    from synth.model.registry import load

    user_family = shared.user_family
    return load(user_family if user_family is not None and user_family.name == family else family, **dict(options))
