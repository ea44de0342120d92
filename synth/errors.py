"""Faults that a user can cause, each told in one sentence."""

from __future__ import annotations


class InputError(ValueError):
    """Something in the input is wrong and the user can put it right.

    Parameters
    ----------
    field : str
        Which field, row or file is meant, as the user wrote it.
    value : object
        What stands there now; ``None`` when something is missing.
    expected : str
        What would be right, in words that can be typed.
    """

    def __init__(self, field: str, value: object, expected: str) -> None:
        self.field = field
        self.value = value
        self.expected = expected
        shown = "is missing" if value is None else f"got {value!r}"
        super().__init__(f"{field}: {shown}; expected {expected}")

    def __reduce__(self) -> tuple[type[InputError], tuple[str, object, str]]:
        """Pickle by the three fields, so that worker processes can hand it on."""
        return type(self), (self.field, self.value, self.expected)
