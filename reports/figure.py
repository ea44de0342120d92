"""A frame of a family's hooks as a figure: what to draw stands in ``frame.attrs``, nothing is computed again.

The keys of ``attrs``, all optional but the title: ``title``, ``x`` (column, by default the first), ``panels`` (each
with ``label``, ``columns``, ``log``, ``points``, ``apart`` where points are not joined, ``stairs``: ``post`` or ``pre``
as values hold up to the next row or from the row before, ``height`` over that of an ordinary panel), ``ticks`` (words
along the horizontal axis: ``x``, ``label``), ``marks`` (vertical lines: ``x``, ``label``), ``spans`` (``from``, ``to``,
``label``, ``shaded``: by default every second one), ``lines`` (horizontal lines: ``panel``, ``y``, ``label``),
``notes`` (lines below the panels: what the labels of marks stand for), ``source`` (footer).
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.style import context
from matplotlib.ticker import LogFormatter, MaxNLocator, ScalarFormatter

from synth.errors import InputError
from synth.units import split_header, unit_text

# The colours of M. Okabe and K. Ito, told apart by the colour-blind; each has a dash of its own, for print without.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 2)),
    (0, (2, 1.2)),
    (0, (6, 1.5, 1.5, 1.5)),
    "-",
    (0, (9, 2, 2, 2)),
    (0, (3, 1)),
)
LEGEND_LETTERS = 21  # of a line beside the panels
LEGEND_ROW, LEGEND_LINE = 0.165, 0.125  # inches of a name in a legend, and of each further line of it
JOINT = re.compile(r"(?<=[0-9]) (?=[^0-9\s])")  # between a number and its unit no line is broken
NAME_SHIFT = 0.03  # inches by which the name of a line may stand below it
STAIRS = {None: "default", "post": "steps-post", "pre": "steps-pre"}
MARKERS = ("o", "s", "^", "D", "x", "v", "+")
STYLE: dict[str, Any] = {
    "font.family": ["DejaVu Sans"],  # comes with matplotlib, so that the figure is the same everywhere
    "font.size": 8.5,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "legend.handlelength": 2.6,
    "svg.fonttype": "path",
    "svg.hashsalt": "clutchsynth",
}
WIDTH, ONE, MORE = 7.1, 3.9, 1.62  # inches: the text width of an A4 page, one panel, each of several
PREFIXED = ("W", "J", "N", "N*m", "Pa")
ROW = 0.155  # inches between two rows of labels above the panels
LETTER = 0.066  # inches, width of a letter of such a label
NOTE_ROW, NOTE_LETTERS = 0.155, 108  # inches between two lines below the panels, and letters on one
TICK_LETTER, TICK_ROW = 0.072, 0.14  # inches, of words along the horizontal axis
MOST_TICK_ROWS, UPRIGHT_LETTERS = 4, 24


def figure_svg(frame: pd.DataFrame) -> str:
    """Draw a frame as SVG; the same frame gives the same bytes.

    Parameters
    ----------
    frame : pandas.DataFrame
        Columns ``name [unit]``, and ``attrs`` that tell how to draw them.

    Returns
    -------
    str
        The SVG document.

    Raises
    ------
    InputError
        When ``attrs`` names a column that is not there.
    """
    with context(["default", STYLE]):
        figure = make_figure(frame)
        FigureCanvasSVG(figure)
        buffer = io.StringIO()
        metadata = {"Date": None, "Creator": "clutchsynth", "Title": str(frame.attrs.get("title", ""))}
        figure.savefig(buffer, format="svg", metadata=metadata)
    return buffer.getvalue()


def figure_png(frame: pd.DataFrame, resolution: int = 150) -> bytes:
    """Draw a frame as PNG.

    Parameters
    ----------
    frame : pandas.DataFrame
        As for :func:`figure_svg`.
    resolution : int
        Dots per inch.

    Returns
    -------
    bytes
        The picture.
    """
    with context(["default", STYLE]):
        figure = make_figure(frame)
        FigureCanvasAgg(figure)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=resolution, metadata={"Software": "clutchsynth"})
    return buffer.getvalue()


def make_figure(frame: pd.DataFrame) -> Figure:
    """Return the figure of a frame, its panels one below the other over a common horizontal axis.

    Parameters
    ----------
    frame : pandas.DataFrame
        As for :func:`figure_svg`.
    """
    attrs = frame.attrs
    x = _column(frame, attrs.get("x", frame.columns[0]))
    panels = attrs.get("panels") or _panels_by_unit(frame, x)
    marks, spans, ticks = (list(attrs.get(key, ())) for key in ("marks", "spans", "ticks"))
    limits = _limits(float(frame[x].min()), float(frame[x].max()), spans)

    left, right, bottom = 0.78, 1.75, 0.5
    axis_width = WIDTH - left - right
    words, rotation, tick_height = _tick_words(ticks, axis_width)
    bottom += tick_height
    strips = _label_rows(spans, marks, limits, axis_width)
    title = textwrap.wrap(str(attrs.get("title", "")), 76)
    footer = textwrap.wrap(str(attrs.get("source", "")), 115)
    notes = _notes([str(note) for note in attrs.get("notes", ())])
    foot = 0.06 + 0.15 * len(footer)
    bottom += foot - 0.06 + NOTE_ROW * len(notes) + 0.06 * bool(notes)
    top = 0.16 + 0.19 * len(title) + ROW * (1 + max((row for _, _, row, _ in strips), default=-1))
    gap = 0.21
    heights = [float(panel.get("height", 1)) * (MORE if len(panels) > 1 else ONE - top / 2) for panel in panels]
    height = top + bottom + sum(heights) - gap

    figure = Figure(figsize=(WIDTH, height))
    axes: list[Axes] = []
    styles: dict[str, int] = {}  # the same name, the same line in every panel
    above: list[str] = []  # the names of the panel above
    for k, panel in enumerate(panels):
        base = height - top - sum(heights[: k + 1]) + gap
        place = (left / WIDTH, base / height, axis_width / WIDTH, (heights[k] - gap) / height)
        axis = figure.add_axes(place, sharex=axes[0] if axes else None)
        axes.append(axis)
        lines = [line for line in attrs.get("lines", ()) if int(line.get("panel", 0)) == k]
        above = _draw_panel(axis, frame, x, panel, lines, styles, above)
        _draw_spans(axis, spans, marks)
        if k + 1 < len(panels):
            axis.tick_params(labelbottom=False)
    if x.endswith("[-]") and (frame[x] % 1 == 0).all():
        axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    if ticks:
        axes[-1].set_xticks([float(tick["x"]) for tick in ticks], labels=words, rotation=rotation)
    axes[0].set_xlim(*limits)
    axes[-1].set_xlabel(_label(x))
    figure.align_ylabels(axes)
    for position, text, row, colour in strips:
        figure.text(
            (left + axis_width * (position - limits[0]) / (limits[1] - limits[0])) / WIDTH,
            1 - (top - 0.05 - ROW * row) / height,
            text,
            ha="center",
            va="bottom",
            fontsize=7.5,
            color=colour,
        )
    for k, text in enumerate(title):
        figure.text(left / WIDTH, 1 - (0.1 + 0.19 * k) / height, text, ha="left", va="top", fontsize=10, weight="bold")
    for k, text in enumerate(reversed(notes)):
        below = (foot + 0.06 + NOTE_ROW * k) / height
        figure.text(left / WIDTH, below, text, ha="left", va="bottom", fontsize=7.5, color="#222222")
    for k, text in enumerate(reversed(footer)):
        figure.text(left / WIDTH, (0.06 + 0.15 * k) / height, text, ha="left", va="bottom", fontsize=7, color="#555555")
    return figure


def _tick_words(ticks: Sequence[Mapping[str, Any]], axis_width: float) -> tuple[list[str], int, float]:
    """Return the words at ticks, their rotation, and the inches that they need beyond those of numbers."""
    if not ticks:
        return [], 0, 0.0
    letters = max(int(axis_width / len(ticks) / TICK_LETTER) - 1, 1)
    level = [_wrapped(str(tick["label"]), letters) for tick in ticks]
    rows = max(map(len, level))
    if rows <= MOST_TICK_ROWS and max(len(line) for lines in level for line in lines) <= letters:
        return ["\n".join(lines) for lines in level], 0, TICK_ROW * (rows - 1)
    upright = [_wrapped(str(tick["label"]), UPRIGHT_LETTERS) for tick in ticks]
    longest = max(len(line) for lines in upright for line in lines)
    return ["\n".join(lines) for lines in upright], 90, TICK_LETTER * longest - TICK_ROW


def _notes(texts: Sequence[str]) -> list[str]:
    """Return the lines of notes; a number, which a tab follows, stands left of all lines of its note."""
    parts = [text.rpartition("\t") for text in texts]
    digits = max((len(number) for number, _, _ in parts), default=0)
    lines = []
    for number, tab, note in parts:
        prefix = number.ljust(digits + 2) if tab else ""
        for k, line in enumerate(textwrap.wrap(JOINT.sub("\u00a0", note), NOTE_LETTERS)):
            lines.append((" " * len(prefix) if k else prefix).replace(" ", "\u2007") + line)  # as wide as a digit
    return lines


def _wrapped(text: str, letters: int) -> list[str]:
    """Return the lines of a text, which may be broken after underscores."""
    lines = textwrap.wrap(text.replace("_", "_ "), letters, break_long_words=False)
    return [line.replace("_ ", "_") for line in lines]


def _limits(low: float, high: float, spans: Sequence[Mapping[str, Any]]) -> tuple[float, float]:
    """Return the ends of the horizontal axis: a little beyond the data, but where a span reaches them."""
    if high <= low:
        return low - 0.5, high + 0.5
    margin, near = 0.02 * (high - low), 1e-6 * (high - low)
    begins = any(float(span["from"]) <= low + near for span in spans)
    ends = any(float(span["to"]) >= high - near for span in spans)
    return low - (0.0 if begins else margin), high + (0.0 if ends else margin)


def _column(frame: pd.DataFrame, name: str) -> str:
    if name not in frame.columns:
        raise InputError("frame.attrs", name, "a column of the frame: " + ", ".join(map(str, frame.columns)))
    return name


def _panels_by_unit(frame: pd.DataFrame, x: str) -> list[dict[str, Any]]:
    """Return one panel per unit, for a frame that names none."""
    groups: dict[str, list[str]] = {}
    for column in frame.columns:
        if column != x:
            groups.setdefault(split_header(str(column))[1] or "-", []).append(str(column))
    return [{"label": _common_label(columns, unit), "columns": columns} for unit, columns in groups.items()]


def _common_label(columns: Sequence[str], unit: str) -> str:
    """Name an axis by the last word that its columns share: driver_speed and driven_speed give speed."""
    last = {split_header(column)[0].split("_")[-1] for column in columns}
    return columns[0] if len(columns) == 1 else f"{last.pop() if len(last) == 1 else 'value'} [{unit}]"


def _label(header: str) -> str:
    """Write ``driver_speed [1/min]`` as people do."""
    name, unit = split_header(header)
    return name.replace("_", " ") + _unit_text(unit or "-")


def _unit_text(unit: str) -> str:
    return f" [{unit_text(unit)}]" if unit_text(unit) else ""


# ---- one panel ------------------------------------------------------------------------------------------------------


def _draw_panel(
    axis: Axes,
    frame: pd.DataFrame,
    x: str,
    panel: Mapping[str, Any],
    lines: Sequence[Mapping[str, Any]],
    styles: dict[str, int],
    above: Sequence[str],
) -> list[str]:
    """Draw a panel; return what its lines are called. ``above`` are the names in the panel above."""
    columns = [_column(frame, name) for name in panel["columns"]]
    name, unit = split_header(str(panel.get("label", columns[0])))
    names = [_legend(column, name) for column in columns]
    logarithmic, apart = bool(panel.get("log", False)), bool(panel.get("apart", False))
    factor, unit = _prefix(frame, columns, unit or "-", lines, logarithmic)
    # A single line whose name stands at the axis already needs no legend.
    named = len(columns) > 1 or not name.replace("_", " ").startswith(names[0])
    rows = [textwrap.fill(JOINT.sub("\u00a0", called), LEGEND_LETTERS) for called in names]
    for column, called, row in zip(columns, names, rows, strict=True):
        k = styles.setdefault(called, len(styles)) if named else 0
        axis.plot(
            frame[x].to_numpy(),
            frame[column].to_numpy(dtype=float) * factor,
            color=COLOURS[k % len(COLOURS)],
            linestyle="" if apart else DASHES[k % len(DASHES)],
            marker=MARKERS[k % len(MARKERS)] if apart or panel.get("points") else "",
            drawstyle=STAIRS[panel.get("stairs")],
            markersize=4.5 if apart else 3.5,
            label=row,
            zorder=3 - 0.01 * k,  # what is named first lies on top where two lines coincide
        )
    for line in lines:
        axis.axhline(float(line["y"]) * factor, color="#444444", linewidth=0.9, linestyle=(0, (4, 2)), zorder=2)
    axis.set_ylabel(textwrap.fill(name.replace("_", " "), 16) + _unit_text(unit))
    _number_axis(axis, logarithmic)
    # A legend that says the same as the one above, which may be long, is left out.
    if named and (names != above or lines):
        axis.legend(loc="upper left", bbox_to_anchor=(1.01, 1.03), borderaxespad=0.0, labelspacing=0.35)
    _name_lines(axis, lines, factor, sum(LEGEND_ROW + LEGEND_LINE * row.count("\n") for row in rows) if named else 0.0)
    return names


def _number_axis(axis: Axes, logarithmic: bool) -> None:
    """Write the numbers of a vertical axis as people do."""
    if logarithmic:
        axis.set_yscale("log")
        axis.yaxis.set_major_formatter(LogFormatter())  # plain numbers, not powers of ten
        axis.yaxis.set_minor_formatter(LogFormatter(minor_thresholds=(1.5, 0.5)))
    else:
        formatter = ScalarFormatter(useOffset=False)
        formatter.set_powerlimits((-4, 6))
        axis.yaxis.set_major_formatter(formatter)
        axis.margins(y=0.08)


def _legend(column: str, panel: str) -> str:
    """Name a line, without the words that stand at its axis already."""
    name, shared = (text.replace("_", " ") for text in (split_header(column)[0], panel))
    return name.removeprefix(f"{shared} ").removesuffix(f" {shared}")


def _prefix(
    frame: pd.DataFrame, columns: Sequence[str], unit: str, lines: Sequence[Mapping[str, Any]], logarithmic: bool
) -> tuple[float, str]:
    """Return factor and unit of an axis: thousands become kilo."""
    if unit not in PREFIXED or logarithmic:
        return 1.0, unit
    values = [float(frame[column].abs().max()) for column in columns] + [abs(float(line["y"])) for line in lines]
    return (1e-3, f"k{unit}") if max(values) >= 1e4 else (1.0, unit)


def _name_lines(axis: Axes, lines: Sequence[Mapping[str, Any]], factor: float, legend: float) -> None:
    """Name horizontal lines at the right of the panel, below the legend (inches) and none on top of another.

    A name that had to give way is joined to its line.
    """
    height = axis.get_position().height * axis.get_figure(root=True).get_figheight()  # type: ignore[union-attr]
    transform = axis.yaxis.get_transform()
    bottom, top = transform.transform(list(axis.get_ylim()))
    ceiling = height - legend + 0.03
    for line in sorted(lines, key=lambda line: -float(line["y"])):
        texts = textwrap.wrap(str(line.get("label", "")), 27)
        level = height * (transform.transform([float(line["y"]) * factor])[0] - bottom) / (top - bottom)
        middle = min(level, ceiling - 0.07 * len(texts))
        ceiling = middle - 0.07 * len(texts)
        axis.text(
            1.016,
            middle / height,
            "\n".join(texts),
            transform=axis.transAxes,
            va="center",
            fontsize=7.5,
            color="#333333",
        )
        if level - middle > NAME_SHIFT:
            joined = {"arrowstyle": "-", "shrinkA": 0, "shrinkB": 0, "color": "#777777", "lw": 0.6}
            axis.annotate("", (1.0, level / height), (1.014, middle / height), "axes fraction", arrowprops=joined)


def _draw_spans(axis: Axes, spans: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]]) -> None:
    for k, span in enumerate(spans):
        if span.get("shaded", k % 2):
            axis.axvspan(float(span["from"]), float(span["to"]), color="#f1f1f1", linewidth=0, zorder=0)
    for mark in marks:
        axis.axvline(float(mark["x"]), color="#777777", linewidth=0.8, linestyle=(0, (3, 2)), zorder=1)


# ---- labels above the panels ----------------------------------------------------------------------------------------


def _label_rows(
    spans: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]], limits: tuple[float, float], width: float
) -> list[tuple[float, str, int, str]]:
    """Return position, text, row and colour of the labels above the panels, so that none covers another."""
    scale = width / (limits[1] - limits[0])
    labels = [((float(s["from"]) + float(s["to"])) / 2, str(s.get("label", "")), "#666666") for s in spans]
    labels += [(float(m["x"]), str(m.get("label", "")), "#222222") for m in marks]
    occupied: list[list[tuple[float, float]]] = []
    placed = []
    first_of_marks = 0
    for k, (position, text, colour) in enumerate(labels):
        if not text or not limits[0] <= position <= limits[1]:
            continue
        if k == len(spans):
            first_of_marks = len(occupied)  # marks above the spans: two kinds, two rows
        half = LETTER * len(text) / 2 + 0.05
        reach = (scale * position - half, scale * position + half)
        row = first_of_marks
        while row < len(occupied) and any(reach[0] < b and a < reach[1] for a, b in occupied[row]):
            row += 1
        while row >= len(occupied):
            occupied.append([])
        occupied[row].append(reach)
        placed.append((position, text, row, colour))
    return placed
