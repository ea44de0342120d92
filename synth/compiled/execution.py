"""What a search may use of the machine: compiled code and threads. No result depends on it but for last digits."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Execution:
    """What a search may use of the machine.

    Parameters
    ----------
    compiled : bool
        Whether code may be compiled for this question alone.
    similar_questions : int
        How many questions of its kind are asked: code that is compiled serves them all.
    workers : int
        Threads.
    """

    compiled: bool = True
    similar_questions: int = 1
    workers: int = 1


EXECUTION = Execution()
