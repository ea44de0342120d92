"""The live workbook: another engine computes it, and what is typed into it, as ours does."""

from __future__ import annotations

import io
import math
import re
import sys
import time
import zipfile
from dataclasses import replace

import numpy as np
import openpyxl
import pytest
from synth.reports.excel_formula import LONGEST
from synth.reports.workbook import live_workbook

import synth
from synth import InputError
from synth.errors import RefusedError
from synth.model.problem import DesignProblem
from synth.results.design import PartRow
from synth.results.report_request import About
from synth.units import typed_quantity
from tests.conformance.cases import CASES
from tests.repetitions import repetitions
from tests.reports.spreadsheet import Spreadsheet
from tests.reports.workbook_cases import (
    DIGITS,
    Change,
    Places,
    Sample,
    broken,
    compared,
    expected,
    like,
    other_requirements,
    sample,
    workbook_of,
)

pytestmark = pytest.mark.slow

# Of each family the last structure, which has the rules of practice and most options; thoroughly all of them.
STRUCTURES = [
    (family, structure) for family, data in CASES.items() for structure in list(data.option_sets)[-repetitions(1, 99) :]
]


def asked_otherwise(sampled, family, rng):
    """Return other requirements, and the design as the engine evaluates it for them."""
    calculation, design = sampled.calculation, sampled.designs[0]
    problem = synth.load(family, **calculation.options)
    for tries in range(60):  # words for one torque or inertia have to agree: the fewer move, the sooner they do
        change = other_requirements(sampled, rng, share=0.3 / (1 + tries / 5))
        asked = dict(design.frame.requirements)
        for name, value in change.numbers.items():
            asked[name] = typed_quantity(value, calculation.quantities[name].unit, None)
        try:
            return change, synth.evaluate(problem, asked, design)
        except RefusedError:  # some do not go together
            continue
    raise AssertionError("all are refused")


@pytest.mark.parametrize(("family", "structure"), STRUCTURES)
def test_another_engine_computes_what_ours_does(family, structure, tmp_path):
    sampled = sample(family, structure, few=repetitions(2, 3))
    calculation, design = sampled.calculation, sampled.designs[0]
    content = workbook_of(sampled)
    places = Places(content, calculation)
    (tmp_path / "live.xlsx").write_bytes(content)
    sheet = Spreadsheet(tmp_path / "live.xlsx")
    rng = np.random.default_rng(11)
    requirements, evaluated = asked_otherwise(sampled, family, rng)
    guards = [x.name for x in calculation.limits if x.guard]
    failing = [change for name in guards if (change := broken(sampled, name, rng)) is not None]
    failing = failing[: repetitions(1, 2)]
    changes = [Change(), requirements, *(like(calculation, other) for other in sampled.designs[1:]), *failing]
    outcomes, cells = [], []
    for change in changes:
        outcomes.append(expected(sampled, design, change)[1])
        cells.append(sheet.with_typed(places.typed(change)))
        worst, wrong = compared(places, outcomes[-1], cells[-1])
        assert not wrong, (change, wrong)
        assert worst < DIGITS, change
    verdicts = [verdict for found in outcomes for verdict in found.verdicts.values()]
    assert any(not verdict.holds for verdict in verdicts)
    if failing:
        assert any(verdict.failed for verdict in verdicts)
        assert any(math.isnan(value) for value in outcomes[-1].values.values())
    own = {slot: str(row) for slot, row in design.parts.items()}
    assert any(change.parts and change.parts != own for change in changes)

    # Not only as the calculation gives it, but as the engine evaluates a design.
    cell = cells[1]
    for name, value in evaluated.values.items():
        if math.isfinite(value) and name in places.si:
            assert cell(*places.si[name]) == pytest.approx(value, rel=DIGITS), name
    told = {name for name, row in places.limit_rows.items() if cell("Limits", f"G{row}") == "VIOLATED"}
    assert told == set(evaluated.violated)


