"""clutchsynth report: what it writes, what it refuses, and that nothing is half-written."""

from __future__ import annotations

import json
import re
import sys
from html.parser import HTMLParser

import pytest

import synth
from synth.results.drawings import EXTRAS
from tests.analysis.independent import recomputed
from tests.terminal.entry import at_once, in_process, without, without_at_once

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


def test_the_knee_of_fronts_of_one_design_and_of_none(tmp_path):
    duty = "{load_torque: 60 N*m, driver_speed: 1000 1/min, driven_inertia: 0.5 kg*m2}"
    for name, family, more in [
        ("one", "disc_clutch", ""),
        ("both", "[disc_clutch, cone_clutch]", ""),
        ("none", "disc_clutch", "limits: {mass: <= 1 g}\n"),
    ]:
        spec = f"family: {family}\nrequirements: {duty}\nobjectives: {{mass: min}}\npoints: 1\n{more}"
        (tmp_path / f"{name}.yaml").write_text(spec)
        at_once("run", tmp_path / f"{name}.yaml", "-o", tmp_path / name, "-q")
        done = at_once("report", tmp_path / name, "-o", tmp_path / f"{name}_report", "--design", "knee,1")
        knee = at_once("report", tmp_path / name, "-o", tmp_path / f"{name}_report", "--design", "knee")
        assert (knee.returncode, knee.stderr) == (3 if name == "none" else 0, "")
        assert done.returncode == (2 if name == "none" else 0)
        sheets = list((tmp_path / f"{name}_report").rglob("design_*_sheet.html"))
        assert len(sheets) == (0 if name == "none" else 1)


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


# ---- extras that are not installed ----------------------------------------------------------------------------------

PACKAGES = {package: (option, extra) for package, option, extra in EXTRAS.values()}
DISCS = "load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2]\n60,1000,0.5\n"


def sentences(packages):
    return [
        f"clutchsynth: {o} needs the extra {e}: pip install 'clutchsynth[{e}]'" for o, e in map(PACKAGES.get, packages)
    ]


@pytest.fixture(scope="module")
def sources(front_folder, tmp_path_factory):
    """Return everything that can be reported, with the options of its formats and what needs no extra."""
    place = tmp_path_factory.mktemp("sources")
    duty = "{load_torque: 60 N*m, driver_speed: 1000 1/min, driven_inertia: 0.5 kg*m2}"
    (place / "any.yaml").write_text(f"family: [disc_clutch, cone_clutch]\nrequirements: {duty}\npoints: 2\n")
    assert at_once("run", place / "any.yaml", "-o", place / "any", "-q").returncode == 0
    (place / "rows.csv").write_text(DISCS)
    batch = ("batch", place / "rows.csv", "--family", "disc_clutch", "--points", "1", "-o", place / "batch", "-q")
    assert in_process(*batch).returncode == 0
    (place / "weak.yaml").write_text(DESIGN)
    every = ("--pdf", "--xlsx", "--dxf", "--step", "--drawing", "--json")
    return {
        "front": (front_folder, (*every, "--explorer"), ("report.html", "explorer.html", "design_01_sheet.json")),
        "comparison": (place / "any", every, ("report.html", "disc_clutch/report.html")),
        "design": (place / "weak.yaml", every, ("weak_sheet.html", "weak_sheet.json", "weak_drawing.svg")),
        "batch": (place / "batch", ("--pdf", "--xlsx"), ("report.html",)),
    }


@pytest.mark.parametrize("source", ["front", "comparison", "design", "batch"])
def test_what_needs_no_extra_is_written_and_every_missing_one_named(sources, source, tmp_path):
    folder, options, plain = sources[source]
    run = without if source == "front" else without_at_once
    done = run(" ".join(PACKAGES), "report", folder, "-o", tmp_path, *options)
    assert done.returncode == 2, done.stderr
    missing = [package for package, (option, _) in PACKAGES.items() if option in options]
    assert sorted(done.stderr.splitlines()) == sorted(sentences(missing))
    written = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert set(plain) <= written
    assert not [name for name in written if name.endswith((".pdf", ".xlsx", ".dxf", ".step", ".glb"))]
    shown = " ".join(done.stdout.split())
    assert all(name in shown for name in written)
    for page in tmp_path.rglob("*.html"):  # no page leads to a file that is not there
        links = [link.split("#")[0] for link in re.findall(r'href="([^"#][^"]*)"', page.read_text())]
        assert all((page.parent / link).is_file() for link in links if ":" not in link), page


@pytest.mark.parametrize("package", list(PACKAGES))
def test_one_missing_extra_keeps_nothing_else_from_being_written(sources, package, tmp_path):
    folder, _, _ = sources["front"]
    option, _ = PACKAGES[package]
    others = [other for name, (other, _) in PACKAGES.items() if name not in (package, "build123d")]
    done = without_at_once(package, "report", folder, "-o", tmp_path, *{*others, option}, "--full", "0")
    assert (done.returncode, done.stderr.splitlines()) == (2, sentences([package]))
    endings = {path.suffix for path in tmp_path.iterdir()}
    made = {f".{word}" for word, (name, *_) in EXTRAS.items() if name not in (package, "build123d")}
    assert endings == {".html", *made}


def test_python_tells_of_extras_after_all_else_is_written(front_folder, tmp_path, monkeypatch):
    for package in PACKAGES:
        monkeypatch.setitem(sys.modules, package, None)
    front = synth.load_front(front_folder)
    with pytest.raises(synth.InputError) as caught:
        front.report(tmp_path / "some", formats=["json", "pdf", "xlsx", "dxf", "step", "glb"])
    told = [f"clutchsynth: {error}" for error in caught.value.every()]
    assert sorted(told) == sorted(sentences(PACKAGES))
    assert [str(error) for error in caught.value.every()[1:]] == caught.value.__notes__
    assert [path.name for path in (tmp_path / "some").iterdir()] == ["design_01_sheet.json"]
    with pytest.raises(synth.InputError, match="--pdf needs the extra pdf"):
        front.report(tmp_path / "none", formats=["pdf"])
    assert not (tmp_path / "none").exists()
