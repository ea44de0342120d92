"""The front as a static drawing: every two objectives against each other, as SVG without any library."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import combinations, pairwise
from typing import TypeAlias

from synth.results import Design, ParetoFront
from synth.text.numbers import page_text
from synth.text.plain_text import printable, words
from synth.units import from_si, unit_text

from .label_spots import Box, label_spots

MOST_PANELS = 3  # of objectives that are drawn in pairs
LABELLED = 20  # designs up to which every point has its rank beside it
WIDTH, HEIGHT = 640, 400  # of one panel, in points of the drawing
LEFT, RIGHT, TOP, BOTTOM = 78, 24, 18, 58  # left of the field at least
NAME_SPACE = 38  # of that for the name of the axis, and between it and the numbers
TICKS = 6
MARGIN = 0.04  # beside the outermost values, as a share of the range
ALIKE = 1e-9  # share of their size by which values differ that are drawn as one
LOG_FROM = 20  # largest over smallest value from which on an axis is logarithmic
DECADES_FROM = 2000
FONTS = "system-ui, Noto Sans, DejaVu Sans, sans-serif"
LETTER, LINE = 8.0, 13.0  # of a rank beside its point: width of a character, height
DOT, KNEE = 5.5, 10.0  # radii
ACCENT = "#0b5cad"
# Of families: the colours of M. Okabe and K. Ito that are dark enough on white, each with a shape, for print without.
FAMILY_COLOURS = ("#0072B2", "#C24E00", "#00795A", "#B0487F", "#000000", "#8A6100", "#2A7FA8")
FAMILY_SHAPES = ("circle", "square", "triangle", "diamond")
HEAD, LINE_HIGH, FOOT = 30, 18, 16  # of a file: its margin above, lines of text, the foot
TITLE_LETTERS, TEXT_LETTERS, FOOT_LETTERS = 66, 88, 100  # on a line
Place: TypeAlias = Callable[[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Axis:
    """One axis: ends and ticks in the unit that is shown, by logarithms where values span much."""

    name: str
    unit: str
    low: float
    high: float
    ticks: tuple[float, ...]
    log: bool = False

    @staticmethod
    def of(name: str, unit: str, values: Sequence[float]) -> Axis:
        """Return an axis with round ticks on which all values have room."""
        low, high = min(values), max(values)
        if low > 0 and high / low >= LOG_FROM:
            return Axis._logarithmic(name, unit, low, high)
        span = high - low
        if span <= ALIKE * max(abs(low), abs(high)):
            span = abs(high) or 1.0
        step = _round_step(span / TICKS)
        first, last = math.floor((low - MARGIN * span) / step), math.ceil((high + MARGIN * span) / step)
        if low >= 0:
            first = max(first, 0)
        ticks = tuple(k * step for k in range(first, last + 1))
        return Axis(name, unit, ticks[0], ticks[-1], ticks)

    @staticmethod
    def _logarithmic(name: str, unit: str, low: float, high: float) -> Axis:
        decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 2)
        steps = (1, 2, 5) if high / low < DECADES_FROM else (1,)
        every = [step * 10.0**decade for decade in decades for step in steps]
        first = max(t for t in every if t <= low / (1 + MARGIN))
        last = min((t for t in every if t >= high * (1 + MARGIN)), default=every[-1])
        return Axis(name, unit, first, last, tuple(t for t in every if first <= t <= last), True)

    def share(self, value: float) -> float:
        """Position of a value on the axis, from 0 to 1."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def title(self) -> str:
        """Return name and unit."""
        return self.name + (f" [{unit_text(self.unit)}]" if unit_text(self.unit) else "")


def _round_step(size: float) -> float:
    power = 10.0 ** math.floor(math.log10(size))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= size)


