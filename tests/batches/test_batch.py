"""Batches from Python: the same bytes whatever the order, the workers and the faults."""

from __future__ import annotations

import json
import os
import random
import threading
import time
from collections.abc import Mapping
from concurrent.futures import Future, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import synth
from synth.batches import executors, runner
from synth.batches.batch import BatchJob, resume, work_off
from synth.batches.executors import Cluster, Inline, Processes
from synth.batches.runner import Shares
from synth.batches.settings import BATCHES, BatchSettings, ClusterSettings, RunnerSettings
from synth.batches.store import Store
from synth.errors import InputError
from synth.question.settings import SearchSettings
from synth.queue.database import file_url
from tests.batches.deadly import deadly_unit, faulty_unit
from tests.sample_problems.rod import Rod
from tests.waiting import PATIENCE, until

PARTS = "steel = S185, 42CrMo4"


def rows(count: int) -> list[dict[str, Any]]:
    return [
        {
            "id": f"R{k}",
            "force [kN]": 10 + k,
            "section": "square" if k % 3 == 0 else "",
            "parts": PARTS,
            "diameter_limit [mm]": 30 if k % 2 else None,
            "length [mm]": 100,
        }
        for k in range(count)
    ]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> synth.BatchResult:
    """Return eight rows, solved in this process, and three that cannot be: bad, infeasible, and one twice."""
    more = [
        {"id": "bad", "force [kN]": "x", "parts": PARTS},
        {"id": "weak", "force [kN]": 900, "parts": PARTS, "diameter_limit [mm]": 2, "load_torque": 3},
        {"id": "R1 again", **{k: v for k, v in rows(2)[1].items() if k != "id"}},
    ]
    return synth.batch(Rod, [*rows(8), *more], tmp_path_factory.mktemp("plain"))


@pytest.mark.slow
def test_the_files_say_what_became_of_each_row(plain: synth.BatchResult) -> None:
    assert plain.stopped == ""
    assert plain.counts == {"bad_input": 1, "infeasible": 1, "optimal": 9}
    table, designs = plain.rows(), plain.designs()
    assert list(table["line"]) == list(range(2, 13))
    assert list(table["status"]) == ["optimal"] * 8 + ["bad_input", "infeasible", "optimal"]
    assert set(table["certificate"]) == {"global", ""}
    assert table["explanation"][8].startswith("line 10, column force [kN]: got 'x'; expected a number")
    assert "diameter" in table["explanation"][9]
    assert table["remarks"][9] == "not used: load_torque"
    assert table["best design"][0].startswith("mass 0.")
    assert "steel 42CrMo4" in table["best design"][0]
    # Designs stand in the order of the rows' content: by their first column, numbers by size.
    assert list(designs["id"]) == [*(f"R{k}" for k in range(2)), "R1 again", *(f"R{k}" for k in range(2, 8))]
    first, again = designs[designs["id"] == "R1"], designs[designs["id"] == "R1 again"]
    assert first.iloc[0]["row"] == again.iloc[0]["row"] == table["row"][1] == table["row"][10]
    assert list(designs["rank"]) == [1] * 9
    assert {"mass [kg]", "diameter [mm]", "rods [-]", "steel", "utilisation: diameter"} <= set(designs.columns)
    record = json.loads((plain.folder / "batch.json").read_text())
    assert record["rows"] == plain.counts
    assert record["state"] == "done"
    assert record["settings"]["seed"] == 0
    assert record["versions"]["clutchsynth"]
    assert set(record["hashes"]) == {"rows", "code", "native code", "processor", "families", "tables"}
    assert not list(plain.folder.glob(".*"))


@pytest.mark.slow
def test_a_row_has_the_designs_that_the_search_finds_alone(plain: synth.BatchResult) -> None:
    row = plain.designs().set_index("id").loc["R3"]
    alone = synth.synthesize(
        Rod(section="square"),
        {"force": "13 kN", "diameter_limit": "30 mm"},
        parts={"steel": ["S185", "42CrMo4"]},
        fix={"length": "100 mm"},
    ).to_frame()
    assert len(alone) == 1
    for name in alone.columns:
        if name != "alternatives":
            assert row[name] == alone.iloc[0][name], name


@pytest.mark.slow
def test_order_and_workers_do_not_change_a_byte(plain: synth.BatchResult, tmp_path: Path) -> None:
    shuffled = [*rows(8), {"id": "R1 again", **{k: v for k, v in rows(2)[1].items() if k != "id"}}]
    random.Random(1).shuffle(shuffled)
    other = synth.batch(Rod, pd.DataFrame(shuffled).astype(object), tmp_path, workers=2)
    assert other.counts == {"optimal": 9}
    assert (other.folder / "designs.csv").read_bytes() == (plain.folder / "designs.csv").read_bytes()
    assert len({row for row in other.rows()["row"]}) == 8