@pytest.mark.parametrize(("family", "structure"), STRUCTURES)
def test_it_is_stored_with_what_its_formulas_come_to(family, structure):
    sampled = sample(family, structure, few=1)
    started = time.process_time()
    content = workbook_of(sampled)
    assert time.process_time() - started < 2  # 0.2 s; others may be at work
    assert len(content) < 120_000
    places = Places(content, sampled.calculation)
    stored = openpyxl.load_workbook(io.BytesIO(content), data_only=True)

    def cell(sheet, address):
        value = stored[sheet][address].value
        return None if isinstance(value, str) and value.startswith("#") else value

    found = expected(sampled, sampled.designs[0], Change())[1]
    worst, wrong = compared(places, found, cell)
    assert not wrong
    assert worst < 1e-15
    for sheet in places.book:
        for row in sheet.iter_rows():
            for one in row:
                if one.data_type == "f":
                    assert len(one.value) <= LONGEST
                    assert not re.search(r"\b(LET|LAMBDA|_xlfn|_xlws)\b", one.value)
                    assert stored[sheet.title][one.coordinate].value is not None or '""' in one.value, one.value


# -- one small problem ---------------------------------------------------------------------------------


class Beam(DesignProblem):
    """A beam with all that a workbook must show: guards that are told by what is behind them, gaps, choices, counts."""

    name, title, sources = "beam", "=cmd()|'/c calc'!A0", ("<script>alert(1)</script>",)

    def declare(self, d):
        g = d.constant("gravity", "m/s2", 9.80665, symbol="g_n", text="Standard gravity", source="CGPM 1901")
        mass = d.requirement("mass_carried", "kg", lower=1, upper=1e4, symbol="m", text='"quoted" & <b>', group="duty")
        length = d.requirement("length", "mm", 500, lower=10, symbol="l", text="+1+1")
        reach = d.requirement("reach", "mm", 2 * length, symbol="l_r", text="Reach")
        warm = d.requirement("warm", "degC", 20, symbol="T", text="Temperature")
        d.requirement("R1", "1/min", 30, symbol="c", text="A name that is a cell as well")
        width = d.variable("width", "mm", 5, 100, symbol="b", text="Width")
        height = d.variable("height", "mm", 5, 100, symbol="h", text="Height")
        layers = d.count("layers", 0.5, 4, 0.5, symbol="n", text="Layers")
        shape = d.choice("shape", ("plain", "ribbed", "with * and ?"), symbol="k", text="Shape")
        metal = d.part("metal", "metals", text="Material")
        taken = d.derive("taken", "mm", height / layers * (1 + shape.sx / 10), symbol="h_1", needs="slender", text="x")
        d.at_most("slender", taken, 5 * width, "mm", guard=True, text="A guard told by what is behind it")
        modulus = d.derive("modulus", "mm3", width * taken**2 / 6, symbol="W", text="Section modulus")
        d.at_most("stress", mass * g * length / modulus, metal.yield_Re, "N/mm2", text="Bending stress")
        d.at_least("bulk", width, 1e-3 * warm * reach / 600, "mm", text="Something with a temperature")
        d.equal("square", width, height, "mm", text="An equation")
        d.derive("area", "mm2", width * height, symbol="A", text="Section")
        d.objective("area", "min")
        d.advise("flat", height < width, "lies flat")


def row_of(designation, strength, **more):
    columns = {"designation": designation, "yield_Re": strength, "source": "-1", "confidence": "typical"}
    return PartRow("metals", "0" * 8, {**columns, **more})


DUTY = {"mass_carried": "100 kg"}


