"""Faults that a user can cause, each told in one sentence."""

from __future__ import annotations

import math
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from numbers import Integral
from types import TracebackType
from typing import Any, TypeVar

from synth.text.input_limits import INPUT_LIMITS
from synth.text.plain_text import printable

Key = str | int
EXPECTED = 8  # times as much room for what is right: that lists names of ours
EXACT = 2**53  # whole numbers of JSON that every reader knows exactly are smaller
PLACES = 20  # where an error was raised that are told


class InputError(ValueError):
    """Something in the input is wrong and the user can put it right.

    Parameters
    ----------
    field : str
        Which field, row or file is meant, as people read it.
    value : object
        What stands there now; ``None`` when something is missing.
    expected : str
        What would be right, in words that can be typed.
    path : tuple of str and int
        The same place for programs: keys of a spec by public name, positions in lists from 0, lines of tables, for
        example ``("requirements", "load_torque")``, ``("limits", "mass", 0)``, ``("rows", 7, "load_torque [N*m]")``.
        Empty where it is no place in the input. Readers of a part say what they know; whoever called them puts his
        own keys in front (:meth:`under`, :class:`at`).
    """

    def __init__(self, field: str, value: object, expected: str, path: tuple[Key, ...] = ()) -> None:
        self.field = field
        self.value = value
        self.expected = expected
        self.path = path
        shown = str(value).lower() if isinstance(value, bool) else _as_text(value, repr)  # as files have it
        got = "is missing" if value is None else f"got {shortened(shown)}"
        # A field names a place in a file: each of the two may be as long as a value.
        place = shortened(": ".join(map(shortened, field.split(": "))), 2 * INPUT_LIMITS.message)
        right = shortened(expected, EXPECTED * INPUT_LIMITS.message)
        super().__init__(printable(f"{place}: {got}; expected {right}"))

    def told(self) -> dict[str, Any]:
        """Return it as JSON holds it, for programs and for people.

        Examples
        --------
        >>> told = InputError("points", float("inf"), "a whole number", ("points",)).told()
        >>> told["path"], told["value"], told["expected"]
        (['points'], 'inf', 'a whole number')
        """
        value = self.value
        plain = value is None or isinstance(value, (bool, int)) or (isinstance(value, float) and math.isfinite(value))
        if not plain or (isinstance(value, int) and abs(value) >= EXACT):
            value = shortened(_as_text(value, str))
        return {"path": list(self.path), "value": value, "expected": self.expected, "message": str(self)}

    def every(self) -> tuple[InputError, ...]:
        """Return everything that is wrong, one by one: this alone."""
        return (self,)

    def under(self, *keys: Key) -> InputError:
        """Put keys in front of the path, as a reader that was given a part of the input; return the same error."""
        self.path = (*keys, *self.path)
        return self

    def __reduce__(self) -> tuple[type[InputError], tuple[str, object, str, tuple[Key, ...]]]:
        """Pickle by the four fields, so that worker processes can hand it on."""
        return type(self), (self.field, self.value, self.expected, self.path)


class SeveralErrors(InputError):
    """Several things are wrong at once; it is told as the first of them, and has the others beside it.

    Parameters
    ----------
    faults : sequence of InputError
        At least one.
    """

    def __init__(self, faults: Sequence[InputError]) -> None:
        first = faults[0]
        super().__init__(first.field, first.value, first.expected, first.path)
        self.args, self.faults = first.args, tuple(faults)
        for fault in faults[1:]:
            self.add_note(str(fault))  # so that a traceback shows all

    def every(self) -> tuple[InputError, ...]:
        """Return everything that is wrong, one by one."""
        return self.faults

    def under(self, *keys: Key) -> InputError:
        """Put keys in front of all paths."""
        for fault in self.faults:
            fault.under(*keys)
        return super().under(*keys)

    def __reduce__(self) -> tuple[type[SeveralErrors], tuple[tuple[InputError, ...]]]:  # type: ignore[override]
        """Pickle by what is wrong."""
        return type(self), (self.faults,)


def first_with_others(faults: Sequence[InputError]) -> InputError:
    """Return a fault as it is, several as one error that has them all."""
    return faults[0] if len(faults) == 1 else SeveralErrors(faults)


@contextmanager
def gathered(faults: list[InputError]) -> Iterator[None]:
    """Add what is refused inside to a list, and go on."""
    try:
        yield
    except InputError as fault:
        faults += fault.every()


def refuse_gathered(faults: Sequence[InputError]) -> None:
    """Refuse all gathered faults at once.

    Raises
    ------
    InputError
        There is one at least.
    """
    if faults:
        raise first_with_others(faults)


