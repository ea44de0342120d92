"""What all kinds share: the keys of a request, tables and earlier jobs that it names, and how progress is told."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from synth.errors import Described, InputError, at, gathered, refuse_gathered
from synth.kinds.settings import KIND_SETTINGS
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.catalogs import as_catalogs, refuse_unused
from synth.question.request import Request
from synth.question.request_fields import FIELDS, REFERENCE, SEARCHED, shown_kind
from synth.question.settings import SearchSettings
from synth.question.spec_keys import no_family, refuse_several
from synth.question.spec_patch import patched
from synth.queue.records import QUESTION, TABLE, Record, ReportProgress, Sources
from synth.results import ParetoFront
from synth.results.front_record import FRONT_FILE, FRONT_FORMAT, changed
from synth.results.loading import COMPARISON, front_of_record
from synth.results.plain import plain
from synth.tables.catalogs import Catalogs
from synth.tables.table_text import TableText
from synth.text.numbers import RAISED, typed_number
from synth.units import typed_quantity
from synth.verbs.request import WHERE, WORKERS, VerbRequest, in_request, known_keys, one_thread
from synth.verbs.requests import OF, SPEC, FrontRequest

FAMILY = "family"
CATALOGS = "catalogs"
MAPPINGS = ("options", "requirements", "limits", "fix", "parts", "weights", "robust")  # keys with entries of their own
STATED = re.compile(
    r"(?<![A-Za-z0-9_.])[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)? [A-Za-z][A-Za-z0-9*/()]*"
)  # a number with a unit
POWER = re.compile(r"(?<=[A-Za-z])[2-4](?![0-9])")  # of a unit
TABLE_EXPECTED = (
    "a table of your own by name and version, 'my_linings@3', or ['+', 'my_linings@3'] to extend the shipped one"
)


Own = TypeVar("Own", bound=VerbRequest)


# ---- keys -----------------------------------------------------------------------------------------------------------


def about_front(request: object, verb: type[Own]) -> tuple[FrontRequest, Own]:
    """Front that a request is about, and what it asks of it.

    Raises
    ------
    InputError
        With everything that is not of its kind.
    """
    keys = (*FrontRequest.fields(), *verb.fields())
    given, faults = known_keys(request, keys), list[InputError]()
    with gathered(faults):
        own = verb.read(given, in_request)
    with gathered(faults):
        front = FrontRequest.read(given, in_request)
    refuse_gathered(faults)
    return front, own


def check_entry(key: str, value: object) -> None:
    """Refuse an entry of a spec that is not of its kind; other entries are for the kind of job to check.

    Which tables there are is known to ``catalogs_of`` alone.

    Raises
    ------
    InputError
    """
    if key == WORKERS:
        one_thread(value)
    elif key in FIELDS and key != CATALOGS:
        FIELDS[key].read(in_request(key), stated_entries(key, value))


def stated_entries(key: str, value: object) -> Any:
    """Value of an entry of a spec, without entries of its own that are None: those are not stated, or taken back."""
    if key not in MAPPINGS or not isinstance(value, Mapping):
        return value
    return {name: entry for name, entry in value.items() if entry is not None}


def spec_of(
    request: object, sources: Sources, more: Collection[str] = (), several: bool = False
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Spec of a request as it stands, and the entries under some more keys.

    Under ``of`` an earlier job may stand: then its spec is meant, with the entries of this request in place of its own.

    Parameters
    ----------
    request : mapping
    sources : Sources
    more : collection of str
        Keys beside those of a spec.
    several : bool
        Whether several families may be asked. Of another family all else would be another fault: it is told alone.

    Raises
    ------
    InputError
        A key is unknown, or there is no such job.
    """
    if not several and isinstance(request, Mapping) and request.get(FAMILY) is not None:
        check_entry(FAMILY, request[FAMILY])
        refuse_several(request[FAMILY], WHERE)
    given = known_keys(request, (*SPEC, *more, OF))
    own = {key: given.pop(key) for key in more if key in given}
    if OF not in given:
        return _without_none(given), own
    with at(OF):
        records = records_of(sources, given.pop(OF))
        before = _json_of(records, QUESTION).get("request") if QUESTION in records else None
        if not isinstance(before, Mapping) or FAMILY not in before:
            raise InputError(f"{WHERE}: {OF}", shown_job(records), "a job that asks a question of a family")
    return _without_none(patched({key: value for key, value in before.items() if key in SPEC}, given)), own


