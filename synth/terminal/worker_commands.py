"""The command that serves a queue: worker."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable
from typing import Annotated

import typer

from synth.errors import whole_number
from synth.system.operating_system import ENDING, cores
from synth.terminal.batch_commands import DATABASE_VARIABLE
from synth.terminal.session import tell
from synth.text.input_limits import INPUT_LIMITS

Served = Annotated[
    str,
    typer.Option(
        envvar=DATABASE_VARIABLE,
        help="Database of the jobs: sqlite:///FILE or postgresql://USER@HOST/NAME.",
        metavar="URL",
    ),
]
Slots = Annotated[int | None, typer.Option(help="Jobs that are worked at side by side; by default one per core.")]
Spare = Annotated[
    bool, typer.Option("--spare/--no-spare", help="Keep one process more warm, for when another is ended.")
]
Follow = Annotated[
    bool, typer.Option("--follow", help="End when standard input is closed: with the program that has started it.")
]


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command(name="worker")(worker)


def worker(database: Served, slots: Slots = None, spare: Spare = True, follow: Follow = False) -> None:
    """Work at the jobs of a database until stopped; any number of workers may, on any machines."""
    from synth.batches.store import Store
    from synth.queue.database import refuse_damaged
    from synth.queue.log_lines import follow_switch
    from synth.workers.worker import Worker

    follow_switch()

    if slots is not None:
        whole_number(slots, "--slots", INPUT_LIMITS.workers, path=("slots",))
    with Store(database, create=False) as store:
        refuse_damaged(store.engine)
        serving = Worker(store, slots or cores(), spare=spare, say=tell)
        for number in (signal.SIGINT, *ENDING):
            signal.signal(number, lambda *_: serving.stop())
        if follow:
            threading.Thread(target=_follow, args=(serving.stop,), name="follow", daemon=True).start()
        tell(f"working at the jobs of {store.url}, {serving.slots} at a time")
        serving.run()
    tell("stopped; what was under way is open again")


def _follow(stop: Callable[[], None]) -> None:
    """Wait until standard input is closed, then stop."""
    while os.read(sys.stdin.fileno(), 4096):
        pass
    stop()
