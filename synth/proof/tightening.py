"""Narrowing of boxes by single limits, for the proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from synth.proof.clusters import FAR, TINY
from synth.proof.enclosure import Encloser, Slopes
from synth.proof.interval_arithmetic import INF, Pair
from synth.proof.questions import Coordinate
from synth.proof.tape import Expr, Ref, sign_of


@dataclass(frozen=True)
class ProofRow:
    """A limit, or an objective against the end of a region, as a value that must not be above 0.

    ``least`` bounds it for feasible designs, ``anywhere`` for all points of the box.
    """

    least: Expr
    anywhere: Expr
    center: Expr
    slopes: Slopes
    void: Ref | None = None


class _Step:
    """Records what the rows say of a batch of boxes."""

    def __init__(
        self,
        encloser: Encloser,
        ends: Sequence[Pair],
        halves: Sequence[Ref],
        coordinates: Sequence[Coordinate],
        groups: Sequence[int],
        pad: float,
    ) -> None:
        self._pad = pad
        self._e, self._do, self._where = encloser, encloser.do, encloser.tape.where
        self._ends, self._halves, self._coordinates, self._groups = ends, halves, coordinates, groups

    def narrowed(self, rows: Sequence[ProofRow], levels: Sequence[Ref], narrow: Sequence[Pair]) -> list[Expr]:
        """Bounds from narrow ranges: the largest row, new ends, and least objectives."""
        worst: Expr = -INF
        floors = []
        for row in rows:
            least = row.least if row.void is None else self._where(row.void, -INF, row.least)
            worst = self._do("fmax", worst, least)
            floors.append(least)
        ends = [self._within(k, pair) for k, pair in enumerate(narrow)]
        floors = [self._do("add", x, level) for x, level in zip(floors, levels, strict=False)]
        return [worst, *(x for x, _ in ends), *(x for _, x in ends), *floors]

    def sloped(
        self,
        rows: Sequence[ProofRow],
        levels: Sequence[Ref],
        widths: Sequence[Ref],
        groups: int,
        emphasis: Sequence[Expr],
    ) -> list[Expr]:
        """Bounds from slopes: as ``narrowed``, then how much each group spreads the rows, and the middle.

        ``emphasis``: how much each row counts when it is told what to split.
        """
        do = self._do
        worst: Expr = -INF
        middle: Expr = -INF
        scores: list[Expr] = [0.0] * groups
        floors = []
        self._up: list[Expr] = [INF] * len(self._ends)
        self._down: list[Expr] = [INF] * len(self._ends)
        for number, (row, counts) in enumerate(zip(rows, emphasis, strict=True)):
            reach = {k: do("multiply", self._e.largest(s), self._halves[k]) for k, s in row.slopes.items()}
            total: Expr = 0.0
            for r in reach.values():
                total = do("add", total, r)
            least, center = do("fmax", row.anywhere, do("subtract", row.center, total)), row.center
            if row.void is not None:
                least, center = self._where(row.void, -INF, least), self._where(row.void, -INF, center)
            worst, middle = do("fmax", worst, least), do("fmax", middle, center)
            if reach:
                # A row near to be broken all over the box, in relation to its spread, is the one to work on.
                weight = do("exp", do("divide", do("multiply", 4.0, least), do("fmin", total, FAR)))
                weight = do("multiply", weight, counts)
                for k, r in reach.items():
                    group = self._groups[k]
                    scores[group] = do("add", scores[group], do("multiply", weight, r))
                if number < len(levels):
                    scores[-1] = do("add", scores[-1], do("multiply", weight, widths[number]))
                self._tighten(row.slopes, do("subtract", TINY, least))
            floors.append(least)
        ends = [self._within(k, self._reached(k)) for k in range(len(self._ends))]
        floors = [do("add", x, level) for x, level in zip(floors, levels, strict=False)]
        return [worst, *(x for x, _ in ends), *(x for _, x in ends), *floors, *scores, middle]

    def _tighten(self, slopes: Slopes, slack: Expr) -> None:
        """Keep inputs within the distance from their best ends that the slack of a row allows."""
        do = self._do
        for k, (low, high) in slopes.items():
            if sign_of(high) >= 0:
                self._up[k] = do("fmin", self._up[k], self._distance(slack, low))
            if sign_of(low) <= 0:
                self._down[k] = do("fmin", self._down[k], self._distance(slack, do("negative", high)))

    def _distance(self, slack: Expr, slope: Expr) -> Expr:
        """Greatest distance of an input from its best end at a slope of at least this; unlimited where it falls."""
        if sign_of(slope) < 0 or (not isinstance(slope, Ref) and slope == 0):
            return INF
        return self._do("divide", slack, self._do("fmax", slope, TINY * TINY) if isinstance(slope, Ref) else slope)

    def _within(self, k: int, pair: Pair) -> Pair:
        """Return the ends of a coordinate met with others, which are given some room for rounding."""
        do, (low, high) = self._do, self._ends[k]
        pad = do("multiply", self._pad, do("maximum", do("absolute", low), do("absolute", high)))
        new_low = low if pair[0] is low else do("fmax", low, do("subtract", pair[0], pad))
        return new_low, high if pair[1] is high else do("fmin", high, do("add", pair[1], pad))

    def _reached(self, k: int) -> Pair:
        """Room that the rows leave a coordinate from its best ends."""
        do, (low, high) = self._do, self._ends[k]
        up, down = self._up[k], self._down[k]
        if self._coordinates[k].log:
            new = do("multiply", high, do("exp", do("negative", down))), do("multiply", low, do("exp", up))
        else:
            new = do("subtract", high, down), do("add", low, up)
        return low if not isinstance(down, Ref) else new[0], high if not isinstance(up, Ref) else new[1]
