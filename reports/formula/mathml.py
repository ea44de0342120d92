"""Layouts as MathML Core, which browsers draw without any library."""

from __future__ import annotations

from html import escape

from synth.text.numbers import THIN, grouped
from synth.units import unit_text

from .layout import SPACE, Amount, Call, Cases, Fence, Fraction, Layout, Letter, Power, Root, Row, Sign, Word
from .symbols import symbol_parts


def mathml(layout: Layout) -> str:
    """Return a layout as the inside of a ``math`` element.

    Examples
    --------
    >>> mathml(Letter("F0"))
    '<msub><mi>F</mi><mn>0</mn></msub>'
    """
    if isinstance(layout, Letter):
        return _letter(layout.symbol)
    if isinstance(layout, Amount):
        return _amount(layout)
    if isinstance(layout, Word):
        return f"<mtext>{escape(layout.text)}</mtext>"
    if isinstance(layout, Sign):
        return '<mspace width="0.17em"/>' if layout == SPACE else f"<mo>{escape(layout.text)}</mo>"
    if isinstance(layout, Row):
        return f"<mrow>{''.join(map(_item, layout.items))}</mrow>"
    if isinstance(layout, Fraction):
        return f"<mfrac>{_one(layout.over)}{_one(layout.under)}</mfrac>"
    if isinstance(layout, Power):
        return f"<msup>{_one(layout.base)}{_one(layout.exponent)}</msup>"
    if isinstance(layout, Root):
        return f"<msqrt>{mathml(layout.inner)}</msqrt>"
    if isinstance(layout, Fence):
        opening, closing = ("|", "|") if layout.bars else ("(", ")")
        return f'<mrow><mo fence="true">{opening}</mo>{mathml(layout.inner)}<mo fence="true">{closing}</mo></mrow>'
    if isinstance(layout, Call):
        return _call(layout)
    assert isinstance(layout, Cases)
    rows = "".join(
        f"<mtr><mtd>{mathml(value)}</mtd><mtd>"
        + ("<mtext>otherwise</mtext>" if condition is None else f"<mtext>if&#160;</mtext>{mathml(condition)}")
        + "</mtd></mtr>"
        for value, condition in layout.rows
    )
    return f'<mrow><mo fence="true" stretchy="true">{{</mo><mtable class="cases">{rows}</mtable></mrow>'


def _item(layout: Layout) -> str:
    """Return a part of a row: words between others keep their distance."""
    if isinstance(layout, Word) and layout.text in ("and", "or", "not"):
        return f"<mtext>&#160;{layout.text}&#160;</mtext>"
    return mathml(layout)


def _one(layout: Layout) -> str:
    """Return a layout as exactly one element."""
    return f"<mrow>{mathml(layout)}</mrow>"


def _letter(symbol: str) -> str:
    parts = symbol_parts(symbol)
    base = f"<mi>{escape(parts.base)}</mi>" if parts.italic else f"<mtext>{escape(parts.base)}</mtext>"
    if parts.subscripts:
        below = "<mo>,</mo>".join(map(_subscript, parts.subscripts))
        base = f"<msub>{base}{below if len(parts.subscripts) == 1 else f'<mrow>{below}</mrow>'}</msub>"
    return f"<mrow><mi>Δ</mi>{base}</mrow>" if parts.difference else base


def _subscript(text: str) -> str:
    kind = "mn" if text.isdigit() else "mi" if len(text) == 1 else "mtext"
    return f"<{kind}>{escape(text)}</{kind}>"


def _amount(layout: Amount) -> str:
    number, unit = layout.shown.number, unit_text(layout.shown.unit)
    negative, digits = bool(number.sign), grouped(number.digits, THIN)
    markup = f"<mo>−</mo><mn>{escape(digits)}</mn>" if negative else f"<mn>{escape(digits)}</mn>"
    several = negative
    if number.power:
        power = f"<mo>−</mo><mn>{-number.power}</mn>" if number.power < 0 else f"<mn>{number.power}</mn>"
        markup += f"<mo>·</mo><msup><mn>10</mn><mrow>{power}</mrow></msup>"
        several = True
    if unit:
        space_width = "0.45em" if unit[0].isdigit() else "0.17em"  # 36 1/min, not 361/min
        space = "" if unit == "°" else f'<mspace width="{space_width}"/>'
        markup += f"{space}<mtext>{escape(unit)}</mtext>"
        several = True
    return f"<mrow>{markup}</mrow>" if several else markup


def _call(layout: Call) -> str:
    inside = "<mo>;</mo>".join(map(mathml, layout.arguments))
    return f'<mrow><mi>{escape(layout.name)}</mi><mo fence="true">(</mo>{inside}<mo fence="true">)</mo></mrow>'
