"""Batches that stand in a folder: their database, and which of its jobs is meant."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sqlalchemy import URL

from synth.batches.store import Store
from synth.errors import InputError
from synth.folders.files import read_json
from synth.queue.database import file_url
from synth.queue.models import Job

DATABASE = "jobs.sqlite"  # beside the results, unless another one is named
SUMMARY = "batch.json"


def opened_batch(source: str | Path, database: str | URL | None = None) -> Store:
    """Return the database of a batch: the one that is named, or that in its folder.

    Raises
    ------
    InputError
        There is none.
    """
    if database is not None:
        return Store(database, create=False)
    folder = Path(source)
    candidates = [folder / DATABASE]
    if (folder / SUMMARY).is_file():  # what was stopped stands in a folder below that of its database
        candidates.append(folder.parent / DATABASE)
    file = next((path for path in candidates if path.is_file()), None)
    if file is None:
        raise InputError("DIR", str(source), f"the folder of a batch, with {DATABASE} in it (or its database)")
    return Store(file_url(file.resolve()), create=False)


def job_of_folder(store: Store, source: str | Path, job: str | None = None) -> Job:
    """Return the job that is meant: by its id, or the latest that was written to the folder.

    Raises
    ------
    InputError
        There is none.
    """
    jobs = store.jobs()
    if job is not None:
        fitting = [candidate for candidate in jobs if candidate.id == job]
    else:
        folder = str(Path(source).resolve())
        fitting = [candidate for candidate in jobs if candidate.folder == folder] or (jobs if len(jobs) == 1 else [])
    if not fitting:
        raise InputError("DIR", str(source), "the folder that a batch was written to")
    return max(fitting, key=lambda candidate: candidate.updated)


def job_written(folder: Path) -> str | None:
    """Return the job whose results stand in a folder; None where none do."""
    if not (folder / SUMMARY).is_file():
        return None
    right = "a batch.json as clutchsynth has written it"
    summary = read_json(folder / SUMMARY, "batch", right)
    job = summary.get("job") if isinstance(summary, Mapping) else None
    if not isinstance(job, str):
        raise InputError("batch", str(folder / SUMMARY), right)
    return job
