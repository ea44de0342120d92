"""One requirement sheet and the families it is shown to: who can serve it, and why the others cannot.

A family states with ``DesignProblem.understands`` which of its requirements mean what they mean in every family. A name
that it does not understand makes it step back; nothing that was asked is overlooked.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from typing import Any

from synth.declaration import Declaration
from synth.errors import ELSEWHERE, InputError, NotCoveredError, at
from synth.model.problem import DesignProblem
from synth.model.registry import every_declaration, every_family, load, skipping_faulty_families
from synth.question import request, uncertainty
from synth.question.arguments import Objectives
from synth.question.catalogs import as_catalogs
from synth.question.names import as_mapping, refuse_power
from synth.question.request import Request
from synth.tables.catalogs import Catalogs
from synth.text.input_limits import INPUT_LIMITS
from synth.units import parse_unit

ANY = "any"
KEYS = ("options", "requirements", "limits", "fix", "parts", "robust")
EXAMPLES = {**request.EXAMPLES, "options": "{'friction_basis': 'worst_case'}", "robust": "{'friction': '+-10 %'}"}
LEAST_OBJECTIVES, MOST_OBJECTIVES = 2, 3

Sheet = Mapping[str, Mapping[str, Any]]


@dataclass
class Applicant:
    """A family, what concerns it alone, and why it cannot serve (``misfits``, as predicates)."""

    label: str
    title: str
    family_sheet: Sheet
    problem: DesignProblem
    declaration: Declaration
    misfits: list[str] = field(default_factory=list)
    declined: bool = False
    not_used: tuple[str, ...] = ()  # requirements of the sheet that cannot matter to it
    as_limits: Mapping[str, str] = field(default_factory=dict)  # those that are limits here: quantity -> comparison

    def robust(self, sheet: Sheet) -> dict[str, Any]:
        """Scatter of the sheet of all, and of its own."""
        return {**sheet["robust"], **self.family_sheet["robust"]}

    def request(self, sheet: Sheet, catalogs: Catalogs, **ranked: Any) -> Request:
        """Question of the family: the sheet of all and its own, and the objectives of the ranking."""
        entries: dict[str, Any] = {key: {**sheet[key], **self.family_sheet[key]} for key in ("limits", "fix", "parts")}
        for name, comparison in self.as_limits.items():
            more = entries["limits"].get(name, [])
            entries["limits"][name] = [*([more] if isinstance(more, str) else more), comparison]
        apart = {*self.not_used, *self.problem.as_limits} - {*self.declaration.requirements}
        common = {n: v for n, v in sheet["requirements"].items() if n not in apart}
        requirements = {**common, **self.family_sheet["requirements"]}
        return Request.of(self.problem, requirements, catalogs, self.robust(sheet) or None, **entries, **ranked)


def sheet_of(**blocks: Any) -> Sheet:
    """Sheet of the blocks; entries that are None are dropped.

    Raises
    ------
    InputError
        When something is no mapping.
    """
    read = {key: as_mapping(blocks.get(key), key, EXAMPLES[key]) for key in KEYS}
    return {key: {str(n): v for n, v in mapping.items() if v is not None} for key, mapping in read.items()}


def understood() -> dict[str, tuple[str, list[str]]]:
    """Return, per requirement that families understand in common, its unit and the registered families that do."""
    units: dict[str, str] = {}
    families: dict[str, list[str]] = {}
    for problem, declared in every_declaration(as_catalogs(None)):
        for name in problem.understands:  # a word of another duty is not declared
            families.setdefault(name, []).append(problem.name)
            units |= {name: declared.requirements[name].unit} if name in declared.requirements else {}
    order = sorted(families, key=lambda name: (-len(families[name]), name))
    return {name: (units.get(name, ""), families[name]) for name in order}


def applicants(families: object, sheet: Sheet, catalogs: Catalogs) -> list[Applicant]:
    """Requested families, each with the reasons for which it cannot serve.

    Parameters
    ----------
    families : "any", or list of names, DesignProblem subclasses, instances, or mappings with ``family``
    sheet : mapping
        Requirements, limits and other entries for all families.
    catalogs : Catalogs

    Raises
    ------
    InputError
        When a name means nothing to any family, or none can serve.
    """
    every = isinstance(families, str) and families == ANY
    entries: object = [*every_family().values()] if every else families
    if isinstance(entries, (str, Mapping)) or not isinstance(entries, Sequence) or not entries:
        raise InputError("family", families, f"'{ANY}', or a list of families", ("family",))
    if len(entries) > INPUT_LIMITS.families:
        raise InputError("family", f"{len(entries)} entries", f"at most {INPUT_LIMITS.families}", ("family",))
    candidates = []
    for k, entry in enumerate(entries):
        with at("family", k), skipping_faulty_families() if every else nullcontext():
            candidates.append(_applicant(entry, sheet, catalogs))
    _number_duplicates(candidates)
    _check_names(candidates, sheet)
    _check_family_sheets(candidates, sheet)
    _check_tables(candidates, catalogs)
    for one in candidates:
        one.not_used = tuple(name for name in sheet["requirements"] if name in one.problem.disregards)
        one.as_limits = _as_limits(one, sheet["requirements"])
        declined = dict.fromkeys(r for name, r in one.problem.declines.items() if name in sheet["requirements"])
        if not one.declined:  # what it cannot do is said alone
            one.declined = bool(declined)
            one.misfits += [*declined] or _misfits(one, sheet)
    return candidates


def refuse_all(candidates: Sequence[Applicant], sheet: Sheet) -> None:
    """Raise where no family can serve, with the reasons of the one that comes nearest."""
    if all(one.misfits for one in candidates):
        near = min(candidates, key=lambda one: sum(m.count(",") + 1 for m in one.misfits))
        shown = ", ".join(sheet["requirements"]) or None
        reasons = " and ".join(near.misfits)
        expected = f"a sheet that one of the families can serve; the nearest is {near.label}, but it {reasons}"
        raise InputError("requirements", shown, expected, ("requirements",))


def _applicant(entry: object, sheet: Sheet, catalogs: Catalogs) -> Applicant:
    """Read one entry of the list of families."""
    family: Any = entry  # read where it is loaded
    family_sheet = sheet_of()
    if isinstance(entry, Mapping):
        family = entry.get("family")
        for key in entry:
            if key not in ("family", *KEYS):
                raise InputError("family", key, f"family, {', '.join(KEYS)}", (str(key),))
        family_sheet = sheet_of(**{key: entry[key] for key in KEYS if key in entry})
    problem = load(family)
    if family_sheet["options"]:
        problem = type(problem)(**{**problem.options, **family_sheet["options"]})
    specified = frozenset({*sheet["requirements"], *family_sheet["requirements"]})
    about = (problem.name, problem.title or problem.name, family_sheet, problem)
    try:
        one = Applicant(*about, problem.model(specified, catalogs).declaration)
    except NotCoveredError as error:
        return Applicant(
            *about,
            type(problem)().model(frozenset(), catalogs).declaration,
            [error.expected.removeprefix(ELSEWHERE)],
            True,
        )
    shared = {n: v for n, v in sheet["options"].items() if n not in problem.options}
    if shared and all(n in one.declaration.options for n in shared):
        one.problem = type(problem)(**{**shared, **problem.options})
        try:
            one.declaration = one.problem.model(specified, catalogs).declaration
        except NotCoveredError as error:
            one.misfits, one.declined = [error.expected.removeprefix(ELSEWHERE)], True
        except InputError as error:
            one.problem = problem
            one.misfits.append(f"refuses an option ({error})")
    return one


def _number_duplicates(candidates: Sequence[Applicant]) -> None:
    """Number families that are requested twice, with other options for instance."""
    for label in {one.label for one in candidates}:
        same = [one for one in candidates if one.label == label]
        for number, one in enumerate(same[1:], start=2):
            one.label = f"{label}_{number}"


def _check_names(candidates: Sequence[Applicant], sheet: Sheet) -> None:
    """Refuse names that mean nothing to any of the families."""
    for key in KEYS:
        known = {n for one in candidates for n in _known(one, key)}
        for name in sheet[key]:
            if name in known or any(_answered(one, key, name) for one in candidates):
                continue
            if key == "requirements":
                common = (r for one in candidates for r in one.declaration.requirements.values() if r.name in known)
                refuse_power(name, sheet[key][name], list(common))
            expected = f"a name that one of the families knows{_hint(name, known)}"
            if key in ("requirements", "robust") and any(name in one.declaration.names() for one in candidates):
                expected = (
                    "a requirement that families understand in common, by name; what concerns one family alone is "
                    "stated under that family"
                )
            raise InputError(key, name, expected, (key, name))


def _hint(word: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(word, known, n=2, cutoff=0.6)
    return f" (did you mean {' or '.join(close)}?)" if close else ""


def _check_family_sheets(candidates: Sequence[Applicant], sheet: Sheet) -> None:
    """Refuse names under a family that mean nothing to it, and blocks of what scatters that mean nothing to any."""
    for one in candidates:
        names = one.declaration.names()
        for key in ("requirements", "limits", "fix", "parts", "robust"):
            # Under a family what concerns it alone may stand as well, by symbols too.
            known = {*_known(one, key), *(one.declaration.requirements if key in ("requirements", "robust") else ())}
            for word in one.family_sheet[key]:
                name = uncertainty.name_in_block(word, names) if key == "robust" else names.get(word, word)
                if name not in known:
                    expected = f"a name that {one.label} knows{_hint(word, known)}"
                    raise InputError(f"family {one.label}: {key}", word, expected)
        if one.family_sheet["robust"]:
            uncertainty.read_remaining(one.robust(sheet), f"family {one.label}: robust")


def _known(one: Applicant, key: str) -> Iterable[str]:
    d = one.declaration
    quantities = {name for name, _, _ in d.quantities()}
    understands = [n for n in one.problem.understands if n in d.requirements]
    columns = {f"{slot}.{column}" for slot, part in d.slots.items() for column in part.columns}
    return {
        "options": d.options,
        "requirements": understands,
        "limits": quantities,
        "fix": quantities | set(d.choices) | set(d.slots),
        "parts": d.slots,
        "robust": {*uncertainty.KEYS, *understands, *d.variables, *columns},
    }[key]


def _check_tables(candidates: Sequence[Applicant], catalogs: Catalogs) -> None:
    used = {table for one in candidates for table in one.declaration.tables()}
    for name in catalogs.added:
        if name not in used:
            right = f"a table that one of the families uses ({', '.join(sorted(used))})"
            raise InputError("catalogs", name, right, ("catalogs", name))


def _answered(one: Applicant, key: str, name: str) -> bool:
    """Whether a family has an answer to a requirement: with another duty, or why it is none of its own."""
    answers = (one.problem.understands, one.problem.declines, one.problem.disregards, one.problem.as_limits)
    return key == "requirements" and any(name in known for known in answers)


def _as_limits(one: Applicant, requirements: Mapping[str, Any]) -> dict[str, str]:
    """Requirements of a sheet that are limits in a family: quantity -> comparison."""
    words = [w for w in one.problem.as_limits if w in requirements and w not in one.declaration.requirements]
    return {one.problem.as_limits[w]: f"{'>=' if w.endswith('_min') else '<='} {requirements[w]}" for w in words}


def _misfits(one: Applicant, sheet: Sheet) -> list[str]:
    """Reasons why a family cannot serve a sheet, as predicates."""
    reasons, d = [], one.declaration
    words = {
        "requirements": "does not understand",
        "limits": "has no quantity",
        "fix": "has nothing to fix as",
        "parts": "has no slot",
        "options": "has no option",
        "robust": "has nothing that scatters as",
    }
    for key, lacks in words.items():
        strange = [n for n in sheet[key] if n not in _known(one, key) and not _answered(one, key, n)]
        if strange:
            reasons.append(f"{lacks} {', '.join(strange)}")
    names = d.names()
    known = {*sheet["requirements"], *(names.get(n, n) for n in one.family_sheet["requirements"])}
    lacking = [r.name for r in d.requirements.values() if r.default is None and not r.optional and r.name not in known]
    if lacking:
        reasons.append(f"needs {', '.join(lacking)}")
    return reasons


# ---- what they are compared by --------------------------------------------------------------------------------------


def common_objectives(candidates: Sequence[Applicant], objectives: Objectives) -> dict[str, str]:
    """Return the objectives that all families that can serve have, and note which family lacks a requested one.

    None requested: what all offer; those that are defaults in most families come first, two at least if there are.

    Raises
    ------
    InputError
        When there is none, or a name or sense is not one.
    """
    serving = [one for one in candidates if not one.misfits]
    if objectives is None:
        return _offered_by_all(serving)
    if isinstance(objectives, str):
        objectives = [objectives]
    pairs = list(objectives.items()) if isinstance(objectives, Mapping) else [(name, None) for name in objectives]
    if not pairs:
        raise InputError("objectives", None, "at least one", ("objectives",))
    result: dict[str, str] = {}
    for name, sense in pairs:
        if name in result:
            raise InputError("objectives", name, "each objective once", ("objectives", str(name)))
        result[name] = _sense(serving, str(name), sense)
    for one in serving:
        has = _units(one)
        lacking = [name for name in result if name not in has]
        if lacking:
            one.misfits.append(f"has no quantity {', '.join(lacking)} to be compared by")
    return result


def _units(one: Applicant) -> dict[str, str]:
    return {name: unit for name, unit, _ in one.declaration.quantities()}


def _sense(serving: Sequence[Applicant], name: str, sense: object) -> str:
    has = [one for one in serving if name in _units(one)]
    if not has:
        known = {n for one in serving for n in _units(one)}
        close = difflib.get_close_matches(name, known, n=2, cutoff=0.6)
        hint = f"; did you mean {' or '.join(close)}?" if close else ""
        raise InputError("objectives", name, f"a quantity of the families, by name{hint}", ("objectives", name))
    kinds = {parse_unit(_units(one)[name]).kind for one in has}
    if len(kinds) > 1:
        right = "a quantity that is measured alike in all families"
        raise InputError("objectives", name, right, ("objectives", name))
    if sense is None:
        offered = {one.declaration.objectives[name].sense for one in has if name in one.declaration.objectives}
        if len(offered) != 1:
            right = f"a sense, for example {{{name}: min}}"
            raise InputError(f"objectives: {name}", None, right, ("objectives", name))
        return offered.pop()
    if sense not in ("min", "max"):
        raise InputError(f"objectives: {name}", sense, "min or max", ("objectives", name))
    return str(sense)


def _offered_by_all(serving: Sequence[Applicant]) -> dict[str, str]:
    first, *others = [one.declaration for one in serving]
    votes: dict[str, int] = {}
    for name, objective in first.objectives.items():
        same = [d.objectives.get(name) for d in others]
        units = {parse_unit(_units(one)[name]).kind for one in serving if name in _units(one)}
        if all(o is not None and o.sense == objective.sense for o in same) and len(units) == 1:
            votes[name] = objective.default + sum(o.default for o in same if o is not None)
    if not votes:
        names = ", ".join(one.label for one in serving)
        raise InputError(
            "objectives", None, f"quantities that {names} have in common, as they offer no objective in common"
        )
    ranked = sorted(votes, key=lambda n: -votes[n])
    defaults = [n for n in ranked if votes[n] == len(serving)]
    chosen = ranked[: max(LEAST_OBJECTIVES, min(len(defaults), MOST_OBJECTIVES))]
    return {name: first.objectives[name].sense for name in chosen}