def test_the_same_call_again_solves_nothing(plain: synth.BatchResult, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even of other rows, where the questions were answered before."""
    before = (plain.folder / "designs.csv").read_bytes()
    monkeypatch.setattr(runner, "solve_unit", None)
    (plain.folder / "designs.csv").unlink()
    table = [*rows(8), {"id": "R1 again", **{k: v for k, v in rows(2)[1].items() if k != "id"}}]
    again = synth.batch(Rod, table, plain.folder)
    assert again.job != plain.job
    assert again.counts == {"optimal": 9}
    assert (plain.folder / "designs.csv").read_bytes() == before


def test_what_other_jobs_have_found_leaves_no_trace(plain: synth.BatchResult, tmp_path: Path) -> None:
    """Columns come from the rows of the job alone, also where its answers were known."""
    table = [row for row in rows(8) if row["diameter_limit [mm]"] is None]
    known = synth.batch(Rod, table, plain.folder)
    fresh = synth.batch(Rod, table, tmp_path)
    assert "utilisation: diameter" not in fresh.designs().columns
    assert (known.folder / "designs.csv").read_bytes() == (fresh.folder / "designs.csv").read_bytes()


def test_limits_of_rows_share_a_column_per_quantity() -> None:
    table = [{"force": 10000, "limits": "length >= 50; area <= 900; area >= 20", "parts": PARTS}]
    designs = synth.batch(Rod, table, objectives=["mass"], points=1).designs()
    assert "utilisation: limits on area" in designs.columns
    assert not [name for name in designs.columns if "<=" in name]
    assert 0 < designs["utilisation: limits on area"][0] <= 1.000001


def test_a_folder_of_ones_own_lives_as_long_as_the_result() -> None:
    result = synth.batch(Rod, rows(1), parts={"steel": "S185"})
    folder = result.folder
    assert (folder / "designs.csv").is_file()
    assert result.designs()["steel"][0] in ("S185", "42CrMo4")
    del result
    assert not folder.exists()


# ---- bad input ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("table", "more", "words"),
    [
        ([{"force": "x"}, {"force": "y"}], {}, "line 2, column force: got 'x'.*none of 2 rows"),
        (pd.DataFrame({"force": []}), {}, "a header only"),
        (rows(1), {"points": 0}, "points: got 0"),
        (rows(1), {"workers": 0}, "workers: got 0"),
        (rows(1), {"objectives": ["cost"]}, "objectives"),
        (rows(1), {"limits": {"mas": "<= 3 kg"}}, "'mas'"),
        (rows(1), {"database": "ftp://x"}, "--database"),
        (rows(1), {"mapping": {"nowhere": "force"}}, "nowhere"),
        (rows(1), {"scheduler": "tcp://127.0.0.1:1"}, "--scheduler.*a Dask scheduler that answers"),
    ],
)
def test_bad_input_is_told_before_anything_is_written(
    table: Any, more: dict[str, Any], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hurried = ClusterSettings(answer=0.5)  # of a scheduler that is not there
    monkeypatch.setattr("synth.batches.batch.Cluster", lambda address, say, _: Cluster(address, say, hurried))
    with pytest.raises(InputError, match=words):
        synth.batch(Rod, table, tmp_path / "out", **more)
    written = {path.name for path in (tmp_path / "out").glob("*")}
    assert not written & {"designs.csv", "rows.csv", "batch.json"}
    if not {"workers", "scheduler"} & set(more):
        assert written == set()


# ---- faults ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_row_that_fails_keeps_its_error_and_the_others_run(
    plain: synth.BatchResult, monkeypatch: pytest.MonkeyPatch, database: str
) -> None:
    monkeypatch.setattr(runner, "solve_unit", faulty_unit)
    result = synth.batch(Rod, rows(5), database=database, objectives=["mass"], points=1)
    assert result.counts == {"failed": 1, "optimal": 4}
    failed = result.rows().query("status == 'failed'")
    assert list(failed["id"]) == ["R4"]
    assert list(failed["explanation"]) == ["ZeroDivisionError: division by zero"]
    with Store(database) as store:
        texts = [text for _, kind, text in store.events(result.job) if kind == "failed"]
    assert [text.split(" of ")[0] for text in texts] == ["attempt 1", "attempt 2", "attempt 3"]


@pytest.mark.slow
def test_a_worker_that_dies_takes_one_row_with_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(runner, "solve_unit", deadly_unit)
    result = synth.batch(Rod, rows(4), tmp_path, workers=2, objectives=["mass"], points=1)
    assert result.counts == {"failed": 1, "optimal": 3}
    failed = result.rows().query("status == 'failed'")
    assert list(failed["id"]) == ["R3"]
    assert "BrokenProcessPool" in failed["explanation"].iloc[0]


def test_a_process_that_dies_does_not_disturb_the_others() -> None:
    pool = Processes(2)
    try:
        dying, living = pool.submit(os._exit, 3), pool.submit(time.sleep, 0.2)
        wait([dying, living], timeout=PATIENCE)
        assert isinstance(dying.exception(), BrokenProcessPool)
        assert living.exception() is None
        own = os.getpid()
        numbers = {pool.submit(os.getpid).result(timeout=PATIENCE) for _ in range(4)}
        assert own not in numbers
    finally:
        pool.shutdown()


@pytest.mark.slow
def test_processes_that_are_ended_at_work_are_ended_once_and_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe closed twice takes with it whatever file has got its number meanwhile."""
    ended, end = [], executors._Worker.end

    def counted(worker: executors._Worker) -> None:
        ended.append(worker)
        end(worker)

    monkeypatch.setattr(executors._Worker, "end", counted)
    pool = Processes(2)
    workers = list(pool._all)
    asleep = [pool.submit(time.sleep, PATIENCE) for _ in range(2)]
    until(lambda: all(future.running() for future in asleep))
    pool.shutdown()
    pool.shutdown()
    wait(asleep, timeout=PATIENCE)
    until(lambda: pool._idle.qsize() == 2)
    assert [pool._idle.get() for _ in range(2)] in (workers, workers[::-1])
    assert ended == workers


class Slow(Inline):
    """Gives futures that others fulfil."""

    slots = 2

    def __init__(self) -> None:
        self.asked: list[tuple[Future[Any], Mapping[str, Any]]] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.asked.append((future := Future(), args[0]))
        return future


def job_of(folder: Path, count: int, numbers: BatchSettings = BATCHES) -> BatchJob:
    common = {"parts": {"steel": ["S185"]}, "limits": None, "fix": None, "objectives": ["mass"], "grid": True}
    job = BatchJob(Rod, rows(count), folder, None, None, None, SearchSettings(points=1), common, numbers)
    job.plan()
    return job


def test_work_that_is_lost_is_asked_for_again_and_is_no_attempt(tmp_path: Path) -> None:
    job, slow = job_of(tmp_path, 5), Slow()
    at_work = runner.Runner(job.store, job.id, Shares(job.settings, None, Rod), slow)
    for _ in range(4):
        at_work._fill()
        for future in list(at_work.under_way):
            future.cancel()
            future.set_running_or_notify_cancel()
            at_work._take(future, at_work.under_way.pop(future))
    assert all(claim.attempts == 0 for claim in at_work.waiting)
    at_work.store.release(at_work.owner)
    assert job.work(None, None, None) == ""
    assert job.write() == {"optimal": 5}
    job.close()


@pytest.mark.slow
def test_cancelling_stops_and_resuming_goes_on(tmp_path: Path) -> None:
    tick = 0.1
    job = job_of(tmp_path, 9, BatchSettings(runner=RunnerSettings(tick=tick)))
    states: list[Mapping[str, Any]] = []

    def look(state: Mapping[str, Any]) -> None:
        states.append(state)
        if len(states) == 1:
            job.store.cancel(job.id)
            time.sleep(2 * tick + 0.3)  # until the heart has beaten

    assert job.work(None, None, look) == "cancelled"
    assert job.write() == {"not_solved": 9}
    assert job.store.open_units(job.id)[1] == 0
    with pytest.raises(InputError, match="its own script"):
        resume(job.store, job.id, None, None, None, print)
    job.plan()
    assert job.work(None, None, states.append) == ""
    assert states[-1]["done"] == states[-1]["rows"] == 9
    assert states[-1]["left"] == 0
    assert {"rate", "failed", "infeasible", "bad"} <= set(states[-1])
    assert job.write() == {"optimal": 9}
    job.close()


@pytest.mark.slow
def test_two_processes_may_work_on_one_job(tmp_path: Path) -> None:
    job = job_of(tmp_path, 12)
    other = Store(file_url(tmp_path / "jobs.sqlite"))
    shares = Shares(job.settings, None, Rod)
    ends: list[str] = []
    helper = threading.Thread(target=lambda: ends.append(work_off(other, job.id, shares, None, None, None, print)))
    helper.start()
    ends.append(job.work(None, None, None))
    helper.join(timeout=PATIENCE)
    assert ends == ["", ""]
    assert job.write() == {"optimal": 12}
    other.close()
    job.close()
