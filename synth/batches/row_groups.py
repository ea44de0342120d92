"""Which rows of a job are answered by one search: those that ask alike but for numbers, neighbours by these numbers.

A group becomes part of what each of its rows asks, as it decides which of two designs that are equal to the gap is
found first. It follows from the rows of the job alone: not from their order, nor from what is solved where, or before.
"""

from __future__ import annotations

import sqlite3
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.batches.entries import RowQuestion
from synth.batches.settings import BATCHES, GroupSettings
from synth.batches.solve import GROUP
from synth.queue.database import digest

WIDEST, FINEST = 2.0**10, 2.0**40  # no place lies further from zero; cells of this many parts of one
TABLES = """
CREATE TABLE shown (alike BLOB, key BLOB, place BLOB, name TEXT, rows INT, number INT, PRIMARY KEY (alike, key))
WITHOUT ROWID
"""


@dataclass(frozen=True)
class GroupMember:
    """The place of a question in a group: the name of the group, how many it holds, and which of them it is."""

    name: str
    rows: int
    number: int

    def with_group(self, question: RowQuestion) -> dict[str, Any]:
        """Question of a member with its group."""
        return {**question, GROUP: {"name": self.name, "rows": self.rows}}

    def position(self) -> bytes:
        """Sort key of questions: those of a group side by side, neighbours in it too."""
        return f"{self.name}\0{self.number:08d}".encode()


class RowGroups:
    """The groups of a job. All its questions are shown first; then each may ask which group is its own.

    Questions wait in a temporary database, which keeps in memory no more than its cache: rows may be many.

    Parameters
    ----------
    settings : GroupSettings
    """

    def __init__(self, settings: GroupSettings = BATCHES.groups) -> None:
        self._settings = settings
        self._database = sqlite3.connect("", isolation_level=None)  # its file has no name, and goes with it
        for statement in (f"PRAGMA cache_size = -{settings.cache}", "PRAGMA journal_mode = OFF", TABLES, "BEGIN"):
            self._database.execute(statement)
        self._formed = False

    def close(self) -> None:
        """Forget all questions."""
        self._database.close()

    def show(self, key: str, alike: str, where: tuple[float, ...]) -> None:
        """Show one question: its key, and ``alike`` and ``place`` of its row."""
        shown = (bytes.fromhex(alike), bytes.fromhex(key), np.array(where, dtype=float).tobytes())
        self._database.execute("INSERT OR IGNORE INTO shown (alike, key, place) VALUES (?, ?, ?)", shown)

    def member(self, key: str, alike: str) -> GroupMember | None:
        """Return the place of a question in its group; None where it is answered alone."""
        if not self._formed:
            self._form()
        row = self._database.execute(
            "SELECT name, rows, number FROM shown WHERE alike = ? AND key = ? AND name IS NOT NULL",
            (bytes.fromhex(alike), bytes.fromhex(key)),
        ).fetchone()
        return None if row is None else GroupMember(*row)

    def _form(self) -> None:
        self._formed = True
        least = max(self._settings.least, 2)
        several = "SELECT alike, count(*) FROM shown GROUP BY alike HAVING count(*) >= ?"
        alike = self._database.execute(several, (least,)).fetchall()
        most = self._settings.size(sum(count for _, count in alike))
        for common, _ in alike:
            for name, keys in self._groups(common, most):
                self._database.executemany(
                    "UPDATE shown SET name = ?, rows = ?, number = ? WHERE alike = ? AND key = ?",
                    [(name, len(keys), number, common, key) for number, key in enumerate(keys)],
                )

    def _groups(self, alike: bytes, most: int) -> Iterator[tuple[str, list[bytes]]]:
        """Name and keys of each group of questions that are alike."""
        with closing(self._database.execute("SELECT key, place FROM shown WHERE alike = ?", (alike,))) as records:
            points = Points.written(records)
        for portion in points.portions(max(self._settings.portion, most)):
            for rows in neighbourhoods(portion["place"], most):
                if len(rows) > 1:
                    keys = [portion["key"][k].tobytes() for k in rows.tolist()]
                    yield digest([alike.hex(), [key.hex() for key in keys]]), keys


