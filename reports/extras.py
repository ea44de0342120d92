"""Packages that come with an extra, for those who want what needs them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from synth.errors import ExtraNeededError
from synth.results.drawings import EXTRAS


class Formats:
    """Formats that are asked for; those that lack an extra are left out where they are wanted, and kept in mind.

    Parameters
    ----------
    words : list of str
    """

    def __init__(self, words: Sequence[str]) -> None:
        self.words = tuple(words)
        self._lacking: dict[str, ExtraNeededError] = {}

    def make(self, word: str) -> bool:
        """True if a format is asked for and can be made here."""
        if word not in self.words:
            return False
        if word in EXTRAS:
            try:
                needed(*EXTRAS[word])
            except ExtraNeededError as error:
                self._lacking.setdefault(error.extra, error)
                return False
        return True

    @property
    def lacking(self) -> tuple[ExtraNeededError, ...]:
        """What was wanted and cannot be made here, each extra once."""
        return tuple(self._lacking.values())


def needed(module: str, option: str, extra: str) -> Any:
    """Return a module, imported on first use.

    Parameters
    ----------
    module : str
        ``typst``.
    option : str
        What was asked for: ``--pdf``.
    extra : str
        The extra that brings the module.

    Raises
    ------
    ExtraNeededError
        The module is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise ExtraNeededError(option, extra) from None
