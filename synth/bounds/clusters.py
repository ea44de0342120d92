"""Clusters of catalogue rows: what a node of the search tree knows of a slot before a row is chosen.

Every slot, count and choice is a factor: a small table of numbers with one row per alternative. Its rows
are halved again and again along the column that matters most (a k-d tree over logarithms); a leaf holds
the rows that are equal in all columns used. A cluster is known by the hull of its rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.question.combinations import MixedRadix

APART = 1e3  # on a scale of logarithms or shares of a range: farther than any two numbers are


@dataclass(frozen=True)
class Factor:
    """A slot, count or choice with its rows.

    Parameters
    ----------
    name : str
        Empty for questions that are answered together.
    inputs : list of int
        Which data inputs of the model the columns are.
    columns : array (rows, columns)
        SI values; not-a-number where a row has none. First those of the inputs, then cutoffs of objectives.
    capped : list of int
        Numbers of the objectives that rows have a cutoff of.
    """

    name: str
    inputs: tuple[int, ...]
    columns: np.ndarray
    capped: tuple[int, ...] = ()


class ClusterTree:
    """The clusters of one factor; number 0 holds all rows.

    ``left`` and ``right`` are the halves (-1: a leaf), ``first`` a row of each cluster, ``size`` how many rows it has,
    ``leaf_of_row`` the leaf that holds a row.

    Parameters
    ----------
    factor : Factor
    weights : array (columns,)
        How much each column matters; 0 leaves a column out of the choice where to split, not out of the leaves.
    """

    def __init__(self, factor: Factor, weights: np.ndarray) -> None:
        self.factor = factor
        place = _places(factor.columns)
        counted = np.where(np.isfinite(weights), np.maximum(weights, 0.0), 0.0)
        self.order = np.arange(len(place))
        left, right, start, stop = [-1], [-1], [0], [len(place)]
        waiting = [0]
        while waiting:
            k = waiting.pop()
            rows = self.order[start[k] : stop[k]]
            mask = _halved(place[rows], counted)
            if mask is None:
                continue
            self.order[start[k] : stop[k]] = np.concatenate([rows[mask], rows[~mask]])
            middle = start[k] + int(mask.sum())
            left[k], right[k] = len(left), len(left) + 1
            waiting += [len(left), len(left) + 1]
            left += [-1, -1]
            right += [-1, -1]
            start += [start[k], middle]
            stop += [middle, stop[k]]
        self.left, self.right = np.array(left, dtype=np.int32), np.array(right, dtype=np.int32)
        self.start, self.stop = np.array(start), np.array(stop)
        self.size = self.stop - self.start
        self.first = self.order[self.start]
        self.leaf = self.left < 0
        self.leaf_of_row = np.empty(len(place), dtype=np.int32)
        for leaf in np.flatnonzero(self.leaf):
            self.leaf_of_row[self.rows(int(leaf))] = leaf

    def __len__(self) -> int:
        return len(self.left)

    def rows(self, cluster: int) -> np.ndarray:
        """Return the rows of a cluster."""
        members: np.ndarray = self.order[self.start[cluster] : self.stop[cluster]]
        return members

    def hull(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return least and largest per cluster (clusters, n) of what is known per row (rows, n); NaN spreads."""
        ordered = values[self.order]
        low, high = np.empty((len(self), values.shape[1])), np.empty((len(self), values.shape[1]))
        # The rows of a leaf are equal in what is used; halves come after the cluster they are made of.
        low[self.leaf] = high[self.leaf] = ordered[self.start[self.leaf]]
        for k in np.flatnonzero(~self.leaf)[::-1].tolist():
            a, b = self.left[k], self.right[k]
            np.minimum(low[a], low[b], out=low[k])
            np.maximum(high[a], high[b], out=high[k])
        return low, high


def _places(columns: np.ndarray) -> np.ndarray:
    """Return columns on a scale on which distances compare: logarithms where positive, else shares of the range."""
    result = np.empty(columns.shape)
    for k, column in enumerate(columns.T):
        known = column[np.isfinite(column)]
        span = np.ptp(known) if len(known) else 0.0
        if len(known) and known.min() > 0:
            result[:, k] = np.log(column)
        else:
            result[:, k] = column / span if span > 0 else np.where(np.isfinite(column), 0.0, column)
        # What has no end, as a cutoff that is missing, is apart from the rest, and equal among itself.
        ends = result[np.isfinite(column), k] if len(known) else np.zeros(1)
        result[column == np.inf, k], result[column == -np.inf, k] = ends.max() + APART, ends.min() - APART
    return result


