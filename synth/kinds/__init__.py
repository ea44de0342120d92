"""The kinds of jobs: what may be asked of an engine, each as pure functions from a request to records.

Importing this package loads nothing heavy; the module of a kind is imported where its work is done. Such a module has

``read(request, sources) -> CheckedRequest``
    Checks a request as far as that goes without the search.
``work(request, sources, tell) -> dict of Record``
    Does what a request that was read asks for.
``summary(records) -> dict``
    A few facts of its records, for lists.
``beside(request, sources) -> dict, list of InputError``
    Where its requests have more keys than a spec: the spec in one that was refused, and what is wrong beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Any, Protocol, cast

from synth.errors import InputError
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources

__all__ = ["KINDS", "CheckedRequest", "Kind", "KindModule", "Record", "ReportProgress", "Sources", "kind"]


class KindModule(Protocol):
    """What the module of a kind has; ``beside`` those with ``keys`` alone."""

    read: Callable[[Mapping[str, Any], Sources], CheckedRequest]
    work: Callable[[Mapping[str, Any], Sources, ReportProgress], dict[str, Record]]
    summary: Callable[[Mapping[str, bytes]], dict[str, Any]]
    beside: Callable[[Mapping[str, Any], Sources], tuple[dict[str, Any], list[InputError]]]


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of job.

    Parameters
    ----------
    name : str
    module : str
        Imported in an engine process only.
    title : str
        One line for people.
    bulk : bool
        Whether it waits behind what somebody waits for; of some kinds ``CheckedRequest.bulk`` decides for each request.
    record : str
        Name of the main record.
    timed : bool
        Whether its requests take a ``time_limit``.
    checked : bool
        Whether the check of a spec tells all that is wrong with its requests.
    keys : tuple of str
        Of its requests beside those of a spec; ``beside`` of its module tells what is wrong under them.
    """

    name: str
    module: str
    title: str
    bulk: bool = False
    record: str
    timed: bool = True
    checked: bool = False
    keys: tuple[str, ...] = ()

    def load(self) -> KindModule:
        """Return its module."""
        return cast("KindModule", import_module(self.module))


def _kinds(*found: Kind) -> Mapping[str, Kind]:
    return MappingProxyType({one.name: one for one in found})


KINDS: Mapping[str, Kind] = _kinds(
    Kind(
        name="synthesis",
        module="synth.kinds.synthesis",
        title="Ranked Pareto designs for a requirement",
        record="front.json",
        checked=True,
    ),
    Kind(
        name="compare",
        module="synth.kinds.comparison",
        title="Several families asked the same",
        record="comparison.json",
        checked=True,
    ),
    Kind(
        name="whatif",
        module="synth.kinds.whatif",
        title="A question at many values of a requirement, limit, weight, part or option",
        record="study.json",
        checked=True,
        keys=("vary", "breaks"),
    ),
    Kind(
        name="explain",
        module="synth.kinds.explain",
        title="Why nothing is feasible, and what would make it so",
        record="explanation.json",
        checked=True,
        keys=("physics",),
    ),
    Kind(
        name="prices",
        module="synth.kinds.prices",
        title="What a per cent of each requirement and limit costs",
        record="prices.json",
    ),
    Kind(
        name="near_equals",
        module="synth.kinds.near_equals",
        title="Other parts, counts or choices that are nearly as good",
        record="near_equals.json",
    ),
    Kind(
        name="rate",
        module="synth.kinds.rate",
        title="How designs stand what scatters",
        record="rating.json",
    ),
    Kind(
        name="verify",
        module="synth.kinds.verify",
        title="A front checked again without the search",
        record="verification.json",
    ),
    Kind(
        name="report",
        module="synth.kinds.report",
        title="The report of a front, with calculation sheets",
        record="report.json",
        timed=False,
    ),
    Kind(
        name="batch",
        module="synth.kinds.batch",
        title="A table of requirements, answered row by row",
        bulk=True,
        record="batch.json",
    ),
    Kind(
        name="size_range",
        module="synth.kinds.size_range",
        title="A few variants that serve a whole table of applications",
        bulk=True,
        record="size_range.json",
    ),
)


def kind(name: Any) -> Kind:
    """Return a kind by its name.

    Raises
    ------
    InputError
        There is none of that name.
    """
    found = KINDS.get(name) if isinstance(name, str) else None
    if found is None:
        raise InputError("kind", name, f"one of {', '.join(KINDS)}", ("kind",))
    return found
