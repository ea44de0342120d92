"""What forms ask while somebody types: families, their declarations, examples, checks, and one design evaluated.

All of it is done in a fraction of a second by a process that has read the families already.
"""

from __future__ import annotations

import inspect
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from synth.analysis.describe import described
from synth.analysis.design_spec import design_of_spec, must_be_a_design
from synth.declaration import Declaration
from synth.errors import InputError, SeveralErrors, at, gathered
from synth.kinds import comparison, synthesis
from synth.kinds.asked import CATALOGS, FAMILY, MAPPINGS, catalogs_of, check_entry, digests, settings_of, spec_of
from synth.kinds.settings import KIND_SETTINGS, KindSettings
from synth.model.model import Model
from synth.model.problem import DesignProblem
from synth.model.registry import every_declaration, load
from synth.question.arguments import Family
from synth.question.catalogs import as_catalogs, lacking_columns, misspelt_columns, refuse_unused
from synth.question.examples import Example, examples_of
from synth.question.examples import examples as all_examples
from synth.question.names import requirement_named
from synth.question.objectives import chosen_objectives
from synth.question.request import Request
from synth.question.request_fields import FIELDS
from synth.question.requirement_values import missing, value_of
from synth.question.spec import spec_from_mapping
from synth.question.spec_keys import asks_several, no_family
from synth.question.uncertainty import read_remaining
from synth.question.user_limits import UserLimits
from synth.question.variable_ranges import VariableRanges
from synth.queue.records import NOTHING, Sources
from synth.results.front_record import design_record
from synth.results.plain import plain
from synth.search.question import pose
from synth.tables.catalogs import Catalogs
from synth.units import typed_quantity
from synth.verbs.request import WHERE, known_keys
from synth.verbs.requests import OF, SPEC

T = TypeVar("T")
SECTIONS = {"option": "option", "slot": "part", "objective": "objective"}  # of a form, by kind of row
NEEDED, LIMIT, ASSUMPTION = "needed", "limit", "assumption"


# ---- what there is --------------------------------------------------------------------------------------------------


def families() -> list[dict[str, Any]]:
    """Return all registered families: name, title, one line, options with their choices, and the names of examples."""
    return [_family(problem, declared) for problem, declared in every_declaration(as_catalogs(None))]


def _family(problem: DesignProblem, declared: Declaration) -> dict[str, Any]:
    return {
        "name": problem.name,
        "title": problem.title or problem.name,
        "line": (inspect.getdoc(problem.declared_by) or "").partition("\n")[0],
        "sources": list(problem.sources),
        "options": [
            {
                "name": option.name,
                "symbol": option.symbol,
                "choices": list(option.choices),
                "default": option.default,
                "text": option.text,
                "source": option.source,
                "group": option.group,
            }
            for option in declared.options.values()
        ],
        "understands": list(problem.understands),
        "examples": [example.name for example in examples_of(problem)],
    }


def declaration(family: Family, options: Mapping[str, object] | None = None) -> dict[str, Any]:
    """Declaration of a family, as a form shows it.

    Parameters
    ----------
    family : str
    options : mapping, optional
        Name -> word, as in a spec.

    Returns
    -------
    dict
        ``name``, ``title``, ``sources``, the ``options`` given, and ``rows``: those of ``synth.describe`` with
        ``section``: ``needed`` (a requirement that must be stated), ``limit`` (one that may be), ``assumption`` (one
        with a default), ``option``, ``part``, ``objective``, or for what a form does not ask the kind of the row.

    Raises
    ------
    InputError
        There is no such family or option.
    """
    with at("options"):
        chosen = FIELDS["options"].value.read("options", options)
    problem = load(FIELDS["family"].read(FAMILY, family) if isinstance(family, str) else family, **chosen)
    rows = [{**row, "section": _section(row)} for row in described(problem)]
    return {
        "name": problem.name,
        "title": problem.title or problem.name,
        "sources": list(problem.sources),
        "options": dict(chosen),
        "rows": [{name: _cell(value) for name, value in row.items()} for row in rows],
    }


def _section(row: Mapping[str, Any]) -> str:
    if row["kind"] == "requirement":
        return LIMIT if row["optional"] else NEEDED if row["default"] is None else ASSUMPTION
    return SECTIONS.get(row["kind"], str(row["kind"]))


def _cell(value: object) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def examples() -> list[dict[str, Any]]:
    """Return the examples of all families: name, family, description, whether it is a design, spec and text."""
    return [_example(one) for one in all_examples()]


def _example(one: Example) -> dict[str, Any]:
    return {
        "name": one.name,
        "family": one.family,
        "description": one.description,
        "design": one.is_design,
        "spec": plain(one.spec),
        "text": one.text,
    }


# ---- a given design -------------------------------------------------------------------------------------------------


