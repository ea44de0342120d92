"""The kind ``compare``: a spec whose ``family`` is ``any`` or a list of families."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from synth.errors import InputError
from synth.kinds.asked import FAMILY, best_of, catalogs_of, of_files, read_json, settings_of, spec_of, words
from synth.question.arguments import UserTables
from synth.question.request import Request, check_grid, listed_objectives
from synth.question.settings import SearchSettings
from synth.question.spec_keys import asks_several, read_keys
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results.calculation import CALCULATION
from synth.results.front_record import FRONT_FILE
from synth.results.loading import COMPARISON
from synth.results.offered import OFFERED
from synth.results.plain import plain
from synth.search.question import pose
from synth.studies.families.compare import compare
from synth.studies.families.requirement_sheet import (
    KEYS,
    Applicant,
    applicants,
    common_objectives,
    refuse_all,
    sheet_of,
)
from synth.verbs.request import WHERE
from synth.verbs.requests import SPEC

KEPT = (FRONT_FILE, CALCULATION, OFFERED)  # of the front of each family; the rest is rendered from these


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request: the sheet, and that one family at least can be asked.

    Raises
    ------
    InputError
        For everything that is wrong for every family.
    """
    spec, _ = spec_of(request, sources, several=True)
    content, settings = _read(spec)
    tables = catalogs_of(spec.get("catalogs"), sources)
    sheet = sheet_of(**{key: content[key] or None for key in KEYS})
    found = applicants(content[FAMILY], sheet, tables)
    refuse_all(found, sheet)
    chosen = common_objectives(found, content["objectives"])
    refuse_all(found, sheet)
    _one_can_be_asked(
        found,
        lambda one: one.request(sheet, tables, objectives=chosen, weights=content["weights"], grid=_grid(content)),
        settings,
    )
    stated = _stated(content, settings, spec.get("catalogs"))
    serving = [one for one in found if not one.misfits]
    return CheckedRequest(
        request=stated,
        title="Comparison: " + ("; ".join(map(_titled, found)) if content[FAMILY] != "any" else "all families"),
        families=tuple(dict.fromkeys(one.problem.name for one in serving)),
    )


def _titled(one: Applicant) -> str:
    """Return a family as a title names it; where one is asked more than once, with its number."""
    return (one.problem.title or words(one.problem.name)) + words(one.label.removeprefix(one.problem.name))


def _one_can_be_asked(found: list[Applicant], asked: Callable[[Applicant], Request], settings: SearchSettings) -> None:
    """Refuse what no family can be asked, as the search would."""
    first: InputError | None = None
    for one in found:
        if one.misfits:
            continue
        try:
            pose(asked(one), settings)
        except InputError as error:
            first = first or error
        else:
            return
    if first is not None:
        raise first


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Search all families and put their designs on one front."""
    content, settings = _read(request)
    asked: dict[str, Any] = {key: content[key] or None for key in (*KEYS, "weights") if key != "requirements"}
    how: dict[str, Any] = settings.to_json()
    found = compare(
        content[FAMILY],
        content["requirements"],
        objectives=content["objectives"],
        catalogs=catalogs_of(request.get("catalogs"), sources),
        grid=_grid(content),
        progress=tell,
        **asked,
        **how,
    )
    own = {name: text for name, text in found.family_files().items() if name.rsplit("/", 1)[-1] in KEPT}
    return of_files({**found.files(), **own})


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a comparison."""
    content = read_json(records, COMPARISON)
    designs, outcomes = content["designs"], content["families"]
    facts = {
        "outcome": content["status"],
        "families": {one["family"]: one["outcome"] for one in outcomes},
        "designs": len(designs),
        "certificate": content["certificate"]["kind"],
        "gap": content["certificate"]["gap"],
        "interrupted": content["interrupted"],
        "objectives": content["objectives"],
        "best": {},
    }
    if designs:
        family = designs[0]["family"]
        folder = next(one["folder"] for one in outcomes if one["family"] == family)
        units = read_json(records, f"{folder}/{FRONT_FILE}")["units"]
        facts |= {"family": family, "best": best_of(designs, units)}
    return facts


def _read(spec: Mapping[str, object]) -> tuple[dict[str, Any], SearchSettings]:
    """Return the entries of a spec as the verb takes them, and how it is searched."""
    content = read_keys({key: value for key, value in spec.items() if key != "catalogs"}, WHERE, SPEC)
    if not asks_several(content[FAMILY]):
        right = "'any' or a list of families; one alone is the kind synthesis"
        raise InputError(f"{WHERE}: {FAMILY}", content[FAMILY], right, (FAMILY,))
    if not isinstance(content[FAMILY], str):
        content[FAMILY] = list(content[FAMILY])
    return content, settings_of(spec)


def _grid(content: Mapping[str, Any]) -> bool:
    return True if content["grid"] is None else check_grid(content["grid"])


def _stated(content: Mapping[str, Any], settings: SearchSettings, catalogs: UserTables) -> dict[str, Any]:
    """Return the request as it is stored; the order of requirements means nothing."""
    families = content[FAMILY]
    stated: dict[str, Any] = {FAMILY: families if isinstance(families, str) else [plain(one) for one in families]}
    for key in ("options", "requirements", "objectives", "limits", "fix", "parts", "weights", "robust"):
        value = listed_objectives(content[key]) if key == "objectives" else plain(content[key])
        if value:
            stated[key] = dict(sorted(value.items())) if key in ("options", "requirements") else value
    if catalogs:
        stated["catalogs"] = plain(catalogs)
    return {**stated, "grid": _grid(content), **{k: v for k, v in settings.to_json().items() if k != "workers"}}
