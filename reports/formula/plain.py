"""Layouts as a line of text: for consoles, for people who hear formulas, and for whoever computes them again."""

from __future__ import annotations

from .layout import SPACE, Amount, Call, Cases, Fence, Fraction, Layout, Letter, Power, Root, Row, Sign, Word

ASCII_SIGN_OF = {"−": "-", "·": "*", "≤": "<=", "≥": ">=", "≠": "!="}


def plain(layout: Layout) -> str:
    """Return a layout as text in which every operator stands between blanks, so that it can be read in one way only.

    Examples
    --------
    >>> plain(Fraction(Letter("M_load"), Row((Letter("J2"), Sign("+"), Letter("J1")))))
    'M_load / (J2 + J1)'
    """
    if isinstance(layout, Letter):
        return layout.symbol
    if isinstance(layout, Amount):
        return layout.shown.plain()
    if isinstance(layout, Word):
        return layout.text
    if isinstance(layout, Sign):
        return "*" if layout == SPACE else ASCII_SIGN_OF.get(layout.text, layout.text)
    if isinstance(layout, Row):
        return _row(layout)
    if isinstance(layout, Fraction):
        return f"{_bracketed(layout.over)} / {_bracketed(layout.under)}"
    if isinstance(layout, Power):
        return f"{_bracketed(layout.base)} ^ {_bracketed(layout.exponent)}"
    if isinstance(layout, Root):
        return f"sqrt({plain(layout.inner)})"
    if isinstance(layout, Fence):
        return f"abs({plain(layout.inner)})" if layout.bars else f"({plain(layout.inner)})"
    if isinstance(layout, Call):
        return f"{layout.name}({'; '.join(map(plain, layout.arguments))})"
    assert isinstance(layout, Cases)
    rows = [
        f"{plain(value)} otherwise" if condition is None else f"{plain(value)} if {plain(condition)}"
        for value, condition in layout.rows
    ]
    return "{ " + ", ".join(rows) + " }"


def _row(layout: Row) -> str:
    items = [x if isinstance(x, (Sign, Word)) else _factor(x, layout) for x in layout.items]
    return " ".join(x if isinstance(x, str) else plain(x) for x in items)


def _factor(item: Layout, row: Row) -> str:
    """Return a part of a row: a fraction among factors is bracketed, as text has no bar."""
    factors = any(isinstance(x, Sign) and x.text in ("·", SPACE.text) for x in row.items)
    return f"({plain(item)})" if factors and isinstance(item, (Fraction, Cases)) else plain(item)


def _bracketed(layout: Layout) -> str:
    text = plain(layout)
    single = isinstance(layout, (Letter, Word, Fence, Root, Call)) or (isinstance(layout, Amount) and " " not in text)
    return text if single and not text.startswith("-") else f"({text})"
