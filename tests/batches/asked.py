"""Batches that are asked with numbers of their own."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from synth.batches.batch import BatchJob, BatchResult
from synth.batches.settings import BatchSettings
from synth.question.settings import SearchSettings


def batch(
    numbers: BatchSettings,
    p: Any,
    table: Any,
    output: Path | None = None,
    *,
    objectives: Any,
    points: int,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Callable[[Mapping[str, Any]], None] | None = None,
) -> BatchResult:
    """Do what ``synth.batch`` does, with these numbers."""
    common = {"parts": None, "limits": None, "fix": None, "objectives": objectives, "grid": True}
    folder = output or Path(tempfile.mkdtemp(prefix="clutchsynth-"))
    settings = SearchSettings(points=points, workers=workers)
    job = BatchJob(p, table, folder, None, None, None, settings, common, numbers)
    return job.result(workers, scheduler, progress)
