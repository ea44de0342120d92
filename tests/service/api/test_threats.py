"""What somebody who may ask can do to others, to the machine, and to whoever opens what was made."""

from __future__ import annotations

import csv
import io
import struct
from pathlib import Path
from typing import Any

import openpyxl
import pytest
import sqlalchemy as sa

from synth.batches.store import Outcome
from synth.queue.models import Tenant
from synth.queue.owners import new_owner
from synth.workers.engine_process import Engines
from synth.workers.settings import INTERACTIVE
from tests.service.api.test_batch_routes import BOOK, LAUGHS, bring, changed
from tests.service.calling import Service, code_of
from tests.service.served import most_memory, processor_time
from tests.service.working import BATCH, DUTY, LONG, PATIENT, QUICK, Client, working
from tests.waiting import PATIENCE

pytestmark = pytest.mark.slow
SHEET = "xl/worksheets/sheet1.xml"
MEMORY = 300_000_000  # bytes, of an engine process
WORK = 4.0  # s of a processor, for one file; 1 where the machine is not shared

# ---- files that are more than they seem -----------------------------------------------------------------------------


def lying(book: bytes, size: int) -> bytes:
    """Return a workbook that says of each of its files that it unpacks to so many bytes."""
    content = bytearray(book)
    place = content.find(b"PK\x01\x02")
    while place >= 0:
        content[place + 24 : place + 28] = struct.pack("<I", size)
        place = content.find(b"PK\x01\x02", place + 4)
    return bytes(content)


