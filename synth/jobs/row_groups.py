"""Which rows of a job are answered by one search: those that ask alike but for numbers, neighbours by these numbers.

A group becomes part of what each of its rows asks, as it decides which of two designs that are equal to the gap is
found first. It follows from the rows of the job alone: not from their order, nor from what is solved where, or before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.jobs.database import digest
from synth.jobs.job_settings import JOBS, GroupSettings
from synth.jobs.solve import GROUP

WIDEST, FINEST = 2.0**10, 2.0**40  # no place lies further from zero; cells of this many parts of one


@dataclass(frozen=True)
class GroupMember:
    """The place of a question in a group: the name of the group, how many it holds, and which of them it is."""

    name: str
    rows: int
    number: int

    def asked(self, question: Mapping[str, Any]) -> dict[str, Any]:
        """Return what a member asks: the question, and which group it belongs to."""
        return {**question, GROUP: {"name": self.name, "rows": self.rows}}

    def position(self) -> bytes:
        """Return what orders questions: those of a group side by side, neighbours in it too."""
        return f"{self.name}\0{self.number:08d}".encode()


class RowGroups:
    """The groups of a job. All its questions are shown first; then each may ask which group is its own.

    Parameters
    ----------
    settings : GroupSettings
    """

    def __init__(self, settings: GroupSettings = JOBS.groups) -> None:
        self._settings = settings
        self._shown: dict[str, dict[bytes, bytes]] = {}  # what is alike -> key -> numbers; as bytes, rows may be many
        self._members: dict[bytes, GroupMember] | None = None

    def show(self, key: str, where: tuple[float, ...], question: Mapping[str, Any]) -> None:
        """Show one question: its key, the place of its requirements among others, and its content."""
        alike = digest({**question, "requirements": sorted(question["requirements"])})
        self._shown.setdefault(alike, {})[bytes.fromhex(key)] = np.array(where, dtype=float).tobytes()

    def member(self, key: str) -> GroupMember | None:
        """Return the place of a question in its group; None where it is answered alone."""
        if self._members is None:
            self._members = self._formed()
        return self._members.get(bytes.fromhex(key))

    def _formed(self) -> dict[bytes, GroupMember]:
        members: dict[bytes, GroupMember] = {}
        for alike, own in self._shown.items():
            if len(own) < max(self._settings.least, 2):
                continue
            keys = sorted(own)
            places = np.array([np.frombuffer(own[key]) for key in keys])
            for rows in neighbourhoods(places, self._settings.most):
                some = [keys[k] for k in rows.tolist()]
                if len(some) < 2:
                    continue
                name = digest([alike, [key.hex() for key in some]])
                members |= {key: GroupMember(name, len(some), number) for number, key in enumerate(some)}
        self._shown.clear()
        return members


def neighbourhoods(places: np.ndarray, most: int) -> list[np.ndarray]:
    """Divide points into groups of neighbours, each in an order in which neighbours are near.

    Space is halved again and again at fixed places, as the bits of a binary number do: a point more or less changes the
    group that it is in, and no other one. Of the coordinates that is halved in which the points need the widest cell.

    Parameters
    ----------
    places : array (points, coordinates)
        As :func:`~synth.jobs.warm_starts.place` returns them.
    most : int
        Points of a group.

    Examples
    --------
    >>> [rows.tolist() for rows in neighbourhoods(np.array([[3.0], [1.0], [4.0], [2.0], [5.0]]), 2)]
    [[1], [3, 0], [2, 4]]
    """
    cells = np.floor((places + WIDEST) * FINEST).astype(np.int64)
    found: list[np.ndarray] = []
    waiting = [np.arange(len(places))]
    while waiting:
        rows = waiting.pop()
        if len(rows) <= most:
            found.append(_in_order(places, rows))
            continue
        own = cells[rows]
        differ = own.min(axis=0) ^ own.max(axis=0)
        widest = int(differ.argmax())
        if not differ[widest]:  # numbers that are the same but for how they are written
            found += np.array_split(rows, -(-len(rows) // most))
            continue
        high = own[:, widest] >> (int(differ[widest]).bit_length() - 1) & 1 == 1
        waiting += [rows[high], rows[~high]]
    return found


def _in_order(places: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return points in the order of a k-d tree."""
    order: list[int] = []
    waiting = [rows]
    while waiting:
        some = waiting.pop()
        own = places[some]
        widest = int(np.ptp(own, axis=0).argmax())
        some = some[np.argsort(own[:, widest], kind="stable")]
        if len(some) <= 2:
            order += some.tolist()
        else:
            waiting += [some[len(some) // 2 :], some[: len(some) // 2]]
    return np.array(order, dtype=np.int64)
