"""Checks of one thing as one test that names each of them that fails."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

import pytest

Check = Callable[..., None]


class Properties:
    """What something must keep; as a decorator it takes up a function that checks one property.

    >>> of_a_number = Properties()
    >>> @of_a_number
    ... def it_is_small(number):
    ...     assert number < 10, "too large"
    >>> @of_a_number
    ... def it_has_an_inverse(number):
    ...     1 / number
    >>> of_a_number.broken(5)
    []
    >>> [text.partition(" (")[0] for found in (20, 0) for text in of_a_number.broken(found)]
    ['it_is_small: AssertionError: too large', 'it_has_an_inverse: ZeroDivisionError: division by zero']
    """

    def __init__(self) -> None:
        self.checks: list[Check] = []

    def __call__(self, check: Check) -> Check:
        self.checks.append(check)
        return check

    def check(self, *found: Any) -> None:
        """Fail with all that does not hold."""
        if broken := self.broken(*found):
            pytest.fail("\n".join(broken), pytrace=False)

    def broken(self, *found: Any) -> list[str]:
        """Return what does not hold, each with the name of its check, its line and its message."""
        told = []
        for check in self.checks:
            try:
                check(*found)
            except (Exception, pytest.fail.Exception) as error:
                line = traceback.extract_tb(error.__traceback__)[-1]
                told.append(f"{check.__name__}: {type(error).__name__}: {error} ({line.filename}:{line.lineno})")
        return told
