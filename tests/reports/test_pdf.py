"""Documents as PDF: what stands in them, that texts of others stay texts, and that nothing runs off the page."""

from __future__ import annotations

import functools
import json
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pypdfium2
import pytest
import typst
from fontTools.ttLib import TTFont
from synth.reports.extras import needed
from synth.reports.formula.layout import PLUS, TIMES, Amount, Cases, Fence, Fraction, Letter, Power, Row, Sign, Word
from synth.reports.numbers import ShownQuantity
from synth.reports.sheet.blocks import (
    Bullets,
    Code,
    Column,
    Document,
    Figure,
    Heading,
    Link,
    Listing,
    Paragraph,
    State,
    StepBlock,
    Strong,
    TableBlock,
    TableRow,
)
from synth.reports.sheet.design_sheet import SheetRequest, design_sheet
from synth.reports.sheet.pdf import pdf, pdf_with_notes
from synth.reports.sheet.typst_source import typst_source

from synth import InputError
from synth.analysis.calculation import calculation_of
from synth.analysis.designs import make_design, make_frame, part_row
from synth.results.report_request import About
from synth.text.numbers import Shown
from tests.conformance.cases import CASES, question

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="10"><rect width="20" height="5"/></svg>'
PIXEL = (
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk"
    "YPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="
)
MARGINS = (20.0, 15.0)  # left and right, mm
TYPST = {"font_paths": typst.Fonts(include_system_fonts=False), "ignore_system_fonts": True}


def pages(data):
    """Return the text of each page."""
    document = pypdfium2.PdfDocument(data)
    return [document[k].get_textpage().get_text_range() for k in range(len(document))]


def bare(text):
    """Return a text without blanks: where lines are broken does not matter."""
    return "".join(text.split())


def every_block(words="words", rows=3):
    """Return a document with every kind of block, in which a text stands everywhere."""
    step = StepBlock(
        number=1,
        anchor="step-x",
        meaning=words,
        name=words,
        source=words,
        symbol=Letter("M_k"),
        equal=(
            (Row((Letter("mu"), TIMES, Letter("F0"))), Row((PLUS, Letter("r")))),
            (Row((Amount(ShownQuantity(Shown("", "1058.8"), "N*m")),)),),
        ),
        plain=("M_k = mu * F0 + r", "= 1058.8 N*m"),
        notes=((words, Letter("z")),),
    )
    table = TableBlock(
        words,
        (Column("limit", width=3), Column("condition"), Column("used", number=True)),
        (
            (
                "",
                tuple(
                    TableRow((words, Row((Letter("p"), Sign("≤"), Letter("q"))), "50 %"), used=0.5) for _ in range(rows)
                ),
            ),
            (words, (TableRow(((words, Code(words)), Word(words), Strong(words)), "bad", 1.2, "row-1"),)),
        ),
    )
    return Document(
        kind="Calculation sheet",
        title=words,
        facts=(
            ("Project", words),
            ("Author", "Ő. Meyer"),
            ("Number", "K-7"),
            ("Revision", "B"),
            ("Date", "2026-03-04"),
        ),
        blocks=(
            State("bad", words, (words,)),
            Heading("First", anchor="first"),
            Paragraph((words, Link(words, "#step-x"), Link("beside", "a.html"), Link("nowhere", "#no")), small=True),
            table,
            Heading("Second", 3),
            step,
            Bullets((words, (words, Code(words)))),
            Figure(SVG, words, words),
            Listing(words),
        ),
        program="clutchsynth 1",
        logo=PIXEL,
    )


def overfull(document):
    """Return how many formulas would have to be too small."""
    return len(json.loads(typst.query(typst_source(document).encode(), "<overfull>", **TYPST)))


def beyond_the_margins(data):
    """Return texts that stand outside of the margins, with their place in points."""
    found = []
    document = pypdfium2.PdfDocument(data)
    for number in range(len(document)):
        page = document[number]
        low, high = MARGINS[0] * 72 / 25.4, page.get_width() - MARGINS[1] * 72 / 25.4
        text = page.get_textpage()
        for k in range(text.count_rects()):
            left, bottom, right, top = text.get_rect(k)
            if left < low - 2 or right > high + 2 or bottom < 0 or top > page.get_height():
                found.append((number, round(left), round(right), text.get_text_bounded(left, bottom, right, top)))
    return found


# ---- what is in it ---------------------------------------------------------------------------------------------------


