"""Files that are brought, looked at before anything reads them: what they are by their content, and how large."""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import PurePosixPath

from synth.errors import InputError
from synth.service.errors import ServiceError
from synth.service.settings import ServiceSettings
from synth.tables.encodings import decoded, known_encoding
from synth.tables.workbook import without_hidden_rows

ZIP = b"PK"
WORKBOOK = "xl/workbook.xml"  # in every file of Excel
MACROS = "vbaproject.bin"
LONGEST_NAME = 100  # of a file, without its ending
FIELD = "file"
CONTROLS = re.compile(rb"[\x00-\x08\x0e-\x1f]")  # in no text, whatever its encoding


def taken(content: bytes, settings: ServiceSettings, encoding: str = "", visible: bool = False) -> tuple[str, bytes]:
    """Return the ending that a file should have by its content, ``.csv`` or ``.xlsx``, and what is kept of it.

    Parameters
    ----------
    content : bytes
    settings : ServiceSettings
    encoding : str
        Of a CSV file, where it is stated: it is kept in UTF-8.
    visible : bool
        Whether hidden and filtered rows of a workbook are left out.

    Raises
    ------
    ServiceError
        415: it is neither.
    InputError
        It is a workbook that would be too large when it is unpacked, or cannot be read; or the encoding is none.
    """
    if encoding and not content.startswith(ZIP):
        content = decoded(content, FIELD, known_encoding(encoding, "encoding"))[0].encode()
    ending = kind_of(content, settings)
    hidden = visible and ending == ".xlsx"
    return ending, without_hidden_rows(content, FIELD, FIELD) if hidden else content


def kind_of(content: bytes, settings: ServiceSettings) -> str:
    """Return the ending that a file should have by its content: ``.csv`` or ``.xlsx``.

    Parameters
    ----------
    content : bytes
    settings : ServiceSettings

    Raises
    ------
    ServiceError
        415: it is neither.
    InputError
        It is a workbook that would be too large when it is unpacked, or cannot be read.
    """
    if content.startswith(ZIP):
        check_workbook(content, settings)
        return ".xlsx"
    try:
        text, _ = decoded(content, FIELD)
    except InputError as error:
        if CONTROLS.search(content) is not None:
            raise _neither() from None
        raise ServiceError(415, f"{error}, or an .xlsx workbook") from None
    if CONTROLS.search(text.encode()) is not None or text.lstrip()[:1] in ("<", "{", "%"):  # pages, JSON, PDF
        raise _neither()
    if not text.strip():
        raise InputError(FIELD, None, "a header, and rows below it", (FIELD,))
    return ".csv"


def _neither() -> ServiceError:
    return ServiceError(415, "the file is neither CSV nor an .xlsx workbook")


def check_workbook(content: bytes, settings: ServiceSettings) -> None:
    """Refuse a workbook that says of itself that it unpacks to too much; unpackers stop at what it says.

    Raises
    ------
    ServiceError
        415: it is an archive of something else.
    InputError
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            found = archive.infolist()
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError) as error:
        raise InputError(FIELD, "a broken archive", "a workbook that can be read", (FIELD,)) from error
    names = {entry.filename.lower() for entry in found}
    if WORKBOOK not in names or any(name.endswith(MACROS) for name in names):
        raise _neither()
    if len(found) > settings.upload_entries:
        raise InputError(FIELD, f"{len(found)} entries", f"a workbook of at most {settings.upload_entries}", (FIELD,))
    unpacked = sum(entry.file_size for entry in found)
    most = min(settings.upload_unpacked, settings.upload_ratio * len(content))
    if unpacked > most:
        raise InputError(FIELD, f"{unpacked} bytes when unpacked", f"a workbook of at most {most}", (FIELD,))


def plain_name(stated: str | None, ending: str) -> str:
    """Return the name of a file as it is shown and kept: no folders, nothing that acts on a terminal.

    Examples
    --------
    >>> plain_name("../../etc/Lasten 2024.CSV", ".csv"), plain_name(None, ".xlsx")
    ('Lasten 2024.csv', 'rows.xlsx')
    """
    base = PurePosixPath((stated or "").replace("\\", "/")).name
    stem = base.rpartition(".")[0] or base
    kept = "".join(letter for letter in re.sub(r"[<>:\"|?*]", "", stem) if letter.isprintable()).strip(" .")
    return f"{kept[:LONGEST_NAME] or 'rows'}{ending}"
