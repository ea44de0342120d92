"""What a service asks engine processes while somebody waits: small questions, and files of jobs that have ended."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.kernels.loading import native_code
from synth.kinds import batch, small
from synth.kinds.asked import catalogs_of
from synth.kinds.files import UnknownFileError, files_to_have
from synth.kinds.files import render as rendered
from synth.model.registry import families as registered
from synth.model.registry import load
from synth.queue.job_table import BATCH
from synth.queue.records import Record
from synth.results.provenance import code_digest, problem_digest
from synth.workers.engine_tasks import ReportProgress
from synth.workers.engine_work import program_fingerprint


def families(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Return all families, and the digest of the code that says so."""
    return {"families": small.families(), "code": code_digest()}


def declaration(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Declaration of a family, and the digest of its code; None for an unknown family."""
    if payload["family"] not in registered():
        return {"declaration": None, "code": code_digest()}
    return {"declaration": small.declaration(payload["family"], payload["options"]), "code": code_digest()}


def examples(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Return the examples of all families, and the digest of the code that they come with."""
    return {"examples": small.examples(), "code": code_digest()}


def check(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Faults of a question."""
    return small.check(payload["request"], payload["sources"])


def evaluate(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Evaluation of one design."""
    return small.evaluate(payload["request"], payload["sources"])


def changed(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Hashes that decide answers and have changed since a batch was begun, and the fingerprint of programs now.

    Raises
    ------
    InputError
        A table that the batch was made with is not there any more.
    """
    content = payload["content"]
    kept = content.get("hashes") or {}
    differing: list[str] = []
    if kept:
        now = {
            "code": code_digest(),
            "native code": native_code(),
            "families": problem_digest([type(load(name)) for name in content["families"]]),
            "tables": catalogs_of(content.get("catalogs"), payload["sources"]).digest(),
        }
        differing = [name for name, text in now.items() if kept.get(name) != text]
    return {"changed": differing, "code": program_fingerprint()}


def files(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, int | None]:
    """Return the names of the files of a job that can be had here, with their sizes where these are known."""
    if payload["kind"] == BATCH:
        return dict.fromkeys(batch.files_to_have())
    return files_to_have(payload["kind"], payload["records"])


def render(payload: Mapping[str, Any], report: ReportProgress) -> Record | None:
    """Return a file of a job; None where it has none of that name.

    Raises
    ------
    ExtraNeededError
        It needs an extra that is not installed.
    InputError
        An option is wrong.
    """
    try:
        if payload["kind"] == BATCH:
            return batch.files(payload, report)
        return rendered(payload["kind"], payload["records"], payload["name"], payload["options"], payload["sources"])
    except UnknownFileError:
        return None