def nested_book(size: int) -> bytes:
    """Return a workbook whose sheet is packed as little as may be, and yet is large: half of it is noise."""
    text = b"".join(b'<c t="inlineStr"><is><t>%d</t></is></c>' % (k * 7919) for k in range(size // 45))
    sheet = b'<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData><row>'
    return changed(BOOK, SHEET, sheet + text + b"</row></sheetData></worksheet>")


BOMBS = {
    "zeros": changed(BOOK, SHEET, b"0" * 99_000_000),
    "zeros said to be few": lying(changed(BOOK, SHEET, b"0" * 99_000_000), 1_000),
    "texts shared": changed(BOOK, "xl/workbook.xml", b" " * 90_000_000),
    "one cell without end": changed(BOOK, SHEET, LAUGHS.partition(b"<!DOCTYPE")[0] + b"<a" * 10_000_000),
    "laughs": changed(BOOK, SHEET, LAUGHS),
    "laughs in texts": changed(BOOK, "xl/styles.xml", LAUGHS),
}


@pytest.fixture(scope="module")
def own_engine() -> Any:
    """Yield an engine process that has done nothing else, so that its memory is that of the files."""
    found = Engines(1, INTERACTIVE)
    yield found
    found.close()


@pytest.mark.parametrize("name", BOMBS)
def test_a_small_file_that_would_unpack_to_much_is_refused_at_once(
    own_engine: Engines, tmp_path: Path, name: str
) -> None:
    with Service(tmp_path, own_engine, **PATIENT) as service:
        client = Client(service)
        assert bring(client, BOOK).status_code == 201  # the process is warm
        (process,) = own_engine.pool._all
        before = processor_time(process.pid)
        answer = bring(client, BOMBS[name])
    assert (answer.status_code, code_of(answer)) == (422, "bad_input"), answer.text
    assert own_engine.pool._all == {process}
    assert processor_time(process.pid) - before < WORK
    assert most_memory(process.pid) < MEMORY


def test_a_file_that_is_as_large_as_may_be_is_read_in_bounds(own_engine: Engines, tmp_path: Path) -> None:
    """Nothing of it is wrong before it is read: the columns are too many, and that is seen at the first row."""
    with Service(tmp_path, own_engine, **PATIENT) as service:
        answer = bring(Client(service), nested_book(8_000_000))
    assert (answer.status_code, code_of(answer)) == (422, "bad_input"), answer.text
    for process in own_engine.pool._all:
        assert most_memory(process.pid) < 2 * MEMORY


# ---- files that a spreadsheet opens ---------------------------------------------------------------------------------

FORMULAS = ("=1+1", "+1+cmd|' /C calc'!A0", "-2+3+cmd|' /C calc'!A0", "@SUM(A1)", '=HYPERLINK("http://x.example","a")')


def cells_of(content: bytes) -> list[Any]:
    book = openpyxl.load_workbook(io.BytesIO(content))
    return [cell for sheet in book.worksheets for row in sheet.iter_rows() for cell in row if cell.value is not None]


def test_no_text_of_somebody_is_a_formula_of_a_workbook(client: Client) -> None:
    rows = (Path(__file__).parents[3] / "catalogs" / "friction_materials.csv").read_text(encoding="utf-8")
    evil = "=cmd|calc"
    table = rows.replace("\nsinter", f"\n{evil}_sinter").replace("\nmillboard", f"\n{evil}_millboard")
    table = "\n".join(
        evil + line if k and not line.startswith(evil) else line for k, line in enumerate(table.splitlines())
    )
    made = client.post("catalogues", {"name": "evil", "table": "friction_materials", "csv": table + "\n"})
    assert made.status_code == 201, made.text
    spec = {**QUICK, "catalogs": {"friction_materials": "evil@1"}}
    job = client.submit("synthesis", spec, title='=HYPERLINK("http://x.example")')
    assert client.ended(job)["state"] == "done"
    names = [file["name"] for file in client.get(f"jobs/{job}/files").json()["files"]]
    books = [name for name in names if name.endswith(".xlsx")]
    assert "designs.xlsx" in books
    seen = 0
    for name in books:
        cells = cells_of(client.get(f"jobs/{job}/files/{name}").content)
        for cell in cells:
            if isinstance(cell.value, str) and ("cmd|" in cell.value or "HYPERLINK" in cell.value):
                assert cell.data_type == "s", (name, cell.coordinate, cell.value)
                seen += 1
        if name == "designs.xlsx":
            assert not [cell for cell in cells if cell.data_type == "f"]
    assert seen
    designs = client.get(f"jobs/{job}/files/designs.csv").text
    texts = [cell for line in csv.reader(io.StringIO(designs)) for cell in line if "cmd|" in cell]
    assert texts
    assert all(cell.startswith("'") for cell in texts)


def test_no_cell_that_was_carried_along_is_a_formula(client: Client) -> None:
    asked = {
        **BATCH,
        "rows": [{**DUTY, "load_torque": f"{400 + k} N*m", "note": text} for k, text in enumerate(FORMULAS)],
    }
    job = client.submit("batch", asked)
    assert client.ended(job)["state"] == "done"
    names = [file["name"] for file in client.get(f"jobs/{job}/files").json()["files"]]
    for name in (name for name in names if name.endswith(".csv")):
        for line in csv.reader(io.StringIO(client.get(f"jobs/{job}/files/{name}").text)):
            assert not [cell for cell in line if cell in FORMULAS], name
    for name in (name for name in names if name.endswith(".xlsx")):
        cells = cells_of(client.get(f"jobs/{job}/files/{name}").content)
        assert not [cell for cell in cells if cell.data_type == "f"], name


# ---- work without end -----------------------------------------------------------------------------------------------


def test_a_search_without_end_ends_at_its_time_and_others_go_on(engines: Engines, tmp_path: Path) -> None:
    with working(tmp_path, engines, slots=2) as service:
        other, limit, found = Client(service, service.token(tenant="other")), 3.0, 0
        while not found:  # on a busy machine a search finds something later, and may be ended before it ends itself
            name = f"greedy-{limit:g}"
            service.accounts.tenant(name, {**service.settings.tenant_limits, "seconds_limit": limit})
            client = Client(service, service.token(tenant=name))
            endless = client.submit("synthesis", {**LONG, "points": 500, "gap": 1e-6, "grid": False})
            client.until(endless, lambda told: told["state"] == "running")
            assert other.ended(other.submit("synthesis", QUICK))["state"] == "done"
            told = client.ended(endless)
            assert told["state"] == "stopped"
            found = (told["summary"] or {}).get("designs", 0)  # what was found is kept
            refused = client.post("jobs", {"kind": "synthesis", "request": QUICK, "seconds_limit": limit + 1})
            assert (refused.status_code, code_of(refused)) == (422, "bad_input")
            limit *= 4
            assert limit < PATIENCE


def test_answers_of_one_tenant_are_not_used_for_another(works: Service) -> None:
    """Else how quickly a table is answered would tell what others have asked."""
    store = works.store
    with store.engine.begin() as connection:
        made = [
            connection.execute(
                sa.insert(Tenant).values(name=f"twin {k}", limits={}, created=0.0).returning(Tenant.id)
            ).scalar_one()
            for k in range(2)
        ]
    question = {"key": "k", "structure": "s", "position": b"p", "content": {"n": 1}}
    row = {"line": 2, "position": b"p", "key": "k", "family": "f", "cells": ["1"], "remarks": "", "faults": []}
    usual = {
        "kind": "batch",
        "title": "t",
        "state": "open",
        "priority": 0,
        "basis": "b",
        "code": None,
        "content": {},
        "request": {},
        "pinned": False,
        "source": "",
        "folder": "",
    }
    names = ("first", "same", "foreign")
    for name, tenant in zip(names, (made[0], made[0], made[1]), strict=True):
        assert store.create(
            {"id": name, "tenant": tenant, "fingerprint": name, **usual}, [{**row, "question": question}], 1
        )
        if name == "first":
            owner = new_owner()
            (claim,) = store.claim(name, owner, 1)
            store.finish(name, claim, owner, {"k": Outcome("optimal", 1.0, None, {})}, {}, 1)
    assert [sum(store.account(name).status.values()) for name in names] == [1, 1, 0]
    with store.engine.begin() as connection:
        connection.execute(sa.delete(Tenant).where(Tenant.id.in_(made)))
