"""Dominance, and the ranking of a front."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

NEAR = 0.005  # how much worse than the best in an objective is as good, when it is told what the others cost at most
DEAR = 0.1  # of a scale: an end that costs more than so much beyond it, for no more than that share, is told to
LEAST_RATIO = 1e-9  # of the smaller end of a scale to the larger: below it the smaller one is as good as zero
FACTOR = math.log(2.0)  # what the nadir is from the ideal, where there are no ratios: one factor of two
SAME = 12  # digits of scores
DIGITS = 9  # of phi, to which designs are the same: solvers differ beyond them


def non_dominated(phi: np.ndarray) -> np.ndarray:
    """Return the mask of the non-dominated rows; of rows equal to nine digits the first is kept."""
    if not len(phi):
        return np.zeros(0, dtype=bool)
    # Compared as they stand, two designs that differ in the last digits of the solver would both be kept.
    with np.errstate(over="ignore"):  # the largest numbers there are become infinite
        rounded = np.round(phi, DIGITS)
    if rounded.shape[1] > 2:
        import moocore  # costly to import; few questions need it

        return np.asarray(moocore.is_nondominated(rounded, keep_weakly=False), dtype=bool)
    # In order of the first objective, a row is beaten unless it is better in the last one than all before it.
    order = np.lexsort(rounded.T[::-1])
    last = rounded[order, -1]
    better = np.ones(len(order), dtype=bool)
    better[1:] = last[1:] < np.minimum.accumulate(last)[:-1]
    keep = np.zeros(len(order), dtype=bool)
    keep[order[better]] = True
    return keep


def extremes(phi: np.ndarray) -> list[int]:
    """Return the positions of the rows that are least in a column."""
    return list(dict.fromkeys(int(np.argmin(phi[:, k])) for k in range(phi.shape[1]))) if len(phi) else []


def spread_subset(phi: np.ndarray, count: int, first: Sequence[int] | None = None) -> np.ndarray:
    """Positions of at most ``count`` rows: the ``first``, then always the one farthest from those chosen.

    The extremes are the first ones by default.
    """
    if len(phi) <= count:
        return np.arange(len(phi))
    span = np.maximum(phi.max(axis=0) - phi.min(axis=0), 1e-300)
    unit = (phi - phi.min(axis=0)) / span
    chosen = list(dict.fromkeys(extremes(unit) if first is None else first))[:count]
    # Column by column: rows are many and short.
    columns = np.ascontiguousarray(unit.T)
    distance = np.full(len(unit), np.inf)
    for row in chosen:
        np.minimum(distance, _distances(columns, row), out=distance)
    while len(chosen) < count:
        farthest = int(np.argmax(distance))
        chosen.append(farthest)
        np.minimum(distance, _distances(columns, farthest), out=distance)
    return np.sort(np.array(chosen))


def _distances(columns: np.ndarray, row: int) -> np.ndarray:
    """Return the distances of all rows of a table, which is given by columns, from one of them."""
    square = np.zeros(columns.shape[1])
    for column in columns:
        apart = column - column[row]
        square += apart * apart
    return np.asarray(np.sqrt(square, out=square))


@dataclass(frozen=True)
class Scale:
    """What objectives are measured by where designs are ranked: logarithms of ratios to the ideal.

    The ideal is what is best in each objective. The nadir of an objective is the most that it must cost for another
    one to be as good as it can be but for ``NEAR``, and at least what is as good as the ideal: an end of the front
    that costs much for next to nothing does not stretch the scale. Only where there are no ratios it counts.

    Parameters
    ----------
    ideal, nadir : array (objectives,)
        In SI, with their sign: smaller is better.
    """

    ideal: np.ndarray
    nadir: np.ndarray

    @staticmethod
    def of(signed: np.ndarray) -> Scale:
        """Return the scale of designs that are all there is to know of a front.

        Parameters
        ----------
        signed : array (designs, objectives)
        """
        near = as_good(signed)
        return Scale(signed.min(axis=0), np.maximum(near, _worst_at_ends(signed, near)))

    def begun_at(self, signed: np.ndarray) -> Scale:
        """Scale of listed designs: from the best among them, at most to their own nadir."""
        listed = Scale.of(signed)
        return Scale(listed.ideal, np.clip(self.nadir, listed.ideal, listed.nadir))

    def as_record(self, objectives: Mapping[str, str]) -> dict[str, list[float]]:
        """Ideal and nadir of each objective in SI, the record that ``read`` reads."""
        ends = np.stack([self.ideal, self.nadir], axis=1) * senses_of(objectives)[:, None]
        return dict(zip(objectives, ends.tolist(), strict=True))

    @staticmethod
    def read(record: Mapping[str, Sequence[float]], objectives: Mapping[str, str]) -> Scale:
        """Scale of a record of ``as_record``; a ValueError where an end is no number."""
        ends = np.array([record[name] for name in objectives], dtype=float) * senses_of(objectives)[:, None]
        if not np.isfinite(ends).all():
            raise ValueError("scale: an end is no number")
        return Scale(ends[:, 0], ends[:, 1])

    @property
    def span(self) -> np.ndarray:
        """How far the ideal and the nadir are apart, per objective; 1 where they are the same."""
        return np.where(self.nadir > self.ideal, self.nadir - self.ideal, 1.0)

    def units(self, signed: np.ndarray) -> np.ndarray:
        """Positions of designs (designs, objectives) on the scale; an objective without a span does not count."""
        return np.where(self.nadir > self.ideal, np.maximum(signed - self.ideal, 0.0) / self.span, 0.0)

    @property
    def has_ratios(self) -> np.ndarray:
        """Mask of the objectives whose ends have the same sign, and neither is next to nothing beside the other."""
        ends = np.abs([self.ideal, self.nadir])
        near = ends.min(axis=0) >= LEAST_RATIO * ends.max(axis=0)
        return np.asarray(near & (np.sign(self.ideal) * np.sign(self.nadir) > 0))

    def distances(self, signed: np.ndarray) -> np.ndarray:
        """Distances of designs (designs, objectives) from the ideal, per objective."""
        ratios = np.maximum(signed / np.where(self.has_ratios, self.ideal, np.inf), LEAST_RATIO)
        logarithms = np.maximum(np.sign(self.ideal) * np.log(ratios), 0.0)
        return np.where(self.has_ratios, logarithms, FACTOR * self.units(signed))

    def at(self, distances: np.ndarray) -> np.ndarray:
        """Signed values of designs (designs, objectives) that are so far from the ideal."""
        ratios = np.exp(np.sign(self.ideal) * distances)
        values = np.where(self.has_ratios, self.ideal * ratios, self.ideal + self.span * distances / FACTOR)
        return np.asarray(values)

    def scores(self, signed: np.ndarray, weights: Sequence[float] | np.ndarray) -> np.ndarray:
        """Weighted distances of designs from the ideal over all objectives."""
        share = np.asarray(weights, dtype=float) / np.sum(weights)
        return np.asarray(np.sqrt(np.sum(share * self.distances(signed) ** 2, axis=1)))


def as_good(signed: np.ndarray) -> np.ndarray:
    """Return, per objective, up to where a design is as good as the best one.

    Parameters
    ----------
    signed : array (designs, objectives)
        Of a front, or its ends alone.
    """
    best = signed.min(axis=0)
    return nearly(best, _worst_at_ends(signed, best))


def _worst_at_ends(signed: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the most that each objective must be, for another one to be as good as its end."""
    columns = range(signed.shape[1])
    return np.asarray(np.max([signed[signed[:, k] <= ends[k]].min(axis=0) for k in columns], axis=0))


