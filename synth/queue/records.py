"""Records of a job: its request as checked, what the request refers to, and its results."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from synth.errors import shortened
from synth.tables.table_text import TableText
from synth.text.plain_text import one_line

ReportProgress = Callable[[Mapping[str, Any]], None]  # called with the progress, in mappings that JSON can hold

MEDIA = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "yaml": "application/yaml",
    "svg": "image/svg+xml",
    "dxf": "image/vnd.dxf",
    "html": "text/html; charset=utf-8",
    "pdf": "application/pdf",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "zip": "application/zip",
    "txt": "text/plain; charset=utf-8",
}
TABLE = "table"  # a batch keeps its rows as a record of this name, with the ending of its kind
QUESTION = "question.json"  # the record that says what was asked, in every job
TITLE = 160  # characters of the title of a job


@dataclass(frozen=True, kw_only=True)
class Record:
    """A named result of a job, or a file that was rendered from such."""

    name: str
    media: str
    content: bytes

    @property
    def digest(self) -> str:
        """The SHA-256 of the content."""
        return hashlib.sha256(self.content).hexdigest()

    @staticmethod
    def of(name: str, content: str | bytes) -> Record:
        """Return a record whose media type follows from the ending of its name."""
        raw = content.encode() if isinstance(content, str) else bytes(content)
        return Record(name=name, media=MEDIA[name.rsplit(".", 1)[-1]], content=raw)


@dataclass(frozen=True, kw_only=True)
class Sources:
    """What a request refers to by name, found by whoever calls.

    Parameters
    ----------
    tables : mapping
        Reference, such as ``my_linings@3`` -> its text.
    records : mapping
        Id of an earlier job -> its records by name. What those refer to in turn stands here as well.
    files : mapping
        Id of a file that was brought for this request -> that file.
    database : str
        Where the rows of earlier batches stand, for kinds that read them.
    """

    tables: Mapping[str, TableText] = field(default_factory=dict)
    records: Mapping[str, Mapping[str, bytes]] = field(default_factory=dict)
    files: Mapping[str, Record] = field(default_factory=dict)
    database: str = ""


@dataclass(frozen=True, kw_only=True)
class CheckedRequest:
    """A request that was checked.

    Parameters
    ----------
    request : mapping
        In the form that is stored: what is left out is written out, and the same meaning gives the same text.
    title : str
        A few words for people.
    families : tuple of str
        The names of those that are asked.
    bulk : bool
        Whether it waits behind what somebody waits for.
    fingerprint : str
        What tells it from other requests of its kind, where the request does not: a batch is known by its rows.
    kept : tuple of Record
        What has to be kept with the job, because it was brought for it.
    steps, rows : int
        Values of a study, and rows of a table, where it has some: whoever takes requests may bound them.
    """

    request: Mapping[str, Any]
    title: str
    families: tuple[str, ...]
    bulk: bool = False
    fingerprint: str = ""
    kept: tuple[Record, ...] = ()
    steps: int = 0
    rows: int = 0

    def __post_init__(self) -> None:
        """Cut a title that repeats long words of the request, and write out what acts on a screen."""
        object.__setattr__(self, "title", shortened(one_line(self.title), TITLE))

    @property
    def text(self) -> str:
        """Return the request as it is stored; entries keep their order, which says in which columns stand."""
        return json.dumps(self.request, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


@dataclass(frozen=True, kw_only=True)
class Mentioned:
    """What a request refers to by name: tables by their reference, earlier jobs, and files."""

    tables: tuple[str, ...]
    jobs: tuple[str, ...]
    files: tuple[str, ...] = ()


def mentioned(request: object) -> Mentioned:
    """Jobs and tables that a request refers to; whatever is wrong with them is for ``read`` to say.

    A job that is mentioned may refer to tables itself: by its own request, which is asked the same way.

    Examples
    --------
    >>> mentioned({"catalogs": {"friction_materials": ["+", "my_linings@3"]}, "of": "01J"})
    Mentioned(tables=('my_linings@3',), jobs=('01J',), files=())
    """
    if not isinstance(request, Mapping):
        return Mentioned(tables=(), jobs=())
    catalogs, job, file = request.get("catalogs"), request.get("of"), request.get("upload")
    tables = dict[str, None]()
    for value in catalogs.values() if isinstance(catalogs, Mapping) else ():
        entries = value if isinstance(value, (list, tuple)) else [value]
        tables |= dict.fromkeys(entry for entry in entries if isinstance(entry, str) and "@" in entry)
    return Mentioned(tables=tuple(tables), jobs=_named(job), files=_named(file))


def _named(value: object) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else ()


NOTHING = Sources()
