"""A saved front improved: the search of the same question goes on from its designs."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

from synth.analysis.restate import problem_of
from synth.errors import InputError
from synth.order.margins import MARGINS
from synth.question.arguments import Family, UserTables
from synth.text.numbers import typed_number

if TYPE_CHECKING:
    from synth.question.request import Request
    from synth.question.settings import Progress, SearchSettings
    from synth.results import ParetoFront
    from synth.search.question import Question


def improve(
    front: ParetoFront,
    problem: Family | None = None,
    catalogs: UserTables = None,
    *,
    time_limit: float | None = None,
    workers: int = 1,
    progress: Progress | None = None,
) -> ParetoFront:
    """Go on with the search of a front from its designs.

    Parameters
    ----------
    front : ParetoFront
        Computed or loaded.
    problem : family name, DesignProblem subclass or instance, optional
        For a loaded front of a problem of one's own.
    catalogs : folder or mapping, optional
        Own tables that were in memory; those that were files are read again.
    time_limit : float, optional
        Seconds.
    workers, progress
        As for ``synthesize``.

    Returns
    -------
    ParetoFront
        Never worse: no design of the one given is better than all listed, and no larger gap is told. It is the same
        front where that is proven as it was asked for.

    Raises
    ------
    InputError
        When the question cannot be posed again.
    """
    from synth.question.request import Request  # costly to import
    from synth.question.settings import SearchSettings, check_progress

    begun = time.monotonic()
    check_progress(progress)
    if problem is None and catalogs is None and front.question is not None:
        problem, catalogs = front.question.problem, front.question.catalogs
    loaded, tables = problem_of(front, problem, catalogs)
    kept, frame = front.settings, front.frame
    settings = SearchSettings(
        points=kept["points"], gap=kept["gap"], workers=workers, seed=kept["seed"], time_limit=time_limit
    )
    request = Request(
        problem=loaded,
        requirements=frame.requirements,
        catalogs=tables,
        objectives=dict(frame.objectives),
        parts=kept["parts"],
        limits=kept["limits"],
        fix=kept["fix"],
        weights=kept["weights"],
        grid=kept["grid"],
    )
    return improve_for(front, request, settings.since(begun), "front", progress)


def improve_for(
    front: ParetoFront, request: Request, settings: SearchSettings, name: str, progress: Progress | None = None
) -> ParetoFront:
    """Answer a request as ``synthesize`` does, from the front of an earlier search of the same one.

    Parameters
    ----------
    front : ParetoFront
    request : Request
    settings : SearchSettings
    name : str
        Of the place where the front was named, for messages.
    progress
        As for ``synthesize``.

    Raises
    ------
    InputError
        For everything that is wrong with the input; where the front is one of another question.
    """
    from synth.search.question import pose

    if request.robust is not None:
        raise InputError("robust", "a robust block", "none: no search goes on with one")
    begun = time.monotonic()
    question = pose(request, settings)
    return go_on(front, question.within(settings.since(begun).time_limit), name, progress)


def go_on(front: ParetoFront, question: Question, name: str, progress: Progress | None = None) -> ParetoFront:
    """Answer a question from the front of an earlier search of the same one.

    Parameters
    ----------
    front : ParetoFront
    question : Question
    name : str
        Of the place where the front was named, for messages.
    progress
        As for ``synthesize``.

    Raises
    ------
    InputError
        When the front is one of another question.
    """
    must_be_the_same(front, question, name)
    certificate, settings = front.certificate, question.settings
    enough = front.complete or len(front.designs) == settings.points
    if certificate.kind == "global" and (not front.designs or ((certificate.gap or 1.0) <= settings.gap and enough)):
        return front
    return question.answer(progress, start=front)


def must_be_the_same(front: ParetoFront, question: Question, name: str) -> None:
    """Refuse a front that answers another question; the message names the difference."""
    differing = difference(front, question)
    if differing:
        place = str(front.folder) if front.folder is not None else front.frame.family
        raise InputError(name, place, f"a front of the same question; it differs in {differing}")


def difference(front: ParetoFront, question: Question) -> str:
    """First difference between the question of a front and another one, in words; empty where they are the same."""
    instance, frame = question.instance, front.frame
    if "robust" in frame.restated or "robust" in instance.problem.restated:
        return "the robust block, with which no search goes on"
    if instance.problem.name != frame.family:
        return f"the family: {frame.family} there, {instance.problem.name} here"
    for name, option in instance.model.declaration.options.items():
        there = frame.options.get(name, option.default)
        if there != option.chosen:  # words as they are declared: yes and no may be stated for on and off
            return f"option {name}: {there} there, {option.chosen} here"
    for key, value in frame.requirement_values.items():
        here = instance.values.requirements.get(key, math.nan)
        if not (here == value or math.isclose(here, value, rel_tol=MARGINS.conversion)):
            return f"requirement {key}: {typed_number(value, 12)} there, {typed_number(here, 12)} here (SI)"
    if set(instance.values.requirements) != set(frame.requirement_values):
        more = sorted(set(instance.values.requirements) ^ set(frame.requirement_values))
        return f"requirement {more[0]}, which only one of them has"
    if dict(question.chosen) != dict(frame.objectives):
        return f"the objectives: {', '.join(frame.objectives)} there, {', '.join(question.chosen)} here"
    settings = question.record()
    for key in ("parts", "limits", "fix", "grid"):
        if settings[key] != front.settings[key]:
            return f"{key}: {front.settings[key]} there, {settings[key]} here"
    for design in front.designs:
        try:
            instance.combinations.number(design)
        except InputError as error:
            return f"what it offers ({error})"
        for slot in instance.selection.slots:
            part = design.parts[slot.slot]
            row = slot.table.designations.index(str(part))
            if slot.table.hashes[row] != part["hash"]:
                return f"the tables: {slot.slot} {part} has other values"
    return ""
