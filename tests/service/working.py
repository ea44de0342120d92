"""A service that works: real engine processes, and a real worker beside it."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx

from synth.batches.store import Store
from synth.service.serve import ServiceServer, listening, server_config
from synth.workers.engine_process import Engines
from synth.workers.settings import WORK
from synth.workers.worker import Worker
from tests.service.calling import Service, bearer
from tests.waiting import until

API = "/api/v1"
DUTY: dict[str, Any] = {
    "load_torque": "600 N*m",
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
    "wear_life_min": 200000,
}
FAMILY = "multi_plate_clutch"
QUICK: dict[str, Any] = {
    "family": FAMILY,
    "requirements": DUTY,
    "fix": {"ramp_time": "2 s"},
    "objectives": ["mass"],
    "points": 1,
}
FRONT = {**QUICK, "objectives": ["mass", "length"], "points": 3}
LONG = {**QUICK, "objectives": ["mass", "length", "friction_work"], "points": 200}
BATCH = {
    "family": FAMILY,
    "rows": [{**DUTY, "load_torque": torque, "note": "=1+1"} for torque in ("400 N*m", "500 N*m", "many")],
    "fix": {"ramp_time": "2 s"},
    "objectives": ["mass"],
    "points": 1,
}
LIVE = ("open", "running")
# On a machine that is busy with other things real processes are late; what tests look at is what they answer.
PATIENT: dict[str, float] = {"small_deadline": 60.0, "file_deadline": 600.0, "queue_wait": 60.0}
LOOKS_OFTEN = replace(WORK, worker=replace(WORK.worker, poll=0.1))


class Client:
    """Somebody with a token, or without one where none is needed."""

    def __init__(self, service: Service, token: str = "") -> None:
        self.service, self.headers = service, bearer(token) if token else {}

    def __call__(self, method: str, path: str, headers: dict[str, str] | None = None, **asked: Any) -> httpx.Response:
        where = path if path.startswith("/") else f"{API}/{path}"
        return self.service(method, where, headers={**self.headers, **(headers or {})}, **asked)

    def get(self, path: str, **asked: Any) -> httpx.Response:
        return self("GET", path, **asked)

    def post(self, path: str, body: Any = None, **asked: Any) -> httpx.Response:
        return self("POST", path, **({} if body is None else {"json": body}), **asked)

    def submit(self, kind: str, request: dict[str, Any], **more: Any) -> str:
        """Id of a new job; a busy machine may be asked again."""
        asked = {"kind": kind, "request": request, **more}
        answer = until(
            lambda: self.post("jobs", asked), lambda told: told.status_code != httpx.codes.SERVICE_UNAVAILABLE
        )
        assert answer.status_code == 202, answer.text
        return str(answer.json()["id"])

    def ended(self, job: str) -> dict[str, Any]:
        """Wait until a job has ended; return how it stands."""
        return self.until(job, lambda told: told["state"] not in LIVE)

    def until(self, job: str, right: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """State of a job, as soon as it is right."""
        found: dict[str, Any] = until(lambda: self.get(f"jobs/{job}").json(), right)
        return found


async def _entered(lifespan: Any) -> None:
    await lifespan.__aenter__()


async def _left(lifespan: Any) -> None:
    await lifespan.__aexit__(None, None, None)


@contextmanager
def working(
    folder: Path, engines: Engines, database: str = "", slots: int = 1, called: bool = True, **numbers: Any
) -> Iterator[Service]:
    """Give a service whose jobs are worked at; one that is called directly does what it does beside, too."""
    with Service(folder, engines, database, **{**PATIENT, **numbers}) as service:
        worker = Worker(Store(service.store.engine.url), slots, spare=False, settings=LOOKS_OFTEN)
        thread = threading.Thread(target=worker.run)
        thread.start()
        lifespan = service.app.router.lifespan_context(service.app) if called else contextlib.nullcontext()
        try:
            service.runner.run(_entered(lifespan))
            yield service
            service.runner.run(_left(lifespan))
        finally:
            worker.stop()
            thread.join()
            with contextlib.suppress(Exception):
                worker.store.close()


@contextmanager
def listened(service: Service) -> Iterator[str]:
    """Let a service listen at an address of this machine; yield it."""
    ready = threading.Event()
    with listening("127.0.0.1", 0) as listener:
        config = server_config(service.app, service.settings)
        server = ServiceServer(config, service.context, ready.set, lambda: None)
        thread = threading.Thread(target=lambda: asyncio.run(server.serve([listener])))
        thread.start()
        try:
            assert ready.wait(20.0)
            yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        finally:
            server.handle_exit(0, None)
            thread.join()
