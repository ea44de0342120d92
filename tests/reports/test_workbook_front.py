"""designs.xlsx: a front as values with units, its state and certificate in words, and no text that acts."""

from __future__ import annotations

import io
import sys
import time
from dataclasses import replace

import openpyxl
import pytest
from synth.reports.workbook_front import front_workbook

import synth
from synth import InputError
from synth.model.problem import DesignProblem
from synth.units import header
from tests.analysis.test_calculation import Beam

ASKED = {"mass_carried": "100 kg"}
SHEETS = ["designs", "requirements", "parts", "limits", "certificate", "sources"]


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Beam, ASKED, objectives={"width": "min", "height": "min"}, points=6)


def opened(raw):
    return openpyxl.load_workbook(io.BytesIO(raw))


def cells(book):
    return [cell for sheet in book for row in sheet.iter_rows() for cell in row if cell.value is not None]


def test_it_has_every_number_of_the_table(front):
    book = opened(front_workbook(front, synth.calculation(front)))
    assert book.sheetnames == SHEETS
    columns, rows = front.table()
    sheet = book["designs"]
    heads = [cell.value for cell in sheet[4]]
    for number, row in enumerate(rows, start=5):
        told = dict(zip(heads, (cell.value for cell in sheet[number]), strict=False))
        for column, value in zip(columns, row, strict=True):
            if isinstance(value, float) and not column.startswith("utilisation: "):
                assert told[column] == pytest.approx(value, rel=1e-12), column
    used = book["limits"]
    names = [cell.value for cell in used[3]]
    for design, row in zip(front.designs, used.iter_rows(min_row=4, values_only=True), strict=True):
        told = dict(zip(names, row, strict=False))
        assert told["stress"] == pytest.approx(design.utilisation["stress"], rel=1e-12)


def test_it_says_how_far_it_is_proven(front):
    told = {cell.value for cell in cells(opened(front_workbook(front)))}
    assert front.certificate.sentence() in told
    stopped = replace(front, interrupted="time limit")
    assert any("INTERRUPTED: time limit" in str(cell.value) for cell in cells(opened(front_workbook(stopped))))


def test_no_designs_is_told_as_well(front):
    nothing = synth.synthesize(Beam, ASKED, limits={"area": "<= 100 mm2"})
    told = " ".join(str(cell.value) for cell in cells(opened(front_workbook(nothing, synth.calculation(nothing)))))
    assert str(nothing.explanation.message)[:40] in told


@pytest.mark.parametrize("text", ["=cmd|' /C calc'!A0", "+1+1", "@SUM(1)", "<script>", "\u202eabc", "x" * 5000])
def test_texts_never_become_formulas(front, text):
    hostile = replace(front, designs=[replace(front.designs[0], note=text, alternatives=(text,))], interrupted=text)
    book = opened(front_workbook(hostile, synth.calculation(front)))
    assert all(cell.data_type != "f" for cell in cells(book))
    plain = text.replace("\u202e", "")  # what turns the direction of writing is told by its number
    assert any(plain in str(cell.value) for cell in cells(book))


def test_the_same_front_gives_the_same_bytes(front):
    calculation = synth.calculation(front)
    assert front_workbook(front, calculation) == front_workbook(front, calculation)


# -- two objectives, a table, units -------------------------------------------------------------------


class Strut(DesignProblem):
    """A strut of a metal, light or stiff."""

    name, title, sources = "strut", "=cmd()", ("any <b>textbook</b>",)

    def declare(self, d):
        force = d.requirement("force", "kN", lower=1, symbol="F", text="=1+1", source="the drive", group="duty")
        length = d.requirement("length", "mm", 500, lower=10, symbol="l", text="Length")
        d.requirement("warm", "degC", 20, symbol="T", text="Temperature")
        diameter = d.variable("diameter", "mm", 5, 200, symbol="d", text="Diameter")
        metal = d.part("metal", "metals", text="Material")
        area = d.derive("area", "mm2", 0.785398 * diameter**2, symbol="A", text="Section")
        d.derive("mass", "kg", area * length * metal.density, symbol="m", text="Mass")
        d.derive("give", "um", force * length / (metal.E * area), symbol="u", text="Compression")
        d.at_most("stress", force / area, metal.yield_Re, "N/mm2", text="Stress", source="statics")
        d.objective("mass", "min")
        d.objective("give", "min")