class Points:
    """Points in a temporary file, each with its key, in the order of keys.

    Parameters
    ----------
    coordinates : int
    """

    def __init__(self, coordinates: int) -> None:
        self._kind = np.dtype([("key", np.uint8, 32), ("place", float, coordinates)])
        self._file = tempfile.TemporaryFile(prefix="clutchsynth-")
        self._count = 0

    @classmethod
    def written(cls, pairs: Iterable[tuple[bytes, bytes]]) -> Points:
        """Points of keys and places."""
        points: Points | None = None
        for key, place in pairs:
            points = points or cls(len(place) // 8)
            points._file.write(key + place)
            points._count += 1
        assert points is not None
        return points

    def portions(self, most: int) -> Iterator[np.ndarray]:
        """Yield the points of cells of space that hold so many at most, as records of ``key`` and ``place``.

        Points at one place are one portion, however many.
        """
        waiting = [self]
        try:
            while waiting:
                cell = waiting.pop()
                with cell._file:
                    halving = None if cell._count <= most else cell._halving(most)
                    if halving is None:
                        yield from cell._read(cell._count)
                    else:
                        waiting += cell._halved(*halving, most)
        finally:
            for cell in waiting:
                cell._file.close()

    def _read(self, count: int) -> Iterator[np.ndarray]:
        self._file.seek(0)
        while len(raw := self._file.read(count * self._kind.itemsize)):
            yield np.frombuffer(raw, dtype=self._kind)

    def _halving(self, portion: int) -> tuple[int, int] | None:
        ends = [(c.min(axis=0), c.max(axis=0)) for c in (_cells(block["place"]) for block in self._read(portion))]
        return _halving(np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0))

    def _halved(self, coordinate: int, bit: int, portion: int) -> tuple[Points, Points]:
        (coordinates,) = self._kind["place"].shape
        halves = high, low = Points(coordinates), Points(coordinates)
        for block in self._read(portion):
            above = _is_high(_cells(block["place"])[:, coordinate], bit)
            for half, half_points in ((high, block[above]), (low, block[~above])):
                half._file.write(half_points.tobytes())
                half._count += len(half_points)
        return halves


def neighbourhoods(places: np.ndarray, most: int) -> Iterator[np.ndarray]:
    """Divide points into groups of neighbours, each in an order in which neighbours are near.

    Space is halved again and again at fixed places, as the bits of a binary number do: a point more or less changes the
    group that it is in, and no other one. Of the coordinates that is halved in which the points need the widest cell.

    Parameters
    ----------
    places : array (points, coordinates)
        As :func:`~synth.batches.warm_starts.place` returns them.
    most : int
        Points of a group.

    Examples
    --------
    >>> [rows.tolist() for rows in neighbourhoods(np.array([[3.0], [1.0], [4.0], [2.0], [5.0]]), 2)]
    [[1], [3, 0], [2, 4]]
    """
    cells = _cells(places)
    waiting = [np.arange(len(places))]
    while waiting:
        rows = waiting.pop()
        if len(rows) <= most:
            yield _in_order(places, rows)
            continue
        members = cells[rows]
        halving = _halving(members.min(axis=0), members.max(axis=0))
        if halving is None:  # numbers that are the same but for how they are written
            yield from np.array_split(rows, -(-len(rows) // most))
            continue
        coordinate, bit = halving
        high = _is_high(members[:, coordinate], bit)
        waiting += [rows[high], rows[~high]]


def _cells(places: np.ndarray) -> np.ndarray:
    """Numbers of the finest cells that points lie in."""
    return np.floor((places + WIDEST) * FINEST).astype(np.int64)


def _halving(low: np.ndarray, high: np.ndarray) -> tuple[int, int] | None:
    """Coordinate and bit by which points between two cells are halved; None where all lie in one cell."""
    differ = low ^ high
    widest = int(differ.argmax())
    return (widest, int(differ[widest]).bit_length() - 1) if differ[widest] else None


def _is_high(cells: np.ndarray, bit: int) -> np.ndarray:
    high: np.ndarray = cells >> bit & 1 == 1
    return high


def _in_order(places: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return points in the order of a k-d tree."""
    order: list[int] = []
    waiting = [rows]
    while waiting:
        group = waiting.pop()
        positions = places[group]
        widest = int(np.ptp(positions, axis=0).argmax())
        group = group[np.argsort(positions[:, widest], kind="stable")]
        if len(group) <= 2:
            order += group.tolist()
        else:
            waiting += [group[len(group) // 2 :], group[: len(group) // 2]]
    return np.array(order, dtype=np.int64)
