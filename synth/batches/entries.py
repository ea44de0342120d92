"""Types of what the database of a batch holds as JSON, and of how far a batch is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

if TYPE_CHECKING:
    import pandas as pd

# Rows of a batch: a file, a frame, or a mapping for each row.
RowSource: TypeAlias = "str | Path | pd.DataFrame | Sequence[Mapping[str, object]]"

# A checked question of a row: keys of a spec, and "like" or "group", which name the questions that help it.
RowQuestion: TypeAlias = Mapping[str, Any]

# What a row is answered: "status", "seconds", "layout" and "content" of its designs, or why there is no answer.
RowAnswer: TypeAlias = Mapping[str, Any]

# Columns of designs: their headings by group, and "family" and "senses" of the objectives.
Layout: TypeAlias = Mapping[str, Any]


class BatchState(TypedDict, total=False):
    """How far the rows of a table are: checked, grouped or written (``stage``), or answered."""

    stage: str
    rows: int
    done: int
    failed: int
    infeasible: int
    bad: int
    rate: float  # rows a second
    found: int  # rows of a group under way that have designs by now
    left: float | None  # s


BatchProgress: TypeAlias = Callable[[BatchState], None]
