"""Notices: what a reader of input says beside what it returns, for whoever shows it to people."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_heard: ContextVar[Callable[[str], None] | None] = ContextVar("heard", default=None)


@contextmanager
def listening(heard: Callable[[str], None]) -> Iterator[None]:
    """Pass every message of the readers of input in the block to a function, each once."""
    passed_on: set[str] = set()

    def once(sentence: str) -> None:
        if sentence not in passed_on:
            passed_on.add(sentence)
            heard(sentence)

    before = _heard.set(once)
    try:
        yield
    finally:
        _heard.reset(before)


def notice(sentence: str) -> None:
    """Say a sentence to whoever listens."""
    heard = _heard.get()
    if heard is not None:
        heard(sentence)


def ignore_notices() -> None:
    """Listen no more, for the rest of what is heard meanwhile."""
    _heard.set(None)
