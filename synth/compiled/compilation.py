"""A C compiler that works beside the program, and is ended with it.

What is compiled is part of how a question is answered: the last digits depend on it. A search that needs it waits, so
that the same question always goes the same way; while it waits it may do something else, see :func:`meanwhile`. Under a
time limit that a compiler may use up nothing is compiled: the other work would have begun anew, for nothing.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from synth import deadline
from synth.native_switch import native_wanted
from synth.tuning import CompilingEffort

PREFIX = "compiling_"  # of the folders it works in, beside what is finished

_other_work: ContextVar[Callable[[Callable[[], bool]], None] | None] = ContextVar("other_work", default=None)
_off: ContextVar[bool] = ContextVar("off", default=False)
_refused: ContextVar[deadline.End | None] = ContextVar("refused", default=None)


class NotCompiled(Exception):
    """The time limit is too short for compiling: what it limits is done without compiled code from now on."""


@contextmanager
def meanwhile(work: Callable[[Callable[[], bool]], None]) -> Iterator[None]:
    """Do some work whenever the block waits for the compiler.

    ``work`` is given a function that tells whether the compiler is done, and should soon return when it is.
    """
    before = _other_work.set(work)
    try:
        yield
    finally:
        _other_work.reset(before)


@contextmanager
def switched_off() -> Iterator[None]:
    """Let the block do without compiled code."""
    before = _off.set(True)
    try:
        yield
    finally:
        _off.reset(before)


def switched_on() -> bool:
    """Tell whether compiled code is wanted."""
    return native_wanted() and not _off.get() and _refused.get() is not deadline.current()


def compile_shared(compiler: str, text: str, path: Path, flags: Sequence[str], effort: CompilingEffort) -> None:
    """Compile a C source into a shared library, unless the time limit is too short for that.

    It is made beside its final place and moved there at once: another process sees all of it or nothing. Whatever ends
    the wait ends the compiler, and nothing of it is left.

    Parameters
    ----------
    compiler : str
    text : str
        The translation unit.
    path : Path
        Of the library.
    flags : list of str
    effort : CompilingEffort

    Raises
    ------
    OSError, subprocess.SubprocessError
        It cannot be compiled, or not written.
    Stopped
        Time is over.
    NotCompiled
        It is not even begun; compiled code is switched off for all that has this time limit.
    """
    end = deadline.current()
    if end.given < effort.worthwhile:
        _refused.set(end)
        raise NotCompiled
    _clear_away(path.parent, 2 * effort.most)
    folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=path.parent))
    process: subprocess.Popen[bytes] | None = None
    try:
        origin, made = folder / "code.c", folder / "code.so"
        origin.write_text(text)
        command = [compiler, *flags, "-o", str(made), str(origin), "-lm"]
        # In a session of its own: it is not the terminal that ends it but we, with all that it has started.
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, "TMPDIR": str(folder)},
        )
        _wait(process, effort)
        if process.returncode != 0:
            raise subprocess.CalledProcessError(process.returncode, command)
        made.replace(path)
    finally:
        if process is not None:
            _end(process)
        shutil.rmtree(folder, ignore_errors=True)


def _wait(process: subprocess.Popen[bytes], effort: CompilingEffort) -> None:
    """Wait for a compiler, and do other work meanwhile, if there is any."""
    begun, work = time.monotonic(), _other_work.get()
    if work is not None:
        without = _other_work.set(None)  # what is done meanwhile waits for nothing
        try:
            work(lambda: process.poll() is not None)
        finally:
            _other_work.reset(without)
    while process.poll() is None:
        deadline.check()
        if time.monotonic() > begun + effort.most:
            raise subprocess.TimeoutExpired(process.args, effort.most)
        with suppress(subprocess.TimeoutExpired):
            process.wait(effort.look)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a compiler that is still at work, with the programs that it has started."""
    if process.poll() is None:
        with suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _clear_away(folder: Path, age: float) -> None:
    """Remove what programs that were killed have left behind: what is older, in s, than any compiler may work."""
    for left in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > age:
                shutil.rmtree(left, ignore_errors=True)
