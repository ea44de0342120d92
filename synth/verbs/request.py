"""Requests as records: what every verb shares in reading, storing and describing them."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Collection, Mapping
from typing import Any, Self

from synth.errors import Described, InputError, gathered, refuse_gathered
from synth.question.request_fields import RequestField, Schema, ValueKind, shown_kind

WHERE = "request"
FIELD = "field"  # of the metadata
WORKERS = "workers"
ONE_THREAD = "1, or nothing: a job is searched by one thread, and any number finds the same"


def field(value: ValueKind, help: str, **more: Any) -> Any:
    """Field of a record of a request, with its default; arguments as for :class:`RequestField`, which gets its name."""
    return shared(RequestField("", value, help, **more))


def shared(record: RequestField, **other: Any) -> Any:
    """The same for a field that several requests have, perhaps with another default or help."""
    mine = dataclasses.replace(record, **other)
    return dataclasses.field(default=mine.usual, metadata={FIELD: mine})


@dataclasses.dataclass(frozen=True, kw_only=True)
class VerbRequest:
    """Request of a verb; None is not stated."""

    @classmethod
    def fields(cls) -> dict[str, RequestField]:
        """Fields by name."""
        return {one.name: dataclasses.replace(one.metadata[FIELD], name=one.name) for one in dataclasses.fields(cls)}

    @classmethod
    def read(
        cls, stated: Mapping[str, object], named: Callable[[str], str] = "{}".format, *, typed: bool = False
    ) -> Self:
        """Request with some values as they are stated.

        Parameters
        ----------
        stated : mapping
            By name of the field; None counts as not stated.
        named : callable
            Name of a field -> how messages call it.
        typed : bool
            Whether they are as the command line has them.

        Raises
        ------
        InputError
            Values are not of their kind, or one is missing: with all of that.
        """
        faults: list[InputError] = []
        read: dict[str, Any] = {}
        for name, record in cls.fields().items():
            with gathered(faults):
                if stated.get(name) is not None:
                    read[name] = record.read(named(name), stated[name], typed)
                elif record.needed:
                    raise InputError(named(name), None, record.needed, (name,))
        refuse_gathered(faults)
        return cls(**read)

    def to_json(self) -> dict[str, Any]:
        """Request as it is stored; what is not stated is left out."""
        values = {name: getattr(self, name) for name in self.fields()}
        return {name: _json(value) for name, value in values.items() if value is not None}


def _json(value: object) -> Any:
    if isinstance(value, Mapping):
        return {name: _json(entry) for name, entry in value.items()}
    return [_json(entry) for entry in value] if isinstance(value, (list, tuple)) else value


def in_request(name: str) -> str:
    """Name of a field in messages about a request."""
    return f"{WHERE}: {name}"


def as_flag(name: str) -> str:
    """Name of a field in messages about a command line."""
    return f"--{name.replace('_', '-')}"


def known_keys(request: object, keys: Collection[str]) -> dict[str, Any]:
    """Entries of a request, whatever their kind; None counts as not stated.

    Raises
    ------
    InputError
        It is no mapping, has a key that is none of these, or holds what no file can.
    """
    if not isinstance(request, Mapping):
        raise InputError(WHERE, shown_kind(request), "a JSON object")
    try:
        json.dumps(request, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, TypeError, RecursionError):  # halves of characters, numbers that are none
        raise InputError(WHERE, Described("what JSON cannot hold"), "texts in Unicode and finite numbers") from None
    faults: list[InputError] = []
    for key in request:
        with gathered(faults):
            if key == WORKERS:
                one_thread(request[key])
            elif key not in keys:
                raise InputError(f"{WHERE}: key", key, f"one of {', '.join(keys)}", (str(key),))
    refuse_gathered(faults)
    return {str(key): value for key, value in request.items() if value is not None and key in keys}


def one_thread(value: object) -> None:
    """Refuse more threads than one: whoever runs the workers says how much is worked at.

    Raises
    ------
    InputError
        Something else is stated.
    """
    if value is not None and (isinstance(value, bool) or value != 1):
        raise InputError(in_request(WORKERS), shown_kind(value), ONE_THREAD, (WORKERS,))


def schema_of(text: str, fields: Mapping[str, RequestField], *, either: Collection[str] = ()) -> Schema:
    """JSON Schema of a request.

    Parameters
    ----------
    text : str
        What it asks.
    fields : mapping
    either : collection of str
        Names of which it needs one.
    """
    needed = [name for name, record in fields.items() if record.needed]
    return {
        "type": "object",
        "description": text,
        "properties": {name: record.schema() for name, record in fields.items()},
        "additionalProperties": False,
        **({"required": needed} if needed else {}),
        **({"anyOf": [{"required": [name]} for name in either]} if either else {}),
    }
