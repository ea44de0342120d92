"""Settings of the kinds of jobs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class KindSettings:
    """How requests are taken.

    Parameters
    ----------
    interactive_steps : int
        Of a study that somebody waits for: as many as fill the track of a slider. With more it is bulk work.
    steps : int
        Of a study: as many as a drawing shows, and as a record holds whose steps are whole fronts.
    posed_steps : int
        Of a study that are posed when its request is read, spread evenly; the rest is when it is worked at. Posing one
        takes some hundredths of a second, and whoever sends a request waits for the answer.
    titled : int
        Requirements that a title repeats.
    remark : int
        Characters of a remark on a table that was brought: it may name a slot of every family.
    digits : int
        Of the values that a summary repeats.
    rounds : int
        Faults of a spec that are looked for one after the other, where each hides the next.
    seconds : float
        For looking for further faults after the first: a form must answer while somebody types.
    checked_seconds : float
        For checking the rows of a table before a batch is started.
    head : int
        Lines of a file that are looked at when it is brought; what the others hold is read when it is checked.
    part_rows : int
        Lines of a part table that is brought: each question that names it reads them.
    told_faults : int
        Of a table that are told one by one.
    """

    interactive_steps: int = 12
    steps: int = 200
    posed_steps: int = 40
    titled: int = 2
    remark: int = 600
    digits: int = 4
    rounds: int = 12
    seconds: float = 2.0
    checked_seconds: float = 10.0
    head: int = 200
    part_rows: int = 20_000
    told_faults: int = 200


KIND_SETTINGS = KindSettings()