@dataclass(frozen=True)
class Drawn:
    """What is drawn: ranked designs, what they are measured by, and the family of each where there are several."""

    designs: Sequence[Design]
    objectives: Mapping[str, str]
    families: Sequence[str] = ()

    def why_not(self) -> str:
        """Reason why there is nothing to draw; empty where there is something."""
        if not self.designs:
            return "there is no design"
        if len(self.objectives) < 2:
            return f"{next(iter(self.objectives), 'one objective')} is the only objective, and a front has two or more"
        return "one design alone is no line" if len(self.designs) < 2 else ""

    def values(self, name: str) -> list[float]:
        """Return the values of an objective, in the unit in which it is shown."""
        return [float(from_si(d.objectives[name], self.unit(name))) for d in self.designs]

    def unit(self, name: str) -> str:
        """Return the unit in which an objective is shown."""
        return self.designs[0].frame.units[name]

    def axis(self, name: str) -> Axis:
        """Return the axis of an objective; it tells where more is better."""
        direction = "" if self.objectives[name] == "min" else ", more is better"
        return Axis.of(f"{words(name)}{direction}", self.unit(name), self.values(name))

    def listed(self) -> dict[str, int]:
        """Return the families in the order of their best designs, with their numbers."""
        return {name: k for k, name in enumerate(dict.fromkeys(self.families))}

    def label(self, design: Design) -> str:
        """Label of a point: its rank, where all of them have room, or it is one to look at."""
        return f"#{design.rank}" if len(self.designs) <= LABELLED or design.note or design.rank == 1 else ""

    def staircase(self, pair: tuple[str, str]) -> list[tuple[float, float]]:
        """Return the border of what the designs dominate: what lies on its good side no design reaches.

        None of fronts of more objectives, of which two do not tell what is dominated.
        """
        if len(self.objectives) != 2:
            return []
        sign = 1 if self.objectives[pair[0]] == "min" else -1
        ordered = sorted(zip(self.values(pair[0]), self.values(pair[1]), strict=True), key=lambda p: sign * p[0])
        corners = [((x2, y1), (x2, y2)) for (_, y1), (x2, y2) in pairwise(ordered)]
        return [ordered[0], *(point for both in corners for point in both)]


def front_svg(front: ParetoFront, chosen: Sequence[int] = (), linked: bool = True) -> str:
    """Return the designs of a front as SVG; nothing where there are no two objectives.

    Parameters
    ----------
    front : ParetoFront
    chosen : list of int
        Ranks of the designs that are told in full; they are filled.
    linked : bool
        Whether a point leads to its design in the document.
    """
    drawn = Drawn(front.designs, front.frame.objectives)
    if drawn.why_not():
        return ""
    pairs = _pairs(drawn)
    panels = [_panel(drawn, pair, k * HEIGHT, chosen, linked) for k, pair in enumerate(pairs)]
    return _document("".join(panels), HEIGHT * len(pairs))


def front_file(
    designs: Sequence[Design], objectives: Mapping[str, str], title: str, proven: str = "", families: Sequence[str] = ()
) -> str:
    """Return the designs of a front as an SVG file that says by itself what it shows; nothing where there is no front.

    Parameters
    ----------
    designs : list of Design
    objectives : mapping
        Names and senses.
    title : str
        What was designed.
    proven : str
        How far the front is proven.
    families : list of str
        The family of each design, where there are several.
    """
    drawn = Drawn(designs, objectives, families)
    if drawn.why_not():
        return ""
    pairs = _pairs(drawn)
    left, parts, y = LEFT - 54, [], HEAD
    shown = list(dict.fromkeys(name for pair in pairs for name in pair))
    for line in textwrap.wrap(f"{printable(title)}: {_and([words(n) for n in shown])}", TITLE_LETTERS):
        parts.append(f'<text x="{left}" y="{y}" font-size="16" font-weight="600">{escape(line)}</text>')
        y += LINE_HIGH + 3
    for line in textwrap.wrap(_caption(drawn, shown), TEXT_LETTERS):
        parts.append(f'<text x="{left}" y="{y}" fill="#5b6775">{escape(line)}</text>')
        y += LINE_HIGH
    for name, k in drawn.listed().items():
        parts.append(_shape(left + 6, y - 4.5, FAMILY_SHAPES[k % 4], FAMILY_COLOURS[k % 7], FAMILY_COLOURS[k % 7]))
        parts.append(f'<text x="{left + 20}" y="{y}">{escape(printable(words(name)))}</text>')
        y += LINE_HIGH
    y -= LINE_HIGH - 4
    chosen = [d.rank or 0 for d in designs]
    parts += [_panel(drawn, pair, y + k * HEIGHT, chosen, False) for k, pair in enumerate(pairs)]
    y += HEIGHT * len(pairs)
    foot = textwrap.wrap(printable(proven), FOOT_LETTERS)
    for k, line in enumerate(foot):
        parts.append(f'<text x="{left}" y="{y + 8 + FOOT * k}" font-size="11.5" fill="#5b6775">{escape(line)}</text>')
    high = y + (FOOT * len(foot) + 4 if foot else 0)
    paper = f'<rect x="0.5" y="0.5" width="{WIDTH - 1}" height="{high - 1}" rx="8" fill="#ffffff" stroke="#d5dbe2"/>'
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + _document(paper + "".join(parts), high) + "\n"


