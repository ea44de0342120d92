"""Files that are made of the records of a job."""

from __future__ import annotations

import io
import json
import pickle
import zipfile
from pathlib import Path

import pytest

from synth.errors import ExtraNeededError, InputError
from synth.kinds import kind
from synth.kinds.files import UnknownFileError, files_of, files_to_have, render
from tests.kinds.jobs import DISC, disc, earlier, pair
from tests.terminal.entry import clutchsynth

pytestmark = pytest.mark.slow


def test_the_files_of_a_front_are_those_that_the_command_line_writes(tmp_path: Path) -> None:
    import yaml

    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(DISC, sort_keys=False))
    done = clutchsynth("run", tmp_path / "spec.yaml", "-o", tmp_path / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    written = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert "designs.csv" in written
    for name, content in written.items():
        if name != "front.json":  # it tells how long the search took
            assert render("synthesis", disc(), name).content == content, name


def test_every_file_of_the_list_is_rendered() -> None:
    listed = files_of("synthesis", disc())
    assert {"designs.csv", "designs.xlsx", "front.json", "design_01.yaml", "report.html", "report.pdf"} <= set(listed)
    assert {"design_04_sheet.pdf", "design_04_live.xlsx", "bundle.zip"} <= set(listed)
    assert {"design_04_drawing.svg", "design_04_drawing.dxf"} <= set(listed)
    starts = {
        ".svg": b"<",
        ".dxf": b"  0\nSECTION",
        ".pdf": b"%PDF",
        ".xlsx": b"PK",
        ".zip": b"PK",
        ".html": b"<!",
        ".json": b"{",
    }
    for name, size in listed.items():
        if "_02" in name or "_03" in name:
            continue
        made = render("synthesis", disc(), name)
        assert made.name == name
        assert size in (None, len(made.content))
        assert made.content.startswith(starts.get(Path(name).suffix, b"")), name
        assert made.media
    explored = json.loads(render("synthesis", disc(), "explorer.json").content)
    assert not any("drawing" in design for design in explored["designs"])  # a page asks for those that it shows
    assert b'"drawing":' in render("synthesis", disc(), "explorer.html").content.replace(b" ", b"")


def test_options_of_reports_are_heeded_and_checked() -> None:
    about = {"about": {"project": "Crane 4"}, "length": "summary"}
    assert b"Crane 4" in render("synthesis", disc(), "design_01_sheet.html", about).content
    for options in ({"length": "long"}, {"about": {"logo": "x.png"}}, {"fonts": ["/etc"]}):
        with pytest.raises(InputError):
            render("synthesis", disc(), "report.html", options)


def test_an_archive_holds_what_the_folder_would_and_is_the_same_each_time() -> None:
    first = render("synthesis", disc(), "bundle.zip").content
    assert render("synthesis", disc(), "bundle.zip").content == first
    with zipfile.ZipFile(io.BytesIO(first)) as archive:
        names = set(archive.namelist())
        assert archive.read("designs.csv") == render("synthesis", disc(), "designs.csv").content
    assert names >= {"designs.csv", "front.json", "calculation.json", "design_01.yaml", "question.json"}


def test_a_comparison_has_files_too() -> None:
    assert render("compare", pair(), "designs.csv").content.startswith(b"rank,")
    assert render("compare", pair(), "report.html").content.startswith(b"<!")
    assert render("compare", pair(), "explorer.html").content.startswith(b"<!")
    told = json.loads(render("compare", pair(), "explorer.json").content)
    listed = json.loads(pair()["comparison.json"])["designs"]
    assert [(d["rank"], d["family"]) for d in told["designs"]] == [(d["rank"], d["family"]) for d in listed]


@pytest.mark.parametrize(
    "name", ["", "x", "../front.json", "/etc/passwd", "design_99.yaml", "design_01_sheet.doc", "a\0"]
)
def test_a_file_that_there_is_not_is_told_apart(name: str) -> None:
    with pytest.raises(UnknownFileError):
        render("synthesis", disc(), name)


def test_an_extra_that_is_missing_is_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(ExtraNeededError, match=r"needs the extra pdf: pip install 'clutchsynth\[pdf\]'") as caught:
        render("synthesis", disc(), "report.pdf")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.extra, again.path) == (str(caught.value), "pdf", ("pdf",))
    listed = files_to_have("synthesis", disc())
    assert "report.html" in listed
    assert "designs.xlsx" in listed
    assert not [name for name in listed if name.endswith(".pdf")]
    with pytest.raises(ExtraNeededError):
        kind("report").load().read({"of": "front", "formats": ["html", "pdf"]}, earlier())
