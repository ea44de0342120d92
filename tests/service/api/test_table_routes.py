"""The part tables that come with the families."""

from __future__ import annotations

import pytest

from tests.service.calling import code_of
from tests.service.working import FAMILY, Client

pytestmark = pytest.mark.slow


def test_tables_are_listed_with_the_families_that_take_parts_from_them(client: Client) -> None:
    found = {one["name"]: one for one in client.get("tables").json()["tables"]}
    assert FAMILY in found["friction_materials"]["families"]
    assert found["core_plates"]["rows"] == 14
    assert found["motors_iec"]["families"] == []


def test_a_table_is_given_in_the_units_of_its_file_with_sources(client: Client) -> None:
    first = client.get("tables/core_plates")
    told = first.json()
    names = [column["name"] for column in told["columns"]]
    assert (names[:2], names[-2:]) == (["designation", "thickness"], ["source", "confidence"])
    assert told["columns"][1] | {"text": ""} == {
        "name": "thickness",
        "unit": "mm",
        "symbol": "t",
        "text": "",
        "lower": 0.05,
        "upper": 20.0,
    }
    assert told["rows"][0][:2] == ["core 0.8", pytest.approx(0.8)]
    assert all(row[-2] and row[-1] for row in told["rows"])
    assert client.get("tables/core_plates", headers={"If-None-Match": first.headers["etag"]}).status_code == 304


def test_a_cell_whose_unit_stands_beside_it_is_given_as_it_stands(client: Client) -> None:
    told = client.get("tables/application_factors").json()
    names = [column["name"] for column in told["columns"]]
    unit, low = names.index("parameter_unit"), names.index("parameter_from")
    assert told["columns"][low]["unit"] == "column:parameter_unit"
    assert any(row[unit] and row[low] is not None for row in told["rows"])


@pytest.mark.parametrize("name", ["nothing", "..%2fmetals", "metals.csv"])
def test_what_is_no_table_is_not_there(client: Client, name: str) -> None:
    answer = client.get(f"tables/{name}")
    assert (answer.status_code, code_of(answer)) == (404, "not_found")
