"""What a per cent of a requirement or a limit costs: the list of prices, its sentences, and its files."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, read_json, table_frame
from synth.folders.output_folder import PRICES, loses_nothing, save_file, save_files, save_result, settle
from synth.results import Frame
from synth.studies.settings import PRICES as LIMITS
from synth.text.numbers import percent

if TYPE_CHECKING:
    import pandas as pd

PRICES_FORMAT = 1  # of the record of prices found
RECORD = "prices.json"
CONFIRMED, FIXED, CHANGE, NOTHING = "confirmed", "parts fixed", "parts change", "no influence"
WITHHELD = "withheld"


@dataclass(frozen=True)
class Price:
    """What one requirement or limit costs in one objective of one design: per cent of the objective per per cent.

    ``elasticity`` is the price by the multipliers, ``up`` and ``down`` those that hold for a little more and a little
    less (None: withheld); ``compared`` tells over which combinations of parts.
    """

    design: int
    objective: str
    quantity: str
    kind: str
    elasticity: float | None
    up: float | None
    down: float | None
    status: str
    reason: str
    compared: str
    sentence: str


COLUMNS = tuple(column.name for column in fields(Price))


@dataclass(frozen=True)
class Prices:
    """Prices of requirements and limits, per design and objective.

    ``step`` is the share by which each was moved, ``asked`` the ranks of the designs asked for; a design that was not
    reached has no rows. ``front`` is the checksum of the front they are of.
    """

    frame: Frame
    asked: tuple[int, ...]
    step: float
    rows: tuple[Price, ...]
    makeable: bool
    fingerprint: str
    statistics: Mapping[str, Any]
    interrupted: str = ""
    front: str = ""

    @property
    def finished(self) -> tuple[int, ...]:
        """Return the ranks of the designs whose prices are known."""
        known = {row.design for row in self.rows}
        return tuple(rank for rank in self.asked if rank in known)

    def of(self, design: int, objective: str, quantity: str, kind: str = "requirement") -> Price:
        """Return one price.

        Raises
        ------
        KeyError
            When there is none of that name.
        """
        for row in self.rows:
            if (row.design, row.objective, row.quantity, row.kind) == (design, objective, quantity, kind):
                return row
        raise KeyError(f"{kind} {quantity}, objective {objective}, design {design}")

    def to_frame(self) -> pd.DataFrame:
        """Return one row per price."""
        return table_frame(COLUMNS, [astuple(row) for row in self.rows])

    def files(self) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text."""
        table = csv_text(COLUMNS, [astuple(row) for row in self.rows])
        store = PriceStore(None, self.fingerprint, self.front)
        self._enter(store)
        return {"prices.csv": table, RECORD: store.text()}

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write prices.csv and prices.json; return the folder.

        What was stopped replaces no earlier result: it is written to a folder ``stopped..`` beside that, where the
        designs that are finished are kept, and goes to the folder when it is finished.
        """
        target = Path(folder)
        store = PriceStore.of(target, self.fingerprint, self.front)
        self._enter(store)
        files = csv.files({**self.files(), RECORD: store.text()})
        if self.interrupted and store.folder != target:
            return save_files(target if store.folder is None else store.folder, files)
        known = loses_nothing(target, files, ["prices.csv"])
        place = save_result(target, files, PRICES, bool(self.interrupted), known)
        if store.folder is not None and store.folder not in (target, place):
            shutil.rmtree(store.folder, ignore_errors=True)  # all of it stands in the result now
        return place

    def _enter(self, store: PriceStore) -> None:
        for rank in self.finished:
            store.known[rank] = [asdict(row) for row in self.rows if row.design == rank]


class PriceStore:
    """Prices of finished designs, kept in a folder; without one nothing is kept."""

    def __init__(self, folder: Path | None, fingerprint: str, front: str = "") -> None:
        self.folder, self.fingerprint, self.front = folder, fingerprint, front
        earlier = None if folder is None else self._read(folder / RECORD)
        self.known: dict[int, list[dict[str, Any]]] = earlier or {}
        self.begun = earlier is not None

    @classmethod
    def of(cls, folder: Path | None, fingerprint: str, front: str = "") -> PriceStore:
        """Return the store of a question: its folder, or one beside the prices of another question."""
        if folder is None:
            return cls(None, fingerprint, front)
        settle(folder)
        here = cls(folder, fingerprint, front)
        if here.begun or not (folder / RECORD).exists():
            return here
        return cls(folder / f"stopped_{fingerprint[:8]}", fingerprint, front)

    def _read(self, path: Path) -> dict[int, list[dict[str, Any]]] | None:
        """Finished part of an earlier run of the same question; None where there was none."""
        try:
            content = read_json(path, "prices", "prices that clutchsynth has written")
            if content["format"] != PRICES_FORMAT or content["fingerprint"] != self.fingerprint:
                return None
            return {int(k): [asdict(Price(**row)) for row in rows] for k, rows in content["designs"].items()}
        except (ValueError, KeyError, TypeError, AttributeError):
            return None

    def text(self) -> str:
        """Content of the file."""
        content = {"format": PRICES_FORMAT, "fingerprint": self.fingerprint, "front": self.front, "designs": self.known}
        return json.dumps(content, indent=1, allow_nan=False) + "\n"

    def get(self, design: int) -> list[Price] | None:
        """Return the prices of a design where they are kept."""
        rows = self.known.get(design)
        return None if rows is None else [Price(**row) for row in rows]

    def put(self, design: int, rows: list[Price]) -> None:
        """Keep the prices of a design."""
        self.known[design] = [asdict(row) for row in rows]
        if self.folder is not None:
            save_file(self.folder / RECORD, self.text())


def price_sentence(
    quantity: str,
    kind: str,
    objective: str,
    sense: str,
    steps: tuple[float, float],
    up: float | None,
    down: float | None,
    notes: tuple[str, str],
) -> str:
    """Return a price as a sentence.

    Parameters
    ----------
    quantity, kind, objective, sense : str
    steps : tuple of float
        The shares that are spoken of, upwards and downwards.
    up, down : float or None
        Prices; None where withheld.
    notes : tuple of str
        What else changes upwards and downwards; nothing where empty.
    """
    if up == 0 and down == 0:
        name = f"the limit {quantity}" if kind == "limit" else quantity
        return f"{name} has no influence on {objective}"
    size, other = (percent(step) for step in steps)
    more = f"raising the limit {quantity} by {size}" if kind == "limit" else f"{size} more {quantity}"
    less = f"lowering it by {other}" if kind == "limit" else f"{other} less"
    if up is None and down is None:
        return f"what {more} costs in {objective} is withheld"
    alike = up is not None and down is not None and abs(up - down) <= LIMITS.alike * max(abs(up), abs(down))
    first = f"{more}: withheld" if up is None else f"{more} {_effect(up, steps[0], objective, sense)}{_note(notes[0])}"
    if alike and not any(notes) and steps[0] == steps[1]:
        return first
    effect = "" if down is None else _effect(-down, steps[1], objective, sense)
    second = f"{less}: withheld" if down is None else f"{less} {effect}{_note(notes[1])}"
    return f"{first}; {second}"


def _note(text: str) -> str:
    return f" ({text})" if text else ""


def _effect(price: float, step: float, objective: str, sense: str) -> str:
    change = price * step
    if abs(change) < 5e-7:
        return f"changes nothing in {objective}"
    worse = (change > 0) == (sense == "min")
    verb = "costs" if worse else "saves" if sense == "min" else "gains"
    return f"{verb} {percent(abs(change))} {objective}"