def _halved(place: np.ndarray, weights: np.ndarray) -> np.ndarray | None:
    """Rows of the first half, or None where all are equal."""
    if len(place) < 2 or not place.shape[1]:
        return None
    plain = place.max(axis=0) - place.min(axis=0)
    unknown = np.isnan(plain)
    if unknown.any():
        lacking = np.isnan(place)
        mixed = np.any(lacking, axis=0) & ~np.all(lacking, axis=0)
        if mixed.any():
            # A limit without a value is void: rows that have one are kept apart, or nothing would be known of any.
            return np.asarray(~lacking[:, int(np.argmax(mixed))])
        plain = np.where(unknown, 0.0, plain)
    column = int(np.argmax(plain * weights))
    if plain[column] * weights[column] <= 0.0:
        column = int(np.argmax(plain))
    if plain[column] == 0.0:
        return None
    values = place[:, column]
    middle = 0.5 * (values.min() + values.max())
    mask = np.asarray(values <= middle)
    return mask if 0 < mask.sum() < len(mask) else np.asarray(values < values.max())


class Cells:
    """All clusters of all factors of a question, and the numbers of combinations they stand for.

    Parameters
    ----------
    trees : list of ClusterTree
        In the order of the digits of a combination.
    radix : list of int
        Rows per factor.
    """

    def __init__(self, trees: Sequence[ClusterTree], radix: Sequence[int]) -> None:
        self.trees = list(trees)
        self.numbers = MixedRadix(radix)

    def all_combinations(self) -> np.ndarray:
        """Cell of all combinations (1, factors)."""
        return np.zeros((1, len(self.trees)), dtype=np.int32)

    def size(self, cells: np.ndarray) -> np.ndarray:
        """Number of combinations in each cell, as floats: products may pass 2**63."""
        result = np.ones(len(cells))
        for f, tree in enumerate(self.trees):
            result = result * tree.size[cells[:, f]]
        return result

    def single(self, cells: np.ndarray) -> np.ndarray:
        """Tell which cells cannot be split any more."""
        result = np.ones(len(cells), dtype=bool)
        for f, tree in enumerate(self.trees):
            result &= tree.leaf[cells[:, f]]
        return result

    def combination(self, cells: np.ndarray) -> np.ndarray:
        """Return a combination of each cell."""
        return self.numbers.composed([tree.first[cells[:, f]] for f, tree in enumerate(self.trees)], len(cells))

    def random_leaves(self, cells: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Return cells of one random combination each; single cells stay what they are."""
        result = cells.copy()
        for f, tree in enumerate(self.trees):
            start, size = tree.start[cells[:, f]], tree.size[cells[:, f]]
            rows = tree.order[start + (rng.random(len(cells)) * size).astype(np.int64)]
            result[:, f] = tree.leaf_of_row[rows]
        return result

    def members(self, cell: np.ndarray, most: int) -> np.ndarray:
        """Return the combinations of one cell, at most so many."""
        result = np.zeros(1, dtype=np.int64)
        for f, tree in enumerate(self.trees):
            rows = np.sort(tree.rows(int(cell[f])))
            result = self.numbers.extended(result[:, None], f, rows[None, :]).ravel()
            result = result[: most * 4]
        return result[:most]

    def all_members(self, cells: np.ndarray, most: int) -> np.ndarray:
        """Distinct combinations of cells, ``most`` at most."""
        combinations = np.empty(0, dtype=np.int64)
        for cell in np.unique(cells, axis=0):
            combinations = np.union1d(combinations, self.members(cell, most))[:most]
            if len(combinations) == most:
                break
        return combinations

    def leaf_of(self, digits: Sequence[int]) -> np.ndarray:
        """Return the cell (1, factors) of leaves that holds one combination given by its rows."""
        cell = np.zeros((1, len(self.trees)), dtype=np.int32)
        for f, tree in enumerate(self.trees):
            cell[0, f] = tree.leaf_of_row[digits[f]]
        return cell
