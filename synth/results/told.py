"""Records that read like dictionaries: what a program reads by name and type, scripts and files read by key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, dataclass, field, fields
from enum import Enum
from typing import Any, Literal, NoReturn, Self

from synth.results.plain import plain


class Untold(Enum):
    """The value of a field that is not told; it counts as false, as what is not there does."""

    UNTOLD = "untold"

    def __bool__(self) -> Literal[False]:
        """False: nothing is told."""
        return False


UNTOLD = Untold.UNTOLD


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Told(dict[str, Any]):
    """A record whose fields are keys as well, in the order of their declaration; it cannot be changed.

    A field that is not told is no key. The key of a field is its name, or where that could not be one what its metadata
    says under ``key``. ``more`` are keys that no field is for, as other versions may have written them.
    """

    more: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Fill in the keys."""
        own = {_key(f): getattr(self, f.name) for f in fields(self) if f.name != "more"}
        super().update({key: value for key, value in own.items() if value is not UNTOLD} | dict(self.more))

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Self:
        """Return the record that a file tells."""
        names = {_key(f): f.name for f in fields(cls) if f.name != "more"}
        own = {names[key]: value for key, value in content.items() if key in names}
        return cls(**own, more={key: value for key, value in content.items() if key not in names})

    @classmethod
    def read(cls, content: Any) -> Any:
        """Return the record that a file tells; what is none stays what it is, for verification to name."""
        return cls.from_json(content) if isinstance(content, Mapping) else content

    def to_json(self) -> dict[str, Any]:
        """Return the keys and values as front.json has them, plain in depth: for YAML too, which knows no records."""
        return dict(plain(self))

    def __reduce__(self) -> tuple[Any, ...]:
        """Tell how it is made again: by pickle and copy."""
        return type(self).from_json, (dict(self),)

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{type(self).__name__} cannot be changed; its to_json() can")

    __setitem__ = __delitem__ = __ior__ = _refuse
    update = setdefault = pop = popitem = clear = _refuse


def _key(own: Field[Any]) -> str:
    return str(own.metadata.get("key", own.name))