def test_every_block_is_written():
    words = "Emelőmű 7: árvíztűrő tükörfúrógép, Ελληνικά, Кириллица"
    data, notes = pdf_with_notes(every_block(words))
    found = bare("".join(pages(data)))
    assert notes == ()
    assert found.count(bare(words)) >= 20
    for text in ("1058.8", "First", "Second", "50%", "beside", "nowhere", "K-7", "rev.B", "page1/"):
        assert text in found, text
    assert beyond_the_margins(data) == []


def test_it_is_for_archives_and_for_those_who_hear_it():
    data = pdf(every_block())
    assert b"<pdfaid:part>2</pdfaid:part><pdfaid:conformance>B</pdfaid:conformance>" in data
    assert b"<pdfuaid:part>1</pdfuaid:part>" in data
    document = pypdfium2.PdfDocument(data)
    assert document.is_tagged()
    about = document.get_metadata_dict()
    assert about["Title"] == "words: calculation sheet"
    assert about["Author"] == "Ő. Meyer"
    assert about["Keywords"].startswith("Calculation sheet")
    assert about["CreationDate"].startswith("D:20260304")
    assert [(mark.get_title(), mark.level) for mark in document.get_toc()] == [("First", 0), ("Second", 1)]


def test_formulas_drawings_and_heads_of_tables_are_said():
    data = pdf(every_block())
    formulas, figures = data.count(b"/S/Formula"), data.count(b"/S/Figure")
    assert formulas > 4
    assert figures == 2  # the drawing and the logo
    assert data.count(b"/Alt") == formulas + figures
    assert data.count(b"/S/TH/") + data.count(b"/S/TH\n") == 4  # three columns and a group
    assert b"/JavaScript" not in data


def test_the_same_document_gives_the_same_bytes_at_any_time():
    told = every_block()
    undated = Document(told.kind, told.title, (("Date", "31. 2. 2026"),), told.blocks, told.program)
    assert pdf(told) == pdf(told)
    assert pdf(undated) == pdf(undated)
    assert pypdfium2.PdfDocument(pdf(undated)).get_metadata_dict()["CreationDate"].startswith("D:19700101")


@pytest.mark.slow
def test_a_table_says_its_head_on_each_page_and_splits_no_row():
    long = " ".join(["a row of several lines"] * 12)
    data = pdf(every_block(long, rows=40))
    told = pages(data)
    inside = [page for page in told if page.count("50 %") > 1]
    assert len(inside) > 3
    assert all("condition" in page for page in inside)
    for page in inside[1:-1]:
        # Each row says its words in full beside its share; a part of a row would leave a rest.
        assert bare(page).count(bare(long)) == bare(page).count("50%")


def test_a_step_stands_on_one_page():
    steps = tuple(
        StepBlock(k, "", "meaning", f"name_{k}_", "", Letter("y"), ((Letter("a"),), (Word(f"result{k}."),)), ("y = a",))
        for k in range(60)
    )
    told = pages(pdf(Document("K", "T", (), steps, "P")))
    assert len(told) > 2
    for k in range(60):
        assert sum(f"name_{k}_" in page and f"result{k}." in page for page in told) == 1


def test_links_lead_to_places_that_exist_and_open_nothing_else():
    source = typst_source(every_block())
    assert 'link(label("step-x")' in source
    assert 'link("a.html"' in source
    assert 'label("no")' not in source
    scripted = Document("K", "T", (), (Paragraph(Link("press", "javascript:alert(1)")),), "P")
    assert "link(" not in typst_source(scripted).split("#show: paper.with")[1]


def test_a_picture_is_shown():
    without = Document("K", "T", (), (), "P")
    logo = Document("K", "T", (), (), "P", logo=PIXEL)
    assert b"/Subtype/Image" in pdf(logo)
    assert b"/Subtype/Image" not in pdf(without)


# ---- texts of others -------------------------------------------------------------------------------------------------

HOSTILE = [
    '#read("/etc/passwd")',
    '"); #read("/etc/passwd"); ("',
    "$x$ #panic() *_#< [a] {b} @c //d /*e*/ `f` ~ -- ---",
    "'r' \"q\" \\ \\u{41} \\n \\",
    "<script>alert(1)</script>",
    "=cmd() &amp; %PDF",
]


@pytest.mark.parametrize("text", HOSTILE)
def test_what_people_write_is_text(text):
    found = bare("".join(pages(pdf(every_block(text)))))
    assert found.count(bare(text)) >= 20
    assert "root:" not in found


def test_what_cannot_be_seen_is_written_out():
    data, notes = pdf_with_notes(every_block("a\x07b\u202ec\ud800d"))
    assert "a[U+0007]b[U+202E]c[U+D800]d" in bare("".join(pages(data)))
    assert notes == ()