STRUT = {"force": "40 kN"}


@pytest.fixture(scope="module")
def struts():
    return synth.synthesize(Strut, STRUT, parts={"metal": ["S185", "42CrMo4"]}, points=4)


@pytest.fixture(scope="module")
def content(struts):
    return front_workbook(struts, synth.calculation(struts))


@pytest.fixture(scope="module")
def book(content):
    return openpyxl.load_workbook(io.BytesIO(content))


def rows_of(sheet, first):
    return [[cell.value for cell in row] for row in sheet.iter_rows(min_row=first)]


def test_limits_are_shares_with_colours_and_both_sides(struts, book):
    sheet = book["limits"]
    heads, *found = rows_of(sheet, 3)
    assert heads[:2] == ["rank", "stress"]
    assert heads[3:] == ["found: stress ≤ [N/mm2]", "allowed: stress ≤ [N/mm2]"]
    for told, design in zip(found, struts.designs, strict=True):
        assert told[:2] == [design.rank, pytest.approx(design.utilisation["stress"])]
        assert told[3] * 1e6 == pytest.approx(design.limits["stress"][0])
    kinds = [rule.type for rules in sheet.conditional_formatting for rule in rules.rules]
    assert "colorScale" in kinds


def test_parts_and_requirements_stand_in_their_units(struts, book):
    lines = rows_of(book["requirements"], 1)
    told = {line[0]: line[1:4] for line in lines}
    assert told["force"] == [40, "kN", "typed"]
    assert told["warm"] == [20, "degC", "default"]
    section, heads, *found = rows_of(book["parts"], 1)
    assert section[0] == "metal"
    assert header("yield_Re", "N/mm2") in heads
    for line in found:
        row = next(design.parts["metal"] for design in struts.designs if str(design.parts["metal"]) == line[0])
        assert line[heads.index("yield_Re [N/mm2]")] * 1e6 == pytest.approx(row["yield_Re"])
        ranks = [f"#{design.rank}" for design in struts.designs if str(design.parts["metal"]) == line[0]]
        assert line[1] == ", ".join(ranks)


def test_it_is_the_same_again_also_of_a_front_that_was_loaded(struts, content, tmp_path):
    assert front_workbook(struts, synth.calculation(struts)) == content
    struts.save(tmp_path)
    loaded = synth.load_front(tmp_path)
    told = openpyxl.load_workbook(io.BytesIO(front_workbook(loaded, synth.calculation(loaded))))
    assert rows_of(told["designs"], 1) == rows_of(openpyxl.load_workbook(io.BytesIO(content))["designs"], 1)
    assert ("checksum of the result", struts.result_digest) in [tuple(x[:2]) for x in rows_of(told["certificate"], 1)]


def test_without_a_calculation_what_parts_say_is_in_si(struts):
    book = openpyxl.load_workbook(io.BytesIO(front_workbook(struts)))
    assert "yield_Re [SI]" in rows_of(book["parts"], 2)[0]
    assert "not known here" in book["sources"]["A1"].value


def test_many_designs_are_written_quickly(struts):
    first = struts.designs[0]
    many = replace(struts, designs=[replace(first, rank=rank, note="<b>=1") for rank in range(1, 201)])
    started = time.process_time()
    written = front_workbook(many, synth.calculation(struts))
    assert time.process_time() - started < 2  # 0.1 s; others may be at work
    assert len(written) < 200_000


def test_without_the_extra_it_is_one_sentence(struts, monkeypatch):
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(InputError, match=r"^--xlsx needs the extra excel: pip install 'clutchsynth\[excel\]'$"):
        front_workbook(struts)
