"""How a question is searched: one record, checked where it is made."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, TypedDict

from synth.errors import InputError
from synth.question.request_fields import FIELDS, SEARCHED
from synth.question.spec_keys import read_keys

LEAST_SECONDS = 1e-3  # for a search when all that goes before it has taken the time there is


class ProgressState(TypedDict, total=False):
    """How far a search is; ``done`` from 0 to 1."""

    stage: str
    done: float
    combinations: int
    incumbents: int
    message: str
    columns: Sequence[str]  # of the known designs, now and then
    points: Sequence[object]


Progress = Callable[[ProgressState], None]


@dataclass(frozen=True, kw_only=True)
class SearchSettings:
    """How a question is searched.

    Parameters
    ----------
    points : int
        At most this many designs.
    gap : float
        Relative improvement in every objective that need not be excluded.
    workers : int
        Threads or processes.
    seed : int
        Of all random choices.
    time_limit : float, optional
        Seconds after which what is found so far is returned.

    Raises
    ------
    InputError
        One of them is none of these.
    """

    points: int = 30
    gap: float = 1e-3
    workers: int = 1
    seed: int = 0
    time_limit: float | None = None

    def __post_init__(self) -> None:
        """Read what is stated; None is the default."""
        for name in SEARCHED:
            field, value = FIELDS[name], getattr(self, name)
            if value is not None or field.usual is not None:
                object.__setattr__(self, name, field.read(name, field.usual if value is None else value))

    def since(self, begun: float) -> SearchSettings:
        """Return the same with what is left of the time limit, which began at a time as of ``time.monotonic``."""
        if self.time_limit is None:
            return self
        return replace(self, time_limit=max(self.time_limit - (time.monotonic() - begun), LEAST_SECONDS))

    def within(self, seconds: float | None) -> SearchSettings:
        """Return the same with another time limit; None: without any."""
        return replace(self, time_limit=seconds)

    @classmethod
    def from_json(cls, content: Mapping[str, object], where: str = "settings") -> SearchSettings:
        """Return the settings that a spec states; where it states none they are the usual ones.

        Parameters
        ----------
        content : mapping
            Keys of a spec; those that say what is asked may stand there as well.
        where : str
            The name of it, for messages.

        Raises
        ------
        InputError
            When a key is unknown, or a value is not of its kind.
        """
        read = read_keys(content, where, SEARCHED)
        return cls(**{name: value for name, value in read.items() if value is not None})

    def to_json(self) -> dict[str, Any]:
        """Return the settings as a spec states them."""
        return {name: value for name, value in asdict(self).items() if value is not None}


def check_progress(progress: object) -> None:
    """Refuse what cannot be told how far a search is.

    Raises
    ------
    InputError
        It is no function.
    """
    if progress is not None and not callable(progress):
        raise InputError("progress", progress, "a function of one mapping, or none")