def _without_none(spec: Mapping[str, object]) -> dict[str, Any]:
    return {key: stated_entries(key, value) for key, value in spec.items()}


def problem_of(spec: Mapping[str, Any]) -> DesignProblem:
    """Family of a spec with its options.

    Raises
    ------
    InputError
        None is named, or several are, or there is none such.
    """
    if spec.get(FAMILY) is None:
        raise no_family(WHERE)
    refuse_several(spec[FAMILY], WHERE)
    return load(spec[FAMILY], **FIELDS["options"].value.read(WHERE, spec.get("options")))


# ---- tables ---------------------------------------------------------------------------------------------------------


def catalogs_of(stated: object, sources: Sources) -> Catalogs:
    """Return the tables that a request names: references to texts, never paths.

    Parameters
    ----------
    stated : mapping or None
        Table -> reference, or ``["+", reference, ...]``.
    sources : Sources

    Raises
    ------
    InputError
        Something else is stated, or there is no such table.
    """
    if stated is None or (isinstance(stated, Mapping) and not stated):
        return as_catalogs(None)
    with at("catalogs"):
        if not isinstance(stated, Mapping):
            raise InputError(f"{WHERE}: catalogs", shown_kind(stated), f"tables with, for each, {TABLE_EXPECTED}")
        found = []
        for table, source in stated.items():
            with at(str(table)):
                found.append((str(table), *_texts(str(table), source, sources)))
    return _catalogs(tuple(found))


def _texts(table: str, source: str | Sequence[object], sources: Sources) -> tuple[bool, tuple[TableText, ...]]:
    """Return whether shipped rows are extended, and the texts that are meant."""
    extends = isinstance(source, (list, tuple)) and len(source) > 1 and source[0] == "+"
    entries: list[object] = list(source[1:]) if extends else [source]
    texts = []
    for entry in entries:
        field = f"{WHERE}: catalogs: {table}"
        if not isinstance(entry, str) or not re.fullmatch(REFERENCE, entry):
            raise InputError(field, shown_kind(entry), TABLE_EXPECTED)
        if entry not in sources.tables:
            raise InputError(field, entry, "a table that there is, with its version")
        texts.append(sources.tables[entry])
    return extends, tuple(texts)


@lru_cache(maxsize=16)
def _catalogs(stated: tuple[tuple[str, bool, tuple[TableText, ...]], ...]) -> Catalogs:
    """Return catalogues with some texts, made once: traces of a problem belong to its catalogues."""
    spec = {table: ["+", *texts] if extends else texts[0] for table, extends, texts in stated}
    found = Catalogs(spec)
    for table in spec:
        found.table(table)  # what is wrong in a text is said now
    return found


def digests(stated: Mapping[str, str | list[str]] | None, sources: Sources) -> dict[str, str]:
    """Return the SHA-256 of every table that a request names, by reference."""
    entries = [x for value in (stated or {}).values() for x in (value if isinstance(value, list) else [value])]
    return {entry: sources.tables[entry].digest for entry in entries if entry in sources.tables}


# ---- earlier jobs ---------------------------------------------------------------------------------------------------


def records_of(sources: Sources, job: object) -> Mapping[str, bytes]:
    """Return the records of an earlier job.

    Raises
    ------
    InputError
        There is no such job, or it has no records yet.
    """
    found = sources.records.get(job) if isinstance(job, str) else None
    if not found:
        shown = None if job is None else shown_kind(job)
        raise InputError(f"{WHERE}: {OF}", shown, "the id of a job that has ended")
    return found


def shown_job(records: Mapping[str, bytes]) -> Described:
    """Text shown for an earlier job that is not of the kind needed."""
    if any(name.startswith(TABLE) for name in records):
        return Described("a batch")
    named = _json_of(records, QUESTION).get("kind") if QUESTION in records else None
    return Described(f"a job of the kind {named}" if isinstance(named, str) else "a job of another kind")


