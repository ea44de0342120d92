"""A batch of many rows, made of a small one that was worked off: what reads batches is tried at their size.

``python -m tests.batches.many_rows SMALL LARGE 10000`` makes the folder LARGE from the folder SMALL of a batch.
"""

from __future__ import annotations

import json
import shutil
import sqlite3
import sys
from contextlib import closing
from hashlib import sha256
from pathlib import Path


def multiplied(small: Path, large: Path, count: int) -> Path:
    """Return a folder with a batch of so many rows: those of a small one again and again, each an answer of its own."""
    large.mkdir()
    with closing(sqlite3.connect(small / "jobs.sqlite")) as source:
        source.execute("VACUUM INTO ?", (str(large / "jobs.sqlite"),))
    with closing(sqlite3.connect(large / "jobs.sqlite")) as database, database:
        job = json.loads((small / "batch.json").read_text(encoding="utf-8"))["job"]
        rows = database.execute("SELECT * FROM job_row WHERE job = ? ORDER BY line", (job,))
        names = [column[0] for column in rows.description]
        kept = [dict(zip(names, row, strict=True)) for row in rows]
        answers = {row[1]: row for row in database.execute("SELECT * FROM result WHERE job = ?", (job,))}
        asked = {row[1]: row for row in database.execute("SELECT * FROM question WHERE job = ?", (job,))}
        line = kept[-1]["line"]
        for number in range(count - len(kept)):
            row = dict(kept[number % len(kept)])
            key, line = row["key"], line + 1
            cells = json.loads(row["cells"])
            cells[0] = f"{cells[0]} no. {number}"
            row |= {"line": line, "cells": json.dumps(cells)}
            if key is not None:
                row["key"] = sha256(f"{key} {number}".encode()).hexdigest()[: len(key)]
                for table, found in (("question", asked), ("result", answers)):
                    if key in found:
                        values = (found[key][0], row["key"], *found[key][2:])
                        database.execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(values))})", values)
            database.execute(f"INSERT INTO job_row VALUES ({', '.join('?' * len(names))})", [row[n] for n in names])
        database.execute("UPDATE job SET rows = ?, folder = ? WHERE id = ?", (count, str(large.resolve()), job))
    shutil.copy(small / "batch.json", large)
    return large


if __name__ == "__main__":
    print(multiplied(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])))
