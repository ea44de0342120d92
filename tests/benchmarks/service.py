"""The service under load, under kills, and how soon it does what somebody waits for.

``python -m tests.benchmarks.service load|cancel|kill|wait|soak [--database URL]`` measures one of them by itself.
Every figure is of a server with its own worker, started as its users start it, and asked over HTTP.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import yaml

from synth.system.operating_system import resident
from tests.benchmarks.tables import Report

ROOT = Path(__file__).parents[2]
COMMAND = (sys.executable, "-c", "from synth.terminal.cli import main; main()")
API = "/api/v1"
ENDED = ("done", "failed", "cancelled", "stopped")
SECONDS = 60.0
MOST_REPEATED = 100  # times that a busy service is asked for one job
LIGHT = ("hoist_multi_plate", "wrap_spring_freewheel")  # least mass in some tenths of a second
FOLLOWING = ("verify", "report", "near_equals")
FAMILIES = ("hoist_multi_plate", "cone_drive", "automobile_disc", "wrap_spring_freewheel", "powder_winder")


def spec(name: str = "hoist_multi_plate", **changed: Any) -> dict[str, Any]:
    """Return the spec of an example, with some keys changed."""
    content: dict[str, Any] = yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text(encoding="utf-8"))
    return {**content, **changed}


QUICK = {"objectives": ["mass"], "points": 1}
LONG = spec(objectives=["mass", "length", "friction_work"], points=400)  # minutes


class Service:
    """A server with its worker, which can be killed in parts and started again.

    Parameters
    ----------
    folder : Path
    database : str, optional
    slots : int
    """

    def __init__(self, folder: Path, database: str | None = None, slots: int = 2) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.words = ["serve", "--data", str(folder), "--port", str(self.port), "--workers", str(slots)]
        self.environment = {**os.environ, "CLUTCHSYNTH_LOG": "false"}
        if database is not None:
            self.environment["CLUTCHSYNTH_DATABASE"] = database
        self.url = f"http://127.0.0.1:{self.port}"
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start the server, and wait until it is ready."""
        self.process = subprocess.Popen(
            [*COMMAND, *self.words], env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        until(self._is_ready, 120.0)

    def _is_ready(self) -> bool:
        try:
            return httpx.get(f"{self.url}/readyz", timeout=5.0).status_code == 200
        except httpx.HTTPError:
            return False

    def processes(self) -> dict[str, list[int]]:
        """Return the processes of the service by what they are."""
        assert self.process is not None
        tree = children()
        server = self.process.pid
        below = tree.get(server, [])
        workers = [pid for pid in below if "worker" in command_of(pid)]
        engines = [pid for worker in workers for pid in tree.get(worker, []) if "spawn_main" in command_of(pid)]
        return {"server": [server], "worker": workers, "engine": engines}

    def stop(self) -> float:
        """End the server as systems do; return how many seconds that takes."""
        assert self.process is not None
        begin = time.monotonic()
        self.process.terminate()
        self.process.wait(timeout=30)
        return time.monotonic() - begin


def children() -> dict[int, list[int]]:
    """Return the processes of this machine by their parents."""
    found: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            if words[0] != "Z":
                found.setdefault(int(words[1]), []).append(int(entry.name))
    return found


def command_of(pid: int) -> str:
    """Return the command line of a process."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")
    except OSError:
        return ""


def until(look: Any, within: float, pause: float = 0.05) -> Any:
    """Return what a function finds, once it finds something."""
    deadline = time.monotonic() + within
    while not (found := look()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"not within {within} s")
        time.sleep(pause)
    return found


@contextmanager
def served(database: str | None = None, slots: int = 2) -> Iterator[Service]:
    """Give a service that runs."""
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as folder:
        service = Service(Path(folder), database, slots)
        service.start()
        try:
            yield service
        finally:
            if service.process is not None and service.process.poll() is None:
                service.stop()


def submit(client: httpx.Client, request: Mapping[str, Any], kind: str = "synthesis", **more: Any) -> str:
    """Ask for a job; return its id."""
    answer = client.post(f"{API}/jobs", json={"kind": kind, "request": request, **more})
    answer.raise_for_status()
    return str(answer.json()["id"])


def patiently(client: httpx.Client, request: Mapping[str, Any], kind: str = "synthesis") -> tuple[str, int]:
    """Ask for a job, and again when a busy service says so, as clients are told to; return its id, and how often."""
    again = 0
    while True:
        answer = client.post(f"{API}/jobs", json={"kind": kind, "request": request})
        if answer.status_code != httpx.codes.SERVICE_UNAVAILABLE or again == MOST_REPEATED:
            answer.raise_for_status()
            return str(answer.json()["id"]), again
        again += 1
        time.sleep(float(answer.headers.get("Retry-After", 1)))


def status(client: httpx.Client, job: str) -> dict[str, Any]:
    """Return how a job is."""
    answer = client.get(f"{API}/jobs/{job}")
    answer.raise_for_status()
    found: dict[str, Any] = answer.json()
    return found


def ended(client: httpx.Client, job: str, within: float = 600.0) -> dict[str, Any]:
    """Return a job once it has ended."""
    deadline = time.monotonic() + within
    while (found := status(client, job))["state"] not in ENDED:
        if time.monotonic() > deadline:
            raise TimeoutError(job)
        time.sleep(0.02)
    return found


def quantiles(times: Sequence[float]) -> str:
    """Return median, 95th and 99th percentile in ms."""
    ordered = sorted(times)
    picked = [ordered[min(int(share * len(ordered)), len(ordered) - 1)] for share in (0.5, 0.95, 0.99)]
    return " / ".join(f"{1000 * value:.1f}" for value in picked)


# ---- load -----------------------------------------------------------------------------------------------------------


def load(database: str | None = None, seconds: float = SECONDS, rate: float = 50.0) -> dict[str, Any]:
    """Read states 50 times a second, with ten streams and two submissions a second, while two searches go on."""
    with served(database) as service, httpx.Client(base_url=service.url, timeout=30.0) as client:
        busy = [submit(client, {**LONG, "seed": k}) for k in range(2)]
        until(lambda: all(status(client, job)["state"] == "running" for job in busy), 60.0)
        server = service.processes()["server"][0]
        found = asyncio.run(_loaded(service.url, busy, seconds, rate))
        found["server MB"] = resident(server) / 1e6
        quick = [job for job in found.pop("submitted")]
        for job in busy:
            client.post(f"{API}/jobs/{job}/cancel")
        ends = Counter(ended(client, job)["state"] for job in quick)
        found["submitted"], found["lost"] = len(quick), len(quick) - ends["done"]
        found["stop s"] = service.stop()
    return found


async def _loaded(url: str, busy: Sequence[str], seconds: float, rate: float) -> dict[str, Any]:
    times: list[float] = []
    errors: Counter[str] = Counter()
    submitted: list[str] = []
    events = 0
    end = time.monotonic() + seconds
    limits = httpx.Limits(max_connections=100, max_keepalive_connections=100)
    async with httpx.AsyncClient(base_url=url, timeout=30.0, limits=limits) as client:

        async def read(number: int) -> None:
            await asyncio.sleep(number / rate)
            due = time.monotonic()
            while due < end:
                begin = time.monotonic()
                try:
                    answer = await client.get(f"{API}/jobs/{busy[number % len(busy)]}")
                    if answer.status_code != 200:
                        errors[str(answer.status_code)] += 1
                except httpx.HTTPError as error:
                    errors[type(error).__name__] += 1
                times.append(time.monotonic() - begin)
                due += 50.0 / rate
                await asyncio.sleep(max(due - time.monotonic(), 0.0))

        async def listen(job: str) -> None:
            nonlocal events
            try:
                async with client.stream("GET", f"{API}/jobs/{job}/events", timeout=None) as stream:
                    async for line in stream.aiter_lines():
                        events += line.startswith("event:")
                        if time.monotonic() > end:
                            return
            except httpx.HTTPError as error:
                errors[f"stream {type(error).__name__}"] += 1

        async def ask() -> None:
            k = 0
            while time.monotonic() < end:
                k += 1
                request = spec(**QUICK, seed=k)
                answer = await client.post(f"{API}/jobs", json={"kind": "synthesis", "request": request})
                if answer.status_code == 202:
                    submitted.append(answer.json()["id"])
                else:
                    errors[f"submit {answer.status_code}"] += 1
                await asyncio.sleep(0.5)

        streams = [asyncio.create_task(listen(busy[k % len(busy)])) for k in range(10)]
        await asyncio.gather(ask(), *(read(k) for k in range(50)))
        for stream in streams:
            stream.cancel()
        await asyncio.gather(*streams, return_exceptions=True)
    return {
        "reads": len(times),
        "p50 / p95 / p99 ms": quantiles(times),
        "errors": dict(errors),
        "events": events,
        "submitted": submitted,
    }


# ---- cancel ---------------------------------------------------------------------------------------------------------


def cancel(database: str | None = None, count: int = 50) -> dict[str, Any]:
    """Cancel searches of several families at random moments; count the time until the slot works again."""
    chance = random.Random(7)
    cancelled: list[float] = []
    working: list[float] = []
    with served(database, slots=1) as service, httpx.Client(base_url=service.url, timeout=30.0) as client:
        for k in range(count):
            request = LONG if k % 6 == 5 else spec(FAMILIES[k % 5], points=200, seed=k)
            job = submit(client, request)
            until(lambda job=job: status(client, job)["state"] != "open", 60.0, 0.01)
            time.sleep(chance.uniform(0.0, 1.5))
            begin = time.monotonic()
            if client.post(f"{API}/jobs/{job}/cancel").status_code != 202:
                continue  # it was done already
            until(lambda job=job: status(client, job)["state"] == "cancelled", 60.0, 0.01)
            cancelled.append(time.monotonic() - begin)
            after = submit(client, spec(**QUICK, seed=k))
            until(lambda job=after: status(client, job)["state"] != "open", 60.0, 0.01)
            working.append(time.monotonic() - begin)
            ended(client, after)
    return {
        "cancelled": len(cancelled),
        "state p50 / p95 / p99 ms": quantiles(cancelled),
        "slot works again p50 / p95 / p99 ms": quantiles(working),
        "slowest s": max(working),
    }


# ---- kill -----------------------------------------------------------------------------------------------------------


def kill(database: str | None = None, kills: int = 100) -> dict[str, Any]:
    """Kill server, worker and engines at random moments; every job must end once, as if nothing had happened."""
    chance = random.Random(11)
    asked = [spec("hoist_multi_plate", points=p) for p in (3, 5, 8)] + [spec("cone_drive"), spec("automobile_disc")]
    killed: Counter[str] = Counter()
    half: list[str] = []
    with served(database) as service:
        with httpx.Client(base_url=service.url, timeout=30.0) as client:
            right = [_designs(client, _done(client, request)) for request in asked]
        jobs: dict[str, int] = {}
        over = threading.Event()
        reader = threading.Thread(target=_read_all, args=(service.url, jobs, half, over))
        reader.start()
        while sum(killed.values()) < kills:
            _keep_busy(service, asked, jobs, chance)
            time.sleep(chance.uniform(0.05, 6.0))  # some jobs end between two kills, and some are struck
            what = chance.choice(("server", "worker", "engine", "engine"))
            victims = service.processes()[what]
            if not victims:
                continue
            try:
                os.kill(chance.choice(victims), signal.SIGKILL)
            except ProcessLookupError:
                continue
            killed[what] += 1
            if what == "server":
                assert service.process is not None
                service.process.wait()
                service.start()
        with httpx.Client(base_url=service.url, timeout=30.0) as client:
            ends: Counter[str] = Counter()
            wrong: list[str] = []
            for job, question in jobs.items():
                found = ended(client, job)
                ends[found["state"]] += 1
                if found["state"] == "done" and _designs(client, job) != right[question]:
                    wrong.append(job)
        over.set()
        reader.join()
    return {
        "killed": dict(killed),
        "jobs": len(jobs),
        "ends": dict(ends),
        "other answers": len(wrong),
        "half-visible": len(half),
    }


def _done(client: httpx.Client, request: Mapping[str, Any]) -> str:
    job = submit(client, request)
    assert ended(client, job)["state"] == "done"
    return job


def _designs(client: httpx.Client, job: str) -> Any:
    answer = client.get(f"{API}/jobs/{job}/result")
    answer.raise_for_status()
    content = answer.json()
    return content["designs"], content["certificate"]["kind"]


def _keep_busy(service: Service, asked: Sequence[Mapping[str, Any]], jobs: dict[str, int], chance: Any) -> None:
    """Let four jobs be open, however often that takes."""
    for _ in range(20):
        try:
            with httpx.Client(base_url=service.url, timeout=10.0) as client:
                page = client.get(f"{API}/jobs", params={"state": ["open", "running"], "limit": 50}).json()
                for _ in range(4 - len(page["jobs"])):
                    k = chance.randrange(len(asked))
                    jobs[submit(client, asked[k])] = k
                return
        except (httpx.HTTPError, KeyError):
            time.sleep(0.2)


def _read_all(url: str, jobs: Mapping[str, int], half: list[str], over: threading.Event) -> None:
    """Read results all the time: what is there must be whole."""
    with httpx.Client(base_url=url, timeout=10.0) as client:
        while not over.wait(0.05):
            for job in list(jobs)[-6:]:
                try:
                    answer = client.get(f"{API}/jobs/{job}/result")
                    if answer.status_code == 200 and not answer.json()["designs"]:
                        half.append(job)
                    elif answer.status_code not in (200, 409, 503):
                        half.append(f"{job} {answer.status_code}")
                except httpx.HTTPError:
                    continue
                except (ValueError, KeyError):
                    half.append(job)


# ---- waiting behind a batch -----------------------------------------------------------------------------------------


def wait(database: str | None = None, rows: int = 1000, count: int = 20) -> dict[str, Any]:
    """Ask quick questions behind a batch; count the time until they are worked at, and until they are answered."""
    begun: list[float] = []
    answered: list[float] = []
    base = {name: str(value) for name, value in spec()["requirements"].items()}
    table = [{**base, "load_torque": f"{300 + 0.5 * k} N*m"} for k in range(rows)]
    with served(database) as service, httpx.Client(base_url=service.url, timeout=60.0) as client:
        text = "\n".join([",".join(table[0]), *(",".join(row.values()) for row in table)])
        upload = client.post(f"{API}/uploads", files={"file": ("rows.csv", text.encode())}).json()["id"]
        batch = submit(client, {"family": "multi_plate_clutch", "upload": upload, "points": 5}, "batch")
        until(lambda: (status(client, batch)["progress"] or {}).get("done", 0) > 2, 300.0)
        for k in range(count):
            job = submit(client, spec(**QUICK, seed=k))
            found = ended(client, job)
            begun.append(found["started"] - found["created"])
            answered.append(found["ended"] - found["created"])
            time.sleep(1.0)
        client.post(f"{API}/jobs/{batch}/cancel")
    return {
        "rows": rows,
        "begun after p50 / p95 / p99 ms": quantiles(begun),
        "answered after p50 / p95 / p99 ms": quantiles(answered),
        "slowest s": max(begun),
    }


# ---- soak -----------------------------------------------------------------------------------------------------------


def soaking(k: int, front: str) -> tuple[str, dict[str, Any]]:
    """Return the kind and the request of the job numbered ``k``: of twenty, three follow from a front, one is a front.

    The others ask for the least mass, each with a seed of its own, so that none of them is known already.
    """
    place = k % 20
    if place < len(FOLLOWING):
        return FOLLOWING[place], {"of": front}
    if place == len(FOLLOWING):
        return "synthesis", spec(FAMILIES[k // 20 % len(FAMILIES)], points=5, seed=k)
    quick = (FAMILIES + LIGHT * 20)[place - len(FOLLOWING) - 1]
    return "synthesis", spec(quick, **QUICK, seed=k)


def soak(database: str | None = None, jobs: int = 10_000, pages: int = 10) -> dict[str, Any]:
    """Ask for many jobs one after the other, two at a time; memory of every process, ten times on the way."""
    sizes: list[dict[str, float]] = []
    ends: Counter[str] = Counter()
    with served(database) as service, httpx.Client(base_url=service.url, timeout=60.0) as client:
        front = submit(client, spec(points=5))
        ended(client, front)
        begin, waiting, refused = time.monotonic(), list[tuple[str, str]](), 0
        for k in range(1, jobs + 1):
            kind, request = soaking(k, front)
            job, busy = patiently(client, request, kind)
            waiting.append((kind, job))
            refused += busy
            if len(waiting) > 2:
                kind, job = waiting.pop(0)
                ends[ended(client, job)["state"]] += 1
                client.get(f"{API}/jobs/{job}/result").raise_for_status()
                if kind == "synthesis":
                    client.get(f"{API}/jobs/{job}/designs").raise_for_status()
            if k % max(jobs // pages, 1) == 0:
                found = service.processes()
                sizes.append({name: sum(map(resident, pids)) / 1e6 for name, pids in found.items()})
                print(k, f"{time.monotonic() - begin:.0f} s", sizes[-1], flush=True)
        ends.update(ended(client, job)["state"] for _, job in waiting)
    return {
        "jobs": jobs,
        "ends": dict(ends),
        "asked again later": refused,
        **{f"{name} MB": ", ".join(f"{size[name]:.0f}" for size in sizes) for name in sizes[-1]},
    }


MEASURES = {"load": load, "cancel": cancel, "kill": kill, "wait": wait, "soak": soak}


def service(quick: bool) -> list[Report]:
    """Return the tables of the service."""
    rows = []
    for name, measure in MEASURES.items():
        if name == "soak" and not quick:
            continue  # an hour: it is asked for by itself
        few: dict[str, Any] = {
            "load": {"seconds": 10.0},
            "cancel": {"count": 8},
            "kill": {"kills": 8},
            "soak": {"jobs": 40},
        }.get(name, {})
        found = measure(None, **(few if quick else {}))
        rows += [{"measure": name, "figure": figure, "value": str(value)} for figure, value in found.items()]
    return [Report("The service", rows)]


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("measure", choices=list(MEASURES))
    parser.add_argument("--database")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=10_000)
    asked = parser.parse_args()
    more: dict[str, Any] = {
        "kill": {"kills": asked.kills},
        "load": {"seconds": asked.seconds},
        "cancel": {"count": asked.count},
        "soak": {"jobs": asked.jobs},
    }.get(asked.measure, {})
    print(json.dumps(MEASURES[asked.measure](asked.database, **more), indent=1))
