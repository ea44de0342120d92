"""Every kind of front has a report that says its state first; nothing in it is ever cut or acted on."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from synth.reports.files import report_files
from synth.reports.sheet.html import asset

import synth
from synth.results import front_record as records
from synth.results.plain import digest_of
from synth.results.report_request import ReportOptions, ReportRequest
from tests.analysis.test_calculation import Beam
from tests.terminal.test_report_commands import Page

ASKED = {"mass_carried": "100 kg"}


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Beam, ASKED, objectives={"width": "min", "height": "min"}, points=6)


def page_of(front, **more):
    how = ReportOptions.read(more.pop("formats", ("html",)), more.pop("about", None))
    files, notes, _ = report_files(ReportRequest(calculation=synth.calculation(front), front=front, how=how, **more))
    assert notes == []
    return Page(files["report.html"]), files


def words(page):
    return " ".join(" ".join(page.words).split())


def changed(front, **certificate):
    return replace(front, certificate=replace(front.certificate, **certificate))


@pytest.mark.parametrize(
    ("make", "head"),
    [
        (lambda f: f, "Proven to 0.1 % over all combinations"),
        (lambda f: replace(f, interrupted="time limit"), "the search was stopped: NOT PROVEN to the end"),
        (lambda f: changed(f, kind="heuristic", gap=None), "NOT PROVEN: better designs may exist"),
        (lambda f: changed(f, kind="exhaustive"), "every combination was solved, bounds are not closed"),
        (lambda f: replace(f, designs=[]), "NOT FEASIBLE, proven: nothing meets the task"),
        (lambda f: replace(changed(f, kind="heuristic"), designs=[]), "NO DESIGN FOUND, not proven"),
        (lambda f: replace(f, designs=f.designs[:1]), "Proven to 0.1 %"),
    ],
)
def test_the_state_stands_first(front, make, head):
    page, files = page_of(make(front))
    told = words(page)
    assert head in told
    assert told.index(head) < told.index("The task")
    if "design_01_sheet.html" in files:
        sheet = words(Page(files["design_01_sheet.html"]))
        assert sheet.index("Feasible") < sheet.index("Input")


@pytest.mark.parametrize("count", [0, 1, 2, 3, 6])
def test_the_knee_of_any_front_has_a_sheet(front, count):
    files = page_of(replace(front, designs=front.designs[:count]), chosen=["knee"])[1]
    sheets = [name for name in files if name.endswith("_sheet.html")]
    assert len(sheets) == min(count, 1)
    if count:
        noted = [d.rank for d in front.designs[:count] if "knee" in d.note] or [1]
        assert sheets == [f"design_{noted[0]:02d}_sheet.html"]


def test_the_knee_and_its_rank_are_one_sheet(front):
    one = replace(front, designs=front.designs[:1])
    assert sum("_sheet" in name for name in page_of(one, chosen=["1", "knee", " knee "])[1]) == 1
    with pytest.raises(synth.InputError, match="a rank from 1 to 1, or knee"):
        page_of(one, chosen=["2"])


def test_three_objectives_are_drawn_in_pairs():
    front = synth.synthesize(Beam, ASKED, objectives={"width": "min", "height": "min", "area": "min"}, points=8)
    files = page_of(front)[1]
    assert files["report.html"].count('class="field"') == 3


def test_every_design_can_be_told_in_full(front):
    page, files = page_of(front, full=99)
    assert {f"full-{d.rank}" for d in front.designs} <= set(page.ids)
    assert "all-designs" not in page.ids  # no data where nothing is left to be shown
    assert "<script" not in files["report.html"]


def test_a_front_of_before_there_were_calculations_has_a_report(front, tmp_path):
    front.save(tmp_path)
    path = tmp_path / "front.json"
    content = {k: v for k, v in json.loads(path.read_text()).items() if k not in ("calculation", "digest")}
    path.write_text(records.record_text(content | {"digest": digest_of(content)}))
    (tmp_path / "calculation.json").unlink()
    synth.load_front(tmp_path).report(tmp_path, problem=Beam)
    assert "Proven to 0.1 %" in (tmp_path / "report.html").read_text()


HOSTILE = (
    "<script>alert(1)</script>",
    "=cmd|' /C calc'!A0",
    '#read("/etc/passwd") $x$ \\ `raw` ]]>',
    "\u202eesrever ' \" & %s {0}",
    "x" * 3000,
)


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:12])
def test_texts_of_others_are_only_texts(front, text):
    first = front.designs[0]
    design = replace(first, note=text, alternatives=(text,), advice=(text,), off_grid={"width": text})
    hostile = replace(front, designs=[design, *front.designs[1:]], interrupted=text)
    page, files = page_of(hostile, about={"project": text[:500], "note": text[:400]}, formats=["html", "json"])
    plain = " ".join(text.split())
    assert plain in words(page)
    for name, content in files.items():
        if name.endswith(".html"):
            assert not re.search(r"<script(?! type=\"application/json\")[^>]*>alert", content)
            Page(content)
        else:
            json.loads(content)


def contrast(first, second):
    """Return the contrast of two colours after WCAG 2."""

    def luminance(colour):
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    light, dark = sorted((luminance(first), luminance(second)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("theme", [0, 1])
def test_words_can_be_read_in_both_themes(theme):
    blocks = re.findall(r":root \{(.*?)\}", asset("report.css"), re.S)
    colours = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6})", blocks[theme]))
    for ink in ("ink", "soft", "accent", "good", "open", "bad"):
        assert contrast(colours[ink], colours["paper"]) >= 4.5, ink
    for level in ("good", "open", "bad"):
        for ink in (level, "ink"):
            assert contrast(colours[ink], colours[f"{level}-paper"]) >= 4.5, (ink, level)
    assert contrast(colours["ink"], colours["field"]) >= 4.5
    assert contrast(colours["soft"], colours["bad-paper"]) >= 4.5
    assert contrast(colours["soft"], colours["open-paper"]) >= 4.5
