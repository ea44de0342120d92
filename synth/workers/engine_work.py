"""What engine processes do, imported there only: everything costly comes with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.batches.solve import solve_unit
from synth.errors import InputError
from synth.kinds import kind
from synth.kinds.asked import catalogs_of, digests, question_record, told
from synth.model.registry import every_family
from synth.queue.records import Sources
from synth.results.provenance import computing_digest, hash_of, problem_digest
from synth.workers.engine_tasks import ReportProgress


def warm_up() -> str:
    """Import what every question needs; return the fingerprint of the programs of this process."""
    import synth.search.question
    import synth.search.synthesize  # noqa: F401  (it brings the solvers)

    return program_fingerprint()


def program_fingerprint() -> str:
    """One hash of everything that decides the digits of an answer: code, with kernels or without, processor, families.

    Units of one job are only worked at by programs that have the same.
    """
    registered = [type(problem) for problem in every_family().values()]
    return hash_of([computing_digest(), problem_digest(registered)])


def rows(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, dict[str, Any]]:
    """Answer some rows of a batch: as :func:`synth.batches.solve.solve_unit`."""
    request = payload["request"]  # none, of a batch that the command line has made: its tables are files
    catalogs = catalogs_of(request.get("catalogs"), _sources(payload)) if request else payload["catalogs"]
    return solve_unit({**payload, "catalogs": catalogs, "code": computing_digest(), "tell": report})


def work(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Do what a job of one unit asks for: its records, and the facts of them."""
    module, request, sources = kind(payload["kind"]).load(), payload["request"], _sources(payload)
    asked = question_record(payload["kind"], request, sources)
    records = {**module.work(request, sources, told(report)), asked.name: asked}
    facts = module.summary({name: record.content for name, record in records.items()})
    return {"records": list(records.values()), "summary": facts}


def read(payload: Mapping[str, Any], report: ReportProgress) -> dict[str, Any]:
    """Check a request; return it as it is stored, with its metadata.

    Raises
    ------
    InputError
        With everything that is wrong, as far as one fault does not hide another.
    """
    chosen, sources = kind(payload["kind"]), _sources(payload)
    module, request = chosen.load(), payload["request"]
    try:
        checked = module.read(request, sources)
    except InputError as fault:
        if not chosen.checked or not isinstance(request, Mapping):
            raise
        from synth.kinds.small import all_faults

        spec, more = module.beside(request, sources) if chosen.keys else (request, [])
        raise all_faults(spec, sources, fault, chosen.keys, more) from fault
    tables = digests(checked.request.get("catalogs"), sources)
    return {
        "request": dict(checked.request),
        "title": checked.title,
        "families": list(checked.families),
        "bulk": checked.bulk,
        "tables": tables,
        "text": checked.text,
        "code": program_fingerprint(),
        "fingerprint": checked.fingerprint or hash_of([payload["kind"], checked.text, tables]),
        "kept": list(checked.kept),
        "steps": checked.steps,
        "rows": checked.rows,
    }


def _sources(payload: Mapping[str, Any]) -> Sources:
    sources: Sources = payload["sources"]
    return sources