def _document(content: str, high: int) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {high}" width="{WIDTH}" height="{high}" '
        f'font-family="{FONTS}" font-size="13" fill="#1b2430">{content}</svg>'
    )


def _pairs(drawn: Drawn) -> list[tuple[str, str]]:
    return list(combinations(drawn.objectives, 2))[:MOST_PANELS]


def _caption(drawn: Drawn, shown: Sequence[str]) -> str:
    """Caption: what is drawn, and what is not."""
    of = "both" if len(drawn.objectives) == 2 else "all objectives"
    parts = [f"{len(drawn.designs)} designs, #1 nearest to the best of {of}"]
    if any("knee" in d.note for d in drawn.designs):
        parts.append("ring: knee")
    if len(drawn.objectives) == 2:
        parts.append("dashes: what no design passes")
    hidden = [words(n) for n in drawn.objectives if n not in shown]
    if hidden:
        parts.append(f"not drawn: {_and(hidden)}")
    return "; ".join(parts)


def _and(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _panel(drawn: Drawn, pair: tuple[str, str], above: float, chosen: Sequence[int], linked: bool) -> str:
    columns = [drawn.values(n) for n in pair]
    x_axis, y_axis = (drawn.axis(n) for n in pair)
    numbers = [page_text(tick) for tick in y_axis.ticks]
    left = max(LEFT, NAME_SPACE + LETTER * max(map(len, numbers)))
    width, height, top = WIDTH - left - RIGHT, HEIGHT - TOP - BOTTOM, above + TOP

    def place(x: float, y: float) -> tuple[float, float]:
        return left + width * x_axis.share(x), top + height * (1 - y_axis.share(y))

    parts = [
        f'<rect class="field" x="{left:g}" y="{top}" width="{width:g}" height="{height}" fill="none" stroke="#cfd6de"/>'
    ]
    for tick in x_axis.ticks:
        x, _ = place(tick, y_axis.low)
        parts.append(_line(x, top, x, top + height))
        parts.append(_text(x, top + height + 18, page_text(tick), "middle"))
    for tick, number in zip(y_axis.ticks, numbers, strict=True):
        _, y = place(x_axis.low, tick)
        parts.append(_line(left, y, left + width, y))
        parts.append(_text(left - 8, y + 4, number, "end"))
    parts.append(_text(left + width / 2, top + height + 42, x_axis.title(), "middle"))
    middle = top + height / 2
    parts.append(
        f'<text class="ink" transform="translate(24 {middle:.1f}) rotate(-90)" text-anchor="middle">'
        f"{escape(y_axis.title())}</text>"
    )
    stairs = [place(x, y) for x, y in drawn.staircase(pair)]
    if stairs:
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in stairs)
        parts.append(f'<path class="stairs" d="M{path}" fill="none" stroke="#8ba3bb" stroke-dasharray="5 4"/>')
    points = [
        (design, *place(x, y), f"{_value_text(x_axis, x)}, {_value_text(y_axis, y)}")
        for design, x, y in zip(drawn.designs, *columns, strict=True)
    ]
    for k, (design, x, y, hint) in reversed(list(enumerate(points))):  # the best ranks on top
        family = drawn.families[k] if drawn.families else ""
        parts.append(_point(design, x, y, hint, design.rank in chosen, linked, (family, drawn.listed().get(family, 0))))
    field = Box(left, top, left + width, top + height)
    parts += _ranks(drawn, [(x, y) for _, x, y, _ in points], stairs, field)
    return "".join(parts)


