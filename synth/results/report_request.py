"""Requests for reports: the engine makes them, reports take them."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeAlias

from synth.errors import InputError
from synth.folders.files import read_bytes

if TYPE_CHECKING:
    from synth.drawing import Drawing
    from synth.results import Design, ParetoFront, PartRow
    from synth.results.batch_record import BatchRecord
    from synth.results.calculation import Calculation

AboutSource: TypeAlias = "About | Mapping[str, object] | None"  # its entries by name

MOST_LETTERS = 500  # of one entry
MOST_LOGO = 1_000_000  # bytes
KINDS = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}
LABELS = {
    "company": "Company",
    "project": "Project",
    "customer": "Customer",
    "number": "Number",
    "author": "Author",
    "checked_by": "Checked by",
    "revision": "Revision",
    "date": "Date",
    "note": "Note",
}


@dataclass(frozen=True)
class About:
    """The head of a report; missing entries stay empty, a date is never made up.

    Parameters
    ----------
    company, project, customer, number, title, author, checked_by, revision, date, note : str
    logo : str
        A PNG or JPEG picture as a data address.
    """

    company: str = ""
    project: str = ""
    customer: str = ""
    number: str = ""
    title: str = ""
    author: str = ""
    checked_by: str = ""
    revision: str = ""
    date: str = ""
    note: str = ""
    logo: str = ""

    def facts(self) -> tuple[tuple[str, str], ...]:
        """Labels and words of the entries."""
        return tuple((label, getattr(self, name)) for name, label in LABELS.items() if getattr(self, name))

    @staticmethod
    def of(about: AboutSource, folder: Path | None = None) -> About:
        """About block from a mapping; empty for None.

        Parameters
        ----------
        about : mapping, About or None
            The entries by name; ``logo`` is a file.
        folder : Path, optional
            Where a logo is looked for, by default the folder that one works in.

        Raises
        ------
        InputError
            An entry is unknown, is no text or is too long, or the logo is no picture.
        """
        if about is None:
            return About()
        if isinstance(about, About):
            return about
        if not isinstance(about, Mapping):
            raise InputError("about", about, "a mapping, for example {'project': 'Hoist 7', 'author': 'A. Meyer'}", ())
        known = [f.name for f in fields(About)]
        values: dict[str, str] = {}
        for key, value in about.items():
            if key not in known:
                raise InputError("about", str(key), f"one of {', '.join(known)}", ("about", str(key)))
            if value is not None and not isinstance(value, (str, date)):
                right = f"a text in quotes, for example {key}: '1.10' (YAML reads 1.10 as the number 1.1)"
                raise InputError(f"about: {key}", value, right, ("about", str(key)))
            text = "" if value is None else str(value)
            if len(text) > MOST_LETTERS:
                raise InputError(f"about: {key}", text, f"at most {MOST_LETTERS} letters", ("about", str(key)))
            values[key] = text
        if values.get("logo"):
            values["logo"] = _picture((folder or Path()) / values["logo"])
        return About(**values)


def _picture(path: Path) -> str:
    """Return a picture as a data address."""
    right = "a picture as PNG or JPEG"
    raw = read_bytes(path, "about: logo", right, MOST_LOGO)
    kind = next((kind for start, kind in KINDS.items() if raw.startswith(start)), None)
    if kind is None:
        raise InputError("about: logo", str(path), right, ("about", "logo"))
    return f"data:{kind};base64,{base64.b64encode(raw).decode()}"


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """How a report is written.

    Parameters
    ----------
    formats : tuple of str
        Some of ``html``, ``explorer``, ``pdf``, ``xlsx``, ``json``, ``svg``, ``dxf``, ``step``, ``glb``.
    about : About
    length : {"summary", "normal", "full"}
        Of the sheets.
    fonts : tuple of Path
        Folders of fonts for the PDF beside its own.
    """

    formats: tuple[str, ...] = ("html",)
    about: About = About()
    length: str = "normal"
    fonts: tuple[Path, ...] = ()

    @classmethod
    def read(
        cls,
        formats: str | Sequence[str] = ("html",),
        about: AboutSource = None,
        length: str = "normal",
        fonts: Sequence[str | Path] = (),
        about_folder: Path | None = None,
    ) -> Self:
        """Options as a user states them; ``about_folder`` is where a logo is looked for.

        Raises
        ------
        InputError
            As for :meth:`About.of`; reports refuse formats and lengths that they do not know.
        """
        words = (formats,) if isinstance(formats, str) else tuple(formats)
        about = About.of(about, about_folder)
        return cls(formats=words, about=about, length=length, fonts=tuple(Path(x) for x in fonts))


@dataclass(frozen=True, kw_only=True)
class ReportRequest:
    """A report of a front, or of one design.

    Parameters
    ----------
    calculation : Calculation
    front : ParetoFront, optional
    design : Design, optional
        One design that was checked, in place of a front.
    name : str
        Of the files of such a design.
    chosen : list of str
        Designs of the front that get sheets: ranks, or ``knee``.
    full : int
        Designs that the front report tells in full.
    how : ReportOptions
    rows : mapping
        Slot -> rows that may be chosen in live workbooks.
    drawings : mapping
        Rank, or 0 for a design that was checked -> Drawing.
    prices, near_equals, curves : list
        What else stands in the folder of the front.
    """

    calculation: Calculation
    front: ParetoFront | None = None
    design: Design | None = None
    name: str = "design"
    chosen: Sequence[str] = ("1",)
    full: int = 5
    how: ReportOptions = ReportOptions()
    rows: Mapping[str, Sequence[PartRow]] = field(default_factory=dict)
    drawings: Mapping[int, Drawing] = field(default_factory=dict)
    prices: Sequence[Mapping[str, Any]] = ()
    near_equals: Sequence[Mapping[str, Any]] = ()
    curves: Sequence[str] = ()


@dataclass(frozen=True, kw_only=True)
class ComparisonRequest:
    """A report of the common front of several families.

    Parameters
    ----------
    content : mapping
        Of comparison.json; its designs have the rank in their family as ``own_rank``.
    fronts : mapping
        Family -> its own front, of those that were searched.
    how : ReportOptions
    links : mapping
        Family -> file of its report.
    calculations : mapping
        Family -> what tells the meaning of its quantities and limits; for the explorer.
    drawings : mapping
        Rank in the common front -> Drawing; for the explorer.
    """

    content: Mapping[str, Any]
    fronts: Mapping[str, ParetoFront]
    how: ReportOptions = ReportOptions()
    links: Mapping[str, str] = field(default_factory=dict)
    calculations: Mapping[str, Calculation] = field(default_factory=dict)
    drawings: Mapping[int, Drawing] = field(default_factory=dict)


@dataclass(frozen=True)
class BatchReportRequest:
    """A report of a batch."""

    batch: BatchRecord
    how: ReportOptions
