"""What a process that works for another one begins with."""

from __future__ import annotations

import os
import signal

from synth.queue.log_lines import follow_switch
from synth.system.operating_system import ENDING

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def begin_to_serve() -> None:
    """Be deaf to Ctrl-C and SIGTERM, and let linear algebra have no threads of its own.

    Whole groups of processes get the signals, and the master decides; and there are as many processes as cores.
    Where the master writes lines of JSON, so does this one.
    """
    follow_switch()
    for number in (signal.SIGINT, *ENDING):
        signal.signal(number, signal.SIG_IGN)
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
