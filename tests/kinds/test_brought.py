"""Files that are brought: of a long one the head is looked at, before anything is parsed."""

from __future__ import annotations

import dataclasses
import io
from typing import Any

import openpyxl
import pytest

from synth.errors import InputError
from synth.kinds import brought
from synth.kinds.settings import KIND_SETTINGS
from synth.tables.delimited_text import first_lines

pytestmark = pytest.mark.slow
HEAD = "load_torque [N*m];driver_speed [rad/s];note\n"
ROW = "600,5;26,6;a\n"


def told(name: str, content: bytes) -> Any:
    return brought.rows_of_file({"name": name, "content": content, "most": 2}, lambda state: None)


def table(text: str, table: str = "friction_materials", schema: str = "") -> Any:
    payload = {"name": "mine", "table": table, "csv": text, "schema": schema}
    return brought.part_table(payload, lambda state: None)


def test_of_rows_that_are_brought_the_head_is_looked_at_alone() -> None:
    """What stands behind the head is told when the rows are checked: here it would be refused."""
    found = told("rows.csv", (HEAD + KIND_SETTINGS.head * ROW + '"never closed\n').encode())
    assert found["header"] == ["load_torque [N*m]", "driver_speed [rad/s]", "note"]
    assert [row["cells"] for row in found["rows"]] == [["600.5", "26.6", "a"]] * 2
    with pytest.raises(InputError, match="quotes that close"):
        told("rows.csv", (HEAD + 3 * ROW + '"never closed\n').encode())


def test_of_a_workbook_the_head_is_looked_at_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    book = openpyxl.Workbook()
    for _ in range(50):
        book.active.append(["load_torque [N*m]", 1.5] if book.active.max_row == 1 else [100, 2.5])
    content = io.BytesIO()
    book.save(content)
    monkeypatch.setattr(brought, "KIND_SETTINGS", dataclasses.replace(KIND_SETTINGS, head=10))
    with brought._as_file({"name": "rows.xlsx", "content": content.getvalue()}) as file:
        assert len(list(brought.RowTable("rows.xlsx", file, 10).lines())) == 9
    assert len(told("rows.xlsx", content.getvalue())["rows"]) == 2


@pytest.mark.parametrize("text", ['a\n"b\nc"\nd\n', 'a\r\n"b\r\nc"\r\nd\r\n'])
def test_a_head_ends_with_a_line_and_not_within_a_cell(text: str) -> None:
    assert first_lines(text.encode(), "table", 2).decode() == text[: text.index("d")]
    assert first_lines(text.encode("utf-16"), "table", 1).decode() == text[: text.index('"')]


def test_rows_without_names_are_refused_before_their_cells_are_read() -> None:
    with pytest.raises(InputError, match="header: is missing; expected a column designation"):
        table("name,mu_dynamic [-]\n" + 10 * "a,none\n")  # "none" is no number
    with pytest.raises(InputError, match="mu_dynamic"):
        table("designation,mu_dynamic [-]\na,none\n")


def test_a_part_table_of_too_many_rows_is_refused_before_its_cells_are_read() -> None:
    lines = KIND_SETTINGS.part_rows + 1
    with pytest.raises(InputError) as refused:
        table("designation,mu_dynamic [-]\n" + KIND_SETTINGS.part_rows * "a,none\n")
    assert f"got {lines} lines; expected a part table of at most {KIND_SETTINGS.part_rows}" in str(refused.value)
