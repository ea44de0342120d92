"""What people say about a report: project, customer, author, revision, date, logo."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import date
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.folders.files import read_bytes

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
    """The head of a report; what is not told stays empty, a date is never made up.

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
        """Return label and words of what is told."""
        return tuple((label, getattr(self, name)) for name, label in LABELS.items() if getattr(self, name))

    @staticmethod
    def of(told: Any, folder: Path | None = None) -> About:
        """About block from a mapping; empty for None.

        Parameters
        ----------
        told : mapping, About or None
            The entries by name; ``logo`` is a file.
        folder : Path, optional
            Where a logo is looked for, by default the folder that one works in.

        Raises
        ------
        InputError
            An entry is unknown, is no text or is too long, or the logo is no picture.
        """
        if told is None:
            return About()
        if isinstance(told, About):
            return told
        if not isinstance(told, Mapping):
            raise InputError("about", told, "a mapping, for example {'project': 'Hoist 7', 'author': 'A. Meyer'}", ())
        known = [f.name for f in fields(About)]
        values: dict[str, str] = {}
        for key, value in told.items():
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