def beam(**values):
    """Return a sample of one beam."""
    own = {"width": "20 mm", "height": "20 mm", "layers": 1, "shape": "plain"} | values
    design = synth.evaluate(Beam, DUTY, values=own, parts={"metal": "S185"})
    return Sample(synth.calculation(Beam, DUTY), [design], {"metal": list(design.parts.values())})


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Return a beam, its workbook, and the other engine with it."""
    sampled = beam()
    own = sampled.designs[0].parts["metal"]
    rows = [row_of("=1+1", 300e6), own, row_of("A*", 200e6), row_of("A?b", 250e6), row_of("ab", 100e6)]
    sampled = replace(sampled, rows={"metal": [*rows, row_of("AB", 150e6)]})
    content = workbook_of(sampled, about={"project": "=HYPERLINK(1)", "note": "שלום ‮abc"})
    path = tmp_path_factory.mktemp("beam") / "live.xlsx"
    path.write_bytes(content)
    return sampled, content, Places(content, sampled.calculation), Spreadsheet(path)


@pytest.mark.parametrize(
    "change",
    [
        Change({"layers": 2.5, "height": 0.07}, {"shape": "with * and ?"}, {"metal": "A*"}),
        Change({"width": 0.05, "warm": 400.0}, {"shape": "ribbed"}, {"metal": "A?b"}),
        Change({"height": 0.1, "width": 0.01}),
        Change({"width": 0.005}, {}, {"metal": "=1+1"}),
        Change({"length": 0.8}),
        Change({"length": 0.8, "reach": 0.3}),
        Change({"width": 0.02 * (1 + 0.9e-6)}),
        Change({"width": 0.02 * (1 + 1.1e-6)}),
        Change({"width": 0.1, "height": 0.5, "layers": 1.0}),  # exactly at the guard, which holds strictly
    ],
)
def test_what_is_typed_into_a_small_workbook(small, change):
    sampled, _, places, sheet = small
    found = expected(sampled, sampled.designs[0], change)[1]
    cell = sheet.with_typed(places.typed(change))
    worst, wrong = compared(places, found, cell)
    assert not wrong
    assert worst < DIGITS
    violated = [name for name, verdict in found.verdicts.items() if not verdict.holds]
    summary = cell("Summary", "A2")
    assert summary.startswith(f"NOT FEASIBLE: {len(violated)} " if violated else "FEASIBLE")
    assert "changed since" in cell("Summary", "B4")
    assert cell("Summary", "B5").startswith("none")


def test_a_workbook_that_nobody_has_touched_says_so(small):
    cell = small[3].with_typed({})
    assert cell("Summary", "B4") == "as solved"
    assert cell("Summary", "B5") == "as recorded: infeasible"
    names = ("mass_carried", "length", "reach", "warm", "R1", "width", "height", "layers", "shape", "area")
    assert not any(cell("Calculation", small[2].shown(name)[1].replace("C", "G")) for name in names)


def test_designations_that_differ_by_capitals_are_told_apart(small):
    _, _, places, sheet = small
    typed = Change(parts={"metal": "AB (2)"})
    assert sheet.with_typed(places.typed(typed))(*places.si["metal.yield_Re"]) == pytest.approx(150e6)
    assert sheet.with_typed(places.typed(Change(parts={"metal": "ab"})))(*places.si["metal.yield_Re"]) == 100e6


def test_a_row_without_a_value_gives_nothing(tmp_path):
    sampled = beam()
    rows = [sampled.designs[0].parts["metal"], row_of("gap", None)]
    content = live_workbook(sampled.calculation, sampled.designs[0], {"metal": rows})
    (tmp_path / "live.xlsx").write_bytes(content)
    places = Places(content, sampled.calculation)
    cell = Spreadsheet(tmp_path / "live.xlsx").with_typed(places.typed(Change(parts={"metal": "gap"})))
    assert cell(*places.si["metal.yield_Re"]) is None
    assert cell("Limits", f"G{places.limit_rows['stress']}") == "VIOLATED"


def test_names_are_public_names_and_none_is_a_cell(small):
    _, _, places, _ = small
    names = set(places.book.defined_names)
    assert {"length", "width", "metal.yield_Re", "R1_", "slender.holds"} <= names
    assert places.book["Calculation"]["E3"].value == "=C3"  # kilograms are SI


def test_inputs_are_open_and_checked_and_all_else_is_locked(small):
    _, _, places, _ = small
    for sheet in places.book:
        assert sheet.protection.sheet
        assert not sheet.protection.password
    open_cells = {
        (sheet.title, cell.coordinate)
        for sheet in places.book
        for row in sheet.iter_rows()
        for cell in row
        if not cell.protection.locked
    }
    checked = {
        (sheet.title, str(area))
        for sheet in places.book
        for rule in sheet.data_validations.dataValidation
        for area in rule.sqref.ranges
    }
    inputs = ("mass_carried", "length", "reach", "warm", "R1", "width", "height", "layers", "shape")
    assert open_cells == checked == {places.shown(name) for name in inputs} | {("Parts", "C3")}
    assert places.book["Helpers"].sheet_state == "hidden"
    rules = {str(rule.sqref): rule for rule in places.book["Calculation"].data_validations.dataValidation}
    mass = rules[places.shown("mass_carried")[1]]
    assert (mass.type, float(mass.formula1), float(mass.formula2), mass.errorStyle) == ("decimal", 1, 10000, None)
    assert rules[places.shown("width")[1]].errorStyle == "warning"
    assert rules[places.shown("layers")[1]].type == "custom"
    assert rules[places.shown("shape")[1]].type == "list"


HOSTILE = ("=cmd()", "+1", "-1", "@SUM(1)", "{=1}", "<script>alert('x')</script>", '"";!', "x" * 10_000, "שלום עולם")


@pytest.mark.parametrize(
    "text", [*HOSTILE, "y" * 40_000, "a\x00b\ud800\ufffe", "_x0041_", "\n\n=1", "http://a.b", "1e5"]
)
def test_no_text_becomes_a_formula_and_none_is_lost(text):
    sampled = beam()
    row = row_of(text, 200e6, source=text, confidence=text)
    design = replace(sampled.designs[0], parts={"metal": replace_row(sampled.designs[0].parts["metal"], text)})
    about = About(project=text, note=text)
    content = live_workbook(sampled.calculation, design, {"metal": [row]}, about, text)
    assert content == live_workbook(sampled.calculation, design, {"metal": [row]}, about, text)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert not any("externalLink" in name or "vba" in name for name in archive.namelist())
        assert not any(b"<hyperlink" in archive.read(name) for name in archive.namelist())
    book = openpyxl.load_workbook(io.BytesIO(content))
    found = 0
    for sheet in book:
        for cells in sheet.iter_rows():
            for cell in cells:
                if cell.data_type == "f":
                    assert text not in HOSTILE or len(text) < 3 or text not in cell.value[1:]
                    assert cell.value.startswith("=")
                elif cell.data_type == "s" and text in HOSTILE:
                    found += cell.value == text
    assert found >= 3 or text not in HOSTILE


def replace_row(row, designation):
    columns = {key: row[key] for key in row if key not in ("table", "hash")}
    return PartRow(row["table"], row["hash"], {**columns, "designation": designation})


def test_the_same_design_gives_the_same_bytes(small):
    sampled, content, _, _ = small
    again = workbook_of(sampled, about={"project": "=HYPERLINK(1)", "note": "שלום ‮abc"})
    assert again == content


def test_without_the_extra_it_is_one_sentence(monkeypatch):
    sampled = beam()
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(InputError, match=r"^--xlsx needs the extra excel: pip install 'clutchsynth\[excel\]'$"):
        workbook_of(sampled)


def test_a_design_of_other_formulas_is_refused():
    sampled = beam()
    design = replace(sampled.designs[0], values={**sampled.designs[0].values, "area": 1.0})
    with pytest.raises(InputError, match="design: area"):
        live_workbook(sampled.calculation, design, {})
