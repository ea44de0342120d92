"""A C compiler that works beside the program, and is ended with it.

What is compiled is part of how a question is answered: the last digits depend on it. A search that needs it waits, so
that the same question always goes the same way; while it waits it may do something else, see :func:`meanwhile`. Under a
time limit that a compiler may use up nothing is compiled: the other work would have begun anew, for nothing.
"""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from synth import deadline
from synth.file_locks import alone, is_taken
from synth.native_switch import native_wanted
from synth.operating_system import LIBRARY, after_fork, apart, end_with_all, put_in_place
from synth.tuning import CompilingEffort

PREFIX = "compiling_"  # of the folders it works in, beside what is finished

_other_work: ContextVar[Callable[[Callable[[], bool]], None] | None] = ContextVar("other_work", default=None)
_off: ContextVar[bool] = ContextVar("off", default=False)
_refused: ContextVar[deadline.End | None] = ContextVar("refused", default=None)


class Elsewhere(Exception):
    """Another process compiles the same."""


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


class Compilation:
    """A compiler at work on a C source, which becomes a shared library.

    It is made beside its final place and moved there at once: another process sees all of it or nothing. No two
    processes make the same one at a time.

    Parameters
    ----------
    compiler : str
    text : str
        The translation unit.
    path : Path
        Of the library.
    flags : list of str

    Raises
    ------
    OSError
        It cannot be begun, or not written.
    Elsewhere
        Another process makes the same.
    """

    def __init__(self, compiler: str, text: str, path: Path, flags: Sequence[str]) -> None:
        self._path, self._left = path, ExitStack()
        self.begun = time.monotonic()
        try:
            self._keep_others_out(path.with_suffix(".lock"))
            folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=path.parent))
            self._left.callback(shutil.rmtree, folder, ignore_errors=True)
            origin, self._made = folder / "code.c", folder / f"code{LIBRARY}"
            origin.write_text(text, encoding="utf-8", newline="\n")
            command = [compiler, *flags, "-o", str(self._made), str(origin), "-lm"]
            # In a session of its own: it is not the terminal that ends it but we, with all that it has started.
            self.process: subprocess.Popen[bytes] = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(folder))},
                **apart(),
            )
            self._left.callback(end_with_all, self.process)
        except BaseException:
            self._left.close()
            raise

    def _keep_others_out(self, lock: Path) -> None:
        if not self._left.enter_context(alone(lock)):
            raise Elsewhere

    def ready(self) -> bool:
        """Tell whether the compiler is done."""
        return self.process.poll() is not None

    def finish(self) -> None:
        """Move what was made to its place; raise CalledProcessError or OSError where nothing was."""
        try:
            if self.process.returncode != 0:
                raise subprocess.CalledProcessError(self.process.returncode, str(self.process.args))
            put_in_place(self._made, self._path)
        finally:
            self.end()

    def end(self) -> None:
        """End the compiler, if it is still at work, with the programs that it has started; nothing of it is left."""
        self._left.close()


# What compiles beside the program, by the place of the library. It is ended with the program; a process that is forked
# off has no part in it, but lets nothing of it be collected, which would end it.
_beside: dict[Path, Compilation] = {}
_of_others: list[Compilation] = []


def _end_all() -> None:
    """Keep what is finished, and end the rest."""
    while _beside:
        running = _beside.popitem()[1]
        with suppress(OSError, subprocess.SubprocessError):
            if running.ready():
                running.finish()
        running.end()


def _leave_to_parent() -> None:
    _of_others.extend(_beside.values())
    _beside.clear()


atexit.register(_end_all)
after_fork(_leave_to_parent)


def _begin_beside(compiler: str, text: str, path: Path, flags: Sequence[str]) -> None:
    _beside[path] = Compilation(compiler, text, path, flags)
    # Processes of a pool end without what is registered for the end of a program.
    pools = sys.modules.get("multiprocessing.util")
    if pools is not None:
        pools.Finalize(None, _end_all, exitpriority=1)


def compile_beside(compiler: str, text: str, path: Path, flags: Sequence[str], effort: CompilingEffort) -> bool:
    """Compile a C source beside all other work; tell whether that is over, well or not.

    It is begun when this is asked first, and looked after whenever it is asked again; nobody waits for it. What is
    still at work when the program ends is ended.

    Parameters
    ----------
    compiler, text, path, flags, effort
        As for :func:`compile_shared`.

    Raises
    ------
    OSError, subprocess.SubprocessError
        It cannot be compiled, or not written.
    """
    if path.exists():
        return True
    if path not in _beside:
        if deadline.current().given < effort.worthwhile:
            return False
        with suppress(Elsewhere):
            _clear_away(path.parent, 2 * effort.most)
            _begin_beside(compiler, text, path, flags)
        return False
    running = _beside[path]
    if running.ready():
        _beside.pop(path).finish()
        return True
    if time.monotonic() > running.begun + effort.most:
        _beside.pop(path).end()
        raise subprocess.TimeoutExpired(str(running.process.args), effort.most)
    return False


def compile_shared(compiler: str, text: str, path: Path, flags: Sequence[str], effort: CompilingEffort) -> None:
    """Compile a C source into a shared library, unless the time limit is too short for that.

    What was begun beside is waited for. Whatever ends the wait ends the compiler, and nothing of it is left.

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
    begun = time.monotonic()
    while not path.exists():
        if time.monotonic() > begun + effort.most:
            raise subprocess.TimeoutExpired(compiler, effort.most)
        try:
            running = _beside.pop(path, None) or Compilation(compiler, text, path, flags)
        except Elsewhere:
            # It is made by another process: wait until it is there, or until that process has given it up.
            _wait(lambda: path.exists() or not is_taken(path.with_suffix(".lock")), begun, effort)
            time.sleep(effort.look)
            continue
        try:
            _wait(running.ready, begun, effort)
            running.finish()
        finally:
            running.end()


def _wait(ready: Callable[[], bool], begun: float, effort: CompilingEffort) -> None:
    """Wait for a compiler, and do other work meanwhile, if there is any and it takes long."""
    work = _other_work.get()
    alone_until = time.monotonic() + effort.undisturbed
    while not ready():
        deadline.check()
        if time.monotonic() > begun + effort.most:
            raise subprocess.TimeoutExpired("cc", effort.most)
        if work is not None and time.monotonic() >= alone_until:
            without = _other_work.set(None)  # what is done meanwhile waits for nothing
            try:
                work(ready)
            finally:
                _other_work.reset(without)
            work = None
        else:
            time.sleep(effort.look)


def _clear_away(folder: Path, age: float) -> None:
    """Remove what programs that were killed have left behind: what is older, in s, than any compiler may work."""
    for left in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > age:
                shutil.rmtree(left, ignore_errors=True)
