"""Explorer record of several families for one requirement sheet: their common front."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from synth.results import Certificate, Design
from synth.results.design import near_ones
from synth.results.report_request import ComparisonRequest
from synth.text.plain_text import counted

from ..front_report import NOT_COVERED
from ..sheet.design_sheet import as_sentence, program_name
from .record import EXPLORER_FORMAT, WORDS, RecordOf, label, number

TITLE = "Comparison of families"


def comparison_record(request: ComparisonRequest) -> dict[str, Any]:
    """Explorer record of a comparison, as JSON holds it."""
    content, fronts, compared = request.content, request.fronts, _Compared(request)
    return {
        "format": EXPLORER_FORMAT,
        "program": program_name(next(iter(fronts.values()), None)),
        "title": compared.about.title or TITLE,
        "family": TITLE,
        "facts": [list(fact) for fact in compared.about.facts()],
        "objectives": dict(content["objectives"]),
        "asked": compared.inputs(),
        "assumed": compared.assumed(),
        "certificate": compared.certificate(),
        "nothing": None if content["designs"] else compared.nothing(),
        "families": compared.families(),
        "quantities": list(compared.quantities.values()),
        "limits": list(compared.limits.values()),
        "parts": {key: part for one in compared.records.values() for key, part in one.parts().items()},
        "spec": {},
        "designs": [compared.design(x) for x in content["designs"]],
    }


class _Compared:
    def __init__(self, request: ComparisonRequest) -> None:
        self.content, self.fronts, self.about = request.content, request.fronts, request.how.about
        self.links, self.drawings = request.links, request.drawings
        self.records = {name: RecordOf(self.fronts[name], x, self.about) for name, x in request.calculations.items()}
        self.titles = self._titles()
        self.quantities: dict[str, dict[str, Any]] = {}
        self.units: dict[str, str] = {}
        self.limits: dict[tuple[str, str, str], dict[str, Any]] = {}
        listed = dict.fromkeys(x["family"] for x in self.content["designs"])
        for family in listed or self.records:
            self._gather(family)

    def _titles(self) -> dict[str, str]:
        """Titles of the families, longer where two have the same."""
        named = {str(x["family"]): str(x["title"]) for x in self.content["families"]}
        often = list(named.values())
        return {name: title if often.count(title) == 1 else f"{title} ({label(name)})" for name, title in named.items()}

    def _gather(self, family: str) -> None:
        """Take up the quantities and limits of a family; what is measured otherwise than elsewhere stands apart."""
        record = self.records[family]
        for name in [*self.content["objectives"], *record.names]:
            key = self._key(family, name)
            if key not in self.quantities:
                apart = {} if key == name else {"name": key, "label": f"{label(name)} ({self.titles[family]})"}
                self.quantities[key] = record.quantity(name) | apart
                self.units[key] = record.frame.units[name]
        for name in record.frame.limit_units:
            limit = record.limit(name)
            self.limits.setdefault((limit["name"], limit["unit"], limit["sign"]), limit)

    def _key(self, family: str, name: str) -> str:
        unit = self.records[family].frame.units[name]
        same = name in self.content["objectives"] or self.units.get(name, unit) == unit
        return name if same else f"{name}:{family}"

    # -- the question --------------------------------------------------------------------------

    def inputs(self) -> list[dict[str, Any]]:
        """Question to all, and to single families."""
        return self._merged({f: [*r.inputs(explicit=True), *r.restrictions()] for f, r in self.records.items()})

    def assumed(self) -> list[dict[str, Any]]:
        """Values at their defaults."""
        return self._merged({family: record.inputs(explicit=False) for family, record in self.records.items()})

    def _merged(self, rows: Mapping[str, Sequence[Mapping[str, Any]]]) -> list[dict[str, Any]]:
        """Return rows once that are the same in all families that have them, the others with their family."""
        values: dict[str, list[Any]] = {}
        for entries in rows.values():
            for row in entries:
                values.setdefault(row["label"], []).append({**row, "text": ""})
        merged: dict[str, dict[str, Any]] = {}
        for family, entries in rows.items():
            for row in entries:
                alike = all(other == values[row["label"]][0] for other in values[row["label"]])
                name = row["label"] if alike else f"{row['label']} ({self.titles[family]})"
                merged.setdefault(name, {**row, "label": name})
        return list(merged.values())

    # -- how far it is proven ------------------------------------------------------------------

    def certificate(self) -> dict[str, Any]:
        content = self.content
        c = Certificate(**content["certificate"])
        proven, any_design = c.kind == "global", bool(content["designs"])
        word = WORDS.get(c.kind, "Not proven")
        if not any_design:
            word = "Not feasible, proven" if proven else "No design found, not proven"
        elif content["interrupted"]:
            word = "Stopped"
        amounts = c.amounts()
        statement = str(content["sentence"])
        sentence = (statement.partition(": ")[2] or statement).replace(amounts, "") + "."
        details = [f"Stopped: {content['interrupted']}."] if content["interrupted"] else []
        if amounts:
            details.append(as_sentence(amounts.strip(" ()")))
        return {
            "level": "bad" if not any_design else "good" if proven and not content["interrupted"] else "open",
            "word": word,
            "sentence": sentence[:1].upper() + sentence[1:],
            "head": word,
            "gap": c.gap,
            "details": details,
            "combinations": c.combinations,
            "excluded": c.excluded_by_bound,
            "solved": c.solved,
            "unresolved": c.unresolved,
            "offered": [
                f"{self.titles[family]}: {counted(front.certificate.combinations, 'combination')}"
                for family, front in self.fronts.items()
            ],
            "not_part": self._not_part(),
        }

    def _not_part(self) -> list[str]:
        outside = ["Objectives are measured as each family defines them."]
        refused = [self.titles[x["family"]] for x in self.content["families"] if x["folder"] is None]
        if refused:
            outside.append(f"Families that were not searched: {', '.join(refused)}.")
        return list(dict.fromkeys([NOT_COVERED, *outside]))

    def nothing(self) -> dict[str, Any]:
        """Sentence that there is no design; each family states the reason."""
        sentence = str(self.content["sentence"])
        message = f"{sentence[:1].upper()}{sentence[1:]}."
        return {"message": message, "conflicts": [], "nearest": []}

    def families(self) -> list[dict[str, Any]]:
        """Outcome of each family."""
        return [
            {
                "name": str(x["family"]),
                "title": self.titles[x["family"]],
                "outcome": str(x["outcome"]),
                "why": label(str(x["why"])),
                "file": self.links.get(x["family"], ""),
                "spec": self.records[x["family"]].spec() if x["family"] in self.records and x["listed"] else {},
            }
            for x in self.content["families"]
        ]

    # -- designs -------------------------------------------------------------------------------

    def design(self, entry: Mapping[str, Any]) -> dict[str, Any]:
        """Return one design, with its rank among those of all families."""
        family, title = entry["family"], self.titles[entry["family"]]
        record, listed = self.records[family], self._design_of(entry)
        drawing = self.drawings.get(entry["rank"])
        pictures = {listed.rank or 0: record.picture(drawing)} if drawing is not None else {}
        result = record.design(listed, (), {}, pictures)
        used = dict(zip(self._limits_of(family), result["used"], strict=True))
        sides = dict(zip(self._limits_of(family), result["sides"], strict=True))
        names = {self._key(family, name): name for name in [*self.content["objectives"], *record.names]}
        proven = self.content["certificate"]["kind"] == "global"
        return result | {
            "rank": entry["rank"],
            "score": entry["score"],
            "status": result["status"] if proven else "feasible",
            "gap": self.content["certificate"]["gap"] if proven else None,
            "note": str(entry["note"] or ""),
            "group": entry.get("group"),
            "near": near_ones(entry["rank"], ((x["rank"], x.get("group")) for x in self.content["designs"])),
            "why": f"{title}: design {listed.rank} of the front of this family alone.",
            "family": family,
            "v": [number(listed.values.get(names.get(key, ""), math.nan), unit) for key, unit in self.units.items()],
            "used": [used.get(key) for key in self.limits],
            "sides": [sides.get(key, [None, None]) for key in self.limits],
        }

    def _design_of(self, entry: Mapping[str, Any]) -> Design:
        return next(d for d in self.fronts[entry["family"]].designs if d.rank == entry["own_rank"])

    def _limits_of(self, family: str) -> list[tuple[str, str, str]]:
        record = self.records[family]
        limits = [record.limit(name) for name in record.frame.limit_units]
        return [(limit["name"], limit["unit"], limit["sign"]) for limit in limits]