ELSEWHERE = "another family: this one "


class UnknownOptionError(InputError):
    """An option that a problem does not have, as it is or with the other options; its name is the last key."""


class RefusedError(InputError):
    """What a family refuses by its declaration: every word is understood, but nothing can be asked so."""


class NotCoveredError(InputError):
    """What a family cannot serve; behind ELSEWHERE ``expected`` says why, as a predicate, and what does."""


class ExtraNeededError(InputError):
    """What was asked needs packages that come with an extra and are not installed.

    Parameters
    ----------
    option : str
        What was asked for: ``--pdf``.
    extra : str
        The extra that brings them.
    """

    def __init__(self, option: str, extra: str) -> None:
        install = f"pip install 'clutchsynth[{extra}]'"
        super().__init__(option, None, install, (option.lstrip("-"),))
        self.option, self.extra = option, extra
        self.args = (f"{option} needs the extra {extra}: {install}",)

    def __reduce__(self) -> tuple[type[ExtraNeededError], tuple[str, str]]:  # type: ignore[override]
        """Pickle by what was asked and what it needs."""
        return type(self), (self.option, self.extra)


class DeclarationError(TypeError):
    """A family declares something that cannot be: a fault of the family, never of its user.

    Parameters
    ----------
    fault : str
    line : object, optional
        Where it stands in the source of the family, as text.
    """

    def __init__(self, fault: str, line: object = None) -> None:
        super().__init__(fault if line is None else f"{fault} ({line})")
        self.line = line


class DerivedFileWarning(UserWarning):
    """A file that is made from a finished result could not be made; the result itself is kept."""


Made = TypeVar("Made")


def derived(name: str, make: Callable[[], Made]) -> Made | None:
    """Make a file from a finished result; where that fails warn of it and return None, so that the result is kept.

    Parameters
    ----------
    name : str
        Of the file.
    make : callable
    """
    try:
        return make()
    except Exception as error:
        reason = named_fault(error)
        warnings.warn(
            f"{name} could not be made ({reason}); the result it is made from is complete. "
            "This is a fault of the program: please report it",
            DerivedFileWarning,
            stacklevel=2,
        )
        return None


class Described:
    """Stands for a value in a message: ``got a list`` says more than the list itself."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


class at:
    """Say where in the input one is: what is refused inside stands under these keys.

    Examples
    --------
    >>> try:
    ...     with at("requirements"), at("load_torque"):
    ...         raise InputError("load_torque", "much", "a number")
    ... except InputError as error:
    ...     error.path
    ('requirements', 'load_torque')
    """

    def __init__(self, *keys: Key) -> None:
        self.keys = keys

    def __enter__(self) -> None:
        return None

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, InputError):
            error.under(*self.keys)


def where_raised(error: BaseException) -> list[str]:
    """Places where an error was raised, innermost first, without its message, which may repeat input."""
    frames = traceback.extract_tb(error.__traceback__)
    return [f"{frame.filename}:{frame.lineno} {frame.name}" for frame in reversed(frames)][:PLACES]


def shortened(text: str, most: int = INPUT_LIMITS.message) -> str:
    """Excerpt of a text for a message: beginning and end of the whole, and of every word, that is too long.

    Examples
    --------
    >>> len(shortened("x" * 1_000_000)), shortened("load_torque"), shortened("the mass " + "x" * 125, 960)[-40:]
    (120, 'load_torque', 'xxxxx ... xxxxxxxxxxxxxxxxxxxxxxxxxxxxxx')
    """
    return _cut(" ".join(_cut(word, INPUT_LIMITS.message) for word in text.split(" ")), most)


def named_fault(error: Exception) -> str:
    """Kind of an error and the first line of what it says."""
    return f"{type(error).__name__}: {shortened(next(iter(str(error).splitlines()), ''))}"


def _as_text(value: object, text: Callable[[object], str]) -> str:
    """Text of a value; words where Python refuses to write thousands of digits or brackets."""
    try:
        return text(value)
    except (ValueError, RecursionError):
        return "a value too long to be shown"


def _cut(text: str, most: int) -> str:
    tail = most // 4
    return text if len(text) <= most else f"{text[: most - tail - 5]} ... {text[-tail:]}"


def whole_number(value: object, field: str, most: int, least: int = 1, path: tuple[Key, ...] = ()) -> int:
    """Return a count that a user stated.

    Raises
    ------
    InputError
        It is no whole number, or not between the least and the most.
    """
    if not isinstance(value, Integral) or isinstance(value, bool) or not least <= int(value) <= most:
        raise InputError(field, value, f"a whole number, {least} or more and at most {most}", path)
    return int(value)
