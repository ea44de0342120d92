"""How much compiled code is asked for, by all programs so far: what is asked for often is there for those to come.

A program that answers one question ends before a compiler would, however often it is run. What code of its own would
have been used for is noted beside the code that is kept; where that adds up, a compiler begins as a program ends and
goes on without it.
"""

from __future__ import annotations

import atexit
import os
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from synth.compiled.compilation import PREFIX
from synth.file_locks import locked
from synth.operating_system import CAN_LEAVE_BEHIND, LIBRARY, after_fork, leave_behind
from synth.tuning import CompilingEffort


class Demand:
    """What one library would have been used for.

    Parameters
    ----------
    command : list of str
        The compiler and its flags.
    text : str
        The translation unit.
    path : Path
        Of the library.
    effort : CompilingEffort
    enough : float
        From how much on it is compiled.

    Attributes
    ----------
    here : float
        By this program.
    """

    def __init__(self, command: Sequence[str], text: str, path: Path, effort: CompilingEffort, enough: float) -> None:
        self.path, self.enough = path, enough
        self._command, self._text, self._effort = list(command), text, effort
        self._noted = path.with_suffix(".demand")
        self.here = 0.0

    def total(self) -> float:
        """Return how much it was, by earlier programs as well."""
        try:
            return self.here + float(self._noted.read_text(encoding="ascii"))
        except (OSError, ValueError):
            return self.here

    def note(self) -> None:
        """Keep how much it was, for programs to come."""
        self._noted.write_text(f"{self.total():.0f}", encoding="ascii", newline="\n")

    def compile(self) -> None:
        """Begin to compile the library, by a process that goes on where this one ends."""
        lock = self.path.with_suffix(".lock")
        handle = locked(lock)
        if handle is None:
            return  # another process compiles it
        try:
            folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=self.path.parent))
            origin, made = folder / "code.c", folder / f"code{LIBRARY}"
            origin.write_text(self._text, encoding="utf-8", newline="\n")
            command = [*self._command, "-o", str(made), str(origin), "-lm"]
            leave_behind(command, self._effort.most, folder, made, self.path, lock, handle)
        finally:
            os.close(handle)
        self._noted.unlink(missing_ok=True)


_known: dict[Path, Demand] = {}


def demand_for(command: Sequence[str], text: str, path: Path, effort: CompilingEffort, enough: float) -> Demand:
    """Return what a library would be used for in this program, which is noted when it ends."""
    pools = sys.modules.get("multiprocessing.util")
    if pools is not None and not _known:
        # Processes of a pool end without what is registered for the end of a program.
        pools.Finalize(None, leave, exitpriority=0)
    if path not in _known:
        _known[path] = Demand(command, text, path, effort, enough)
    return _known[path]


def leave() -> None:
    """Note what was asked for, and begin to compile what was asked for most: one library as a program ends."""
    asked = [demand for demand in _known.values() if demand.here and not demand.path.exists()]
    _known.clear()
    most = max(asked, key=Demand.total, default=None)
    for demand in asked:
        with suppress(OSError):  # the folder may be gone, or full
            if CAN_LEAVE_BEHIND and demand is most and demand.total() >= demand.enough:
                demand.compile()
            else:
                demand.note()


atexit.register(leave)
after_fork(_known.clear)
