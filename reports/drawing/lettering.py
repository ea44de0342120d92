"""How wide texts are: drawings are set in a sans-serif letter as wide as Helvetica, whatever the reader has."""

from __future__ import annotations

from synth.text.plain_text import one_line

TEXT = 3.5  # mm, height of letters of dimensions (ISO 3098)
SMALL = 2.5  # of lists and notes
LABEL = 1.8  # of the names of fields
CAPITAL = 0.72  # height of a capital over the size of a font

# Thousandths of the size of the font (Helvetica); what is not here is as wide as the widest.
WIDTHS = {
    **dict.fromkeys("ijl'|", 222),
    **dict.fromkeys("ftI.,:;!/\\[] ", 278),
    **dict.fromkeys("r()-`", 333),
    **dict.fromkeys('"°·', 400),
    **dict.fromkeys("csJkvxyz*", 500),
    **dict.fromkeys("abdeghnopquL0123456789#$_?", 556),
    **dict.fromkeys("+<>=~×±−", 584),
    **dict.fromkeys("FTZ", 611),
    **dict.fromkeys("ABEKPSVXY&", 667),
    **dict.fromkeys("CDHNRUw", 722),
    **dict.fromkeys("GOQØ", 778),
    **dict.fromkeys("mM%", 889),
    "W": 944,
    "–": 556,
    "…": 1000,
}
ELSE = 700  # other alphabets
IDEOGRAPH = 1000  # ideographs


def size_of(height: float) -> float:
    """Return the size of a font whose capitals have a height."""
    return height / CAPITAL


def width(text: str, height: float) -> float:
    """Return the width of a text [mm] whose capitals are ``height`` high.

    >>> round(width("Ø204", 3.5), 1)
    11.9
    """
    units = sum(WIDTHS.get(c, IDEOGRAPH if ord(c) >= 0x2E80 else ELSE) for c in text)
    return units / 1000 * size_of(height)


def fitted(text: str, most: float, height: float, least: float) -> tuple[str, float]:
    """Return a text that is no wider than ``most``: smaller letters first, then cut with an ellipsis.

    >>> fitted("Inner plate", 20, 2.5, 2.0)
    ('Inner plate', 2.5)
    >>> fitted("A name without end", 20, 2.5, 2.0)
    ('A name witho…', 2.0)
    """
    text = one_line(text)
    needed = width(text, height)
    if needed <= most:
        return text, height
    smaller = max(least, height * most / needed)
    if width(text, smaller) <= most * (1 + 1e-9):
        return text, smaller
    kept = text
    while kept and width(kept.rstrip() + "…", least) > most:
        kept = kept[: min(len(kept) - 1, int(len(kept) * most / width(kept, least)) + 2)]
    return kept.rstrip() + "…", least


def wrapped(text: str, most: float, height: float) -> list[str]:
    """Return a text in lines that are no wider than ``most``; words that are wider are cut.

    >>> wrapped("Not part of the model", 20, 2.5)
    ['Not part of', 'the model']
    """
    lines = [""]
    for word in one_line(text).split():
        remaining = word
        while remaining:
            wider = f"{lines[-1]} {remaining}".strip()
            if width(wider, height) <= most:
                lines[-1], remaining = wider, ""
            elif lines[-1]:
                lines.append("")
            else:
                fits = next(k for k in range(len(remaining), 0, -1) if k == 1 or width(remaining[:k], height) <= most)
                lines[-1], remaining = remaining[:fits], remaining[fits:]
                if remaining:
                    lines.append("")
    return lines
