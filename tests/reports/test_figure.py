"""Frames as figures: what stands in ``attrs`` is in the drawing, readable, the same bytes each time."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from itertools import combinations
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.style import context
from matplotlib.text import Text
from synth.reports.figure import STYLE, figure_png, figure_svg, make_figure

import synth
from synth.errors import InputError
from tests.sample_problems.ropes import Ropes, ropes
from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]


def sample(**attrs: Any) -> pd.DataFrame:
    time = np.linspace(0.0, 4.0, 50)
    frame = pd.DataFrame(
        {
            "time [s]": time,
            "driver_speed [1/min]": 250 + 0 * time,
            "driven_speed [1/min]": 60 * time,
            "friction_work [J]": 9000 * time,
            "acceleration [rad/s2]": 1 + time,
        }
    )
    frame.attrs = {
        "title": "A sample",
        "panels": [
            {"label": "speed [1/min]", "columns": ["driver_speed [1/min]", "driven_speed [1/min]"]},
            {"label": "friction_work [J]", "columns": ["friction_work [J]"]},
            {"label": "acceleration [rad/s2]", "columns": ["acceleration [rad/s2]"], "log": True, "points": True},
        ],
        "marks": [{"x": 1.0, "label": "ramp ends"}, {"x": 1.2, "label": "lock-up"}],
        "spans": [{"from": 0.0, "to": 1.0, "label": "ramp"}, {"from": 1.0, "to": 4.0, "label": "locked"}],
        "lines": [{"panel": 0, "y": 200.0, "label": "limit of speed"}],
        "source": "Nothing but an example.",
        **attrs,
    }
    return frame


def written(svg: str) -> list[str]:
    """Return the texts of a drawing; matplotlib names each one in a comment before its outlines."""
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    return [(node.text or "").strip() for node in ET.fromstring(svg, parser).iter() if node.tag is ET.Comment]


def drawn(frame: pd.DataFrame) -> tuple[Figure, list[tuple[str, Any]]]:
    """Return a figure and every visible text with its place on the canvas."""
    with context(["default", STYLE]):
        figure = make_figure(frame)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        hidden = {label for axis in figure.axes for label in beyond(axis.xaxis) | beyond(axis.yaxis)}
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text() and t not in hidden]
        return figure, [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in shown]


def beyond(axis: Axis) -> set[Text]:
    """Return the labels of ticks beyond the ends of an axis: matplotlib keeps them and does not draw them."""
    low, high = sorted(axis.get_view_interval())
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    return {x for t in ticks if not low <= t.get_loc() <= high for x in (t.label1, t.label2)}


def assert_readable(frame: pd.DataFrame) -> None:
    """No text leaves the page or covers another."""
    figure, texts = drawn(frame)
    assert len(texts) > 2
    for text, box in texts:
        assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1, text
        assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1, text
    for (one, first), (other, second) in combinations(texts, 2):
        apart = first.x1 <= second.x0 or second.x1 <= first.x0 or first.y1 <= second.y0 or second.y1 <= first.y0
        assert apart, (one, other)


def test_everything_that_was_asked_for_is_written() -> None:
    texts = written(figure_svg(sample()))
    for text in (
        "A sample",
        "time [s]",
        "speed [1/min]",
        "friction work [kJ]",
        "acceleration [rad/s²]",
        "driver",
        "driven",
        "ramp ends",
        "lock-up",
        "ramp",
        "locked",
        "limit of speed",
        "Nothing but an example.",
    ):
        assert text in texts, text


def test_nothing_leaves_the_page_or_covers_anything_else() -> None:
    assert_readable(sample())
    crowd = [{"x": 1 + 0.05 * k, "label": f"event number {k}"} for k in range(6)]
    limits = [{"panel": 0, "y": 240.0 + k, "label": f"limit {k} with a long name that is broken"} for k in range(3)]
    assert_readable(sample(marks=crowd, lines=limits, title="A title " * 15, source="A long source. " * 20))
    assert_readable(sample(marks=[], spans=[], source="", panels=sample().attrs["panels"][:1]))


@pytest.mark.slow
@pytest.mark.parametrize("motor", [None, "IEC4P-15kW"])
def test_the_figures_of_a_design_can_be_read(motor: str | None) -> None:
    design = yaml.safe_load((ROOT / "examples" / "lecture_design.yaml").read_text())
    problem = synth.load(design["family"], **design["options"])
    settings = {} if motor is None else {"motor": motor}
    frames = synth.simulate(problem, design["requirements"], design, settings=settings)
    frames |= synth.curves(problem, design["requirements"], design)
    assert list(frames) == ["startup", "temperature", "torque_over_plates", "startup_over_torque", "force_along_pack"]
    for frame in frames.values():
        assert_readable(frame)
    for frame in synth.curves(problem, design["requirements"]).values():
        assert_readable(frame)


@pytest.mark.slow
@pytest.mark.parametrize("vary", [{"load": "20, 40, 120 kN"}, {"load": "20, 40 kN", "share": "1, 2.5, 3"}])
def test_the_figures_of_a_study_can_be_read(vary: dict[str, str]) -> None:
    problem, table = Ropes(thick="given"), ropes((10, 2), (20, 1), (35, 0.5), most=[20, 60, 60])
    study = synth.whatif(problem, {"load": "20 kN"}, vary, {"cost": "min", "bulk": "min"}, 6, catalogs=table)
    frames = study.curves()
    assert list(frames) == ["whatif", "fronts"]
    for frame in frames.values():
        assert_readable(frame)
    panels = make_figure(frames["whatif"]).axes
    first, second = ([(line.get_label(), line.get_color()) for line in axis.get_lines()] for axis in panels)
    named = [pair for pair in first if not str(pair[0]).startswith("_")]
    assert len(named) == 3
    assert named == [pair for pair in second if not str(pair[0]).startswith("_")]


def words(labels: list[str]) -> pd.DataFrame:
    places = np.arange(1.0, len(labels) + 1)
    frame = pd.DataFrame({"kind [-]": places, "mass [kg]": places**2})
    frame.attrs = {
        "title": "Words",
        "source": "Nothing but an example.",
        "panels": [{"label": "mass [kg]", "columns": ["mass [kg]"], "apart": True}],
        "ticks": [{"x": x, "label": label} for x, label in zip(places, labels, strict=True)],
    }
    return frame


@pytest.mark.parametrize(
    ("labels", "rotation", "first"),
    [
        (["none", "+-10 %", "catalogue range"], 0, "none"),
        (["metal_ceramic_bronze_dry", "moulded_dry", "paper_wet", "cork_wet"], 0, "metal_\nceramic_\nbronze_dry"),
        ([f"designation-{k}" for k in range(20)], 90, "designation-0"),
        (["a_lining_with_a_very_long_name_indeed", *"bcdefgh"], 90, "a_lining_with_a_\nvery_long_name_indeed"),
        (["mu >= 0.12 and p_allow >= 0.5", *"bcdefghi"], 90, "mu >= 0.12 and p_allow\n>= 0.5"),
    ],
)
def test_words_stand_along_the_axis(labels: list[str], rotation: int, first: str) -> None:
    frame = words(labels)
    assert_readable(frame)
    figure, _ = drawn(frame)
    axis = figure.axes[0].xaxis
    assert [t.get_rotation() for t in axis.get_ticklabels()] == [rotation] * len(labels)
    assert axis.get_ticklabels()[0].get_text() == first
    (line,) = figure.axes[0].get_lines()
    assert (line.get_linestyle(), line.get_marker()) == ("None", "o")


def test_a_study_of_words_names_them_and_joins_nothing() -> None:
    problem, table = Ropes(thick="given"), ropes((10, 2), (20, 1), (35, 0.5), most=[20, 60, 60])
    vary = {"parts.rope": "rope a, rope b", "options.thick": "given, makeable"}
    study = synth.whatif(problem, {"load": "20 kN"}, vary, {"cost": "min"}, 1, catalogs=table)
    (frame,) = study.curves().values()
    assert_readable(frame)
    assert [tick["label"] for tick in frame.attrs["ticks"]] == ["rope a", "rope b"]
    (panel,) = frame.attrs["panels"]
    assert panel["apart"]
    # A line per option, each with what is best of either rope.
    cost = [f.designs[0].values["cost"] if f.designs else np.nan for f in study.fronts]
    assert frame[panel["columns"]].to_numpy().T == pytest.approx(np.array([cost[::2], cost[1::2]]), nan_ok=True)
    assert "cost over rope, by thick" in frame.attrs["title"]


def test_a_frame_with_a_title_only_gets_a_panel_per_unit() -> None:
    frame = sample()
    frame.attrs = {"title": "Plain"}
    figure, _ = drawn(frame)
    labels = [" ".join(axis.get_ylabel().split()) for axis in figure.axes]
    assert labels == ["speed [1/min]", "friction work [kJ]", "acceleration [rad/s²]"]
    assert_readable(frame)


def test_lines_are_drawn_in_row_order_and_broken_by_nothing() -> None:
    frame = pd.DataFrame({"x [mm]": [0.0, 2.0, 1.0, np.nan, 3.0], "y [N]": [1.0, 2.0, np.nan, 4.0, 5.0]})
    frame.attrs = {"title": "Loop"}
    (axis,) = make_figure(frame).axes
    (line,) = axis.get_lines()
    np.testing.assert_array_equal(line.get_xdata(), frame["x [mm]"])
    np.testing.assert_array_equal(line.get_ydata(), frame["y [N]"])
    ET.fromstring(figure_svg(frame))


def test_axes_are_logarithmic_points_marked_and_panels_high_where_asked() -> None:
    panels = sample().attrs["panels"]
    figure = make_figure(sample(panels=[{**panels[0], "height": 2}, *panels[1:]]))
    assert [axis.get_yscale() for axis in figure.axes] == ["linear", "linear", "log"]
    assert [axis.get_lines()[0].get_marker() != "" for axis in figure.axes] == [False, False, True]
    heights = [axis.get_position().height for axis in figure.axes]
    assert heights[0] > 1.8 * heights[1]


@pytest.mark.parametrize(("stairs", "style"), [("post", "steps-post"), ("pre", "steps-pre"), (None, "default")])
def test_values_hold_up_to_the_next_row_where_asked(stairs: str | None, style: str) -> None:
    first, *rest = sample().attrs["panels"]
    axes = make_figure(sample(panels=[{**first, "stairs": stairs}, *rest])).axes
    assert [axis.get_lines()[0].get_drawstyle() for axis in axes] == [style, "default", "default"]


def test_spans_are_shaded_in_turn_or_where_asked() -> None:
    ends = [{"from": float(k), "to": k + 1.0} for k in range(3)]
    for spans, shaded in (
        (ends, [1.0]),
        ([{**span, "shaded": True} for span in ends], [0.0, 1.0, 2.0]),
        ([{**ends[0], "shaded": True}, {**ends[1], "shaded": False}], [0.0]),
    ):
        (axis,) = make_figure(sample(spans=spans, panels=sample().attrs["panels"][:1])).axes
        assert [patch.get_extents().transformed(axis.transData.inverted()).x0 for patch in axis.patches] == (
            pytest.approx(shaded)
        )


def test_the_same_name_is_the_same_line_in_every_panel() -> None:
    frame = sample()
    frame["driven_power [W]"] = frame["time [s]"]
    panels = [frame.attrs["panels"][0], {"label": "power [W]", "columns": ["driven_power [W]"]}]
    frame.attrs["panels"] = panels
    speed, power = make_figure(frame).axes
    # the dashed line at the end is the horizontal one
    driver, driven = speed.get_lines()[:2]
    assert power.get_lines()[0].get_color() == driven.get_color() != driver.get_color()
    assert driver.get_linestyle() != driven.get_linestyle()  # told apart in print without colour


@pytest.mark.parametrize(
    ("largest", "label", "drawn_as"), [(9999.0, "work [J]", 9999.0), (1e4, "work [kJ]", 10.0), (5e7, "work [kJ]", 5e4)]
)
def test_thousands_become_kilo(largest: float, label: str, drawn_as: float) -> None:
    frame = pd.DataFrame({"t [s]": [0.0, 1.0], "work [J]": [0.0, largest]})
    frame.attrs = {"title": "W"}
    (axis,) = make_figure(frame).axes
    assert axis.get_ylabel() == label
    assert axis.get_lines()[0].get_ydata()[-1] == pytest.approx(drawn_as)


def test_a_column_that_is_not_there_is_named() -> None:
    with pytest.raises(InputError, match="got 'force \\[N\\]'; expected a column of the frame: time"):
        figure_svg(sample(x="force [N]"))
    with pytest.raises(InputError, match="'torque"):
        figure_svg(sample(panels=[{"label": "torque [N*m]", "columns": ["torque [N*m]"]}]))


@pytest.mark.slow
def test_the_drawing_depends_on_the_frame_alone() -> None:
    svg = figure_svg(sample())
    with mpl.rc_context({"font.size": 30, "lines.linewidth": 9, "svg.fonttype": "none"}):
        assert figure_svg(sample()) == svg
    assert mpl.rcParams["svg.hashsalt"] is None  # and leaves the settings of others alone
    program = (
        "import sys\nfrom tests.reports.test_figure import sample\nfrom synth.reports.figure import figure_svg\n"
        "sys.stdout.buffer.write(figure_svg(sample()).encode())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        cwd=ROOT,
        timeout=PATIENCE,
        check=True,
        env={**os.environ, "PYTHONHASHSEED": "1"},
    )
    assert done.stdout.decode() == svg
    assert "<dc:date>" not in svg
    assert ET.fromstring(svg).tag.endswith("svg")


def test_png_has_the_same_size_on_paper() -> None:
    picture = imread(io.BytesIO(figure_png(sample(), resolution=100)))
    page = ET.fromstring(figure_svg(sample()))
    width, height = (float(page.get(name, "").removesuffix("pt")) for name in ("width", "height"))
    assert picture.shape[1] == pytest.approx(width / 72 * 100, abs=1)
    assert picture.shape[0] == pytest.approx(height / 72 * 100, abs=1)
    assert width <= 7.2 * 72  # fits the text width of an A4 page


def test_a_legend_that_says_the_same_stands_once_and_has_room() -> None:
    frame = pd.DataFrame({"load [kN]": [1.0, 2.0]})
    groups = [f"robust.friction = +-{k} % in each lining" for k in range(7)]
    panels = []
    for name, unit in (("mass", "kg"), ("actuation_force", "N")):
        columns = [f"{group}: best {name} [{unit}]" for group in groups]
        for k, column in enumerate(columns):
            frame[column] = [k, k + 1.0]
        panels.append({"label": f"{name} [{unit}]", "columns": columns, "points": True})
    frame.attrs = {"title": "Many lines", "panels": panels}
    assert_readable(frame)
    upper, lower = make_figure(frame).axes
    assert upper.get_legend() is not None
    assert lower.get_legend() is None
    # Another name, and it is told.
    panels[1]["columns"] = panels[1]["columns"][:6]
    assert make_figure(frame).axes[1].get_legend() is not None


def test_whole_numbers_without_a_unit_are_counted() -> None:
    frame = pd.DataFrame({"step [-]": np.arange(1.0, 23), "mass [kg]": np.arange(22.0)})
    frame.attrs = {"title": "Steps"}
    (axis,) = make_figure(frame).axes
    assert all(float(place).is_integer() for place in axis.get_xticks())


def test_notes_stand_below_the_panels_each_beside_its_number() -> None:
    long = (
        "best mass: friction pair a \u2192 b, inner plate core 2.5 \u2192 core 2, outer plate core 2.5 \u2192 core 2, "
    )
    long += "friction surfaces 6 \u2192 10"
    notes = [f"{k}\t{10 * k} mm, {long}" for k in range(8, 12)]
    frame = sample(notes=notes)
    assert_readable(frame)
    texts = [text for text, _ in drawn(frame)[1]]
    first = [text.split()[0] for text in texts if "best mass" in text]
    assert first == ["11", "10", "9", "8"]  # from below
    assert len({text.index("mm") for text in texts if "best mass" in text}) == 2  # 80 and 90, 100 and 110


@pytest.mark.slow
def test_a_study_says_what_it_does_not_draw() -> None:
    problem, table = Ropes(thick="given"), ropes((10, 2), (20, 1), (35, 0.5), most=[20, 60, 60])
    loads = ", ".join(f"{10 + k}" for k in range(9)) + ", 300 kN"
    study = synth.whatif(
        problem,
        {"load": "20 kN"},
        {"share": "1, 2", "load": loads},
        {"cost": "min", "bulk": "min"},
        3,
        catalogs=table,
        breaks=False,
    )
    frames = study.curves()
    assert "5 of 9 lines drawn" in frames["whatif"].attrs["source"]
    assert "no design: load 300 kN" in frames["whatif"].attrs["source"]
    assert " fronts drawn" in frames["fronts"].attrs["source"]
    for frame in frames.values():
        assert_readable(frame)
