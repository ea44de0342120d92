"""The front as a static drawing: every two objectives against each other, as SVG without any library."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import combinations
from typing import TypeAlias

from reports.numbers import unit_text
from reports.reasons import significant
from synth.results import Design, ParetoFront
from synth.units import from_si

MOST_PANELS = 3  # of objectives that are drawn in pairs
LABELLED = 20  # designs up to which every point has its rank beside it
WIDE, HIGH = 640, 400  # of one panel, in points of the drawing
LEFT, RIGHT, TOP, BOTTOM = 78, 24, 18, 58
TICKS = 6
ROOM = 0.04  # beside the outermost values, as a share of the range
WIDE_RANGE = 20  # largest over smallest value from which on an axis is logarithmic
MANY_DECADES = 2000
FONTS = "system-ui, Noto Sans, DejaVu Sans, sans-serif"
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
        if low > 0 and high / low >= WIDE_RANGE:
            return Axis._logarithmic(name, unit, low, high)
        span = (high - low) or abs(high) or 1.0
        step = _round_step(span / TICKS)
        first, last = math.floor((low - ROOM * span) / step), math.ceil((high + ROOM * span) / step)
        if low >= 0:
            first = max(first, 0)
        ticks = tuple(k * step for k in range(first, last + 1))
        return Axis(name, unit, ticks[0], ticks[-1], ticks)

    @staticmethod
    def _logarithmic(name: str, unit: str, low: float, high: float) -> Axis:
        decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 2)
        steps = (1, 2, 5) if high / low < MANY_DECADES else (1,)
        every = [step * 10.0**decade for decade in decades for step in steps]
        first = max(t for t in every if t <= low / (1 + ROOM))
        last = min((t for t in every if t >= high * (1 + ROOM)), default=every[-1])
        return Axis(name, unit, first, last, tuple(t for t in every if first <= t <= last), True)

    def share(self, value: float) -> float:
        """Return where on the axis a value lies, from 0 to 1."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def title(self) -> str:
        """Return name and unit."""
        return self.name + (f" [{unit_text(self.unit)}]" if unit_text(self.unit) else "")


def _round_step(size: float) -> float:
    power = 10.0 ** math.floor(math.log10(size))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= size)


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
    pairs = list(combinations(front.frame.objectives, 2))[:MOST_PANELS]
    if not pairs or len(front.designs) < 2:
        return ""
    panels = [_panel(front, pair, k, chosen, linked) for k, pair in enumerate(pairs)]
    high = HIGH * len(pairs)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {high}" width="{WIDE}" height="{high}" '
        f'font-family="{FONTS}" font-size="13" fill="#1b2430">{"".join(panels)}</svg>'
    )


def _panel(front: ParetoFront, pair: tuple[str, str], number: int, chosen: Sequence[int], linked: bool) -> str:
    units = front.frame.units
    columns = [[float(from_si(d.objectives[n], units[n])) for d in front.designs] for n in pair]
    x_axis, y_axis = (Axis.of(n, units[n], v) for n, v in zip(pair, columns, strict=True))
    width, height, top = WIDE - LEFT - RIGHT, HIGH - TOP - BOTTOM, number * HIGH + TOP

    def place(x: float, y: float) -> tuple[float, float]:
        return LEFT + width * x_axis.share(x), top + height * (1 - y_axis.share(y))

    parts = [
        f'<rect class="field" x="{LEFT}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#cfd6de"/>'
    ]
    for tick in x_axis.ticks:
        x, _ = place(tick, y_axis.low)
        parts.append(_line(x, top, x, top + height))
        parts.append(_text(x, top + height + 18, significant(tick), "middle"))
    for tick in y_axis.ticks:
        _, y = place(x_axis.low, tick)
        parts.append(_line(LEFT, y, LEFT + width, y))
        parts.append(_text(LEFT - 8, y + 4, significant(tick), "end"))
    parts.append(_text(LEFT + width / 2, top + height + 42, x_axis.title(), "middle"))
    middle = top + height / 2
    parts.append(
        f'<text class="ink" transform="translate(16 {middle:.1f}) rotate(-90)" text-anchor="middle">'
        f"{escape(y_axis.title())}</text>"
    )
    points = list(zip(front.designs, *columns, strict=True))
    if len(front.frame.objectives) == 2:
        parts.append(_staircase(front, pair, points, place))
    for design, x, y in reversed(points):  # the best ranks on top
        parts.append(_point(design, *place(x, y), f"{_said(x_axis, x)}, {_said(y_axis, y)}", chosen, linked))
    if len(points) <= LABELLED:
        for design, x, y in points:
            px, py = place(x, y)
            parts.append(_text(px + 9, py - 8, f"#{design.rank}", "start"))
    return "".join(parts)


def _said(axis: Axis, value: float) -> str:
    return f"{axis.name} {significant(value)} {unit_text(axis.unit)}".strip()


def _line(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="grid" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#e3e8ed"/>'


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text class="ink" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _staircase(
    front: ParetoFront, pair: tuple[str, str], points: Sequence[tuple[Design, float, float]], place: Place
) -> str:
    """Return the border of what the designs dominate: what lies on its good side no design reaches."""
    signs = [1 if front.frame.objectives[name] == "min" else -1 for name in pair]
    ordered = sorted(points, key=lambda p: signs[0] * p[1])
    path: list[str] = []
    for k, (_, x, y) in enumerate(ordered):
        if k:
            corner = place(x, ordered[k - 1][2])
            path.append(f"L{corner[0]:.1f} {corner[1]:.1f}")
        px, py = place(x, y)
        path.append(f"{'L' if k else 'M'}{px:.1f} {py:.1f}")
    return f'<path class="stairs" d="{"".join(path)}" fill="none" stroke="#8ba3bb" stroke-dasharray="5 4"/>'


def _point(design: Design, x: float, y: float, said: str, chosen: Sequence[int], linked: bool) -> str:
    full, knee = design.rank in chosen, "knee" in design.note
    words = f"#{design.rank}: {said}" + (" (knee)" if knee else "")
    fill = "#0b5cad" if full else "#ffffff"
    ring = f'<circle class="knee" cx="{x:.1f}" cy="{y:.1f}" r="10" fill="none" stroke="#b3541e" stroke-width="1.6"/>'
    dot = (
        f'<circle class="{"dot" if full else "hollow"}" cx="{x:.1f}" cy="{y:.1f}" r="5.5" fill="{fill}" '
        f'stroke="#0b5cad" stroke-width="1.6"/>'
    )
    drawn = f"<title>{escape(words)}</title>{ring if knee else ''}{dot}"
    if linked:
        return f'<a href="#design-{design.rank}">{drawn}</a>'
    return f"<g>{drawn}</g>"


def front_in_words(front: ParetoFront) -> str:
    """Return what the drawing shows, for people who do not see it."""
    told = []
    for name, sense in front.frame.objectives.items():
        unit = front.frame.units[name]
        values = [float(from_si(d.objectives[name], unit)) for d in front.designs]
        best, worst = (min(values), max(values)) if sense == "min" else (max(values), min(values))
        told.append(f"{name} from {significant(best)} to {significant(worst)} {unit_text(unit)}".strip())
    return f"{len(front.designs)} designs: {'; '.join(told)}"
