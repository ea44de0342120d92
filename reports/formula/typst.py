"""Layouts as mathematics of Typst. Every text of others stands in a string, never in markup."""

from __future__ import annotations

import re
from collections.abc import Sequence

from synth.text.numbers import THIN, grouped
from synth.units import unit_text

from .layout import MINUS, SPACE, Amount, Call, Cases, Fence, Fraction, Layout, Letter, Power, Root, Row, Sign, Word
from .symbols import symbol_parts

TYPST_SIGN_OF = {"−": "-", "·": "dot.op", "≤": "<=", "≥": ">=", "≠": "!=", "=": "=", "+": "+", "<": "<"}


# Characters that no font has or that turn the direction of writing, and halves of characters.
UNSEEN = re.compile("[\x00-\x08\x0b-\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")


def written_out(character: str) -> str:
    """Replacement of a character that cannot be shown.

    Examples
    --------
    >>> written_out("漢")
    '[U+6F22]'
    """
    return f"[U+{ord(character):04X}]"


def string(text: str) -> str:
    r"""Return a text as a string of Typst; what cannot be seen is written out.

    Examples
    --------
    >>> string('a "b" #read(1)')
    '"a \\"b\\" #read(1)"'
    >>> string("a\x07b")
    '"a[U+0007]b"'
    """
    seen = UNSEEN.sub(lambda match: written_out(match[0]), text)
    escaped = seen.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\r", "").replace("\t", " ")
    return f'"{escaped}"'


def typst_math(layout: Layout) -> str:
    """Return a layout as what may stand between dollar signs."""
    if isinstance(layout, Letter):
        return _letter(layout.symbol)
    if isinstance(layout, Amount):
        return _amount(layout)
    if isinstance(layout, Word) and layout.text in ("(", ")"):
        return f" \\{layout.text} "
    if isinstance(layout, Word):
        return f" {string(f' {layout.text} ' if layout.text in ('and', 'or', 'not') else layout.text)} "
    if isinstance(layout, Sign):
        return " thin " if layout == SPACE else f" {TYPST_SIGN_OF[layout.text]} "
    if isinstance(layout, Row):
        return _row(layout.items)
    if isinstance(layout, Fraction):
        parts = [typst_math(layout.over), typst_math(layout.under)]
        if _is_high(layout.over) or _is_high(layout.under):
            parts = [f"inline({part})" for part in parts]  # each fraction in another one is set smaller otherwise
        return f" frac({', '.join(parts)}) "
    if isinstance(layout, Power):
        if layout.base == Word("e") and _is_high(layout.exponent):
            return f" exp lr(({typst_math(layout.exponent)})) "  # a fraction that is raised is too small to be read
        return f" attach({typst_math(layout.base)}, t: {typst_math(layout.exponent).strip()}) "
    if isinstance(layout, Root):
        return f" sqrt({typst_math(layout.inner)}) "
    if isinstance(layout, Fence):
        inside = typst_math(layout.inner)
        return f" abs({inside}) " if layout.bars else f" lr(({inside})) "
    if isinstance(layout, Call):
        inside = '#"; "'.join(typst_math(x).strip() for x in layout.arguments)
        return f" op({string(layout.name)}) lr(({inside})) "
    assert isinstance(layout, Cases)
    rows = [
        f'inline({typst_math(value)}) quad & inline("otherwise")'
        if condition is None
        else f'inline({typst_math(value)}) quad & inline("if" thick {typst_math(condition)})'
        for value, condition in layout.rows
    ]
    return f" cases({', '.join(rows)}) "


def _row(items: Sequence[Layout]) -> str:
    if len(items) > 1 and items[0] == MINUS:
        return f" -{_row(items[1:]).strip()} "  # a sign that stands first belongs to what follows
    return "".join(map(typst_math, items))


def _is_high(layout: Layout) -> bool:
    """True if a layout has a fraction or cases in it, which stand above each other."""
    if isinstance(layout, Row):
        return any(map(_is_high, layout.items))
    if isinstance(layout, Call):
        return any(map(_is_high, layout.arguments))
    return isinstance(layout, (Fraction, Cases)) or (isinstance(layout, (Fence, Root)) and _is_high(layout.inner))


def _letter(symbol: str) -> str:
    parts = symbol_parts(symbol)
    base = f"italic({string(parts.base)})" if parts.italic else f"upright({string(parts.base)})"
    before = "upright(Delta)" if parts.difference else ""
    if not parts.subscripts:
        return f" {before}{base} "
    below = '#","'.join(
        f"italic({string(x)})" if len(x) == 1 and not x.isdigit() else f"upright({string(x)})" for x in parts.subscripts
    )
    return f" {before}attach({base}, b: {below}) "


def _amount(layout: Amount) -> str:
    number, unit = layout.shown.number, unit_text(layout.shown.unit)
    markup = f"upright({string(grouped(number.digits, THIN))})"
    if number.sign:
        markup = f"- {markup}"
    if number.power:
        markup += f" dot.op attach(10, t: {number.power})"
    if unit:
        space = "" if unit == "°" else " thick thin " if unit[0].isdigit() else " thin "  # 36 1/min, not 361/min
        markup += f"{space}upright({string(unit)})"
    return f" {markup} "
