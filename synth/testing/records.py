"""Cases of a family, and the questions that they ask."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import synth
from synth.model.problem import DesignProblem
from synth.question.catalogs import as_catalogs
from synth.question.instance import Instance
from synth.question.request import Request

Sampler = Callable[[np.random.Generator, Instance, int], np.ndarray]


@dataclass(frozen=True)
class Case:
    """One question, with restrictions that keep it small.

    Parameters
    ----------
    requirements, options : mapping
        As in ``synth.synthesize`` and ``synth.load``.
    settings : mapping
        Further arguments of ``synth.synthesize``.
    tighten : mapping
        Requirements moved the hard way.
    """

    requirements: Mapping[str, Any]
    options: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    tighten: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class KnownDesign:
    """Sizes, counts and parts of one design."""

    sizes: Mapping[str, str]
    counts: Mapping[str, float]
    parts: Mapping[str, str]


@dataclass(frozen=True)
class FamilyCases:
    """Cases of one family.

    Parameters
    ----------
    option_sets : mapping
        Name -> options of a structure to trace.
    requirements, optional : mapping
        Required ones, and values of all optional ones of the first option set.
    feasible : mapping
        Name -> case whose front is proven in seconds.
    infeasible : Case
        Has no design.
    culprits : frozenset of str
        Limits of which the explanation of the infeasible case names one.
    sound : callable
        (generator, question, count) -> variables (count, variables) in SI of sensible proportions.
    names : Path
        Table of public names.
    symbols : mapping
        Symbol that no other family has -> its letters, indices (``fe,max``) and style, as they are typeset.
    needed, unknown : mapping
        ``option=value`` -> requirements that it needs, or does not have.
    constants : mapping
        ``module:name`` of a number with a unit inside a formula -> exponents of kg, m, s, K and A.
    for_si : frozenset of str
        Quantities whose formula holds in SI only.
    designs : mapping
        Option set -> feasible design, where random parts hardly ever fit each other.
    """

    option_sets: Mapping[str, Mapping[str, str]]
    requirements: Mapping[str, Any]
    optional: Mapping[str, Any]
    feasible: Mapping[str, Case]
    infeasible: Case
    culprits: frozenset[str]
    sound: Sampler
    names: Path
    symbols: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    needed: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    unknown: Mapping[str, frozenset[str]] = field(default_factory=dict)
    constants: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    for_si: frozenset[str] = frozenset()
    designs: Mapping[str, KnownDesign] = field(default_factory=dict)


@cache
def cases_of(family: str) -> FamilyCases:
    """Cases of a registered family, from the module ``cases`` beside its model."""
    package = type(synth.load(family)).__module__.rpartition(".")[0]
    found: FamilyCases = import_module(f"{package}.cases" if package else "cases").CASES[family]
    return found


def question(family: str, options: Mapping[str, str], optional: bool, **settings: Any) -> Instance:
    """Question to the whole catalogue, with or without the optional requirements; traced once per process."""
    if settings:
        return question_to(synth.load(family, **options), options, optional, **settings)
    return _traced_once(family, tuple(options.items()), optional)


@cache
def _traced_once(family: str, options: tuple[tuple[str, str], ...], optional: bool) -> Instance:
    return question_to(synth.load(family, **dict(options)), dict(options), optional)


def question_to(problem: DesignProblem, options: Mapping[str, str], optional: bool, **settings: Any) -> Instance:
    """Question to a problem; its requirements are those of the cases of its family."""
    cases = cases_of(problem.name)
    requirements = {**cases.requirements, **(cases.optional if optional else {})}
    for option, value in options.items():
        requirements |= cases.needed.get(f"{option}={value}", {})
        absent = cases.unknown.get(f"{option}={value}", frozenset())
        requirements = {name: given for name, given in requirements.items() if name not in absent}
    return Instance(Request(problem=problem, requirements=requirements, catalogs=as_catalogs(None), **settings))


def answer(family: str, case: Case, **more: Any) -> synth.ParetoFront:
    """Front of a case; the time limit shows a search that does not end."""
    requirements = {**case.requirements, **more.pop("requirements", {})}
    settings = {"points": 4, "time_limit": 60, **case.settings, **more}
    return synth.synthesize(synth.load(family, **case.options), requirements, **settings)


@cache
def front_of(family: str, name: str) -> synth.ParetoFront:
    """Front of a feasible case, computed once per process; tests only read it."""
    return answer(family, cases_of(family).feasible[name])
