"""What is compiled once for all questions, begun before the first of them needs it."""

from __future__ import annotations

import time

from synth import deadline
from synth.bounds import compiled_boxes
from synth.nlp import interior_point_c_interpreted
from synth.tuning import TUNING, Tuning


def begin_shared_code(time_limit: float | None = None, tuning: Tuning = TUNING) -> None:
    """Let the code that all questions share be compiled while they are read and posed, where it is not there yet.

    Both parts at once: what a program does until it needs them takes about as long as a compiler does. It changes
    nothing but time; for programs that answer one question and end.

    Parameters
    ----------
    time_limit : float, optional
        In s, of the question: under a short one nothing is compiled.
    tuning : Tuning
    """
    with deadline.until(float("inf") if time_limit is None else time.monotonic() + time_limit):
        compiled_boxes.begin(tuning.compiling.effort)
        interior_point_c_interpreted.begin(tuning.nlp)