def nearly(best: np.ndarray, worst: np.ndarray) -> np.ndarray:
    """Return up to where a design is as good as the best: by a share of the best that is positive, else of the range.

    Parameters
    ----------
    best : array (objectives,)
    worst : array (objectives,)
        What each objective is where another one is best.
    """
    near: np.ndarray = best + NEAR * np.where(best > 0, best, worst - best)
    return near


@dataclass(frozen=True)
class Ranking:
    """Order of the designs of a front (positions, best first), scores and notes, and what they are measured by."""

    order: list[int]
    scores: np.ndarray
    notes: list[str]
    scale: Scale


@dataclass(frozen=True, kw_only=True)
class ListSettings:
    """How the designs of a front are listed.

    Parameters
    ----------
    merge_within : float
        Designs of the same parts, counts and choices that differ by no more in any objective are one line: less than
        what masses and lengths of drawings differ by.
    """

    merge_within: float = 0.02


LISTED = ListSettings()


def merged(
    values: np.ndarray, kinds: Sequence[object], scores: Sequence[float] | np.ndarray, within: float
) -> list[list[int]]:
    """Positions of designs in groups, those that come first leading: each joins the first leader that it is near to.

    Parameters
    ----------
    values : array (designs, objectives)
        Of objectives with another sign, or zero, only equal ones are near.
    kinds : list
        Only designs of one kind are near: of the same parts, counts and choices.
    scores : list of float
        The smallest comes first.
    within : float
        Near is within this share, in every objective.

    Examples
    --------
    >>> values = np.array([[10, 100], [10.1, 100.5], [10.3, 99], [9.9, 101.9], [12, 80]])
    >>> scores = Scale.of(values).scores(values, [1, 1])
    >>> [[1 + k for k in group] for group in merged(values, ["a", "a", "a", "b", "a"], scores, 0.02)]
    [[5], [3, 2], [1], [4]]
    """
    logarithms, polarity = np.log(np.where(values == 0, 1.0, np.abs(values))), np.sign(values)
    groups: list[list[int]] = []
    for k in np.argsort(scores, kind="stable").tolist():
        for group in groups:
            near = np.abs(logarithms[k] - logarithms[group[0]]) <= math.log1p(within)
            if kinds[k] == kinds[group[0]] and np.all(near & (polarity[k] == polarity[group[0]])):
                group.append(k)
                break
        else:
            groups.append([k])
    return groups