def test_right_to_left_is_written():
    found = bare("".join(pages(pdf(every_block("שלום abc")))))
    assert "abc" in found
    assert "שלום" in found or "םולש" in found


@pytest.mark.slow
def test_ten_thousand_letters_without_a_blank_are_broken_into_lines():
    word = "ж" * 10_000
    told = every_block()
    blocks = (
        Paragraph(word),
        TableBlock.of("caption", (Column("a", width=3), Column("b", number=True)), [TableRow((word, word))]),
        Listing(word),
    )
    data = pdf(Document(told.kind, word, told.facts, blocks, told.program))
    assert "".join(pages(data)).count("ж") >= 50_000
    assert beyond_the_margins(data) == []


def test_a_character_that_no_font_has_is_told():
    data, notes = pdf_with_notes(every_block("漢字 東京"))
    assert notes == (
        "PDF: no font has 京 (U+4EAC) 字 (U+5B57) 東 (U+6771) 漢 (U+6F22); the file has their numbers instead. "
        "Pass a font that has them with --font-path.",
    )
    assert "[U+6F22][U+5B57]" in bare("".join(pages(data)))


def test_a_font_that_has_it_is_taken(tmp_path):
    font = TTFont(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "STIXGeneral.ttf")
    for table in font["cmap"].tables:
        if table.isUnicode():
            table.cmap = {**table.cmap, ord("漢"): "A"}
    font.save(tmp_path / "kan.ttf")
    for place in (tmp_path, tmp_path / "kan.ttf"):
        data, notes = pdf_with_notes(every_block("漢"), [place])
        assert notes == ()
        assert "漢" in "".join(pages(data))


def test_a_font_that_is_not_there_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="--font-path"):
        pdf(every_block(), [tmp_path / "no.ttf"])


def test_a_missing_extra_is_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(InputError) as refused:
        pdf(every_block())
    assert str(refused.value) == "--pdf needs the extra pdf: pip install 'clutchsynth[pdf]'"
    assert needed("json", "--x", "y") is json


# ---- formulas --------------------------------------------------------------------------------------------------------


def test_a_formula_that_would_be_too_small_is_counted():
    root = Power(Letter("x"), Word("w" * 400))
    step = StepBlock(1, "", "m", "n", "s", Letter("y"), ((root,),), ("y = x ^ w",))
    assert overfull(Document("K", "T", (), (step,), "P")) == 1
    assert overfull(every_block()) == 0


def test_a_condition_too_wide_for_its_column_stands_below_it():
    high = Fraction(Fence(Row((Letter("alpha_first"), PLUS, Cases(((Letter("beta_second"), None),))))), Letter("g"))
    wide = Row((high, TIMES, high, TIMES, high, Sign("≥"), Letter("p")))
    columns = (Column("limit"), Column("condition"), Column("used", number=True, width=4))
    narrow = TableBlock.of("t", columns, [TableRow(("name", Power(wide, Letter("b")), "1"))])
    source = typst_source(Document("K", "T", (), (narrow,), "P"))
    assert "below: " in source
    assert '"as below"' in source
    assert overfull(Document("K", "T", (), (narrow,), "P")) == 0


STRUCTURES = [(f, s) for f, data in CASES.items() for s in data.option_sets if s in ("default", "practice")]


@functools.cache
def checked(family, structure):
    """Return the sheet of one design of a structure, feasible or not."""
    instance = question(family, CASES[family].option_sets[structure], optional=True)
    rng = np.random.default_rng(5)
    variables = CASES[family].sound(rng, instance, 2)
    numbers = rng.integers(0, instance.combinations.count, 2)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (2,)) for x in instance.data(numbers)]
    rows, _, choices = instance.combinations.describe(int(numbers[0]))
    parts = {slot: part_row(table, index) for slot, (table, index) in rows.items()}
    frame = make_frame(instance, {})
    result = instance.evaluate(variables, data)
    design = make_design(instance, frame, variables[0], result, 0, parts, choices)
    return design_sheet(SheetRequest(calculation_of(instance), design, None, About(project="Hoist"), "full"))


@pytest.mark.slow
@pytest.mark.parametrize(("family", "structure"), STRUCTURES)
def test_the_sheet_of_every_family_fits_its_pages(family, structure):
    sheet = checked(family, structure)
    assert overfull(sheet) == 0
    data, notes = pdf_with_notes(sheet)
    assert notes == ()
    assert beyond_the_margins(data) == []
    told = bare("".join(pages(data)))
    assert all(bare(block.name) in told for block in sheet.blocks if isinstance(block, StepBlock))
