"""Lines of the log of a service: JSON, whichever of its processes says something, and however it does.

What Python says by itself, warnings and tracebacks, goes to standard error as the log does. Where processes of a
service begin, standard error becomes a stream that makes lines of JSON of all that is no such line already.
"""

from __future__ import annotations

import json
import os
import re
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

SWITCH = "CLUTCHSYNTH_JSON_LINES"  # a variable: processes that a service starts know by it whose they are
BEGINNING = "cs_"  # of every token: programs that look for secrets in texts know them by it
TOKENS = re.compile(rf"{BEGINNING}[\w-]{{20,}}")  # also in a path, where somebody has put one by mistake
PRINTED = "said"  # the event of a line that a process has printed


def log_line(event: str, **details: Any) -> str:
    """Return a line of the log, without the tokens that may stand in it."""
    line = json.dumps({"time": round(time.time(), 3), "event": event, **details}, default=str)
    return TOKENS.sub(f"{BEGINNING}...", line)


class JsonLines:
    """Stream into which anything may be written, and which hands on lines of JSON.

    Parameters
    ----------
    stream : TextIO
        Where they go.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._begun, self._guard = stream, dict[int, str](), threading.Lock()

    def write(self, text: str) -> int:
        """Hand on what is a line by now; threads say theirs apart from each other."""
        thread = threading.get_ident()
        with self._guard:
            *lines, unfinished = (self._begun.pop(thread, "") + text).split("\n")
            if unfinished:
                self._begun[thread] = unfinished
            self._stream.writelines(f"{_as_json(line)}\n" for line in lines if line.strip())
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Hand on several texts."""
        for line in lines:
            self.write(line)

    def close_lines(self) -> None:
        """Hand on what has no end yet."""
        with self._guard:
            self._stream.writelines(f"{_as_json(line)}\n" for line in self._begun.values() if line.strip())
            self._begun.clear()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _as_json(line: str) -> str:
    try:
        if isinstance(json.loads(line), dict):
            return line
    except (ValueError, RecursionError):
        pass
    return log_line(PRINTED, process=os.getpid(), text=line)


@contextmanager
def json_lines() -> Iterator[None]:
    """Let this process, and those that it starts, write nothing but lines of JSON to standard error."""
    before, switch = sys.stderr, os.environ.get(SWITCH)
    stream = JsonLines(before)
    sys.stderr, os.environ[SWITCH] = stream, "1"
    try:
        yield
    finally:
        stream.close_lines()
        sys.stderr = before
        if switch is None:
            del os.environ[SWITCH]


def follow_switch() -> None:
    """Let a process whose service writes lines of JSON do so until it ends."""
    if os.environ.get(SWITCH) and not isinstance(sys.stderr, JsonLines):
        sys.stderr = JsonLines(sys.stderr)
