"""Layouts as mathematics of Typst. Every text of others stands in a string, never in markup."""

from __future__ import annotations

from reports.formula.layout import (
    BESIDE,
    Amount,
    Call,
    Cases,
    Fence,
    Fraction,
    Layout,
    Letter,
    Power,
    Root,
    Row,
    Sign,
    Word,
)
from reports.formula.symbols import symbol_parts
from reports.numbers import unit_text

SIGNS = {"−": "-", "·": "dot.op", "≤": "<=", "≠": "!=", "=": "=", "+": "+", "<": "<"}
NAMED = {"ln", "sin", "cos", "tan", "sinh", "cosh", "tanh", "min", "max"}


def string(text: str) -> str:
    r"""Return a text as a string of Typst.

    Examples
    --------
    >>> string('a "b" #read(1)')
    '"a \\"b\\" #read(1)"'
    """
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\r", "").replace("\t", " ")
    return f'"{escaped}"'


def typst_math(layout: Layout) -> str:
    """Return a layout as what may stand between dollar signs."""
    if isinstance(layout, Letter):
        return _letter(layout.symbol)
    if isinstance(layout, Amount):
        return _amount(layout)
    if isinstance(layout, Word):
        return f" {string(f' {layout.text} ' if layout.text in ('and', 'or', 'not') else layout.text)} "
    if isinstance(layout, Sign):
        return " thin " if layout == BESIDE else f" {SIGNS[layout.text]} "
    if isinstance(layout, Row):
        return "".join(map(typst_math, layout.items))
    if isinstance(layout, Fraction):
        return f" frac({typst_math(layout.over)}, {typst_math(layout.under)}) "
    if isinstance(layout, Power):
        return f" attach({typst_math(layout.base)}, t: {typst_math(layout.exponent)}) "
    if isinstance(layout, Root):
        return f" sqrt({typst_math(layout.inner)}) "
    if isinstance(layout, Fence):
        inside = typst_math(layout.inner)
        return f" abs({inside}) " if layout.bars else f" lr(({inside})) "
    if isinstance(layout, Call):
        name = layout.name if layout.name in NAMED else f"op({string(layout.name)})"
        return f" {name} lr(({' ; '.join(map(typst_math, layout.arguments))})) ".replace(" ; ", ' #";" ')
    assert isinstance(layout, Cases)
    rows = [
        f'{typst_math(value)} quad & "otherwise"'
        if condition is None
        else f'{typst_math(value)} quad & "if" thick {typst_math(condition)}'
        for value, condition in layout.rows
    ]
    return f" cases({', '.join(rows)}) "


def _letter(symbol: str) -> str:
    parts = symbol_parts(symbol)
    base = f"italic({string(parts.base)})" if parts.italic else f"upright({string(parts.base)})"
    before = "upright(Delta) " if parts.difference else ""
    if not parts.subscripts:
        return f" {before}{base} "
    below = ' #"," '.join(
        f"italic({string(x)})" if len(x) == 1 and not x.isdigit() else f"upright({string(x)})" for x in parts.subscripts
    )
    return f" {before}attach({base}, b: {below}) "


def _amount(layout: Amount) -> str:
    number = layout.shown
    found = f"upright({string(number.text.removeprefix('-'))})"
    if number.text.startswith("-"):
        found = f"- {found}"
    if number.exponent:
        found += f" dot.op attach(10, t: {number.exponent})"
    if number.unit:
        unit = unit_text(number.unit)
        found += ("" if unit == "°" else " thin ") + f" upright({string(unit)})"
    return f" {found} "
