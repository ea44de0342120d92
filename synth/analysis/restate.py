"""The question that a front answers, posed again: from the front itself, or from what a saved one repeats."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.catalogs import catalogs_for
from synth.question.instance import Instance
from synth.question.request import Request
from synth.robust.counterpart import robust_counterpart
from synth.tables.catalogs import Catalogs

if TYPE_CHECKING:
    from synth.results import ParetoFront


def problem_of(front: ParetoFront, problem: Any = None, catalogs: Any = None) -> tuple[DesignProblem, Catalogs]:
    """Return the problem of a front and its tables.

    Parameters
    ----------
    front : ParetoFront
    problem : family name, DesignProblem subclass or instance, optional
        For a front of a problem of one's own that was loaded from a file.
    catalogs : folder or mapping, optional
        Own tables that were in memory; those that were files are read again.

    Raises
    ------
    InputError
        When the problem or its tables cannot be had.
    """
    own = load(front.frame.family, **front.frame.options) if problem is None else load(problem)
    restated = front.frame.restated
    own = robust_counterpart(own, restated.get("robust"), restated.get("limits"))
    return own, catalogs_for(own, restated.get("catalogs") if catalogs is None else catalogs)


def asked_again(front: ParetoFront, problem: DesignProblem, catalogs: Catalogs) -> Instance:
    """Return the question of a front with a problem and its tables.

    Raises
    ------
    InputError, KeyError, TypeError, ValueError
        When the record of the front does not pose a question.
    """
    settings = front.settings
    return Instance(
        Request(
            problem=problem,
            requirements=front.frame.requirements,
            catalogs=catalogs,
            parts=settings["parts"],
            limits=settings["limits"],
            fix=settings["fix"],
            grid=bool(settings["grid"]),
        )
    )


def question_of(front: ParetoFront, problem: Any = None, catalogs: Any = None) -> Instance:
    """Return the question that a front answers.

    Raises
    ------
    InputError
        When it cannot be posed again.
    """
    if front.question is not None and problem is None and catalogs is None:
        known: Instance = front.question
        return known
    own, tables = problem_of(front, problem, catalogs)
    try:
        return asked_again(front, own, tables)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("front", front.frame.family, "a front whose record is complete") from error