def _ranks(
    drawn: Drawn, places: Sequence[tuple[float, float]], stairs: Sequence[tuple[float, float]], field: Box
) -> list[str]:
    """Return the ranks beside their points, as far as there is room."""
    labels = [drawn.label(design) for design in drawn.designs]
    boxes = []
    for design, (x, y) in zip(drawn.designs, places, strict=True):
        reach = KNEE if "knee" in design.note else DOT
        boxes.append(Box(x - reach, y - reach, x + reach, y + reach))
    lines = [Box(min(a, c) - 1, min(b, d) - 1, max(a, c) + 1, max(b, d) + 1) for (a, b), (c, d) in pairwise(stairs)]
    sizes = [(LETTER * len(label), LINE) if label else None for label in labels]
    spots = label_spots(boxes, sizes, field, lines, 2.0)
    return [
        _text(spot.left, spot.bottom - 2.5, label, "start")
        for spot, label in zip(spots, labels, strict=True)
        if spot is not None
    ]


def _value_text(axis: Axis, value: float) -> str:
    return f"{axis.name} {page_text(value)} {unit_text(axis.unit)}".strip()


def _line(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="grid" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#e3e8ed"/>'


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text class="ink" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _point(
    design: Design, x: float, y: float, values: str, full: bool, linked: bool, family: tuple[str, int] = ("", 0)
) -> str:
    name, k = family
    knee = "knee" in design.note
    hint = f"#{design.rank}" + (f", {printable(words(name))}" if name else "") + f": {values}" + " (knee)" * knee
    colour = FAMILY_COLOURS[k % len(FAMILY_COLOURS)] if name else ACCENT
    ring = (
        f'<circle class="knee" cx="{x:.1f}" cy="{y:.1f}" r="{KNEE:g}" fill="none" stroke="#b3541e" stroke-width="1.6"/>'
    )
    shape = FAMILY_SHAPES[k % len(FAMILY_SHAPES)] if name else "circle"
    dot = _shape(x, y, shape, colour if full else "#ffffff", colour, "dot" if full else "hollow")
    drawn = f"<title>{escape(hint)}</title>{ring if knee else ''}{dot}"
    if linked:
        return f'<a href="#design-{design.group or design.rank}">{drawn}</a>'
    return f"<g>{drawn}</g>"


def _shape(x: float, y: float, shape: str, fill: str, stroke: str, kind: str = "dot") -> str:
    painted = f'fill="{fill}" stroke="{stroke}" stroke-width="1.6"/>'
    if shape == "circle":
        return f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{DOT}" {painted}'
    shapes: dict[str, list[tuple[float, float]]] = {
        "square": [(-5, -5), (5, -5), (5, 5), (-5, 5)],
        "triangle": [(0, -6), (6, 5), (-6, 5)],
        "diamond": [(0, -6.5), (6.5, 0), (0, 6.5), (-6.5, 0)],
    }
    outline = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in shapes[shape])
    return f'<polygon class="{kind}" points="{outline}" {painted}'


def front_in_words(front: ParetoFront) -> str:
    """Description of the drawing, for people who do not see it."""
    ranges = []
    for name, sense in front.frame.objectives.items():
        unit = front.frame.units[name]
        values = [float(from_si(d.objectives[name], unit)) for d in front.designs]
        best, worst = (min(values), max(values)) if sense == "min" else (max(values), min(values))
        ranges.append(f"{name} from {page_text(best)} to {page_text(worst)} {unit_text(unit)}".strip())
    return f"{len(front.designs)} designs: {'; '.join(ranges)}"
