"""The families that are installed."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from synth.declaration import Declaration
from synth.errors import DeclarationError, InputError, named_fault
from synth.model.problem import DesignProblem
from synth.plugins import FAMILIES, family_names, installed
from synth.tables.catalogs import Catalogs
from synth.text.notices import notice


def families() -> list[str]:
    """Return the names of all registered families, sorted."""
    return family_names()


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
        When the name is not registered, its package cannot be imported, or options are given for a finished instance.
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
    for point in installed(FAMILIES):
        if point.name == problem:
            try:
                family = point.load()
            except Exception as error:
                owner = f" of {point.dist.name}" if point.dist is not None else ""
                right = f"a family that can be imported ({point.module}{owner} fails with {named_fault(error)})"
                raise InputError("family", problem, right, ("family",)) from error
            plain = all(isinstance(value, str) for value in options.values())
            return _shared(family, tuple(sorted(options.items()))) if plain else load(family, **options)
    close = difflib.get_close_matches(problem, families(), n=2)
    hint = f"a family (did you mean {' or '.join(close)}?)" if close else "one of " + ", ".join(families())
    raise InputError("family", problem, hint, ("family",))


def every_family() -> dict[str, DesignProblem]:
    """Registered families by name, ready to use; a notice names those that cannot be imported."""
    problems = {}
    for name in families():
        try:
            problems[name] = load(name)
        except InputError as error:
            notice(f"left out: {error}")
    return problems


def every_declaration(catalogs: Catalogs) -> Iterator[tuple[DesignProblem, Declaration]]:
    """Registered families with what they declare; a notice names those that cannot be imported or declared."""
    for problem in every_family().values():
        with skipping_faulty_families():
            yield problem, problem.declaration(frozenset(), catalogs)


@contextmanager
def skipping_faulty_families() -> Iterator[None]:
    """Go on after a family that cannot be declared; a notice names it."""
    try:
        yield
    except DeclarationError as error:
        notice(f"left out: {error}")


@lru_cache(maxsize=64)
def _shared(family: type[DesignProblem], options: tuple[tuple[str, str], ...]) -> DesignProblem:
    return family(**dict(options))
