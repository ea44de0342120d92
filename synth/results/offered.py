"""Rows that slots offered in a search, kept with its front: live workbooks let choose among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.folders.files import read_json
from synth.results.design import PartRow
from synth.results.front_record import fits
from synth.results.plain import digest_of

OFFERED = "offered.json"
OFFERED_FORMAT = 1
RIGHT = "an offered.json as clutchsynth has written it"
Offered = Mapping[str, Sequence[PartRow]]  # by slot


def offered_content(offered: Offered) -> dict[str, Any]:
    """Content of an offered.json; a row of several slots stands there once."""
    content: dict[str, Any] = {
        "format": OFFERED_FORMAT,
        "rows": {row.key: row.record() for rows in offered.values() for row in rows},
        "slots": {slot: [row.key for row in rows] for slot, rows in offered.items()},
    }
    return {**content, "digest": digest_of(content)}


def load_offered(folder: Path, digest: str) -> Offered:
    """Rows that were saved in a folder with a front.

    Parameters
    ----------
    folder : Path
    digest : str
        What the front says of the file.

    Raises
    ------
    InputError
        It is missing, was changed, or belongs to another front.
    """
    path = folder / OFFERED
    content = read_json(path, "offered", RIGHT)
    try:
        if fits(content, digest) and content["format"] == OFFERED_FORMAT:
            rows = {key: PartRow.read(row) for key, row in content["rows"].items()}
            return {slot: [rows[key] for key in keys] for slot, keys in content["slots"].items()}
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(f"offered {path}", str(error), f"{RIGHT}; this one is not complete") from error
    raise InputError(f"offered {path}", "another file", f"{RIGHT} with this front")
