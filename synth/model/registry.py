"""The families that are installed."""

from __future__ import annotations

import difflib
from functools import lru_cache

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.plugins import installed

ENTRY_POINT_GROUP = "clutchsynth.problems"


def families() -> list[str]:
    """Return the names of all registered families, sorted."""
    return sorted({point.name for point in installed(ENTRY_POINT_GROUP)})


def load(problem: str | type[DesignProblem] | DesignProblem, /, **options: str) -> DesignProblem:
    """Return a problem ready to use; one of a name is made once, so that its traces serve all questions of a process.

    Parameters
    ----------
    problem : str, subclass or instance of DesignProblem
        A registered name, or a problem of your own.
    **options : str
        Structural choices; only with a name or a class.

    Raises
    ------
    InputError
        When the name is not registered, or options are given for a finished instance.
    """
    if isinstance(problem, DesignProblem):
        if options:
            right = "no options here: the instance was made with its own"
            raise InputError("options", sorted(options), right, ("options",))
        return problem
    if isinstance(problem, type) and issubclass(problem, DesignProblem):
        return problem(**options)
    if not isinstance(problem, str):
        right = "the name of a family, or a subclass or instance of DesignProblem"
        raise InputError("family", problem, right, ("family",))
    for point in installed(ENTRY_POINT_GROUP):
        if point.name == problem:
            family = point.load()
            plain = all(isinstance(value, str) for value in options.values())
            return _shared(family, tuple(sorted(options.items()))) if plain else load(family, **options)
    close = difflib.get_close_matches(problem, families(), n=2)
    hint = f"a family (did you mean {' or '.join(close)}?)" if close else "one of " + ", ".join(families())
    raise InputError("family", problem, hint, ("family",))


@lru_cache(maxsize=64)
def _shared(family: type[DesignProblem], options: tuple[tuple[str, str], ...]) -> DesignProblem:
    return family(**dict(options))
