"""The question that all benchmarks ask, and catalogues of a wanted size made from the shipped ones.

A smaller size restricts the shipped tables by ``parts``. A larger one appends rows to them whose numbers are those of a
shipped row, each times a random factor near 1. The random numbers are seeded, and a larger table begins
with the rows of a smaller one, so that fronts of different sizes can be compared.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from synth.problems.multi_plate.model import MultiPlateClutch

from synth.declaration import Declaration
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of

# The hoist of examples/hoist_multi_plate.yaml; the ramp time is free here.
HOIST: dict[str, Any] = {
    "load_torque": "600 N*m",
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
}
# How far the requirement rows of the part "rows" go from the hoist, as the standard deviation of a logarithm.
ROW_SPREAD = {"load_torque": 0.15, "driver_speed": 0.10, "driven_inertia": 0.15, "jerk_limit": 0.20}
ROW_UNITS = {"load_torque": "N*m", "driver_speed": "rad/s", "driven_inertia": "kg*m2", "jerk_limit": "rad/s3"}
OBJECTIVES = ("mass", "actuation_force")
# The smallest question of the same kind: what it takes the first time is tracing and compilation.
TINY: dict[str, Any] = {
    "parts": {"friction_pair": ["graphitic_wet"], "inner_plate": ["core 1.5"], "outer_plate": ["core 1.5"]},
    "fix": {"friction_surfaces": 20},
}

ROW_NOISE = 0.03
SEED = 20240
LININGS, PLATES = "friction_materials", "core_plates"
# Of the shipped plates only these, so that questions stay those of earlier measurements.
CORES = tuple(f"core {t}" for t in ("0.8", "1", "1.2", "1.5", "1.6", "1.8", "2", "2.5", "3", "3.5", "4"))


@dataclass(frozen=True)
class Size:
    """A number of combinations: rows that fit the slots after enlarging, and a restriction by ``parts``."""

    name: str
    linings: int
    plates: int
    parts: Mapping[str, tuple[str, ...]] | None = None


SIZES = {
    size.name: size
    for size in (
        Size("tiny", 11, 11, TINY["parts"]),
        Size(
            "6k",
            11,
            11,
            {
                "inner_plate": ("core 0.8", "core 1", "core 1.5", "core 2", "core 2.5", "core 4"),
                "outer_plate": ("core 1", "core 2", "core 4"),
            },
        ),
        Size("110k", 30, 11),
        Size("240k", 20, 20),
        Size("1M", 69, 22),
        Size("1G", 1000, 183),
    )
}


class CountedTraces(MultiPlateClutch):
    """The family, which counts how often the engine traces it."""

    traces = 0

    def declare(self, d: Declaration) -> None:
        self.traces += 1
        super().declare(d)


@cache
def problem() -> CountedTraces:
    """Return the problem without the rules of practice, as other optimisers get it; one instance, traced once."""
    return CountedTraces(practice="off")


@cache
def offered() -> dict[str, tuple[str, ...]]:
    """Return, per table to enlarge, the designations of the shipped rows that the family may use."""
    slots = instance_of(problem(), HOIST, Catalogs()).selection.slots
    rows = {s.table.name: tuple(s.table.designations[row] for row in s.rows) for s in slots}
    return {**rows, PLATES: CORES}


def more_rows(name: str, count: int) -> pd.DataFrame:
    """Return rows to append to a shipped table, so that ``count`` rows fit the slots that use it.

    Parameters
    ----------
    name : str
        Name of the table.
    count : int
        Rows that fit, with the shipped ones.

    Returns
    -------
    pandas.DataFrame
        Shipped rows in turn, with designations such as ``cork_wet~1``; empty where the shipped ones suffice.
    """
    catalogs = Catalogs()
    table, schema = catalogs.table(name), catalogs.schema(name)
    base = [table.row_index(designation) for designation in offered()[name]]
    made = max(count - len(base), 0)
    source = [base[k % len(base)] for k in range(made)]
    frame = table.select(source).to_frame()
    frame["designation"] = [f"{table.designations[row]}~{k // len(base) + 1}" for k, row in enumerate(source)]
    numeric = [c for c in table.columns.values() if c.numeric and c.type == "number"]
    rng = np.random.default_rng([SEED, sum(name.encode())])
    # One draw per row and column in this order: a longer table begins with the rows of a shorter one.
    factors = np.exp(ROW_NOISE * np.clip(rng.standard_normal((made, len(numeric))), -3, 3))
    friction = next((k for k, c in enumerate(numeric) if c.name.startswith("mu_")), 0)
    for k, column in enumerate(numeric):
        # One factor for all friction coefficients of a row keeps their order.
        factor = factors[:, friction if column.name.startswith("mu_") else k]
        limits = None if schema is None else schema.get(column.name)
        low = -math.inf if limits is None or limits.minimum is None else limits.minimum
        high = math.inf if limits is None or limits.maximum is None else limits.maximum
        frame[column.heading] = np.clip(frame[column.heading].to_numpy(dtype=float) * factor, low, high)
    return frame


def tables(size: Size) -> dict[str, Any]:
    """Return the tables of a size, as ``catalogs=`` takes them."""
    shipped = Catalogs().table(PLATES)
    cores = shipped.select([shipped.row_index(designation) for designation in CORES]).to_frame()
    spec: dict[str, Any] = {PLATES: pd.concat([cores, more_rows(PLATES, size.plates)], ignore_index=True)}
    linings = more_rows(LININGS, size.linings)
    if len(linings):
        spec[LININGS] = ["+", linings]
    return spec


def question(size: Size) -> dict[str, Any]:
    """Return what all calls about a size hand to ``synth.synthesize``, requirements apart."""
    parts = None if size.parts is None else {slot: list(rows) for slot, rows in size.parts.items()}
    return {"catalogs": Catalogs(tables(size)), "parts": parts}


def requirement_rows(count: int) -> list[dict[str, Any]]:
    """Return seeded requirement rows around the hoist; a longer list begins with a shorter one."""
    rng = np.random.default_rng([SEED, 300])
    rows = []
    for _ in range(count):
        row = dict(HOIST)
        for name, spread in ROW_SPREAD.items():
            nominal = float(HOIST[name].split()[0])
            factor = math.exp(spread * float(np.clip(rng.standard_normal(), -2, 2)))
            row[name] = f"{nominal * factor:.6g} {ROW_UNITS[name]}"
        rows.append(row)
    return rows
