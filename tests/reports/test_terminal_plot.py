"""The front on a terminal: within its width, every point in the field, names where there is room, texts harmless."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from rich.cells import cell_len
from rich.console import Console
from synth.reports.front_plot import Drawn
from synth.reports.label_spots import Box, label_spots
from synth.reports.terminal_plot import ASCII_GLYPHS, BRAILLE_GLYPHS, Canvas, plot_lines, print_plot

import synth
from tests.analysis.test_calculation import Beam

MIN2 = {"width": "min", "height": "min"}


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Beam, {"mass_carried": "100 kg"}, objectives=MIN2, points=12)


def designs_at(front, points, notes=()):
    """Return designs that lie where a test wants them, in mm."""
    first = front.designs[0]
    notes = [*notes, *[""] * (len(points) - len(notes))]
    return [
        replace(first, rank=k, note=note, objectives={"width": x / 1000, "height": y / 1000})
        for k, ((x, y), note) in enumerate(zip(points, notes, strict=True), start=1)
    ]


def shown(designs, objectives=MIN2, width=80, encoding="utf-8", **how):
    """Return what a console of this width and encoding shows."""
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors="replace", newline="\n")
    print_plot(designs, objectives, Console(file=stream, width=width, markup=False, highlight=False), **how)
    stream.flush()
    return stream.buffer.getvalue().decode(encoding)


def field_of(text):
    """Return the rows of the field, without the axis."""
    return [
        re.split("[│┤|]|(?<=[0-9 ])[+]", line, maxsplit=1)[1]
        for line in text.splitlines()
        if re.match(r" *[0-9. ]* [│┤|+]", line)
    ]


@pytest.mark.parametrize("width", [25, 40, 80, 160])
@pytest.mark.parametrize("signs", [BRAILLE_GLYPHS, ASCII_GLYPHS])
def test_it_fits_its_width(front, width, signs):
    lines = plot_lines(Drawn(front.designs, MIN2), width, signs)
    assert max(line.cell_len for line in lines) <= width
    assert len(lines) > 13
    assert max(len(line) for line in shown(front.designs, width=width).splitlines()) <= min(width, 100)


def test_where_there_is_no_room_it_says_so(front):
    assert shown(front.designs, width=15).split() == "no plot: it needs wider lines".split()


def test_plain_characters_where_the_encoding_has_no_braille(front):
    for encoding in ("ascii", "latin-1", "cp437"):
        text = shown(front.designs, encoding=encoding)
        assert "?" not in text
        assert sum(row.count("o") for row in field_of(text)) == len(front.designs)
        assert not re.search("[⠀-⣿│┤]", text)
    assert re.search("[⠁-⣿]", shown(front.designs))
    assert "o" not in "".join(field_of(shown(front.designs)))


@pytest.mark.parametrize("fine", [BRAILLE_GLYPHS, ASCII_GLYPHS])
def test_the_outermost_points_lie_in_the_outermost_cells(fine):
    canvas = Canvas(30, 16, fine)
    assert canvas.cell(*canvas.place(0, 1)) == (0, 0)
    assert canvas.cell(*canvas.place(1, 0)) == (29, 15)
    assert canvas.cell(*canvas.place(0.5, 0.5)) in {(14, 7), (14, 8), (15, 7), (15, 8)}
    canvas.dot(canvas.points, -1, 0)
    canvas.dot(canvas.points, 0, 10_000)
    assert not canvas.points


def test_points_stand_where_the_numbers_of_the_axes_say(front):
    text = shown(designs_at(front, [(10, 40), (20, 30), (40, 10)]), encoding="ascii")
    lines = text.splitlines()
    across = {int(x.group()): (x.start() + x.end() - 1) / 2 for x in re.finditer("[0-9]+", lines[-2])}
    up = {int(line.split("+")[0]): k for k, line in enumerate(lines) if re.match(" *[0-9]+ [+]", line)}
    for x, y in ((10, 40), (20, 30), (40, 10)):
        assert lines[up[y]].find("o", int(across[x] - 1)) - across[x] == pytest.approx(0, abs=1.5)


def test_axes_have_names_and_units_and_tell_where_more_is_better(front):
    text = shown(front.designs, {"width": "min", "height": "max"})
    assert text.splitlines()[0] == "height, more is better [mm]"
    assert text.splitlines()[-1].strip() == "width [mm]"


def test_wide_ranges_have_logarithms(front):
    text = shown(designs_at(front, [(1, 3000), (50, 50), (3000, 1)]), encoding="ascii")
    rows = [k for k, row in enumerate(field_of(text)) if "o" in row]
    assert rows[1] - rows[0] == pytest.approx(rows[2] - rows[1], abs=1)


def test_ranks_stand_beside_their_points_and_the_knee_is_named(front):
    text = shown(designs_at(front, [(20, 20), (10, 40), (40, 10)], ["knee"]), encoding="ascii")
    assert "#1 knee" in text
    for rank in ("#2", "#3"):
        assert len(re.findall(re.escape(rank), text)) == 1


def test_names_that_have_no_room_are_left_out_and_none_covers_a_point(front):
    crowd = [(10 + 0.01 * k, 40 - 0.01 * k) for k in range(18)] + [(60, 5), (5, 60)]
    text = shown(designs_at(front, crowd), encoding="ascii", width=40)
    ranks = re.findall("#[0-9]+", text)
    assert len(ranks) == len(set(ranks)) < 20
    assert {"#1", "#19", "#20"} <= set(ranks)
    assert "".join(field_of(text)).count("o") >= 3


def test_of_many_designs_those_are_named_that_are_best_in_something(front):
    many = [(k, 1000 / k) for k in range(10, 60)]
    notes = [""] * 50
    notes[20], notes[49] = "knee", "smallest height"
    text = shown(designs_at(front, many, notes))
    assert sorted(re.findall("#[0-9]+(?: knee)?", text)) == ["#1", "#21 knee", "#50"]


def test_families_have_letters(front):
    designs = designs_at(front, [(20, 20), (10, 40), (40, 10)])
    for encoding in ("utf-8", "ascii"):
        text = shown(designs, encoding=encoding, families=["disc_clutch", "cone_clutch", "disc_clutch"])
        assert text.splitlines()[-2:] == ["A: disc clutch", "B: cone clutch"]
        field = "".join(field_of(text))
        assert (field.count("A"), field.count("B")) == (2, 1)


def test_of_three_objectives_two_are_drawn_and_the_third_is_named(front):
    designs = [replace(d, objectives={**d.objectives, "area": 1.0 * d.rank}) for d in front.designs]
    designs = [replace(d, frame=replace(d.frame, units={**d.frame.units, "area": "mm2"})) for d in designs]
    text = shown(designs, {**MIN2, "area": "min"}, encoding="ascii")
    assert "drawn are the first two of 3 objectives, without area" in " ".join(text.split())
    assert "." not in "".join(field_of(text))  # two objectives do not tell what is dominated


@pytest.mark.parametrize(
    ("count", "objectives", "told"),
    [
        (0, MIN2, "there is no design"),
        (1, MIN2, "one design alone is no line"),
        (3, {"width": "min"}, "width is the only objective, and a front has two or more"),
    ],
)
def test_where_there_is_no_front_a_sentence_says_so(front, count, objectives, told):
    assert shown(front.designs[:count], objectives, width=100).strip() == f"no plot: {told}"


def test_designs_that_are_alike_are_drawn(front):
    for x in (20.0, 20.0 * (1 + 1e-15)):
        text = shown(designs_at(front, [(20, 20), (x, x)]), encoding="ascii")
        assert "o" in "".join(field_of(text))


def test_texts_of_others_do_nothing(front):
    hostile = "=1+1\x1b[2J\u202e[red]漢字漢字漢字漢字漢字漢字漢字\n\r\tx" * 3
    designs = designs_at(front, [(20, 20), (10, 40)])
    frame = replace(designs[0].frame, units={hostile: "mm", "height": "mm"})
    designs = [
        replace(d, frame=frame, objectives={hostile: d.objectives["width"], "height": d.objectives["height"]})
        for d in designs
    ]
    lines = plot_lines(Drawn(designs, {hostile: "min", "height": "min"}, [hostile, "b"]), 40, BRAILLE_GLYPHS)
    text = "\n".join(line.plain for line in lines)
    assert not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]", text)
    assert all(cell_len(line) <= 40 for line in text.split("\n"))
    assert r"\x1b" in text


def test_spots_keep_clear_of_points_names_lines_and_edges():
    field = Box(0, 0, 12, 5)
    points = [Box(5, 2, 6, 3), Box(11, 0, 12, 1)]
    line = [Box(6, 1, 12, 2)]
    first, second = label_spots(points, [(2, 1), (3, 1)], field, line, integer=True)
    assert first is not None
    assert second is not None
    assert field.holds(first)
    assert field.holds(second)
    assert not first.meets(line[0])
    assert not any(second.meets(box) for box in (*points, first))
    assert label_spots(points, [(20, 1), None], field, integer=True) == [None, None]
