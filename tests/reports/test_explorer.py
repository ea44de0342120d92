"""The explorer without a browser: what it weighs, that it asks for nothing, and how it is handed over."""

from __future__ import annotations

import gzip
import html
import json
import re
from html.parser import HTMLParser
from importlib.resources import files

import pytest
from synth.reports.explorer.page import IMPORT, explorer_files, explorer_frame, explorer_page, one_script
from synth.reports.explorer.record import explorer_record

from synth.errors import InputError
from synth.results.drawings import report
from tests.reports.explorer_records import HOSTILE, empty_record, grown, hostile_record, small_front, small_record
from tests.terminal.entry import in_process

pytestmark = pytest.mark.slow
MOST_BYTES = 50_000  # gzip, without data
MOST_LINES = 400


class Elements(HTMLParser):
    """The elements of a page, the addresses in it and the texts of its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.scripts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        self.attributes += attrs

    def handle_data(self, data: str) -> None:
        if self.names and self.names[-1] == "script" and data.strip():
            self.scripts.append(data)


def test_program_and_style_weigh_little():
    whole = one_script() + "".join(text for name, text in explorer_files().items() if name.endswith(".css"))
    assert len(gzip.compress(whole.encode(), 9)) < MOST_BYTES


def test_modules_are_small_and_import_only_each_other():
    modules = {name: text for name, text in explorer_files().items() if name.endswith(".js")}
    assert len(modules) > 10
    for name, text in modules.items():
        assert len(text.splitlines()) < MOST_LINES, name
        statements = [line for line in text.splitlines() if line.startswith("import ")]
        assert len(statements) == len(IMPORT.findall(text)), f"{name} imports in another way than the page can join"
        for names, other in IMPORT.findall(text):
            for word in names.split(","):
                assert re.search(rf"^export (?:const|function|class) {word.strip()}\b", modules[other], re.MULTILINE)


def test_nothing_that_runs_text_stands_in_the_modules():
    risky = re.compile(
        r"innerHTML|outerHTML|insertAdjacent|document\.write|\beval\b|new Function|setAttribute\(\"style|fetch\("
    )
    assert not {name for name, text in explorer_files().items() if risky.search(text)}


def test_the_page_leads_nowhere():
    page = explorer_page(small_record())
    found = Elements(page)
    addresses = [value for name, value in found.attributes if name in ("src", "href", "action", "srcset")]
    assert addresses == ["data:,"]
    assert re.findall(r"https?://[^\s\"'<\\]+", "".join(explorer_files().values())) == ["http://www.w3.org/2000/svg"]
    assert "default-src &#x27;none&#x27;" in page


def test_a_record_cannot_end_its_element():
    record = hostile_record()
    found = Elements(explorer_page(record))
    assert found.names.count("script") == 2
    assert "img" not in found.names
    assert json.loads(found.scripts[0]) == record


def test_the_record_says_what_the_front_says():
    front, record = small_front(), small_record()
    names = [q["name"] for q in record["quantities"]]
    for design, told in zip(front.designs, record["designs"], strict=True):
        mass = told["v"][names.index("mass")]
        assert mass == pytest.approx(design.values["mass"], rel=1e-6)  # in kg, as the front shows it
        diameter = told["v"][names.index("ring_outer_diameter")]
        assert diameter == pytest.approx(1000 * design.values["ring_outer_diameter"], rel=1e-6)
        used = dict(zip((x["name"] for x in record["limits"]), told["used"], strict=True))
        assert used == pytest.approx(dict(design.utilisation), rel=1e-6)
        assert {s: record["parts"][p]["name"] for s, p in told["parts"].items()} == {
            s: str(row) for s, row in design.parts.items()
        }
    assert record["certificate"]["word"] == "Proven"
    assert any("marked typical" in text for text in record["certificate"]["not_part"])
    json.dumps(record, allow_nan=False)


def test_without_a_design_the_record_says_why():
    record = empty_record()
    assert record["designs"] == []
    assert record["certificate"]["word"] == "Not feasible, proven"
    assert any(miss["label"] == "outer diameter ≤ 90 mm" for miss in record["nothing"]["conflicts"])


def test_a_frame_is_closed_off_and_holds_the_whole_page():
    record = small_record()
    found = Elements(explorer_frame(record, 10**6))
    told = dict(found.attributes)
    assert found.names == ["iframe"]
    assert set(str(told["sandbox"]).split()) == {"allow-scripts", "allow-downloads"}
    assert told["srcdoc"] == explorer_page(record)
    assert told["height"] == "4000"


def test_a_front_explores_itself_in_a_notebook():
    shown = small_front().explore(500, about={"title": "Hoist <7>"})._repr_html_()
    assert 'height="500"' in shown
    assert "<title>Hoist &lt;7&gt;: explorer</title>" in html.unescape(shown)
    assert "Hoist <7>" not in shown


def test_report_writes_the_explorer_with_links_to_the_sheets(tmp_path):
    small_front().save(tmp_path / "out")
    handed = tmp_path / "handed"
    result = in_process("report", tmp_path / "out", "--explorer", "--design", "1,2", "-o", handed)
    assert result.returncode == 0, result.stderr
    assert "explorer.html" in result.stdout
    page = Elements((handed / "explorer.html").read_text(encoding="utf-8"))
    designs = json.loads(page.scripts[0])["designs"]
    assert designs[1]["files"] == [["Calculation sheet", "design_02_sheet.html"]]
    assert (handed / "design_02_sheet.html").is_file()
    assert '<a href="explorer.html">' in (handed / "report.html").read_text(encoding="utf-8")
    again = small_front().report(tmp_path / "again", formats=["explorer"])
    assert [path.name for path in again.iterdir()] == ["explorer.html"]


def test_one_design_has_nothing_to_explore(tmp_path):
    small_front().save(tmp_path)
    result = in_process("report", str(tmp_path / "design_01.yaml"), "--explorer")
    assert result.returncode == 2
    assert "--explorer" in result.stderr
    with pytest.raises(InputError, match="some of"):
        small_front().report(tmp_path / "x", formats=["explorers"])


def test_a_service_finds_modules_and_record_by_name():
    handed, record = report("explorer_files"), report("explorer_record")
    assert handed is not None
    assert record is explorer_record
    assert {"explorer.js", "explorer.css"} <= set(handed())
    homes = (files("synth.reports.explorer"), files("synth.ui"))
    there = [path.name for home in homes for path in home.iterdir() if path.name.endswith((".js", ".css"))]
    assert sorted(handed()) == sorted(there)
    assert "export function mount(" in handed()["explorer.js"]


def test_many_designs_stay_a_page_of_moderate_size():
    assert len(gzip.compress(explorer_page(grown(1000)).encode())) < 3_000_000
    assert HOSTILE not in explorer_page(hostile_record())
