"""Part tables of one's own: what is told of how they are read, and of what they lack."""

from __future__ import annotations

from typing import Any

import pytest

from tests.service.working import FAMILY, QUICK, Client

pytestmark = pytest.mark.slow
TABLE = "friction_materials"


@pytest.fixture(scope="module")
def shipped(client: Client) -> tuple[list[str], list[list[Any]]]:
    """Yield headings and rows of a table of ours, as a user would copy them."""
    told = client.get(f"tables/{TABLE}").json()
    titles = [
        column["name"] if column["unit"] is None else f"{column['name']} [{column['unit']}]"
        for column in told["columns"]
    ]
    return titles, told["rows"]


def text_of(titles: list[str], rows: list[list[Any]], separator: str = ",") -> str:
    lines = [titles, *([("" if cell is None else f"{cell}") for cell in row] for row in rows)]
    quoted = [[f'"{cell}"' if set(cell) & {",", ";", '"'} else cell for cell in line] for line in lines]
    return "\n".join(separator.join(line) for line in quoted) + "\n"


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