def _json_of(records: Mapping[str, bytes], name: str) -> dict[str, Any]:
    try:
        content = json.loads(records[name])
    except (KeyError, ValueError, RecursionError):
        content = None
    if not isinstance(content, dict):
        raise InputError(f"{WHERE}: {OF}", Described("a job whose records are damaged"), "one that is as it was saved")
    return content


def fronts_in(records: Mapping[str, bytes]) -> dict[str, str]:
    """Return the names of the records that are fronts, by family; of one question by an empty name."""
    if FRONT_FILE in records:
        return {"": FRONT_FILE}
    return {name.split("/")[0]: name for name in records if name.endswith(f"/{FRONT_FILE}")}


def front_in(records: Mapping[str, bytes], family: object = None, check: bool = True) -> ParetoFront:
    """Return a front of an earlier job: of several families that of the one that is named.

    Parameters
    ----------
    records : mapping
    family : str, optional
    check : bool
        Whether a record that was changed is refused.

    Raises
    ------
    InputError
        There is none, or it cannot be read.
    """
    names = fronts_in(records)
    if not names:
        raise InputError(f"{WHERE}: {OF}", shown_job(records), "a job that has found a front", (OF,))
    if "" in names and family is not None:
        raise InputError(f"{WHERE}: {FAMILY}", shown_kind(family), "no family: the job asks one alone", (FAMILY,))
    if "" not in names and not (isinstance(family, str) and family in names):
        right = f"one of those that the job compares: {', '.join(names)}"
        raise InputError(f"{WHERE}: {FAMILY}", None if family is None else shown_kind(family), right, (FAMILY,))
    name = names[family if isinstance(family, str) else ""]
    with at(OF):
        content = _json_of(records, name)
        if content.get("format") != FRONT_FORMAT:
            raise InputError(f"{WHERE}: {OF}: {name}: format", content.get("format"), f"format {FRONT_FORMAT}")
        if check and (fault := changed(content)):
            changed_front = Described("a front that was changed")
            raise InputError(f"{WHERE}: {OF}: {name}", changed_front, f"a front as it was saved; {fault}")
        return replace(front_of_record(content, Path(name)), folder=None)


def front_of(asked: FrontRequest, sources: Sources) -> tuple[ParetoFront, Catalogs]:
    """Return the front that a request is of, with its tables.

    Raises
    ------
    InputError
        There is none, or one of its tables cannot be had.
    """
    with at(OF):
        records = records_of(sources, asked.of)
    front = front_in(records, asked.family)
    with at(OF):
        return front, catalogs_of(front.frame.restated.get("catalogs"), sources)


def is_comparison(records: Mapping[str, bytes]) -> bool:
    """True if records are those of several families."""
    return COMPARISON in records


# ---- questions ------------------------------------------------------------------------------------------------------


def question_of(spec: Mapping[str, object], sources: Sources, **usual: Any) -> tuple[Request, SearchSettings]:
    """Request to one family in a spec, and how it is searched; ``usual`` counts where the spec states nothing.

    Raises
    ------
    InputError
        With everything that is not of its kind.
    """
    content = {key: value for key, value in spec.items() if key != CATALOGS}
    refuse_several(content.get(FAMILY, ""), WHERE)
    faults, tables = list[InputError](), as_catalogs(None)
    with gathered(faults):
        tables = catalogs_of(spec.get(CATALOGS), sources)
    with gathered(faults):
        request = Request.from_json(content, WHERE, catalogs=tables)
    with gathered(faults):
        settings = settings_of(spec, **usual)
    refuse_gathered(faults)
    refuse_unused(request.problem, tables)
    return request, settings


def settings_of(spec: Mapping[str, object], **usual: Any) -> SearchSettings:
    """Search settings of a spec. How many threads work at it is not for a request to say, and changes nothing.

    Raises
    ------
    InputError
        A value is not of its kind, or more than one thread is asked for.
    """
    one_thread(spec.get(WORKERS))
    stated = {key: value for key, value in spec.items() if key in SEARCHED and value is not None}
    read = SearchSettings.from_json({**usual, **stated}, WHERE)
    return replace(read, workers=1)


