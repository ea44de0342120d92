"""Batches on a real Dask cluster whose parts are killed on the way."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.batches import executors
from synth.batches.executors import Cluster
from synth.batches.settings import BatchSettings, ClusterSettings, RunnerSettings
from synth.errors import InputError
from tests.batches.asked import batch
from tests.sample_problems.rod import Rod
from tests.waiting import PATIENCE, until

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow


def rows(count: int) -> list[dict[str, Any]]:
    return [{"force [kN]": 10 + k, "parts": "steel = S185, 42CrMo4", "length [mm]": 100} for k in range(count)]


class Parts:
    """The processes of a cluster."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self.folder = folder
        self.path = ROOT  # where they find the program
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, module: str, *words: str) -> subprocess.Popen[bytes]:
        environment = {**os.environ, "PYTHONPATH": str(self.path), "PYTHONWARNINGS": "ignore"}
        with (self.folder / f"{module}.log").open("ab") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{module}", *words, "--no-dashboard"],
                stdout=log,
                stderr=log,
                env=environment,
                cwd=self.folder,
            )
        self.processes.append(process)
        return process

    def scheduler(self) -> subprocess.Popen[bytes]:
        host, port = self.address.removeprefix("tcp://").split(":")
        return self.start("dask_scheduler", "--host", host, "--port", port)

    def worker(self) -> subprocess.Popen[bytes]:
        return self.start("dask_worker", self.address, "--nthreads", "1", "--no-nanny", "--death-timeout", "60")

    def ready(self, workers: int) -> None:
        from distributed import Client

        with Client(self.address, timeout=PATIENCE, set_as_default=False) as client:
            if workers:
                client.wait_for_workers(workers, timeout=PATIENCE)


@pytest.fixture
def parts(tmp_path: Path) -> Iterator[Parts]:
    started = Parts(tmp_path)
    yield started
    for process in started.processes:
        with contextlib.suppress(OSError):
            process.kill()
        process.wait()


def test_workers_and_the_scheduler_may_die_on_the_way(
    parts: Parts, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    numbers = BatchSettings(
        runner=RunnerSettings(pause=0.0, report_share=1e9)
    )  # rows are solved in milliseconds: every one is to be seen
    alone = synth.batch(Rod, rows(240), tmp_path / "alone", objectives=["mass"], points=1)
    scheduler = parts.scheduler()
    first, _ = parts.worker(), parts.worker()
    parts.ready(2)
    seen: list[int] = []

    def disturb(state: Any) -> None:
        seen.append(state["done"])
        if state["done"] and len(parts.processes) == 3:
            first.kill()  # one of two workers, with work in its hands
            parts.worker()
        elif state["done"] > 6 and len(parts.processes) == 4:
            scheduler.kill()  # all futures are cancelled; the workers leave by themselves
            scheduler.wait()
            parts.scheduler()
            parts.worker()

    result = batch(
        numbers,
        Rod,
        rows(240),
        tmp_path / "cluster",
        objectives=["mass"],
        points=1,
        scheduler=parts.address,
        progress=disturb,
    )
    assert len(parts.processes) == 6, "everything was solved before anything was killed"
    assert result.counts == {"optimal": 240}
    written = [(r.folder / "designs.csv").read_bytes() for r in (alone, result)]
    assert written[0] == written[1]
    from synth.batches.store import Store

    with Store(result.database) as store:
        assert "failed" not in [kind for _, kind, _ in store.events(result.job)]


def test_a_scheduler_that_is_waited_for_in_vain(parts: Parts, capfd: pytest.CaptureFixture[str]) -> None:
    scheduler = parts.scheduler()
    parts.ready(0)
    said: list[str] = []
    cluster = Cluster(parts.address, said.append, ClusterSettings(answer=2.0, recount=0.0, retry=0.1, patience=0.3))
    assert cluster.alive()
    assert [cluster.slots, cluster.slots] == [2, 2]
    assert said == [f"the scheduler at {parts.address} has no workers; waiting for them"]
    said.clear()
    scheduler.kill()
    scheduler.wait()
    until(cluster.alive, right=lambda alive: not alive)
    assert not cluster.reconnect(lambda: False)
    assert "does not answer; nothing is lost" in said[0]
    cluster.shutdown()
    del cluster
    gc.collect()
    assert capfd.readouterr().err == ""


@contextlib.contextmanager
def answering(reply: bytes | None) -> Iterator[str]:
    """Give the address of a server that is no scheduler: it says something and hangs up, or says nothing."""
    kept: list[socket.socket] = []

    def serve() -> None:
        while True:
            try:
                connection, _ = server.accept()
            except OSError:
                return
            kept.append(connection)
            if reply is not None:
                with contextlib.suppress(OSError):
                    connection.sendall(reply)
                    connection.close()

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
        server.shutdown(socket.SHUT_RDWR)
    thread.join()
    for connection in kept:
        connection.close()


@pytest.mark.parametrize("reply", [None, b"", b"SSH-2.0-OpenSSH_9.6" + bytes(200), b"HTTP/1.1 400 Bad" + bytes(60)])
def test_a_server_that_is_no_scheduler_is_told_in_one_sentence(
    reply: bytes | None, capfd: pytest.CaptureFixture[str]
) -> None:
    with answering(reply) as address, pytest.raises(InputError, match="the address of a Dask scheduler that answers"):
        Cluster(address, print, ClusterSettings(answer=0.5))
    gc.collect()  # a client that was never connected must not complain when it goes
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "address", ["tls://127.0.0.1:1", "ucx://127.0.0.1:1", "inproc://1/2", "", "ö://x", "tcp://[::1"]
)
def test_an_address_of_another_kind_is_told_in_one_sentence(address: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match=r"--scheduler: .* expected the address of a Dask scheduler that answers"):
        Cluster(address, print, ClusterSettings(answer=0.5))
    gc.collect()
    assert capfd.readouterr() == ("", "")


def test_a_cluster_with_another_program_is_told_in_one_sentence(
    parts: Parts, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "other" / "synth").mkdir(parents=True)
    (tmp_path / "other" / "synth" / "__init__.py").write_text("raise ImportError('there is none')", encoding="utf-8")
    parts.path = tmp_path / "other"
    parts.scheduler()
    parts.ready(0)
    with pytest.raises(InputError, match="expected the same clutchsynth"):
        synth.batch(Rod, rows(3), tmp_path / "out", objectives=["mass"], points=1, scheduler=parts.address)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["distributed.client", "distributed.core", "tornado.application", "asyncio"])
def test_what_dask_logs_reaches_no_screen_but_handlers_of_others(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    import distributed

    executors._quiet_client(distributed.Client)
    heard: list[logging.LogRecord] = []
    other = logging.Handler()
    other.emit = heard.append  # type: ignore[method-assign]
    logging.getLogger(name).addHandler(other)
    logging.getLogger(name).error("lost", exc_info=TimeoutError("no answer"))
    logging.getLogger(name).removeHandler(other)
    assert len(heard) == 1
    assert capfd.readouterr().err == ""


def test_a_worker_with_another_version_is_noticed() -> None:
    from synth.batches.solve import OtherCodeError, solve_unit

    with pytest.raises(OtherCodeError):
        solve_unit({"code": "another", "job": "j", "questions": {}, "settings": {}, "catalogs": None, "own": None})


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"clutchsynth\[cluster\]"):
        Cluster("tcp://127.0.0.1:1", print)
