"""Formulas that are too wide for a line, broken where people would: before the terms of a sum, then before factors."""

from __future__ import annotations

from synth.text.numbers import shown

from ..numbers import ShownQuantity, printed
from .layout import SPACE, TIMES, Amount, Call, Cases, Fence, Fraction, Layout, Letter, Power, Root, Row, Sign, Word
from .symbols import symbol_parts

WIDEST = 74.0  # digits side by side that a line of a page holds
MOST_UNDER = 0.5  # of a line: what stands under a bar beside which the rest is broken
SMALL = 0.72  # size of what is raised, lowered, or stands in a fraction inside a line


def width(layout: Layout) -> float:
    """Return about how wide a layout is, in digits."""
    if isinstance(layout, Letter):
        parts = symbol_parts(layout.symbol)
        return parts.difference + len(parts.base) + SMALL * len(",".join(parts.subscripts))
    if isinstance(layout, Amount):
        return len(printed(layout.shown)) * 0.95
    if isinstance(layout, Word):
        return len(layout.text) * 0.95
    if isinstance(layout, Sign):
        return 0.4 if layout == SPACE else 1.9
    if isinstance(layout, Row):
        return sum(map(width, layout.items))
    if isinstance(layout, Fraction):
        return max(width(layout.over), width(layout.under)) + 0.5
    if isinstance(layout, Power):
        return width(layout.base) + SMALL * width(layout.exponent)
    if isinstance(layout, Root):
        return width(layout.inner) + 1.2
    if isinstance(layout, Fence):
        return width(layout.inner) + 1.2
    if isinstance(layout, Call):
        return len(layout.name) + sum(width(a) + 1.0 for a in layout.arguments) + 1.0
    assert isinstance(layout, Cases)
    values = max(width(value) for value, _ in layout.rows)
    return values + max(width(condition) + 3 if condition else 9.0 for _, condition in layout.rows) + 2.0


def broken(layout: Layout, widest: float = WIDEST) -> list[Layout]:
    """Return a layout as lines; each but the first begins with the sign that joins it to the line before.

    What has no place to break stays one line, however wide.
    """
    if width(layout) <= widest:
        return [layout]
    row = layout if isinstance(layout, Row) else Row((layout,))
    for joints in (("+", "−"), ("·", SPACE.text)):
        pieces = _pieces(row, joints)
        if len(pieces) > 1:
            lines = [line for packed in _packed(pieces, widest) for line in _again(packed, joints, widest)]
            return [part for line in lines for part in _inside(line, widest)]
    return _inside(layout, widest)


def _inside(line: Layout, widest: float) -> list[Layout]:
    """Break a line that is still too wide inside its widest part: a bracket, or what stands over a bar."""
    if width(line) <= widest:
        return [line]
    items = line.items if isinstance(line, Row) else (line,)
    place = max(range(len(items)), key=lambda k: width(items[k]))
    part, before, after = items[place], items[:place], items[place + 1 :]
    if isinstance(part, Fraction) and width(part.under) <= MOST_UNDER * widest and width(part.over) > widest:
        # What is over a bar cannot be broken; beside one over what is under it, it can.
        over = part.over.items if isinstance(part.over, Row) else (part.over,)
        if any(isinstance(x, Sign) and x.text in ("+", "−") for x in over):
            over = (Fence(part.over),)
        return broken(
            Row((*before, Fraction(Amount(ShownQuantity(shown(1))), part.under), TIMES, *over, *after)), widest
        )
    if isinstance(part, Fence) and not part.bars and isinstance(part.inner, Row):
        opened = Row((*before, Word("("), *part.inner.items, Word(")"), *after))
        return _packed(_pieces(opened, ("+", "−"), (place + 2, place + 1 + len(part.inner.items))), widest)
    return [line]


def _pieces(row: Row, joints: tuple[str, ...], places: tuple[int, int] = (1, 1_000)) -> list[list[Layout]]:
    """Pieces of a row before and behind some signs, of those between two places."""
    pieces: list[list[Layout]] = [[]]
    for position, item in enumerate(row.items):
        if places[0] <= position < places[1] and isinstance(item, Sign) and item.text in joints:
            pieces.append([])
        pieces[-1].append(item)
    return pieces


def _packed(pieces: list[list[Layout]], widest: float) -> list[Layout]:
    lines: list[list[Layout]] = []
    for piece in pieces:
        if lines and width(Row(tuple(lines[-1]))) + width(Row(tuple(piece))) <= widest:
            lines[-1] += piece
        else:
            lines.append(list(piece))
    return [Row(tuple(line)) for line in lines]


def _again(line: Layout, joints: tuple[str, ...], widest: float) -> list[Layout]:
    """Break a term that is too wide alone before its factors."""
    if joints[0] == "+" and width(line) > widest and isinstance(line, Row):
        pieces = _pieces(line, ("·", SPACE.text))
        return _packed(pieces, widest) if len(pieces) > 1 else [line]
    return [line]
