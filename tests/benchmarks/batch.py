"""Batches of thousands of rows: time, memory, solver calls and what the job database costs; and size ranges.

``python -m tests.benchmarks.batch ROWS POINTS SIZE WORKERS`` measures one batch by itself, and prints JSON.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import sqlalchemy as sa

from synth.batches import runner
from synth.batches.batch import BatchJob
from synth.batches.outputs import write_outputs
from synth.question.settings import SearchSettings
from synth.queue.models import Job
from synth.variants.p_median import Chooser
from tests.benchmarks import cases
from tests.benchmarks.tables import Report
from tests.sample_problems.rod import Rod

ROOT = Path(__file__).parents[2]
FAMILY = "multi_plate_clutch"
MIB = 2**20
EMPTY_ROWS = 2000
LONG = "long"


def case(rows: int, points: int, size: str, folder: Path) -> BatchJob:
    """Return a batch of seeded requirement rows around the hoist.

    Parameters
    ----------
    rows, points : int
        One point is the least mass, to 0.1 %.
    size : str
        One of ``cases.SIZES``.
    folder : Path
        For its results.
    """
    question = cases.question(cases.SIZES[size])
    asked_rows = [{**row, "practice": "off"} for row in cases.requirement_rows(rows)]
    asked = ["mass"] if points == 1 else ["mass", "actuation_force"]
    common = {"parts": question["parts"], "limits": None, "fix": None, "objectives": asked, "grid": True}
    settings = SearchSettings(points=points)
    return BatchJob(FAMILY, asked_rows, folder, None, cases.tables(cases.SIZES[size]), None, settings, common)


def measure(rows: int, points: int, size: str, workers: int | None) -> dict[str, Any]:
    """Run a batch and return its figures; ``workers`` None works in this process."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        job = case(rows, points, size, Path(folder))
        job.plan()
        planned = time.monotonic()
        job.work(workers, None, None)
        worked = time.monotonic()
        counts = job.write()
        written = time.monotonic()
        contents = [row.content for row in job.store.rows(job.id, canonical=False) if row.content is not None]
        job.close()
    solves = [c["nlp_solves"] for c in contents if c.get("nlp_solves") is not None]
    to_find = [c["nlp_solves_to_find"] for c in contents if c.get("nlp_solves_to_find") is not None]
    unit = 1024 if sys.platform != "darwin" else 1
    return {
        "rows": rows,
        "points": points,
        "combinations": max((c.get("combinations", 0) for c in contents), default=0),
        "workers": workers or 1,
        "seconds": written - begin,
        "check and plan s": planned - begin,
        "rows per second": rows / max(worked - planned, 1e-9),
        "write s": written - worked,
        "NLPs to find, median": float(statistics.median(to_find)) if to_find else None,
        "NLPs in all, median": float(statistics.median(solves)) if solves else None,
        "global": sum(c.get("certificate") == "global" for c in contents),
        "with designs": counts.get("optimal", 0) + counts.get("feasible", 0),
        "MiB, master": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / MIB,
        "MiB, worker": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit / MIB,
    }


