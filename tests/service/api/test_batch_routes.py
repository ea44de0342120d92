"""Files that are brought, tables that are checked, and part tables in versions."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from synth.service.api.schemas import EXAMPLES
from tests.service.calling import Service, code_of
from tests.service.working import BATCH, DUTY, QUICK, Client

pytestmark = pytest.mark.slow
CATALOGUE_BODY: dict[str, Any] = EXAMPLES["catalogue"]
ROOT = Path(__file__).parents[3]
HEADER = [*DUTY, "note"]
LINES = [[*map(str, {**DUTY, "load_torque": torque}.values()), "=1+1"] for torque in ("400 N*m", "lots", "500 N*m")]
CSV = "\n".join(",".join(line) for line in (HEADER, *LINES)).encode()


def workbook(lines: list[list[Any]]) -> bytes:
    book = openpyxl.Workbook()
    for line in lines:
        book.active.append(line)
    for row in book.active.iter_rows():
        for cell in row:
            cell.data_type = "s" if cell.data_type == "f" else cell.data_type  # a text that looks like a formula
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


def packed(**entries: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name.replace("__", "/"), content)
    return file.getvalue()


def changed(book: bytes, name: str, content: bytes) -> bytes:
    """Return a workbook with another content of one of its files."""
    file = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(book)) as old, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.namelist():
            new.writestr(entry, content if entry == name else old.read(entry))
    return file.getvalue()


def bring(client: Client, content: bytes, name: str = "rows.csv") -> Any:
    return client.post("uploads", files={"file": (name, content)})


@pytest.mark.parametrize("book", [False, True])
def test_a_file_is_brought_checked_and_asked(client: Client, book: bool) -> None:
    content = workbook([HEADER, *LINES]) if book else CSV
    answer = bring(client, content, "../../C:\\Lasten.exe")
    assert answer.status_code == 201, answer.text
    upload = answer.json()
    assert upload["name"] == ("Lasten.xlsx" if book else "Lasten.csv")
    assert (upload["header"], upload["size"], len(upload["rows"])) == (HEADER, len(content), 3)
    asked = {**BATCH, "upload": upload["id"]}
    del asked["rows"]
    checked = client.post("batches/check", asked).json()
    assert (checked["rows"], checked["bad"], checked["carried"]) == (3, 1, ["note"])
    (fault,) = checked["faults"]
    assert (fault["line"], fault["column"], fault["value"]) == (3, "load_torque", "lots")
    made = client.post("batches", asked)
    assert made.status_code == 202
    assert client.ended(made.json()["id"])["summary"]["status"] == {"bad_input": 1, "optimal": 2}


BOOK = workbook([["load_torque"], ["400"]])
LAUGHS = (
    b'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "ha">'
    + b"".join(b'<!ENTITY %c "%s">' % (98 + k, b"&%c;" % (97 + k) * 10) for k in range(9))
    + b']><worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">'
    b'<sheetData><row r="1"><c r="A1" t="inlineStr"><is><t>&j;</t></is></c></row></sheetData></worksheet>'
)


@pytest.mark.parametrize(
    ("content", "status"),
    [
        (b"\x89PNG\r\n\x1a\n", 415),
        (b"%PDF-1.7", 415),
        (b"<html></html>", 415),
        (b'{"a": 1}', 415),
        (b"a,b\n\x00,1\n", 415),
        (b"a,\x81\n1,2\n", 415),
        (packed(a=b"1"), 415),
        (packed(xl__workbook__xml=b"1").replace(b"xl/workbook/xml", b"xl/workbook.xml"), 422),
        (b"PK\x03\x04 broken", 422),
        (b"", 422),
        (b"\n\n", 422),
        (b"a,a\n1,2\n", 422),
        (b'a,b\n"1,2\n', 422),
        (changed(BOOK, "xl/worksheets/sheet1.xml", b"0" * 99_000_000), 422),
        (changed(BOOK, "xl/worksheets/sheet1.xml", LAUGHS), 422),
        (changed(BOOK, "xl/worksheets/sheet1.xml", b"<worksheet"), 422),
    ],
)
def test_what_is_no_table_is_refused(client: Client, content: bytes, status: int) -> None:
    answer = bring(client, content)
    assert answer.status_code == status, answer.text
    code_of(answer)


def test_a_table_in_another_encoding_is_told_as_one(client: Client) -> None:
    answer = bring(client, b"a,b\n1,2\nL\x81nge,3\n")
    assert (answer.status_code, code_of(answer)) == (415, "unsupported_media")
    assert answer.json()["error"]["message"].startswith(
        "file, line 3: got b'\\x81'; expected text in UTF-8, UTF-16 or Windows-1252"
    )


def test_a_table_in_an_encoding_that_is_stated_is_taken(client: Client) -> None:
    raw = "stroj,load_torque [N*m]\nčep,60\n".encode("cp1250")
    refused = bring(client, raw)
    assert (refused.status_code, code_of(refused)) == (415, "unsupported_media")
    assert "--encoding cp1250 for 'čep'" in refused.json()["error"]["message"]
    taken = client.post("uploads?encoding=cp1250", files={"file": ("rows.csv", raw)})
    assert taken.status_code == 201, taken.text
    assert taken.json()["rows"] == [{"line": 2, "cells": ["čep", "60"]}]
    for wrong in ("cp99", "base64"):
        assert client.post(f"uploads?encoding={wrong}", files={"file": ("rows.csv", raw)}).status_code == 422


def test_hidden_rows_are_told_and_left_out_where_it_is_asked(client: Client) -> None:
    book = openpyxl.load_workbook(io.BytesIO(workbook([HEADER, *LINES])))
    book.active.row_dimensions[2].hidden = True
    packed = io.BytesIO()
    book.save(packed)
    every = bring(client, packed.getvalue(), "rows.xlsx").json()
    assert "with 1 hidden or filtered row (2; " in every["reading"]
    shown = client.post("uploads?visible=true", files={"file": ("rows.xlsx", packed.getvalue())}).json()
    assert [row["line"] for row in every["rows"]] == [2, *[row["line"] for row in shown["rows"]]]
    assert shown["reading"] == ""


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16", "utf-8-sig"])
def test_a_table_of_a_german_spreadsheet_is_taken(client: Client, encoding: str) -> None:
    text = "Länge;load_torque [N*m];driver_speed [1/min];driven_inertia [kg*m2]\r\nA;60,5;1500;0,5\r\n"
    brought = bring(client, text.encode(encoding))
    assert brought.status_code == 201, brought.text
    asked = {"family": "cone_clutch", "upload": brought.json()["id"], "points": 2}
    told = client.post("batches/check", asked).json()
    assert (told["rows"], told["faults"]) == (1, []), told


def test_bodies_of_uploads_are_bounded(works: Service, client: Client) -> None:
    large = bring(client, b"a" * (works.settings.upload_limit + 1))
    assert (large.status_code, code_of(large)) == (413, "too_large")
    assert client.post("uploads", {"file": "rows.csv"}).status_code in (415, 422)
    assert client.post("uploads", files={"other": ("a.csv", b"a\n1\n")}).status_code == 422
    no_file = client.post("uploads", data={"file": "rows"}, files={"other": ("a.csv", b"a\n1\n")}).json()["error"]
    assert no_file["message"] == "file: got 'rows'; expected a file with its content"


def test_files_go_when_there_are_too_many(works: Service, client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("synth.service.api.batch_routes.uploads_kept", lambda *_: works.settings.tenant_uploads)
    answer = bring(client, CSV)
    assert (answer.status_code, code_of(answer)) == (429, "too_many")


def test_a_table_as_a_whole_is_refused(client: Client) -> None:
    for asked in ({"rows": []}, {"upload": "x"}, {}, {"rows": [1]}, {**BATCH, "mapping": 1}, {**BATCH, "points": 0}):
        answer = client.post("batches/check", asked)
        assert (answer.status_code, code_of(answer)) == (422, "bad_input"), asked


# ---- part tables ----------------------------------------------------------------------------------------------------


def test_part_tables_have_versions(client: Client) -> None:
    first = client.post("catalogues", CATALOGUE_BODY)
    assert first.status_code == 201
    assert first.headers["location"] == "/api/v1/catalogues/my_linings/1"
    same = client.post("catalogues", {**CATALOGUE_BODY, "note": "again"})
    assert (same.status_code, code_of(same)) == (409, "same_content")
    assert same.headers["location"] == first.headers["location"]
    more = CATALOGUE_BODY["csv"].replace("0.3", "0.35") + "L2,0.4,data sheet,typical\n"
    second = client.post("catalogues", {**CATALOGUE_BODY, "csv": more}).json()
    assert (second["reference"], second["rows"]) == ("my_linings@2", 2)
    assert [one["version"] for one in client.get("catalogues").json()["catalogues"]] == [2, 1]
    found = client.get("catalogues/my_linings/2").json()
    assert (found["csv"], found["schema"], found["used_by"]) == (more, CATALOGUE_BODY["schema"], [])
    diff = client.get("catalogues/my_linings/2/changes?since=1").json()
    assert (diff["added"], diff["removed"]) == (["L2"], [])
    assert diff["changed"] == [{"designation": "L1", "column": "mu [-]", "before": "0.3", "after": "0.35"}]
    assert client.get("catalogues/my_linings/3").status_code == 404
    assert client.get("catalogues/my_linings/2/changes?since=3").status_code == 404
    assert client("DELETE", "catalogues/my_linings/2").status_code == 204
    assert client("DELETE", "catalogues/my_linings/2").status_code == 404


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"csv": "designation,mu [-]\nL1,much\n"}, ["csv"]),
        ({"csv": "mu [-]\n0.3\n"}, ["csv"]),
        ({"csv": CATALOGUE_BODY["csv"].splitlines()[0] + "\n"}, ["csv"]),
        ({"schema": "column,type\nx,odd\n"}, ["schema"]),
        ({"schema": ""}, ["table"]),
        ({"name": "../x"}, ["name"]),
        ({"name": "/etc/passwd"}, ["name"]),
        ({"name": ""}, ["name"]),
        ({"url": "http://example.com/table.csv"}, ["url"]),
    ],
)
def test_what_is_no_part_table_is_refused(client: Client, change: dict[str, str], path: list[str]) -> None:
    answer = client.post("catalogues", {**CATALOGUE_BODY, **change})
    assert (answer.status_code, code_of(answer)) == (422, "bad_input"), answer.text
    assert answer.json()["error"]["problems"][0]["path"] == path


def test_a_table_that_a_job_names_stays(client: Client) -> None:
    rows = (ROOT / "catalogs" / "friction_materials.csv").read_text(encoding="utf-8")
    made = client.post("catalogues", {"name": "own", "table": "friction_materials", "csv": rows})
    assert made.status_code == 201, made.text
    job = client.post("jobs", {"kind": "synthesis", "request": {**QUICK, "catalogs": {"friction_materials": "own@1"}}})
    assert job.status_code == 202, job.text
    told = client.ended(job.json()["id"])
    assert told["state"] == "done", told
    kept = client("DELETE", "catalogues/own/1")
    assert (kept.status_code, code_of(kept)) == (409, "in_use")
    assert client.get("catalogues/own/1").json()["used_by"] == [job.json()["id"]]
    assert client("DELETE", f"jobs/{job.json()['id']}").status_code == 204
    assert client("DELETE", "catalogues/own/1").status_code == 204