KNEE = "knee"
AT_A_PRICE = ", whose last 0.5 % costs much"


def senses_of(objectives: Mapping[str, str]) -> np.ndarray:
    """Sense of each objective: 1 to minimise, -1 to maximise."""
    return np.array([1.0 if sense == "min" else -1.0 for sense in objectives.values()])


def rank(
    objectives: Mapping[str, str],
    values: np.ndarray,
    weights: Sequence[float],
    complete: bool = False,
    scale: Scale | None = None,
) -> Ranking:
    """Rank designs by their weighted distance to the ideal point.

    Parameters
    ----------
    objectives : mapping
        Names and senses.
    values : array (designs, objectives)
        SI.
    weights : list of float
        One per objective.
    complete : bool
        Whether there are no other non-dominated designs.
    scale : Scale, optional
        Of the whole front; by default that of the designs.

    Returns
    -------
    Ranking
    """
    signed = values * senses_of(objectives)
    scale = Scale.of(signed) if scale is None else scale.begun_at(signed)
    unit, scores = scale.units(signed), np.round(scale.scores(signed, weights), SAME)
    keys = [*(np.round(signed[:, k], 15) for k in reversed(range(signed.shape[1]))), scores]
    order = [int(k) for k in np.lexsort(keys)]
    notes: list[list[str]] = [[] for _ in order]
    if len(order) > 1:
        for k, (name, sense) in enumerate(objectives.items()):
            word = "smallest" if sense == "min" else "largest"
            end = int(np.argmin(signed[:, k]))
            dear = bool(np.any(np.delete(unit[end], k) > 1.0 + DEAR))
            notes[end].append(f"{word} {name}" + (AT_A_PRICE if dear else ""))
        if len(order) > 2 and signed.shape[1] > 1:
            notes[int(np.argmin(unit.sum(axis=1)))].append(KNEE)
    elif signed.shape[1] == 1:
        notes[0].append("optimum")
    elif complete:
        notes[0].append("only non-dominated design")
    return Ranking(order, scores, ["; ".join(n) for n in notes], scale)


def knee_of(notes: Sequence[str]) -> int:
    """Place of the knee among ranked designs by their notes; the first, which comes nearest to the best, if none is.

    Examples
    --------
    >>> knee_of(["smallest mass", "knee; largest life"]), knee_of(["optimum"])
    (1, 0)
    """
    return next((place for place, note in enumerate(notes) if KNEE in note), 0)
