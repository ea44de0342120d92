"""Results over HTTP: records, designs, rows and files."""

from __future__ import annotations

import csv
import gzip
import hashlib
import io
import zipfile
from pathlib import Path
from typing import Any

import pytest

from synth.errors import ExtraNeededError
from synth.folders.csv_style import GERMAN, unstyled
from synth.workers.engine_process import Engines
from synth.workers.engine_tasks import RENDER_TASK
from tests.service.calling import Service, code_of
from tests.service.working import FRONT, Client
from tests.terminal.entry import in_process

pytestmark = pytest.mark.slow


def test_the_record_is_sent_as_it_is_kept(works: Service, client: Client, front: str) -> None:
    kept = works.store.records(front, ["front.json"])["front.json"]
    plain = client.get(f"jobs/{front}/result", headers={"Accept-Encoding": "identity"})
    assert plain.content == kept.content
    assert plain.headers["etag"] == f'"{kept.digest}"'
    packed = client.get(f"jobs/{front}/result", headers={"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.content == kept.content
    for etag in (plain.headers["etag"], packed.headers["etag"], f'"x", {packed.headers["etag"]}', "*"):
        assert client.get(f"jobs/{front}/result", headers={"If-None-Match": etag}).status_code == 304


def test_designs_are_flat_rows_with_units(client: Client, front: str) -> None:
    page = client.get(f"jobs/{front}/designs").json()
    units = {column["name"]: column["unit"] for column in page["columns"]}
    assert (page["total"], page["next"], units["mass"], units["status"]) == (3, None, "kg", None)
    masses = [design["mass"] for design in page["designs"]]
    text = client.get(f"jobs/{front}/files/designs.csv").text
    assert [float(row["mass [kg]"]) for row in csv.DictReader(io.StringIO(text))] == masses

    def found(**asked: Any) -> list[float]:
        answer = client.get(f"jobs/{front}/designs", params=asked)
        assert answer.status_code == 200, answer.text
        return [design["mass"] for design in answer.json()["designs"]]

    assert found(sort="-mass") == sorted(masses, reverse=True)
    assert found(sort="mass", limit=1) == [min(masses)]
    middle = sorted(masses)[1]
    assert found(where=f"mass <= '{middle} kg' and status == 'optimal'", sort="mass") == sorted(masses)[:2]
    assert found(where=f"mass > '{1000 * max(masses)} g'") == []
    first = client.get(f"jobs/{front}/designs?limit=2&sort=length").json()
    second = client.get(f"jobs/{front}/designs?limit=2&sort=length&cursor={first['next']}").json()
    lengths = [design["length"] for design in (*first["designs"], *second["designs"])]
    assert lengths == sorted(lengths)
    assert len(lengths) == 3


@pytest.mark.parametrize(
    ("asked", "path"),
    [
        ({"where": "mass <"}, ["where"]),
        ({"where": "colour == 'red'"}, ["where"]),
        ({"where": "mass < '20 m'"}, ["where"]),
        ({"where": "__import__('os')"}, ["where"]),
        ({"sort": "colour"}, ["sort"]),
        ({"family": "disc_clutch"}, ["family"]),
        ({"cursor": "AAAA"}, ["cursor"]),
        ({"limit": 0}, ["limit"]),
        ({"limit": 1000}, ["limit"]),
    ],
)
def test_what_designs_cannot_be_asked(client: Client, front: str, asked: dict[str, Any], path: list[str]) -> None:
    answer = client.get(f"jobs/{front}/designs", params=asked)
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    assert answer.json()["error"]["problems"][0]["path"] == path


def test_files_are_listed_and_made(client: Client, front: str) -> None:
    names = [file["name"] for file in client.get(f"jobs/{front}/files").json()["files"]]
    assert {"front.json", "designs.csv", "designs.xlsx", "report.html", "report.pdf", "bundle.zip"} <= set(names)
    for name in ("designs.csv", "design_01.yaml", "report.html", "bundle.zip", "design_01_live.xlsx"):
        answer = client.get(f"jobs/{front}/files/{name}")
        assert answer.status_code == 200, answer.text
        assert answer.headers["content-disposition"] == f'attachment; filename="{name}"'
        known = client.get(f"jobs/{front}/files/{name}", headers={"If-None-Match": answer.headers["etag"]})
        assert known.status_code == 304
    bundle = zipfile.ZipFile(io.BytesIO(client.get(f"jobs/{front}/files/bundle.zip").content))
    assert "front.json" in bundle.namelist()
    short = client.get(f"jobs/{front}/files/report.html?length=summary&full=0")
    assert len(short.content) < len(client.get(f"jobs/{front}/files/report.html").content)
    assert client.get(f"jobs/{front}/files/report.html?length=endless").status_code == 422


@pytest.mark.parametrize(
    "name",
    [
        "nothing.csv",
        "../../../etc/passwd",
        "..%2f..%2fetc%2fpasswd",
        "%2e%2e/%2e%2e/front.json",
        "/etc/passwd",
        "%2Fetc%2Fpasswd",
        "front.json%00.csv",
        "http://example.com/front.json",
        "file:///etc/passwd",
        "C:%5Cwindows",
        "design_99.yaml",
        "front.json/",
    ],
)
def test_only_files_that_are_listed_are_given(client: Client, front: str, table: str, name: str) -> None:
    for job in (front, table):
        answer = client.get(f"jobs/{job}/files/{name}")
        assert (answer.status_code, code_of(answer)) == (404, "not_found")
        again = client.get(f"jobs/{job}/files/{name}", headers={"If-None-Match": "*"})
        assert again.status_code == 404


def test_what_needs_an_extra_says_so(
    client: Client, works: Service, front: str, engines: Engines, monkeypatch: pytest.MonkeyPatch
) -> None:
    call = engines.call

    def lacking(task: str, payload: Any, deadline: float) -> Any:
        if task == RENDER_TASK:
            raise ExtraNeededError("--pdf", "pdf")
        return call(task, payload, deadline)

    monkeypatch.setattr(engines, "call", lacking)
    answer = client.get(f"jobs/{front}/files/report.pdf")
    assert (answer.status_code, code_of(answer)) == (501, "not_installed")
    assert "pip install 'clutchsynth[pdf]'" in answer.json()["error"]["message"]
    assert "--pdf" not in answer.text


def test_the_same_spec_by_command_line_gives_the_same_bytes(client: Client, front: str, tmp_path: Path) -> None:
    spec = client.get(f"jobs/{front}/request", headers={"Accept": "application/yaml"}).text
    (tmp_path / "spec.yaml").write_text(spec, encoding="utf-8")
    done = in_process("run", "spec.yaml", "-o", "out", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    by_http = client.get(f"jobs/{front}/files/designs.csv").content
    assert by_http == (tmp_path / "out" / "designs.csv").read_bytes()
    assert FRONT["points"] == 3


def test_rows_are_paged_and_chosen_from(client: Client, front: str, table: str) -> None:
    first = client.get(f"jobs/{table}/rows?limit=2").json()
    second = client.get(f"jobs/{table}/rows?limit=2&cursor={first['next']}").json()
    rows = [*first["rows"], *second["rows"]]
    assert [row["line"] for row in rows] == [2, 3, 4]
    assert second["next"] is None
    assert first["header"][-1] == "note"
    assert rows[0]["best_design"].startswith("mass ")
    assert "many" in rows[2]["explanation"]
    assert [r["line"] for r in client.get(f"jobs/{table}/rows?status=optimal").json()["rows"]] == [2, 3]
    assert client.get(f"jobs/{table}/rows?status=not_solved").json()["rows"] == []
    assert client.get(f"jobs/{table}/rows?status=odd").status_code == 422
    full = client.get(f"jobs/{table}/rows/3").json()
    assert full["question"]["requirements"]["load_torque"] == "500 N*m"
    assert isinstance(full["designs"][0]["mass"], float)
    bad = client.get(f"jobs/{table}/rows/4").json()
    assert (bad["question"], bad["designs"], bad["faults"][0]["column"]) == (None, [], "load_torque")
    assert client.get(f"jobs/{table}/rows/5").status_code == 404
    assert client.get(f"jobs/{table}/rows/0").status_code == 422
    assert client.get(f"jobs/{front}/rows").status_code == 404
    assert client.get(f"jobs/{table}/designs").status_code == 404


def test_cells_that_a_spreadsheet_would_compute_are_kept_from_it(client: Client, table: str) -> None:
    safe, raw = (client.get(f"jobs/{table}/files/rows.csv{query}").text for query in ("", "?raw=1"))
    cells = [[row["input: note"] for row in csv.DictReader(io.StringIO(text))] for text in (safe, raw)]
    assert cells == [["'=1+1"] * 3, ["=1+1"] * 3]


def test_csv_is_given_as_spreadsheets_of_germany_open_it(client: Client, table: str) -> None:
    plain, german = (client.get(f"jobs/{table}/files/designs.csv{query}") for query in ("", "?csv=de"))
    assert german.content.decode() == GERMAN.text(plain.content.decode())
    assert german.content.startswith(b"\xef\xbb\xbfrow;family;")
    assert unstyled(german.content.decode()) == plain.content.decode()
    assert german.headers["etag"] != plain.headers["etag"]
    summary = "files/batch.json"
    assert client.get(f"jobs/{table}/{summary}?csv=de").content == client.get(f"jobs/{table}/{summary}").content
    assert client.get(f"jobs/{table}/files/designs.csv?csv=fr").status_code == 422


def test_the_summary_of_a_batch_tells_no_place_of_this_machine(works: Service, client: Client, table: str) -> None:
    for path in ("result", "files/batch.json"):
        answer = client.get(f"jobs/{table}/{path}")
        assert answer.json()["job"] == table
        assert works.file.name not in answer.text
    found = client.get(f"jobs/{table}/result")
    assert found.headers["etag"] == f'"{hashlib.sha256(found.content).hexdigest()}"'
    assert gzip.compress(found.content)


def test_the_report_of_a_batch_is_a_file_of_it(works: Service, client: Client, table: str) -> None:
    listed = [file["name"] for file in client.get(f"jobs/{table}/files").json()["files"]]
    assert {"report.html", "report.pdf", "batch.xlsx"} < set(listed)
    page = client.get(f"jobs/{table}/files/report.html")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert "Rows by state" in page.text
    assert works.file.name not in page.text
    assert client.get(f"jobs/{table}/files/batch.xlsx").content.startswith(b"PK")
