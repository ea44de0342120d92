"""Batches of boxes as the kernel reads and writes them: records with addresses of arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.branching import ScoreTables
from synth.bounds.root_propagation import Root
from synth.bounds.settings import KernelSizes

# Rows of scores are as long as a multiple of it, so that registers hold whole ones.
SCORE_WIDTH = 16

# The record of a batch, in C and here: numbers, arrays that are read, and arrays that are written.
NUMBERS = {
    "count": "long long",
    "passes": "long long",
    "factors": "long long",
    "goals": "long long",
    "cutoffs_step": "long long",
    "weights_step": "long long",
    "bits": "long long",
    "score_width": "long long",
    "snap": "double",
    "pinned": "double",
}
INPUT_ARRAYS = {
    "cell": "int",
    "low": "double",
    "high": "double",
    "bounds": "double",
    "tag": "int",
    "scores": "float",
    "cutoffs": "double",
    "floors": "double",
    "constants": "double",
    "right_sides": "double",
    "root_low": "double",
    "root_high": "double",
    "lower": "double",
    "upper": "double",
    "spans": "double",
    "weights": "double",
    "steep": "double",
    "rows": "double *const",
    "spreads": "float *const",
    "grids": "double *const",
    "grid_sizes": "long long",
    "per_unit": "double",
    "shape": "void",
}
OUTPUT_ARRAYS = {
    "out_cell": "int",
    "out_low": "double",
    "out_high": "double",
    "out_bounds": "double",
    "out_tag": "int",
    "out_scores": "float",
    "alive": "unsigned char",
    "undecided": "unsigned char",
}
CTYPES: dict[str, type[ctypes.c_longlong | ctypes.c_double]] = {
    "long long": ctypes.c_longlong,
    "double": ctypes.c_double,
}


class BatchStructure(ctypes.Structure):
    """The structure ``Batch`` of the C source."""

    _fields_ = (
        *((name, CTYPES[kind]) for name, kind in NUMBERS.items()),
        *((name, ctypes.c_void_p) for name in (*INPUT_ARRAYS, *OUTPUT_ARRAYS)),
    )


@dataclass(frozen=True)
class KernelQuestion:
    """What the contraction of boxes reads of one question.

    Parameters
    ----------
    tables : list of (factor, low, high)
        Ends of every tabulated node per cluster.
    constants, right_sides : array
        Values of constant nodes, and constant right sides.
    root : Root
        What holds over the whole question.
    lower, upper : array (variables,)
    spans : array (variables,)
        Unit of the width of each variable; 0 where widths are logarithms of ratios.
    scoring : ScoreTables
    grids : list of arrays
        Makeable values per variable; empty where it is continuous.
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    sizes : KernelSizes
    floors : array (clusters, objectives), optional
        The least that objectives may be, with their sign, by the cluster of the first factor.
    """

    tables: Sequence[tuple[int, np.ndarray, np.ndarray]]
    constants: np.ndarray
    right_sides: np.ndarray
    root: Root
    lower: np.ndarray
    upper: np.ndarray
    spans: np.ndarray
    scoring: ScoreTables
    grids: Sequence[np.ndarray]
    margins: tuple[float, float]
    sizes: KernelSizes
    floors: np.ndarray | None = None


class Prepared:
    """The arrays of one question as the kernel reads them."""

    def __init__(self, question: KernelQuestion) -> None:
        steep, of_clusters = question.scoring.steep, question.scoring.spreads
        self.sizes, factors = question.sizes, len(of_clusters)
        width = -(-steep.shape[0] // SCORE_WIDTH) * SCORE_WIDTH
        self.kept: dict[str, Any] = {
            name: np.ascontiguousarray(getattr(question, name), dtype=float)
            for name in ("constants", "right_sides", "lower", "upper", "spans")
        }
        if question.floors is not None:
            self.kept["floors"] = np.ascontiguousarray(question.floors, dtype=float)
        self.kept["steep"] = np.ascontiguousarray(steep, dtype=float)
        for name, end in (("root_low", question.root.low), ("root_high", question.root.high)):
            self.kept[name] = np.where(question.root.narrowed, end, np.nan)
        per_factor: list[list[np.ndarray]] = [[] for _ in range(factors)]
        for f, low, high in question.tables:
            per_factor[f] += [low, high]
        rows = [np.stack(columns, axis=1) if columns else np.zeros((1, 1)) for columns in per_factor]
        spreads = [np.zeros((len(s), width), dtype=np.float32) for s in of_clusters]
        for padded, spread in zip(spreads, of_clusters, strict=True):
            padded[:, : spread.shape[1]] = spread
        grids = [np.ascontiguousarray(g, dtype=float) for g in question.grids]
        self.kept["grid_sizes"] = np.array([len(g) for g in grids] or [0], dtype=np.int64)
        self.kept["per_unit"] = np.array([_per_unit(g) for g in grids] or [0.0])
        self._lists = {"rows": rows, "spreads": spreads, "grids": grids}
        for name, arrays in self._lists.items():
            self.kept[name] = np.array([a.ctypes.data for a in arrays] or [0], dtype=np.uintp)
        self.numbers = {
            "factors": factors,
            "score_width": width,
            "snap": question.margins[0],
            "pinned": question.margins[1],
        }

    def parts(self, boxes: int, workers: int) -> list[int]:
        """Ends of parts of so many boxes that threads share, from 0 on."""
        parts = max(1, boxes // self.sizes.part) if workers > 1 else 1
        return [boxes * k // parts for k in range(parts + 1)]


def _per_unit(grid: np.ndarray) -> float:
    """Number of values of a grid per unit, on average."""
    return (len(grid) - 1) / (grid[-1] - grid[0]) if len(grid) > 1 else 0.0


class Batches:
    """Some boxes as the kernel reads them, from any first to any last one.

    Parameters
    ----------
    prepared : Prepared
    boxes : Boxes
    weights : array (sets, limits + objectives)
        One row per set of objectives with a cutoff, a power of 2; or one row alone.
    passes : int
        Forward-backward sweeps.
    moving : mapping, optional
        Further arrays with a row per box, so that a batch begins so many rows further on.
    still : mapping, optional
        Further arrays that serve all boxes.
    numbers : int
        Further numbers of the record.
    """

    def __init__(
        self,
        prepared: Prepared,
        boxes: Boxes,
        weights: np.ndarray,
        passes: int,
        moving: Mapping[str, np.ndarray] | None = None,
        still: Mapping[str, np.ndarray] | None = None,
        **numbers: int,
    ) -> None:
        per_box = {
            "cell": np.ascontiguousarray(boxes.cell, dtype=np.int32),
            "low": np.ascontiguousarray(boxes.low, dtype=float),
            "high": np.ascontiguousarray(boxes.high, dtype=float),
            "bounds": np.ascontiguousarray(boxes.bounds, dtype=float),
            "tag": np.ascontiguousarray(boxes.tag, dtype=np.int32),
        }
        # The record holds addresses alone: the arrays live as long as this.
        self._moving = per_box | dict(moving or {})
        self._fixed = prepared.kept | {"weights": np.ascontiguousarray(weights, dtype=float)} | dict(still or {})
        self._places = {name: a.ctypes.data for name, a in self._fixed.items()}
        self._steps = {name: (a.ctypes.data, a.strides[0]) for name, a in self._moving.items()}
        self._numbers = {
            **prepared.numbers,
            "weights_step": weights.shape[1],
            "bits": len(weights).bit_length() - 1,
            "goals": boxes.bounds.shape[1],
            "passes": passes,
            **numbers,
        }

    def part(self, first: int, last: int) -> BatchStructure:
        """Return the boxes from a first to a last one; it knows addresses only, of arrays that live as long as this."""
        places = {name: place + first * step for name, (place, step) in self._steps.items()}
        return BatchStructure(count=last - first, **self._numbers, **self._places, **places)


def output_arrays(boxes: Boxes, count: int) -> dict[str, np.ndarray]:
    """Empty output arrays for ``count`` boxes of the shape of ``boxes``, by name in the record; without scores."""
    return {
        "out_cell": np.empty((count, boxes.cell.shape[1]), dtype=np.int32),
        "out_low": np.empty((count, boxes.low.shape[1])),
        "out_high": np.empty((count, boxes.high.shape[1])),
        "out_bounds": np.empty((count, boxes.bounds.shape[1])),
        "out_tag": np.empty(count, dtype=np.int32),
    }


def scored_output_arrays(boxes: Boxes, count: int) -> dict[str, np.ndarray]:
    """Empty output arrays of :func:`output_arrays` and of the scores."""
    columns = boxes.low.shape[1] + boxes.cell.shape[1]
    return output_arrays(boxes, count) | {"out_scores": np.empty((count, columns), dtype=np.float32)}


def filled(arrays: Mapping[str, np.ndarray]) -> Boxes:
    """Scored boxes from the arrays that a kernel has filled."""
    return Boxes(*(arrays[f"out_{name}"] for name in ("cell", "low", "high", "bounds", "scores", "tag")))
