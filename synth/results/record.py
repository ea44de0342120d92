"""Records of files: fields by name and type for programs, the same by key for scripts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal, Self

import msgspec
from msgspec import UNSET
from msgspec import UnsetType as Unset
from msgspec.structs import force_setattr

from synth.results.plain import plain

Number = float | Literal["inf", "-inf"] | None  # JSON has no infinity; null is not-a-number

__all__ = ["UNSET", "FileRecord", "Number", "Unset", "force_setattr"]


class FileRecord(msgspec.Struct, frozen=True, kw_only=True, eq=False):
    """Immutable record that reads like the mapping of its file; fields that are not set are no keys.

    msgspec checks types when a file is read, and makes the JSON schema.
    """

    @classmethod
    def from_json(cls, content: Any) -> Self:
        """FileRecord from its entry of a file; keys of other versions are left out.

        Raises
        ------
        ValueError
            Something has the wrong type; the message says where.
        """
        return msgspec.convert(content, cls)

    def to_json(self) -> dict[str, Any]:
        """Keys and values as front.json has them, plain in depth: for YAML too, which knows no records."""
        return dict(plain(self))

    def __getitem__(self, key: str) -> Any:
        """Value of a key."""
        names = dict(zip(self.__struct_encode_fields__, self.__struct_fields__, strict=True))
        value = getattr(self, names[key])
        if value is UNSET:
            raise KeyError(key)
        return value

    def __iter__(self) -> Iterator[str]:
        """Keys in the order of the fields."""
        for key, name in zip(self.__struct_encode_fields__, self.__struct_fields__, strict=True):
            if getattr(self, name) is not UNSET:
                yield key

    def __len__(self) -> int:
        """Number of keys; an empty record is false."""
        return sum(1 for _ in self)

    def __contains__(self, key: object) -> bool:
        """True if a key is set."""
        return key in list(self)

    def __eq__(self, other: object) -> bool:
        """True if a record or mapping has the same keys and values."""
        return dict(self.items()) == dict(other.items()) if isinstance(other, Mapping) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # it may hold mappings

    def get(self, key: str, default: Any = None) -> Any:
        """Value of a key, or the default where it is not set."""
        return self[key] if key in self else default

    def keys(self) -> list[str]:
        """Keys that are set."""
        return list(self)

    def items(self) -> list[tuple[str, Any]]:
        """Keys that are set, with their values."""
        return [(key, self[key]) for key in self]


Mapping.register(FileRecord)
