"""Documents as PDF, set by Typst: PDF/A-2b for archives and PDF/UA-1 for those who hear them."""

from __future__ import annotations

import base64
import re
import shutil
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.results.drawings import EXTRAS

from ..extras import needed
from ..formula.typst import written_out
from .blocks import Document
from .typst_source import typst_source

STANDARDS = ("a-2b", "ua-1")
NO_GLYPH = re.compile(r'the text `"(.*?)"` could not be displayed')
ESCAPED = re.compile(r"\\u\{([0-9a-f]+)\}|\\(.)")
MOST_NAMED = 12  # characters without a glyph that are named one by one
ROUNDS = 4  # of looking for characters without a glyph: each round finds all of the texts that it sees


def pdf(document: Document, fonts: Sequence[Path] = ()) -> bytes:
    """Return a document as PDF; see :func:`pdf_with_notes`."""
    return pdf_with_notes(document, fonts)[0]


def pdf_with_notes(document: Document, fonts: Sequence[Path] = ()) -> tuple[bytes, tuple[str, ...]]:
    """Document as PDF, and notes on characters without a glyph.

    The same document gives the same bytes. Nothing is read but the document and the fonts.

    Parameters
    ----------
    document : Document
    fonts : list of Path
        Files or folders with fonts for characters that those of Typst do not have.

    Raises
    ------
    InputError
        The extra is not installed, or there are no such fonts.
    """
    typst = needed(*EXTRAS["pdf"])
    lacking: dict[str, None] = {}
    with tempfile.TemporaryDirectory() as root:
        known = _fonts(typst, fonts, Path(root)) if fonts else _bundled_fonts()
        logo = _logo_file(document.logo, Path(root))
        source = typst_source(document, logo)
        for _ in range(ROUNDS):
            text = source.translate({ord(c): written_out(c) for c in lacking})
            try:
                made = typst.compile(
                    text.encode(),
                    root=root,
                    format="pdf",
                    font_paths=known,
                    ignore_system_fonts=True,
                    package_path=root,
                    package_cache_path=root,
                    pdf_standards=list(STANDARDS),
                    timestamp=0,
                )
            except typst.TypstError as error:
                missing = _without_glyph(str(error.diagnostic))
                if not missing - lacking.keys():
                    raise
                lacking |= dict.fromkeys(sorted(missing))
            else:
                return bytes(made), _notes(lacking)
    raise AssertionError("characters that were replaced are still there")


@cache
def _bundled_fonts() -> Any:
    """Return the fonts that come with Typst; none of the system."""
    return needed(*EXTRAS["pdf"]).Fonts(include_system_fonts=False)


def _fonts(typst: Any, paths: Sequence[Path], folder: Path) -> Any:
    """Return these fonts as well; Typst takes folders, so that files are copied into one."""
    folders: list[str] = []
    for number, path in enumerate(map(Path, paths)):
        if not path.exists():
            raise InputError("--font-path", str(path), "a font file, or a folder with fonts")
        if path.is_file():
            target = folder / f"font-{number}"
            target.mkdir()
            shutil.copyfile(path, target / path.name)
        folders.append(str(path if path.is_dir() else target))
    return typst.Fonts(include_system_fonts=False, font_paths=folders)


def _logo_file(logo: str, folder: Path) -> str:
    """Write a picture that is a data address into a folder; return its name."""
    kind, comma, packed = logo.partition(";base64,")
    if not comma:
        return ""
    name = "logo.png" if kind == "data:image/png" else "logo.jpg"
    (folder / name).write_bytes(base64.b64decode(packed))
    return name


def _without_glyph(diagnostic: str) -> set[str]:
    """Return the characters of which Typst says that no font has them."""

    def meant(match: re.Match[str]) -> str:
        return chr(int(match[1], 16)) if match[1] else match[2]

    return {c for text in NO_GLYPH.findall(diagnostic) for c in ESCAPED.sub(meant, text) if ord(c) > 0x7E}


def _notes(lacking: dict[str, None]) -> tuple[str, ...]:
    if not lacking:
        return ()
    named = " ".join(f"{c} (U+{ord(c):04X})" for c in list(lacking)[:MOST_NAMED])
    more = f" and {len(lacking) - MOST_NAMED} more" if len(lacking) > MOST_NAMED else ""
    return (
        f"PDF: no font has {named}{more}; the file has their numbers instead. "
        "Pass a font that has them with --font-path.",
    )