def _answered_at_once(work: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    content = {
        "certificate": "global",
        "gap": 1e-3,
        "rows": [["1.2345678901234567"] * 70],
        "designs": [],
        "nlp_solves": 1,
    }
    layout = {
        "family": FAMILY,
        "senses": {},
        **{group: [] for group in ("objectives", "choices", "parts", "derived", "limits")},
    }
    layout["searched"] = [f"column {k} [mm]" for k in range(64)]
    return {
        key: {"status": "optimal", "seconds": 0.0, "layout": layout, "content": content} for key in work["questions"]
    }


def overhead(rows: int, database: str | None = None) -> dict[str, Any]:
    """Return what writing, claiming, keeping and reading cost per row, where solving costs nothing.

    ``database`` is an address; none is a SQLite file. What checking the rows costs, without any database, stands apart.
    """
    known = runner.solve_unit
    runner.solve_unit = _answered_at_once
    try:
        with tempfile.TemporaryDirectory() as folder:
            job = case(rows, 1, "tiny", Path(folder))
            job.address = database or job.address
            job.id = uuid.uuid4().hex[:16]  # in a database that is kept, a job of its own each time
            job.basis = job.id
            job.store.jobs()  # opens the database, which is not a matter of rows
            begin = time.monotonic()
            for _ in case(rows, 1, "tiny", Path(folder)).questioner.rows():  # a row is checked once per questioner
                pass
            checked = time.monotonic()
            job.plan()
            planned = time.monotonic()
            job.work(None, None, None)
            worked = time.monotonic()
            write_outputs(job.store, job.id, job.folder)
            written = time.monotonic()
            with job.store.engine.begin() as connection:
                if database:
                    connection.execute(sa.delete(Job).where(Job.id == job.id))
            job.close()
    finally:
        runner.solve_unit = known
    plan = (planned - checked) - (checked - begin)
    return {
        "database": "SQLite" if database is None else database.partition(":")[0].partition("+")[0],
        "rows": rows,
        "check ms": 1e3 * (checked - begin) / rows,
        "plan ms": 1e3 * plan / rows,
        "claim and keep ms": 1e3 * (worked - planned) / rows,
        "write ms": 1e3 * (written - worked) / rows,
        "database in all ms": 1e3 * (plan + written - planned) / rows,
    }


def long_table(rows: int, workers: int) -> dict[str, Any]:
    """Return what a file of many rows of three numbers costs, where solving costs nothing."""
    known, chance = runner.solve_unit, np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows.csv"
        with path.open("w", encoding="utf-8") as file:
            file.write("force [kN],safety_factor,diameter_limit [mm]\n")
            for force, safety, room in chance.uniform((1, 1, 10), (400, 3, 90), (rows, 3)):
                file.write(f"{force:.3f},{safety:.4f},{room:.2f}\n")
        begin = time.monotonic()
        common = {"parts": None, "limits": None, "fix": None, "objectives": ["mass"], "grid": True}
        job = BatchJob(Rod, path, Path(folder) / "out", None, None, None, SearchSettings(points=1), common)
        for _ in job.table.lines():
            pass
        opened = time.monotonic()
        checked = [opened]  # when the last row was
        job.plan(workers, lambda state: checked.append(time.monotonic()) if state["stage"] == "checked" else None)
        planned = time.monotonic()
        units = sum(job.store.open_units(job.id))
        runner.solve_unit = _answered_at_once
        try:
            job.work(None, None, None)
        finally:
            runner.solve_unit = known
        worked = time.monotonic()
        job.write()
        written = time.monotonic()
        job.close()
        size = sum(file.stat().st_size for file in (Path(folder) / "out").glob("jobs.sqlite*"))
    unit = 1024 if sys.platform != "darwin" else 1
    return {
        "rows": rows,
        "units": units,
        "read s": opened - begin,
        "check s": checked[-1] - opened,
        "plan s": planned - checked[-1],
        "claim and keep s": worked - planned,
        "write s": written - worked,
        "processor s, master": time.process_time(),
        "database MB": size / 1e6,
        "MiB, master": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / MIB,
        "MiB, worker": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit / MIB,
    }


def in_a_process(rows: int, points: int, size: str, workers: int, most: float) -> dict[str, Any]:
    """Measure a batch in a process of its own; of the size ``long`` a table of three numbers a row."""
    command = [sys.executable, "-m", "tests.benchmarks.batch", str(rows), str(points), size, str(workers)]
    print(f"... batch {rows} rows, {points} points, {size}", file=sys.stderr, flush=True)
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=most, check=False)
    except subprocess.TimeoutExpired:
        return {"rows": rows, "points": points, "seconds": None, "note": f"ended after {most:.0f} s"}
    if done.returncode:
        return {"rows": rows, "points": points, "note": (done.stderr.strip().splitlines() or ["?"])[-1]}
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def batches(quick: bool) -> list[Report]:
    """Return the figures of whole batches, of two sizes to see that memory does not grow with the rows."""
    if quick:
        table = [in_a_process(4, 1, "tiny", 1, 300.0)]
        spent = [overhead(40)]
        long = [in_a_process(3_000, 1, LONG, 2, 300.0)]
    else:
        table = [
            in_a_process(1_000, 1, "110k", 2, 3600.0),
            in_a_process(10_000, 1, "110k", 2, 7200.0),
            in_a_process(1_000, 20, "110k", 2, 7200.0),
        ]
        addresses = [None, *filter(None, [os.environ.get("CLUTCHSYNTH_DATABASE")])]
        spent = [overhead(EMPTY_ROWS, address) for address in addresses]
        long = [in_a_process(rows, 1, LONG, 2, 14_400.0) for rows in (10_000, 1_000_000)]
    return [
        Report("batch", table, ["least mass, or mass against force, to 0.1 %, makeable sizes; rows around the hoist"]),
        Report(
            "job database",
            spent,
            ["per row, with answers that cost nothing; SQLite, and the server that CLUTCHSYNTH_DATABASE names, if any"],
        ),
        Report("long table", long, ["three numbers a row, two processes, answers that cost nothing, SQLite"]),
    ]


def ranges(quick: bool) -> list[Report]:
    """Return the time of choosing variants: rows that need a capacity in a room, and points in the plane."""
    rows, columns = (60, 30) if quick else (1000, 500)
    table = []
    for kind, costs in (("capacity and room", _capacities(rows, columns)), ("plane", _plane(rows, columns))):
        begin = time.monotonic()
        chooser = Chooser(costs, np.ones(len(costs)), 1e-3)
        fewest, _ = chooser.fewest(begin + 60.0)
        number = max(12, len(fewest))
        choice = chooser.best(number, begin + 60.0, fewest)
        table.append(
            {
                "kind": kind,
                "rows": len(costs),
                "candidates": columns,
                "not dominated": chooser.columns,
                "fewest": len(fewest),
                "variants": number,
                "gap": choice.gap,
                "seconds": time.monotonic() - begin,
            }
        )
    return [Report("ranges", table, ["gap 0.1 % asked, 60 s at most"])]


def _capacities(rows: int, columns: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    need, have = np.exp(rng.normal(5, 1, rows)), np.exp(rng.normal(5, 1, columns))
    room = need**0.33 * np.exp(rng.normal(0.5, 0.25, rows))
    size, mass = have**0.33 * np.exp(rng.normal(0.2, 0.2, columns)), have**0.8 * np.exp(rng.normal(0, 0.2, columns))
    fits = (have[None, :] >= need[:, None]) & (size[None, :] <= room[:, None])
    costs = np.where(fits, mass[None, :], np.inf)[fits.any(axis=1)]
    return np.asarray(costs - costs.min(axis=1, keepdims=True))


def _plane(rows: int, columns: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    a, b = rng.random((rows, 2)), rng.random((columns, 2))
    costs = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
    costs[costs > np.maximum(0.45, costs.min(axis=1, keepdims=True))] = np.inf
    return np.asarray(costs - costs.min(axis=1, keepdims=True))


if __name__ == "__main__":
    if sys.argv[3] == LONG:
        print(json.dumps(long_table(int(sys.argv[1]), int(sys.argv[4]))))
    else:
        print(json.dumps(measure(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4]))))
