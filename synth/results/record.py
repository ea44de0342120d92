"""Records of files: fields by name and type for programs, the same by key for scripts."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, KeysView, Mapping
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
    def from_json(cls, content: object) -> Self:
        """Record from its entry of a file; keys of other versions are left out.

        Raises
        ------
        ValueError
            Something has the wrong type; the message says where.
        """
        return msgspec.convert(content, cls)

    def to_json(self) -> dict[str, Any]:
        """Keys and values as front.json has them, plain in depth: for YAML too, which knows no records."""
        return dict(plain(self))

    @property
    def _entries(self) -> dict[str, Any]:
        """Keys that are set, with their values, in the order of the fields."""
        names = zip(self.__struct_encode_fields__, self.__struct_fields__, strict=True)
        return {key: value for key, name in names if (value := getattr(self, name)) is not UNSET}

    def __getitem__(self, key: str) -> Any:
        """Value of a key."""
        return self._entries[key]

    def __iter__(self) -> Iterator[str]:
        """Keys that are set."""
        return iter(self._entries)

    def __len__(self) -> int:
        """Number of keys; an empty record is false."""
        return len(self._entries)

    def __contains__(self, key: object) -> bool:
        """True if a key is set."""
        return key in self._entries

    def __eq__(self, other: object) -> bool:
        """True if a record or mapping has the same keys and values."""
        return self._entries == dict(other.items()) if isinstance(other, Mapping) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # it may hold mappings

    def get(self, key: str, default: object = None) -> Any:
        """Value of a key, or the default where it is not set."""
        return self._entries.get(key, default)

    def keys(self) -> KeysView[str]:
        """Keys that are set."""
        return self._entries.keys()

    def items(self) -> ItemsView[str, Any]:
        """Keys that are set, with their values."""
        return self._entries.items()


Mapping.register(FileRecord)
