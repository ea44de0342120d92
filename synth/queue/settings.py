"""Settings of the job database: patience, leases, sizes of reads and writes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class StoreSettings:
    """How the job database is used.

    Parameters
    ----------
    patience : float
        In s, that whoever opens or writes waits for others: a checkpoint of SQLite may take seconds, nothing a minute.
    lease : float
        In s, that a claim lasts without a sign of life: so long a unit is idle whose worker died on another machine.
    chunk : int
        Rows that are written or read at a time: enough that statements cost little, and little memory.
    overflow : int
        Connections at a time beside the five that stay open: more than a server has threads, as whoever waits for one
        in its loop holds up all others.
    starving : float
        In s, after which bulk work that nobody has served counts as work that somebody waits for.
    forgotten : float
        In s, after which a worker that has given no sign of life is listed no more.
    pages_released : int
        Pages of a SQLite file, of 4 kB mostly, that are given back at a time after jobs were removed: others wait for
        as long, some hundredths of a second.
    """

    patience: float = 60.0
    lease: float = 60.0
    chunk: int = 500
    overflow: int = 45
    starving: float = 60.0
    forgotten: float = 86400.0
    pages_released: int = 5000


STORE = StoreSettings()
