"""Plain text tables, easy to paste, and the same figures as CSV."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

NUMERIC = re.compile(r"^[<>~]?-?[\d .]+(e[+-]?\d+)?( [%x])?$")


@dataclass(frozen=True)
class Report:
    """One part of the benchmarks: a title, remarks, and rows that share their columns."""

    title: str
    rows: Sequence[Mapping[str, Any]]
    remarks: Sequence[str] = ()

    def text(self) -> str:
        """Return the table, columns aligned, remarks below it."""
        columns = list(dict.fromkeys(name for row in self.rows for name in row))
        cells = [[shown(row.get(name)) for name in columns] for row in self.rows]
        widths = [max(len(name), *(len(line[k]) for line in cells)) for k, name in enumerate(columns)]
        right = [
            all(NUMERIC.match(line[k]) or line[k] in ("-", "stopped") for line in cells) for k in range(len(columns))
        ]
        lines = [self.title, "=" * len(self.title)]
        if columns:
            lines.append(_line(columns, widths, right))
            lines.append("  ".join("-" * width for width in widths))
            lines += [_line(line, widths, right) for line in cells]
        return "\n".join([*lines, *(f"* {remark}" for remark in self.remarks)]) + "\n"


def _line(cells: Sequence[str], widths: Sequence[int], right: Sequence[bool]) -> str:
    aligned = [c.rjust(w) if r else c.ljust(w) for c, w, r in zip(cells, widths, right, strict=True)]
    return "  ".join(aligned).rstrip()


def shown(value: Any) -> str:
    """Return a cell: three or four significant digits, thousands apart, a dash for what is not known."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", " ")
    if isinstance(value, float):
        if not math.isfinite(value):
            return "-"
        if abs(value) >= 1000:
            return f"{value:,.0f}".replace(",", " ")
        return f"{value:#.3g}".rstrip(".") if abs(value) >= 1e-4 or value == 0 else f"{value:.2e}"
    return str(value)


def write_csv(path: Path, reports: Sequence[Report]) -> None:
    """Write all figures with one line each: part, row, figure, value."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["part", "row", "figure", "value"])
        for report in reports:
            for number, row in enumerate(report.rows, start=1):
                for name, value in row.items():
                    writer.writerow([report.title, number, name, "" if value is None else value])
