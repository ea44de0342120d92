"""Part tables of one's own: what is told of how they are read, and of what they lack."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tests.service.working import FAMILY, QUICK, Client

pytestmark = pytest.mark.slow
TABLE = "friction_materials"


SHIPPED = (Path(__file__).parents[3] / "catalogs" / f"{TABLE}.csv").read_text(encoding="utf-8")


def brought(client: Client, name: str, csv: str) -> str:
    answer = client.post("catalogues", {"name": name, "table": TABLE, "csv": csv})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["reference"])


def test_columns_that_an_own_table_lacks_are_told_by_a_check_and_all_at_once(client: Client) -> None:
    reference = brought(client, "bare", "designation,mu_dynamics [-]\nL1,0.1\n")
    asked = {**QUICK, "catalogs": {TABLE: reference}, "requirements": {"load_torque": "much"}}
    answer = client.post("check", asked)
    assert answer.status_code == 200
    found = answer.json()
    assert not found["ready"]
    problems = {tuple(one["path"]): one for one in found["problems"]}
    assert ("catalogs", TABLE, "mu_dynamic") in problems
    assert len([path for path in problems if path[:2] == ("catalogs", TABLE)]) >= 2
    assert "did you mean mu_dynamics?" in problems["catalogs", TABLE, "mu_dynamic"]["message"]
    assert ("requirements", "load_torque") in problems  # what else is wrong is told beside it
    refused = client.post("jobs", {"kind": "synthesis", "request": asked})
    assert refused.status_code == 422
    assert {tuple(one["path"]) for one in refused.json()["error"]["problems"]} == set(problems)


@pytest.mark.parametrize(
    "spec",
    [
        {"family": FAMILY, "catalogs": {TABLE: "nothing@1"}},
        {"family": FAMILY, "catalogs": {"nothing": "nothing@1"}},
        {"family": FAMILY, "catalogs": []},
        {"family": [FAMILY, "disc_clutch"], "catalogs": {TABLE: "nothing@1"}},
    ],
)
def test_a_check_tells_what_is_wrong_with_tables_and_refuses_nothing(client: Client, spec: dict[str, Any]) -> None:
    answer = client.post("check", spec)
    assert (answer.status_code, answer.json()["ready"]) == (200, False)
    assert any(one["path"][:1] == ["catalogs"] for one in answer.json()["problems"])


# ---- how a table was read -------------------------------------------------------------------------------------------


def test_a_whole_table_has_nothing_to_remark(client: Client) -> None:
    told = client.post("catalogues", {"name": "whole", "table": TABLE, "csv": SHIPPED}).json()
    assert told["reading"] == {"separator": ",", "encoding": "utf-8", "decimal_commas": []}
    assert (told["missing"], told["remarks"]) == ([], [])
    assert all(column["known"] and column["meant"] is None for column in told["columns"])
    assert len(told["columns"]) == 42


def test_it_is_told_how_a_table_was_read_and_which_columns_are_known(client: Client) -> None:
    csv = "designation;mu_dynamics [-];colour\nL1;0,12;red\nL2;0,1;blue\n"
    answer = client.post("catalogues", {"name": "odd", "table": TABLE, "csv": csv})
    assert answer.status_code == 201
    told = answer.json()
    assert told["reading"] == {"separator": ";", "encoding": "utf-8", "decimal_commas": ["mu_dynamics [-]"]}
    assert told["columns"] == [
        {"name": "designation", "unit": None, "known": True, "meant": None},
        {"name": "mu_dynamics", "unit": "-", "known": False, "meant": "mu_dynamic"},
        {"name": "colour", "unit": None, "known": False, "meant": None},
    ]
    slots = {(one["family"], one["slot"]): one["columns"] for one in told["missing"]}
    assert "mu_dynamic" in slots[FAMILY, "friction_pair"]
    assert told["remarks"][0] == "odd: semicolons between the columns, decimal commas in mu_dynamics [-]"
    assert "column colour: no family knows it, and it is carried along" in told["remarks"]
    assert any("column mu_dynamics" in one and "did you mean mu_dynamic?" in one for one in told["remarks"])
    (missing,) = [one for one in told["remarks"] if one.startswith("column mu_dynamic is missing")]
    assert f"friction_pair of {FAMILY}" in missing


def test_what_is_told_to_be_missing_is_what_a_check_misses(client: Client) -> None:
    csv = "designation,mu_dynamic [-]\nL1,0.1\n"
    told = client.post("catalogues", {"name": "scarce", "table": TABLE, "csv": csv}).json()
    (missing,) = [one["columns"] for one in told["missing"] if one["family"] == FAMILY]
    checked = client.post("check", {**QUICK, "catalogs": {TABLE: told["reference"]}}).json()
    lacking = [one["path"][2] for one in checked["problems"] if one["path"][:2] == ["catalogs", TABLE]]
    assert lacking
    assert set(lacking) == {name for name in missing if " or " not in name}


def test_a_table_of_ones_own_is_known_by_its_schema(client: Client) -> None:
    schema = "column,type,unit,minimum,maximum,required,symbol,description\ndesignation,text,,,,1,,Name\n"
    schema += "mass,number,kg,,,1,m,Mass\n"
    csv = "designation,mass [kg],mas [kg]\nA,1,2\n"
    told = client.post("catalogues", {"name": "mine", "table": "things", "csv": csv, "schema": schema}).json()
    assert [column["known"] for column in told["columns"]] == [True, True, False]
    assert told["missing"] == []


@pytest.mark.parametrize("extends", [False, True])
def test_a_misspelt_column_beside_right_ones_is_remarked_by_a_check(client: Client, extends: bool) -> None:
    head, *rows = SHIPPED.splitlines()
    csv = "\n".join([head.replace("relative_cost", "relative_cots"), *(f"own_{row}" for row in rows)])
    reference = brought(client, f"misspelt_{extends}", csv)
    found = client.post("check", {**QUICK, "catalogs": {TABLE: ["+", reference] if extends else reference}}).json()
    assert found["ready"], found["problems"]
    (remark,) = found["remarks"]
    assert remark["path"] == ["catalogs", TABLE, "relative_cots"]
    assert remark["message"].endswith("did you mean relative_cost?")
    assert client.post("check", QUICK).json()["remarks"] == []


def test_versions_with_semicolons_are_compared_cell_by_cell(client: Client) -> None:
    for number in ("0,12", "0,13"):
        brought(client, "changes", f"designation;mu_dynamic [-]\nL1;{number}\nL2;0,2\n")
    told = client.get("catalogues/changes/2/changes?since=1").json()
    assert told["changed"] == [{"designation": "L1", "column": "mu_dynamic [-]", "before": "0.12", "after": "0.13"}]
    assert (told["added"], told["removed"]) == ([], [])


# ---- files ----------------------------------------------------------------------------------------------------------


def file_id(client: Client, name: str, content: bytes) -> str:
    answer = client.post("uploads", files={"file": (name, content)})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def workbook(*rows: tuple[object, ...]) -> bytes:
    book, target = openpyxl.Workbook(), io.BytesIO()
    book.active.append(["a cover sheet"])
    sheet = book.create_sheet("Linings")
    for row in rows:
        sheet.append(row)
    book.save(target)
    return target.getvalue()


def test_a_table_may_be_a_file_as_spreadsheets_write_it(client: Client) -> None:
    german = file_id(client, "own.csv", "designation;mu_dynamic [-];Händler\nL1;0,125;Müller\n".encode("cp1252"))
    book = file_id(client, "own.xlsx", workbook(("designation", "mu_dynamic [-]", "Händler"), ("L1", 0.125, "Müller")))
    for name, brought_as in (("western", {"upload": german}), ("sheet", {"upload": book, "sheet": "Linings"})):
        answer = client.post("catalogues", {"name": name, "table": TABLE, **brought_as})
        assert answer.status_code == 201, answer.text
        kept = client.get(f"catalogues/{name}/1").json()["csv"]
        assert "Müller" in kept
        assert "0,125" in kept or "0.125" in kept
    found = client.post("catalogues", {"name": "found", "table": TABLE, "upload": book})
    assert found.json()["rows"] == 1  # the first sheet with designations


@pytest.mark.parametrize(
    ("body", "field"),
    [({}, "csv"), ({"csv": "designation\nL1\n", "upload": "x"}, "csv"), ({"upload": "nothing"}, "upload")],
)
def test_rows_are_brought_in_one_way(client: Client, body: dict[str, str], field: str) -> None:
    refused = client.post("catalogues", {"name": "own", "table": TABLE, **body})
    assert refused.status_code == 422
    assert [one["path"] for one in refused.json()["error"]["problems"]] == [[field]]
