"""Which encoding the text of a table is in: told beyond doubt, or asked back.

UTF-8 and UTF-16 say it themselves. Of what is left a code page fits where every letter is of one language that is
written in it; two pages that fit and differ are a doubt. Detectors that weigh letters are no help with short tables.
"""

from __future__ import annotations

import codecs
import re

from synth.errors import InputError, shortened

MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
WESTERN, CENTRAL, JAPANESE = "cp1252", "cp1250", "cp932"
# What they are called in messages, and told where a table is in one of them.
NAMES = {WESTERN: "Windows-1252", CENTRAL: "Windows-1250", JAPANESE: "Shift-JIS", "utf-16": "UTF-16"}
# Letters beyond ASCII by language; Faroese, Icelandic and letters of single foreign words are left to be asked back.
ALPHABETS = {
    WESTERN: ("äöüß", "àâæçèéêëîïôœùûüÿ", "åäöé", "æøåé", "áéíñóúü¿¡ªº", "ãáâàçéêíõóôúüªº", "àèéìîòóùªº", "éëïóöüèê"),
    CENTRAL: ("äöüß", "áčďéěíňóřšťúůýž", "áäčďéíľňóôšťúýž", "ąćęłńóśźż", "áéíóöőúüű", "čćđšž", "ăâîşţ"),
}
SYMBOLS = set("°±²·µ§€–—‘’“”„…«»®©™×÷¬¦¶\u00a0\u00ad")
# In headings of any language: cubic units, diameters and fractions by the numbers that they stand beside.
APART = re.compile(
    rb"(?<![A-Za-z\xc0-\xff])[kdcm\xb5]?m\xb3(?![A-Za-z\x80-\xff])"
    rb"|(?<![A-Za-z\x80-\xff])[\xd8\xf8](?= ?[0-9\[])"
    rb"|(?<![A-Za-z\x80-\xff])[\xbc-\xbe](?= ?(?:in\b|hp\b|[\"\[]))"
)
INSIDE = re.compile(r"[^\W\d_][€“”„…«»®©™±÷¬¦¶§][^\W\d_]")  # signs that stand within no word
KANA_OR_KANJI = re.compile("[\u3041-\u30fa\u4e00-\u9fff]")
JAPANESE_CHARACTERS = re.compile("[\u3000-\u30ff\u4e00-\u9fff\uff01-\uff5e\u2103\u03b1-\u03c9°±×÷μ]*")
KANA = re.compile("[\u3041-\u30fa]")
RARE = b"\x99"  # where the characters of Shift-JIS begin that no table of parts needs


def decoded(raw: bytes, name: str, named: str = "") -> tuple[str, str]:
    """Return the text of a file without its byte order mark, and its encoding.

    Parameters
    ----------
    raw : bytes
    name : str
        How messages call the file.
    named : str
        The encoding that somebody has named; nothing: it is recognised.

    Raises
    ------
    InputError
        It is no text, not in the encoding named, or may be in several.
    """
    if named:
        return _in_encoding(raw, name, named)
    for mark, encoding in MARKS:
        if raw.startswith(mark):
            try:
                return raw.decode(encoding), encoding
            except UnicodeDecodeError:
                raise InputError(name, "a broken file", f"text in {encoding.upper()} as its first bytes say") from None
    if b"\0" in raw:
        line = raw[: raw.index(b"\0")].count(b"\n") + 1
        raise InputError(f"{name}, line {line}", "a binary file", "a text file such as CSV, or .xlsx")
    try:
        return raw.decode("utf-8"), "utf-8"
    except UnicodeDecodeError:
        return _recognised(raw, name)


def known_encoding(name: str, field: str) -> str:
    """Return the name by which Python knows an encoding of text.

    Raises
    ------
    InputError
        There is none.
    """
    try:
        "".encode(python_name := codecs.lookup(name).name)  # those that turn bytes into bytes refuse it
    except (LookupError, ValueError):
        raise InputError(field, name, "an encoding of text, such as cp1250, cp1252, shift_jis or utf-8") from None
    return python_name


def _in_encoding(raw: bytes, name: str, named: str) -> tuple[str, str]:
    encoding = known_encoding(named, "--encoding")
    try:
        return raw.decode(encoding).removeprefix("\ufeff"), encoding
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        got = raw[error.start : error.start + 1]
        raise InputError(f"{name}, line {line}", got, f"text in {encoding}, as is stated") from None


def _recognised(raw: bytes, name: str) -> tuple[str, str]:
    """Return the text and the one encoding that it may be in.

    Raises
    ------
    InputError
        There are two, or none.
    """
    plain = APART.sub(b"", raw)
    fitting = [page for page in ALPHABETS if _fits(plain, page)]
    if len({plain.decode(page) for page in fitting}) == 1:
        return raw.decode(fitting[0], "replace"), fitting[0]
    if not fitting and _is_japanese(raw):
        return raw.decode(JAPANESE), JAPANESE
    if fitting:
        raise _doubt(plain, name, fitting)
    position = next(k for k, byte in enumerate(raw) if byte >= 0x80)
    broken = re.search(rb"[\x81\x8d\x8f\x90\x9d]", raw)  # of Windows-1252 never
    position = broken.start() if broken else position
    line = raw[:position].count(b"\n") + 1
    right = "text in UTF-8, UTF-16 or Windows-1252: save as CSV UTF-8, or name its encoding (--encoding)"
    raise InputError(f"{name}, line {line}", raw[position : position + 1], right)


def _fits(raw: bytes, page: str) -> bool:
    """True if all letters of a text in a code page are of one language, and all signs are such as tables have."""
    try:
        text = raw.decode(page)
    except UnicodeDecodeError:
        return False
    if INSIDE.search(text):
        return False
    letters = {letter for letter in text.lower() if letter > "\x7f"} - SYMBOLS
    return any(letters <= set(alphabet) for alphabet in ALPHABETS[page])


def _is_japanese(raw: bytes) -> bool:
    """True if a text is Japanese in Shift-JIS beyond doubt: of kana and common characters, in pairs of bytes."""
    try:
        text = "".join(letter for letter in raw.decode(JAPANESE) if letter > "\x7f")
    except UnicodeDecodeError:
        return False
    if not JAPANESE_CHARACTERS.fullmatch(text) or not KANA_OR_KANJI.search(text):
        return False
    return KANA.search(text) is not None or all(letter.encode(JAPANESE) < RARE for letter in text)


def _doubt(raw: bytes, name: str, pages: list[str]) -> InputError:
    """Question about a text that may be in several code pages: with a word as each of them has it."""
    readings = [raw.decode(page).splitlines() for page in pages]
    lines = zip(*readings, strict=False)
    number, line = next((k, line) for k, line in enumerate(lines, start=1) if len(set(line)) > 1)
    words = zip(*(re.findall(r"[^\s,;\"]+", text) for text in line), strict=False)
    word = next(word for word in words if len(set(word)) > 1)
    shown = " or ".join(f"--encoding {page} for {shortened(w)!r}" for page, w in zip(pages, word, strict=True))
    right = f"its encoding, which may be either: {shown}; or save as CSV UTF-8"
    return InputError(f"{name}, line {number}", word[0], right)
