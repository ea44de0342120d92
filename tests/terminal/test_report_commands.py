"""clutchsynth report: what it writes, what it refuses, and that nothing is half-written."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

import pytest

import synth
from tests.analysis.independent import recomputed
from tests.terminal.entry import at_once

pytestmark = pytest.mark.slow
SPEC = """
family: multi_plate_clutch
requirements: {load_torque: 600 N*m, driver_speed: 254 rpm, driven_inertia: 30 kg*m2}
parts: {friction_pair: [paper_wet, sinter_bronze_wet], inner_plate: [core 2], outer_plate: [core 2]}
fix: {ramp_time: 2 s}
points: 6
"""
DESIGN = """
family: multi_plate_clutch
requirements: {load_torque: 600 N*m, driver_speed: 254 rpm, driven_inertia: 30 kg*m2}
values: {ring_outer_diameter: 200 mm, ring_inner_diameter: 145 mm, actuation_force: 3 kN, ramp_time: 2 s,
  friction_surfaces: 10}
parts: {friction_pair: paper_wet, inner_plate: core 3, outer_plate: core 2}
"""


@pytest.fixture(scope="module")
def front_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("front")
    (folder / "spec.yaml").write_text(SPEC)
    assert at_once("run", folder / "spec.yaml", "-o", folder / "out", "-q").returncode == 0
    return folder / "out"


class Page(HTMLParser):
    """Collects what a page says and whether its elements close."""

    VOID = frozenset({"meta", "img", "col", "br", "mspace", "circle", "line", "path", "rect", "input"})

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.links, self.words = [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        told = dict(attrs)
        self.ids += [told["id"]] if "id" in told else []
        self.links += [told["href"]] if "href" in told else []
        assert not any(name.startswith("on") for name in told)
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def test_a_report_is_one_page_that_asks_for_nothing(front_folder, tmp_path):
    done = at_once("report", front_folder, "-o", tmp_path, "--design", "1,knee", "--full", "2")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "report.html").read_text()
    page = Page(text)
    assert not re.search(r"(src|href)=\"(https?:)?//", text)
    assert "default-src 'none'" in text
    local = [link for link in page.links if link.startswith("#")]
    assert {link[1:] for link in local} <= set(page.ids)
    files = [link for link in page.links if not link.startswith("#")]
    assert files
    assert all((tmp_path / name).is_file() for name in files)
    assert "Proven to 0.1 %" in " ".join(page.words)


def test_a_sheet_says_its_state_first_and_every_number(front_folder, tmp_path):
    assert at_once("report", front_folder, "-o", tmp_path, "--length", "full", "-q").returncode == 0
    text = (tmp_path / "design_01_sheet.html").read_text()
    page = Page(text)
    front = synth.load_front(front_folder)
    for name in front.frame.kinds:
        assert name in " ".join(page.words)
    for name in front.frame.limit_units:
        assert name in " ".join(page.words)
    assert " ".join(page.words).index("the front is proven") < " ".join(page.words).index("Input")


def test_the_sheet_for_programs_is_recomputed_by_one_that_knows_nothing_of_us(front_folder, tmp_path):
    assert at_once("report", front_folder, "-o", tmp_path, "--json", "-q").returncode == 0
    told = json.loads((tmp_path / "design_01_sheet.json").read_text())
    computed = ("step", "derived", "helper")
    numbers = {k: float("nan") if v is None else float(v) for k, v in told["values_si"].items()}
    inputs = {q["name"]: numbers[q["name"]] for q in told["calculation"]["quantities"] if q["kind"] not in computed}
    values, limits = recomputed(told["calculation"], inputs)
    for name, value in numbers.items():
        assert values[name] == pytest.approx(value, rel=1e-12, nan_ok=True), name
    for x in told["limits"]:
        value, limit, void, holds, used = limits[x["name"]]
        assert (void, holds) == (x["void"], x["holds"])
        assert value == pytest.approx(float(x["value_si"]), rel=1e-12)
        assert limit == pytest.approx(float(x["limit_si"]), rel=1e-12)
        assert used == (None if x["used"] is None else pytest.approx(float(x["used"]), rel=1e-12))


def test_the_same_input_gives_the_same_bytes(front_folder, tmp_path):
    for name in ("a", "b"):
        assert at_once("report", front_folder, "-o", tmp_path / name, "--json", "-q").returncode == 0
    assert {p.name for p in (tmp_path / "a").iterdir()} == {p.name for p in (tmp_path / "b").iterdir()}
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


def test_a_design_that_is_not_feasible_has_a_sheet_and_an_exit_code(tmp_path):
    (tmp_path / "weak.yaml").write_text(DESIGN)
    done = at_once("report", tmp_path / "weak.yaml")
    assert done.returncode == 3, done.stderr
    text = (tmp_path / "weak_sheet.html").read_text()
    assert "NOT FEASIBLE: 2 limits violated" in text
    assert "not checked: never_starts fails" in text


def test_nothing_feasible_has_a_report_that_says_so_first(front_folder, tmp_path):
    (tmp_path / "none.yaml").write_text(SPEC + 'limits: {outer_diameter: "<= 120 mm"}\n')
    assert at_once("run", tmp_path / "none.yaml", "-o", tmp_path / "none", "-q").returncode == 3
    done = at_once("report", tmp_path / "none")
    assert done.returncode == 3, done.stderr
    assert "NOT FEASIBLE, proven" in (tmp_path / "none" / "report.html").read_text()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--design", "99"), "design: got '99'; expected a rank from 1 to"),
        (("--design", "best"), "design: got 'best'"),
        (("--length", "long"), "length: got 'long'; expected one of summary, normal, full"),
        (("--about", "missing.yaml"), "missing.yaml"),
    ],
)
def test_what_is_wrong_is_one_sentence_and_nothing_is_written(front_folder, tmp_path, more, words):
    done = at_once("report", front_folder, "-o", tmp_path / "out", *more)
    assert done.returncode == 2
    assert words in " ".join(done.stderr.split())
    assert not list(tmp_path.glob("out/*.html"))


def test_what_is_no_front_is_one_sentence(tmp_path):
    done = at_once("report", tmp_path / "nowhere")
    assert done.returncode == 2
    assert "front: got" in done.stderr


def test_a_changed_calculation_is_refused_by_name(front_folder, tmp_path):
    synth.load_front(front_folder).save(tmp_path)
    path = tmp_path / "calculation.json"
    path.write_text(path.read_text().replace('"value":150.0', '"value":151.0', 1))
    done = at_once("report", tmp_path)
    assert done.returncode == 2
    assert "calculation" in done.stderr
    assert not (tmp_path / "report.html").exists()


HOSTILE = '<script>alert(1)</script> =cmd() #read("x") $x$ \\ \' " &amp; \u202eabc ' + "x" * 300


def test_hostile_words_are_only_words(front_folder, tmp_path):
    (tmp_path / "about.yaml").write_text(json.dumps({"project": HOSTILE, "title": HOSTILE}))
    assert at_once("report", front_folder, "-o", tmp_path / "out", "--about", tmp_path / "about.yaml").returncode == 0
    text = (tmp_path / "out" / "report.html").read_text()
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert(1)" in text
    Page(text)


def test_about_knows_its_entries(front_folder, tmp_path):
    (tmp_path / "about.yaml").write_text("projekt: x\n")
    done = at_once("report", front_folder, "-o", tmp_path / "out", "--about", tmp_path / "about.yaml")
    assert done.returncode == 2
    assert "about: got 'projekt'; expected one of company, project" in done.stderr


def test_a_new_front_takes_the_reports_of_the_old_one_away(tmp_path):
    (tmp_path / "spec.yaml").write_text(SPEC)
    for _ in range(2):
        assert at_once("run", tmp_path / "spec.yaml", "-o", tmp_path / "out", "-q").returncode == 0
        assert not (tmp_path / "out" / "report.html").exists()
        assert at_once("report", tmp_path / "out", "-q").returncode == 0
        assert (tmp_path / "out" / "report.html").exists()


def test_python_writes_the_same(front_folder, tmp_path):
    assert at_once("report", front_folder, "-o", tmp_path / "a", "-q").returncode == 0
    synth.load_front(front_folder).report(tmp_path / "b")
    assert (tmp_path / "a" / "report.html").read_bytes() == (tmp_path / "b" / "report.html").read_bytes()


def test_files_of_others_are_left_alone(front_folder, tmp_path):
    (tmp_path / "notes.html").write_text("mine")
    (tmp_path / "design_07_sheet.html").write_text("mine")
    assert at_once("report", front_folder, "-o", tmp_path, "--json", "-q").returncode == 0
    assert at_once("report", front_folder, "-o", tmp_path, "-q").returncode == 0
    assert (tmp_path / "notes.html").read_text() == (tmp_path / "design_07_sheet.html").read_text() == "mine"
    assert (tmp_path / "design_01_sheet.json").is_file()


def test_the_folder_of_another_front_is_refused(front_folder, tmp_path):
    (tmp_path / "spec.yaml").write_text(SPEC.replace("600 N*m", "500 N*m"))
    assert at_once("run", tmp_path / "spec.yaml", "-o", tmp_path / "other", "-q").returncode == 0
    before = {p.name: p.read_bytes() for p in (tmp_path / "other").iterdir()}
    done = at_once("report", front_folder, "-o", tmp_path / "other")
    assert done.returncode == 2
    assert "this one holds another front" in done.stderr
    assert {p.name: p.read_bytes() for p in (tmp_path / "other").iterdir()} == before


def test_a_design_of_a_front_checked_alone_does_not_replace_its_sheet(front_folder, tmp_path):
    synth.load_front(front_folder).save(tmp_path)
    assert at_once("report", tmp_path, "-q").returncode == 0
    before = (tmp_path / "design_01_sheet.html").read_bytes()
    assert at_once("report", tmp_path / "design_01.yaml", "-q").returncode == 0
    assert (tmp_path / "design_01_sheet.html").read_bytes() == before
    assert (tmp_path / "design_01_checked_sheet.html").is_file()


@pytest.mark.parametrize("entry", ["number: 007", "revision: 1.10", "project: yes", "note: [1]"])
def test_what_yaml_reads_as_something_else_is_refused(front_folder, tmp_path, entry):
    (tmp_path / "about.yaml").write_text(entry + "\n")
    done = at_once("report", front_folder, "-o", tmp_path / "out", "--about", tmp_path / "about.yaml")
    assert done.returncode == 2
    assert "a text in quotes" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("flag", [("--design", "2"), ("--full", "3")])
def test_what_a_single_design_does_not_have_is_refused(tmp_path, flag):
    (tmp_path / "weak.yaml").write_text(DESIGN)
    done = at_once("report", tmp_path / "weak.yaml", *flag)
    assert done.returncode == 2
    assert "weak.yaml is one design" in done.stderr
    assert not (tmp_path / "weak_sheet.html").exists()


def test_fonts_without_pdf_are_refused(front_folder, tmp_path):
    done = at_once("report", front_folder, "-o", tmp_path / "out", "--font-path", tmp_path)
    assert done.returncode == 2
    assert "only PDF takes fonts" in done.stderr


SEVERAL = """
family: [multi_plate_clutch, disc_clutch, cone_clutch]
requirements: {load_torque: 60 N*m, driver_speed: 1000 1/min, driven_inertia: 0.5 kg*m2}
points: 3
"""


def test_ranks_of_a_comparison_are_those_of_the_common_front(tmp_path):
    (tmp_path / "spec.yaml").write_text(SEVERAL)
    assert at_once("run", tmp_path / "spec.yaml", "-o", tmp_path / "any", "-q").returncode == 0
    told = json.loads((tmp_path / "any" / "comparison.json").read_text())
    last = told["designs"][-1]
    done = at_once("report", tmp_path / "any", "-o", tmp_path / "out", "--explorer", "--design", f"knee,{last['rank']}")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "explorer.html").is_file()
    text = (tmp_path / "out" / "report.html").read_text()
    # The common front is drawn with a shape and a colour for each family, whatever the colours of the page.
    picture = text[text.index("<svg") : text.index("</svg>")]
    assert "Common front" in picture
    assert picture.count("#0072B2") > picture.count('class="') == 0
    assert all(f">#{design['rank']}<" in picture for design in told["designs"])
    page = Page(text)
    files = [link.split("#")[0] for link in page.links if not link.startswith("#")]
    assert files
    assert all((tmp_path / "out" / name).is_file() for name in files)
    assert list((tmp_path / "out" / last["family"]).glob("design_*_sheet.html"))
    refused = at_once("report", tmp_path / "any", "-o", tmp_path / "none", "--design", "99")
    assert refused.returncode == 2
    assert "of the common front" in refused.stderr
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("formats", [[], "html", ["doc"]])
def test_formats_are_named_or_refused(front_folder, tmp_path, formats):
    front = synth.load_front(front_folder)
    if formats == "html":
        assert (front.report(tmp_path, formats=formats) / "report.html").is_file()
        return
    with pytest.raises(synth.InputError, match="formats"):
        front.report(tmp_path, formats=formats)
    assert not list(tmp_path.iterdir())
