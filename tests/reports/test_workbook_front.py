"""designs.xlsx: a front as values with units, its state and certificate in words, and no text that acts."""

from __future__ import annotations

import io
from dataclasses import replace

import openpyxl
import pytest

import synth
from reports.workbook_front import front_workbook
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