def evaluate(design: object, sources: Sources = NOTHING) -> dict[str, Any]:
    """Return the record of a given design, with what says how to show it.

    Parameters
    ----------
    design : mapping
        A spec with ``values`` and ``parts``, as in a DESIGN.yaml.
    sources : Sources
        With the tables that it names.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    given = known_keys(design, tuple(FIELDS))
    tables = catalogs_of(given.get("catalogs"), sources)
    asked = spec_from_mapping({key: value for key, value in given.items() if key != "catalogs"}, WHERE, Path())
    must_be_a_design(asked)
    _, _, found = design_of_spec(asked, tables)
    frame = found.frame
    return {
        "family": frame.family,
        "title": frame.title,
        "options": dict(frame.options),
        "requirements": dict(frame.requirements),
        "objectives": dict(frame.objectives),
        "units": dict(frame.units),
        "kinds": dict(frame.kinds),
        "limit_units": dict(frame.limit_units),
        "limit_senses": dict(frame.limit_senses),
        "tables": digests(given.get("catalogs"), sources),
        "parts": {row.key: row.record() for row in (*found.parts.values(), *found.rows)},
        "design": plain(design_record(found)),
        "spec": plain(found.to_spec()),
    }


# ---- checks ---------------------------------------------------------------------------------------------------------


def check(request: object, sources: Sources = NOTHING, settings: KindSettings = KIND_SETTINGS) -> dict[str, Any]:
    """Faults of a question, all at once as far as one fault does not hide another; nothing is raised.

    Parameters
    ----------
    request : mapping
        A spec, which may be incomplete; also ``of`` an earlier job.
    sources : Sources
        What it refers to.
    settings : KindSettings
        For how long further faults are looked for.

    Returns
    -------
    dict
        ``ready``: whether it can be asked; ``problems``: ``path``, ``value``, ``expected`` and ``message`` of each
        fault; ``read``: the requirements stated, as they are understood; ``remarks``: ``path`` and ``message`` of what
        is no fault and perhaps not meant; ``combinations`` of parts and counts, where it is ready and asks one family.
    """
    return _Check(sources, settings).of(request)


def all_faults(
    spec: Mapping[str, object],
    sources: Sources,
    first: InputError,
    keys: Sequence[str] = (),
    more: Sequence[InputError] = (),
) -> InputError:
    """Return a refusal that has, beside the fault that was found first, everything else that is wrong.

    Parameters
    ----------
    spec : mapping
        What a request asks as a spec.
    sources : Sources
    first : InputError
    keys : sequence of str
        That may stand beside those of a spec.
    more : sequence of InputError
        What is wrong under those.
    """
    if first.path[:1] == (FAMILY,):
        return first  # of another family all else would be another fault
    check = _Check(sources, KIND_SETTINGS, keys)
    check.of(spec)
    found = [*check.faults, *more]
    if not any(fault.path == first.path for fault in found):
        found.insert(0, first)
    return SeveralErrors(found) if len(found) > 1 else first


class _Check:
    """One check: what is understood goes on, what is not is a fault and is left out."""

    def __init__(self, sources: Sources, settings: KindSettings, more: Sequence[str] = ()) -> None:
        self.sources, self.settings, self.keys = sources, settings, (*SPEC, OF, *more)
        self.faults: list[InputError] = []
        self.read: dict[str, str] = {}
        self.remarks: list[dict[str, Any]] = []
        self.combinations: int | None = None
        self.end = time.monotonic() + settings.seconds

    def of(self, request: object) -> dict[str, Any]:
        self._caught(self._looked_at, request)
        return {
            "ready": not self.faults,
            "problems": [fault.told() for fault in self.faults],
            "read": self.read,
            "remarks": self.remarks,
            "combinations": None if self.faults else self.combinations,
        }

    def _looked_at(self, request: object) -> None:
        """Note all that is wrong; what is raised is one fault more, after which nothing is looked at."""
        spec = self._entries(request)
        family = spec.get(FAMILY)
        if family is None:
            if isinstance(request, Mapping) and not any(fault.path[:1] in ((FAMILY,), (OF,)) for fault in self.faults):
                self.faults.append(no_family(WHERE))
        elif asks_several(family):
            if not self.faults:
                self._caught(comparison.read, spec, self.sources)
        else:
            self._one_family(spec)

    def _caught(self, act: Callable[..., T], *given: Any) -> T | None:
        """Value from a reader; None where it refuses, which is noted."""
        try:
            return act(*given)
        except InputError as fault:
            self.faults += fault.every()
            return None

    def _late(self) -> bool:
        """True if enough is wrong, and time is over for finding more."""
        return bool(self.faults) and time.monotonic() > self.end

    # -- entries by themselves -----------------------------------------------------------------

    def _entries(self, request: object) -> dict[str, Any]:
        """Entries under the keys of a spec that are of the right kind."""
        if isinstance(request, Mapping):
            for key in [key for key in request if key not in self.keys]:
                self._caught(known_keys, {key: 0}, self.keys)
            request = {key: self._entry(key, value) for key, value in request.items() if key in (*SPEC, OF)}
        found = self._caught(spec_of, request, self.sources, (), True)
        return {} if found is None else found[0]

    def _entry(self, key: str, value: object) -> Any:
        """Entry under one key, without parts of a wrong kind; None where nothing is left."""
        if key not in MAPPINGS or not isinstance(value, Mapping):
            return value if self._fits(key, value) else None
        return {name: entry for name, entry in value.items() if self._fits(key, {name: entry})}

    def _fits(self, key: str, value: object) -> bool:
        """True if an entry is of its kind; note where it is not."""
        faults: list[InputError] = []
        if value is not None:
            with gathered(faults):
                check_entry(key, value)
        self.faults += faults
        return not faults

    # -- one family ----------------------------------------------------------------------------

    def _one_family(self, spec: dict[str, Any]) -> None:
        problem = self._problem(spec)
        if problem is None:
            return
        tables = self._tables(spec, problem)
        stated = self._requirements(spec, problem, tables)
        model = self._caught(problem.model, frozenset(stated), tables)
        if model is None:
            return
        self._each(spec, model)
        if self.faults:
            return
        kept = {**{key: value for key, value in spec.items() if key != "catalogs"}}
        for _ in range(self.settings.rounds):
            fault = self._posed(kept, problem, tables)
            if fault is None or self._late() or not _left_out(kept, fault):
                return

    def _problem(self, spec: dict[str, Any]) -> DesignProblem | None:
        """Return the family with those of its options that it has."""
        options = dict(spec.get("options") or {})
        while True:
            try:
                problem = load(spec[FAMILY], **FIELDS["options"].value.read(WHERE, options))
                problem.model(frozenset(), as_catalogs(None))
            except InputError as fault:
                self.faults.append(fault)
                names = [step for step in fault.path if step in options]
                if fault.path[:1] == (FAMILY,) or not options:
                    return None
                options = {name: word for name, word in options.items() if names and name != names[-1]}
            else:
                return problem

    def _tables(self, spec: dict[str, Any], problem: DesignProblem) -> Catalogs:
        def read() -> Catalogs:
            tables = catalogs_of(spec.get("catalogs"), self.sources)
            refuse_unused(problem, tables)
            self.remarks += [
                {
                    "path": [CATALOGS, table, column],
                    "message": f"table {table}, column {column}: no family knows it, and it is carried along; "
                    f"did you mean {meant}?",
                }
                for table, column, meant in misspelt_columns(tables)
            ]
            try:
                problem.model(frozenset(), tables)
            except InputError as fault:
                if fault.path[:1] != (CATALOGS,):
                    raise
                raise SeveralErrors(lacking_columns(problem, tables) or [fault]) from None
            return tables

        found = self._caught(read)
        return as_catalogs(None) if found is None else found

    def _requirements(self, spec: dict[str, Any], problem: DesignProblem, tables: Catalogs) -> dict[str, float]:
        """Return the requirements that are understood in SI; note what is missing as well."""
        model, stated = problem.model(frozenset(), tables), dict[str, float]()
        named = set[str]()
        for word, typed in (spec.get("requirements") or {}).items():
            if self._late():
                return stated
            name = self._caught(requirement_named, str(word), typed, problem, model, tables)
            if name is None:
                continue
            if name in named:
                right = "each requirement once (name and symbol mean the same)"
                self.faults.append(InputError(f"requirement {name}", word, right, ("requirements", word)))
                continue
            named.add(name)
            record = model.declaration.requirements[name]
            value = self._caught(value_of, record, typed)
            if value is not None:
                stated[name] = value
                self.read[name] = typed_quantity(value, record.unit)
        asked = self._caught(problem.model, frozenset(named), tables) or model  # what is stated decides what is needed
        for record in asked.declaration.requirements.values():
            if record.default is None and not record.optional and record.name not in named:
                self.faults.append(missing(record))
        return stated

    def _each(self, spec: Mapping[str, Any], model: Model) -> None:
        """Look at limits, pins, objectives and what scatters one by one."""
        for key in ("limits", "fix"):
            for word, asked in (spec.get(key) or {}).items():
                if self._late():
                    return
                given: dict[str, dict[str, Any]] = {"limits": {}, "fix": {}, key: {word: asked}}
                ranges = VariableRanges(model.variables, True)
                self._caught(UserLimits, model, given["limits"], given["fix"], ranges, True)
        self._caught(chosen_objectives, model, spec.get("objectives"))
        self._caught(read_remaining, spec.get("robust") or None)

    def _posed(self, spec: Mapping[str, object], problem: DesignProblem, tables: Catalogs) -> InputError | None:
        """Pose the question; return and note what is refused."""
        try:
            asked = Request.from_json(spec, WHERE, problem=problem, catalogs=tables)
            how = settings_of(spec)
            count = pose(asked, how).instance.combinations.count
            synthesis.checked(asked, how)
        except InputError as fault:
            if any(str(fault) == str(known) for known in self.faults):
                return None
            self.faults.append(fault)
            return fault
        self.combinations = count
        return None


def _left_out(spec: dict[str, Any], fault: InputError) -> bool:
    """Leave out the entry that is refused, so that the next fault shows; tell whether there was one."""
    if len(fault.path) < 2 or fault.path[0] not in MAPPINGS:
        return False
    key, name = str(fault.path[0]), fault.path[1]
    entries = spec.get(key)
    if not isinstance(entries, Mapping) or name not in entries or key in ("requirements", "options"):
        return False
    spec[key] = {word: value for word, value in entries.items() if word != name}
    return True
