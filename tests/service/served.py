"""The server as a program of its own, with what every process of it does on the network written down."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx

from tests.service.working import LIVE, PATIENT, QUICK
from tests.terminal.entry import COMMAND
from tests.waiting import PATIENCE, until

# Python runs this at the start of every process that has its folder in PYTHONPATH: workers and engines, too.
WATCH = """
import os, sys

LOCAL = ("127.0.0.1", "localhost", "::1", "0.0.0.0", "::", None, "", b"127.0.0.1", b"localhost")

def told(event, args):
    if event in ("socket.connect", "socket.sendto"):
        host = args[1][0] if isinstance(args[1], tuple) else None
    elif event in ("socket.getaddrinfo", "socket.gethostbyname", "urllib.Request"):
        host = args[0]
    else:
        return
    if host not in LOCAL:
        with open(os.environ["WATCHED"], "a") as file:
            file.write(f"{event} {host}\\n")
        raise OSError("this is not done here")

sys.addaudithook(told)
with open(os.environ["WATCHED"] + ".processes", "a") as file:
    file.write(f"{os.getpid()}\\n")
"""


@dataclass(frozen=True)
class Served:
    """A server that runs, and where it writes what."""

    address: str
    pid: int
    folder: Path

    def ask(self, method: str, path: str, **asked: Any) -> httpx.Response:
        """Ask something of the interface, or of what stands beside it."""
        where = path if path.startswith("/") else f"/api/v1/{path}"
        return httpx.request(method, f"{self.address}{where}", timeout=PATIENCE, **asked)

    def warm(self) -> None:
        """Wait until small questions and tables are answered: a process that begins may be asked too early."""
        until(lambda: self.ask("POST", "check", json=QUICK).status_code == 200)
        until(lambda: self.ask("POST", "batches/check", json={"rows": []}).status_code == 422)

    def ended(self, job: str, **asked: Any) -> dict[str, Any]:
        """State of a job that has ended."""
        found = until(lambda: self.ask("GET", f"jobs/{job}", **asked).json(), lambda found: found["state"] not in LIVE)
        return dict(found)

    def network(self) -> str:
        """Return what was asked of the network beyond this machine: all of it was refused."""
        file = self.folder / "watched"
        return file.read_text() if file.exists() else ""

    def processes(self) -> int:
        """Return how many processes were watched."""
        return len(set((self.folder / "watched.processes").read_text().split()))

    def log(self) -> list[dict[str, Any]]:
        """Return the lines of its log."""
        return lines_of((self.folder / "err.txt").read_text())

    def said(self) -> str:
        """Return all that it has said."""
        return "".join((self.folder / name).read_text() for name in ("out.txt", "err.txt"))


def watched(folder: Path) -> dict[str, str]:
    """Return the variables of a process that is watched, and begins others that are."""
    (folder / "watch").mkdir()
    (folder / "watch" / "sitecustomize.py").write_text(WATCH)
    return {"PYTHONPATH": str(folder / "watch"), "WATCHED": str(folder / "watched")}


@contextmanager
def served(folder: Path, *words: str, environment: Mapping[str, str] | None = None) -> Iterator[Served]:
    """Run the server with a worker; it ends with the block, whatever happens there."""
    patient = {f"CLUTCHSYNTH_{key.upper()}": str(value) for key, value in PATIENT.items()}
    watch, more = watched(folder), {**patient, **(environment or {})}
    paths = [own["PYTHONPATH"] for own in (watch, more, os.environ) if "PYTHONPATH" in own]
    own = {**watch, **more, "PYTHONPATH": os.pathsep.join(paths)}
    place = () if "CLUTCHSYNTH_DATABASE" in own else ("--data", str(folder / "data"))
    with (folder / "out.txt").open("w") as out, (folder / "err.txt").open("w") as err:
        process = subprocess.Popen(
            [*COMMAND, "serve", "--port", "0", *place, *words],
            cwd=folder,
            env={**os.environ, **own},
            stdout=out,
            stderr=err,
        )
    try:
        line = until(lambda: (folder / "out.txt").read_text() or process.poll() is not None)
        assert line is not True, (folder / "err.txt").read_text()
        yield Served(str(line).split()[-1].rstrip("/"), process.pid, folder)
        process.terminate()
        process.wait(20.0)
    finally:
        process.kill()
        process.wait()


def most_memory(pid: int) -> int:
    """Return the most memory that a process has used at a time, in bytes."""
    (line,) = [line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmHWM")]
    return int(line.split()[1]) * 1024


def processor_time(pid: int) -> float:
    """Return the time in s that processors have worked for a process: what it had to do, however busy they are."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def lines_of(text: str) -> list[dict[str, Any]]:
    """Return the lines of a log, each of which must be JSON."""
    return [json.loads(line) for line in text.splitlines()]
