"""The kinds of jobs: what may be asked of an engine, each as pure functions from a request to records.

Importing this package loads nothing heavy; the module of a kind is imported where its work is done. Such a module has

``read(request, sources) -> CheckedRequest``
    Checks a request as far as that goes without the search.
``work(request, sources, tell) -> dict of Record``
    Does what a request that was read asks for; the record of the question itself is added to what it returns.
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
from synth.question.request_fields import FIELDS
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.verbs.requests import VERBS, Subject, Verb

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
    verb : Verb
        What it asks.
    module : str
        Imported in an engine process only.
    bulk : bool
        Whether it waits behind what somebody waits for; of some kinds ``CheckedRequest.bulk`` decides for each request.
    record : str
        Name of the main record.
    """

    verb: Verb
    module: str
    bulk: bool = False
    record: str

    @property
    def name(self) -> str:
        """Its name, that of the verb."""
        return self.verb.name

    @property
    def title(self) -> str:
        """One line for people."""
        return self.verb.title

    @property
    def timed(self) -> bool:
        """Whether its requests take a ``time_limit``."""
        return "time_limit" in self.verb.fields()

    @property
    def checked(self) -> bool:
        """Whether the check of a spec tells all that is wrong with its requests."""
        return self.verb.about is Subject.QUESTION

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of its requests beside those of a spec; ``beside`` of its module tells what is wrong under them."""
        return tuple(name for name in self.verb.request.fields() if name not in FIELDS) if self.checked else ()

    def load(self) -> KindModule:
        """Return its module."""
        return cast("KindModule", import_module(self.module))


def _kinds(*found: tuple[str, str, str, bool]) -> Mapping[str, Kind]:
    kinds = [
        Kind(verb=VERBS[name], module=f"synth.kinds.{module}", record=record, bulk=bulk)
        for name, module, record, bulk in found
    ]
    return MappingProxyType({kind.name: kind for kind in kinds})


KINDS: Mapping[str, Kind] = _kinds(
    ("synthesis", "synthesis", "front.json", False),
    ("compare", "comparison", "comparison.json", False),
    ("whatif", "whatif", "study.json", False),
    ("explain", "explain", "explanation.json", False),
    ("prices", "prices", "prices.json", False),
    ("near_equals", "near_equals", "near_equals.json", False),
    ("rate", "rate", "rating.json", False),
    ("verify", "verify", "verification.json", False),
    ("report", "report", "report.json", False),
    ("batch", "batch", "batch.json", True),
    ("size_range", "size_range", "size_range.json", True),
)


def kind(name: object) -> Kind:
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