def stated_spec(request: Request, settings: SearchSettings, keys: Collection[str] = SEARCHED) -> dict[str, Any]:
    """Return a question as it is stored: requirements by their names in the order of the family, defaults written out.

    Limits, pins and parts keep their order, in which tables show them.
    """
    content = request.to_json()
    declared = request.problem.declaration(frozenset(), request.catalogs)
    names, order = declared.names(), list(declared.requirements)
    if "requirements" in content:
        read = {names.get(word, word): value for word, value in content["requirements"].items()}
        known = [name for name in order if name in read]
        content["requirements"] = {name: read[name] for name in [*known, *(n for n in read if n not in order)]}
    if "options" in content:
        content["options"] = dict(sorted(content["options"].items()))
    how = {key: value for key, value in settings.to_json().items() if key in keys and key != "workers"}
    return {**plain(content), **how}


def titled(request: Request) -> str:
    """Return a few words on what is asked: the family, and the first requirements."""
    declared = request.problem.declaration(frozenset(map(str, request.requirements)), request.catalogs)
    names = declared.names()
    given = {names.get(str(word), str(word)): value for word, value in request.requirements.items()}
    shown = [
        f"{words(name)} {_shown(given[name], declared.requirements[name].unit)}"
        for name in declared.requirements
        if name in given
    ]
    title = request.problem.title or request.problem.name
    return f"{title}: {', '.join(shown[: KIND_SETTINGS.titled])}" if shown else title


def words(text: str) -> str:
    """Return names and quantities as people write them in a title.

    Examples
    --------
    >>> words("load_torque 300 N*m .. 600 N*m"), words("driven_inertia 2 kg*m2")
    ('load torque 300 N·m .. 600 N·m', 'driven inertia 2 kg·m²')
    """
    return STATED.sub(lambda found: POWER.sub(_raised, found[0].replace("*", "·")), text.replace("_", " "))


def _raised(found: re.Match[str]) -> str:
    return found[0].translate(RAISED)


def _shown(value: Any, unit: str) -> str:
    return words(value if isinstance(value, str) else f"{typed_number(value)} {unit}".removesuffix(" -"))


# ---- what comes out -------------------------------------------------------------------------------------------------


def told(tell: ReportProgress) -> ReportProgress:
    """Return a progress function that tells what JSON can hold."""

    def show(state: Mapping[str, object]) -> None:
        tell(plain({key: _number(value) for key, value in state.items()}))

    return show


def _number(value: object) -> Any:
    return value.item() if hasattr(value, "item") else value


def question_record(name: str, posed: Mapping[str, Any], sources: Sources) -> Record:
    """Return the record of what was asked: the kind, the request, and the digests of the tables that it names."""
    content = {"kind": name, "request": posed, "tables": digests(posed.get("catalogs"), sources)}
    return json_record(QUESTION, content)


def json_record(name: str, content: Mapping[str, object]) -> Record:
    """Return a record of JSON."""
    return Record.of(name, json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def by_name(*records: Record) -> dict[str, Record]:
    """Return records by their names."""
    return {record.name: record for record in records}


def of_files(files: Mapping[str, str | bytes], names: Collection[str] | None = None) -> dict[str, Record]:
    """Return files as records, all or some of them."""
    return {name: Record.of(name, text) for name, text in files.items() if names is None or name in names}


def read_json(records: Mapping[str, bytes], name: str) -> dict[str, Any]:
    """Return the content of a record of ours."""
    content: dict[str, Any] = json.loads(records[name])
    return content


def front_summary(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the facts of the record of a front."""
    designs = content["designs"]
    return {
        "outcome": content["status"],
        "family": content["family"],
        "title": content["title"],
        "designs": len(designs),
        "certificate": content["certificate"]["kind"],
        "gap": content["certificate"]["gap"],
        "interrupted": content["interrupted"],
        "objectives": dict(content["objectives"]),
        "best": best_of(designs, content["units"]),
    }


def best_of(designs: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> dict[str, str]:
    """Return the objectives of the first of some designs of a record with their units; nothing where there is none."""
    best = designs[0]["objectives"] if designs else {}
    return {name: typed_quantity(float(x), units[name], KIND_SETTINGS.digits) for name, x in best.items()}
