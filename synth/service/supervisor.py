"""The worker that a server starts beside itself: begun again when it dies, ended with the server, and by its death."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import IO

from synth.service.recording import log
from synth.service.settings import ServiceSettings
from synth.system.operating_system import apart

COMMAND = (sys.executable, "-c", "from synth.terminal.cli import main; main()")
LIVED = 2.0  # times as long as the pause before it, that a process must live to count as having begun well


def worker_command(settings: ServiceSettings) -> list[str]:
    """Command that starts the worker of this machine; a variable names the database, which may hold a password."""
    return [*COMMAND, "worker", "--slots", str(settings.workers), "--follow"]


class Supervisor:
    """Keeps a process alive.

    Its standard input is its lifeline: a pipe of which the other end is held by this process alone, so that it is
    closed by whatever ends this process.

    Parameters
    ----------
    command : sequence of str
    environment : mapping
        Variables beside those of this process.
    settings : ServiceSettings
    begun : callable
        Told of every start.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        settings: ServiceSettings,
        begun: Callable[[], None] = lambda: None,
    ) -> None:
        self._command, self._environment, self._settings, self._begun = command, environment, settings, begun
        self._ending = threading.Event()
        self._told = 0.0  # when the process was told to end
        self._guard = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._thread = threading.Thread(target=self._keep, name="supervisor", daemon=True)

    @property
    def pid(self) -> int | None:
        """The number of the process; None where there is none."""
        process = self._process
        return None if process is None or process.poll() is not None else process.pid

    def start(self) -> None:
        """Start the process, and whoever starts it again."""
        self._thread.start()

    def tell_end(self) -> None:
        """Let the process end, without waiting for it; it is not started again."""
        if not self._ending.is_set():
            self._told = time.monotonic()
        self._ending.set()
        with self._guard:
            if self._process is not None:
                _close(self._process.stdin)

    def stop(self) -> None:
        """End the process; at once, where it does not in time."""
        self.tell_end()
        process = self._process
        if process is not None:
            try:
                process.wait(max(self._told + self._settings.worker_patience - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                log("worker_killed", pid=process.pid)
                process.kill()
                process.wait()
        if self._thread.ident is not None:
            self._thread.join()

    def _keep(self) -> None:
        pause = self._settings.worker_restart
        while (process := self._begin()) is not None:
            begun = time.monotonic()
            code = process.wait()
            _close(process.stdin)
            if self._ending.is_set():
                return
            well = time.monotonic() - begun > LIVED * pause
            pause = self._settings.worker_restart if well else min(2 * pause, self._settings.worker_restart_most)
            log("worker_ended", code=code, again_after=pause)
            self._ending.wait(pause)

    def _begin(self) -> subprocess.Popen[bytes] | None:
        with self._guard:
            if self._ending.is_set():
                return None
            process = self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                env={**os.environ, **self._environment},
                **apart(),  # Ctrl-C is for the server, which ends its worker
            )
        self._begun()
        log("worker_begun", pid=process.pid)
        return process


def _close(stream: IO[bytes] | None) -> None:
    if stream is not None:
        stream.close()
