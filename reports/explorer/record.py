"""What the explorer shows of a front, as one record: numbers in the unit in which they are read, words as printed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from synth.drawing import Drawing
from synth.results import Design, ParetoFront
from synth.results.calculation import Calculation, NamedQuantity
from synth.results.design import near_ones, reached_limits
from synth.results.rating_tables import yield_percent
from synth.results.report_request import About, ReportRequest
from synth.text.numbers import typed_number
from synth.units import finite_from_si, miss_text, unit_text

from ..drawing.files import svg_of
from ..front_report import NOT_COVERED
from ..reasons import SIGN_OF, why
from ..sheet.design_sheet import as_sentence, front_details, front_state, over_range_in_words, program_name

EXPLORER_FORMAT = 1
DIGITS = 7  # significant, of numbers in the record; five are shown
SLOPES = 8  # requirements and limits of a design that tell what 1 % more changes, the largest first
LEAST_SLOPE = 1e-3
HOW_RATED = ("mode", "samples", "seed", "confidence")  # entries of a robust block that are not scatter
WORDS = {"global": "Proven", "exhaustive": "Every combination solved", "heuristic": "Not proven"}


def explorer_record(request: ReportRequest, files: Mapping[int, Mapping[str, str]] | None = None) -> dict[str, Any]:
    """Explorer record of a front, as JSON holds it.

    Parameters
    ----------
    request : ReportRequest
        Of a front; drawings are shown as pictures, in which nothing runs.
    files : mapping
        Rank -> label -> file beside the page.
    """
    front, files = request.front, files or {}
    assert front is not None
    record = RecordOf(front, request.calculation, request.how.about)
    pictures = {rank: record.picture(drawing) for rank, drawing in request.drawings.items()}
    return {
        "format": EXPLORER_FORMAT,
        "program": program_name(front),
        "title": record.about.title or front.frame.title,
        "family": front.frame.title,
        "facts": [list(fact) for fact in record.about.facts()],
        "objectives": dict(front.frame.objectives),
        "asked": record.inputs(explicit=True) + record.restrictions(),
        "assumed": record.inputs(explicit=False),
        "certificate": record.certificate(),
        "nothing": record.nothing(),
        "quantities": [record.quantity(name) for name in record.names],
        "limits": [record.limit(name) for name in front.frame.limit_units],
        "parts": record.parts(),
        "spec": record.spec(),
        "designs": [record.design(d, request.prices, files.get(d.rank or 0, {}), pictures) for d in front.designs],
    }


class RecordOf:
    """The record of one front: each method returns a part of it."""

    def __init__(self, front: ParetoFront, calculation: Calculation, about: About) -> None:
        self.front, self.calculation, self.about = front, calculation, about
        self.frame = front.frame
        kinds = self.frame.kinds
        order = {"variable": 0, "count": 1, "derived": 2}
        others = [n for n, kind in kinds.items() if kind in order and n not in self.frame.objectives]
        self.names = [*self.frame.objectives, *sorted(others, key=lambda n: order[kinds[n]])]
        self.rules = {x.name: x for x in calculation.limits}

    def quantity(self, name: str) -> dict[str, Any]:
        """Entry of a quantity beside its values."""
        q = self.calculation.quantities.get(name)
        unit = self.frame.units[name]
        entry = {"name": name, "label": label(name), "unit": page_unit(unit), "kind": self.frame.kinds.get(name, "")}
        return entry | {"text": _of(q, "text"), "symbol": _of(q, "symbol"), "source": _of(q, "source")}

    def limit(self, name: str) -> dict[str, Any]:
        """Entry of a limit beside its sides."""
        rule = self.rules.get(name)
        return {
            "name": name,
            "label": _compared(label(name)),
            "unit": page_unit(self.frame.limit_units[name]),
            "sign": SIGN_OF[self.frame.limit_senses[name]],
            "text": rule.text if rule is not None else "",
            "source": rule.source if rule is not None else "",
        }

    # -- the question --------------------------------------------------------------------------

    def inputs(self, explicit: bool) -> list[dict[str, Any]]:
        """Explicit requirements, or those at their defaults."""
        quantities = [q for q in self.calculation.quantities.values() if q.kind == "requirement"]
        rows = [
            {
                "label": label(q.name),
                "text": q.text,
                "value": number(self.frame.requirement_values[q.name], q.unit),
                "unit": page_unit(q.unit),
            }
            for q in quantities
            if q.name in self.frame.requirement_values and (q.name in self.frame.requirements) == explicit
        ]
        options = [
            {"label": label(name), "text": "", "words": word}
            for name, word in self.calculation.options.items()
            if (name in self.frame.options) == explicit
        ]
        return rows + options

    def restrictions(self) -> list[dict[str, Any]]:
        """Question beside its requirements: own limits, fixed sizes, parts held to, scatter."""
        rows = []
        for key, words in (("limits", ""), ("fix", "fixed at "), ("parts", "only "), ("robust", "scatters ")):
            block = self.front.settings.get(key)
            for name, value in block.items() if isinstance(block, Mapping) else ():
                if key != "robust" or name not in HOW_RATED:
                    rows.append({"label": label(str(name)), "text": "", "words": words + _in_words(value)})
        return rows

    def spec(self) -> dict[str, Any]:
        """Common part of all DESIGN.yaml of the front."""
        if not self.front.designs:
            return {}
        return {key: x for key, x in self.front.designs[0].to_spec().items() if key not in ("values", "parts")}

    # -- how far it is proven ------------------------------------------------------------------

    def certificate(self) -> dict[str, Any]:
        """Sentence on how far the front is proven, and what is no part of the proof."""
        c, front = self.front.certificate, self.front
        level, head = front_state(front)
        word = WORDS.get(c.kind, "Not proven")
        if not front.designs:
            word = "Not feasible, proven" if c.kind == "global" else "No design found, not proven"
        elif front.interrupted:
            word = "Stopped"
        details = front_details(front)
        amounts = c.amounts()
        sentence = (details[0].partition(": ")[2] or details[0]).replace(amounts, "")
        if amounts:
            details.append(as_sentence(amounts.strip(" ()")))
        return {
            "level": level,
            "word": word,
            "sentence": sentence[:1].upper() + sentence[1:],
            "head": head,
            "gap": c.gap,
            "details": details[1:],
            "combinations": c.combinations,
            "excluded": c.excluded_by_bound,
            "solved": c.solved,
            "unresolved": c.unresolved,
            "offered": self._offered(),
            "not_part": self._not_part(),
        }

    def _offered(self) -> list[str]:
        """Number of rows offered to each slot, and of those that may be used here."""
        statistics = self.front.statistics
        offered, used = statistics.get("rows_offered") or {}, statistics.get("rows_used") or {}
        return [
            f"{label(slot)}: {count} rows of tables offered, {used.get(slot, count)} of them fit the task"
            for slot, count in offered.items()
        ]

    def _not_part(self) -> list[str]:
        """Parts of the question that the certificate does not cover."""
        notes = [NOT_COVERED]
        marked = sorted({f"{row} ({row['table']})" for row in self._rows() if row.get("confidence") != "verified"})
        if marked:
            notes.append("Rows of tables used here that are not marked verified: " + ", ".join(marked) + ".")
        unchecked = sorted({text for d in self.front.designs for text in d.not_checked})
        notes += [f"Not checked: {text}" for text in unchecked[:6]]
        if self.frame.not_asked:
            notes.append("Not asked: " + ", ".join(map(label, self.frame.not_asked)) + ".")
        return notes

    def nothing(self) -> dict[str, Any] | None:
        """Reason why there is no design; None where there is one."""
        explanation = self.front.explanation
        if self.front.designs or not explanation:
            return None
        conflicts = []
        for miss in explanation.conflicts or ():
            unit = str(miss.unit or "-")
            sides = [number(x, unit) if isinstance(x, float) else None for x in (miss.value, miss.limit_value)]
            by = ""
            if isinstance(miss.value, float) and isinstance(miss.limit_value, float):
                by = miss_text(miss.value, miss.limit_value, unit)
            name = str(miss.limit)
            sign = SIGN_OF.get(self.frame.limit_senses.get(name, ""), "")
            conflicts.append(
                {"label": _compared(label(name)), "sides": sides, "unit": page_unit(unit), "sign": sign, "by": by}
            )
        nearest = {**(explanation.nearest or {}), **(explanation.parts or {})}
        return {
            "message": explanation.headline,
            "conflicts": conflicts,
            "nearest": [[label(name), str(value)] for name, value in nearest.items()],
        }

    # -- designs -------------------------------------------------------------------------------

    def _rows(self) -> Iterable[Any]:
        return (row for design in self.front.designs for row in design.parts.values())

    def parts(self) -> dict[str, dict[str, str]]:
        """Return the rows of tables that fill slots, by table and designation."""
        return {
            f"{row['table']}/{row}": {
                "name": str(row),
                "table": str(row["table"]),
                "source": str(row.get("source") or ""),
                "confidence": str(row.get("confidence") or ""),
                "note": str(row.get("note") or ""),
            }
            for row in self._rows()
        }

    def design(
        self, d: Design, prices: Sequence[Mapping[str, Any]], files: Mapping[str, str], drawings: Mapping[int, str]
    ) -> dict[str, Any]:
        """Return one design."""
        limits = list(self.frame.limit_units)
        reason = why(self.front, d)
        entry: dict[str, Any] = {
            "rank": d.rank,
            "score": _rounded(d.score),
            "status": d.status.value,
            "gap": d.gap,
            "note": d.note,
            "why": label(reason[:1].upper() + reason[1:] + "."),
            "v": [number(d.values.get(name, math.nan), self.frame.units[name]) for name in self.names],
            "choices": dict(d.choices),
            "parts": {slot: f"{row['table']}/{row}" for slot, row in d.parts.items()},
            "used": [_rounded(d.utilisation.get(name)) for name in limits],
            "sides": [[number(x, self.frame.limit_units[name]) for x in d.limits[name]] for name in limits],
            "spec": d.to_spec()["values"],
            "at_limit": reached_limits(d),
        }
        more: dict[str, Any] = {
            "slopes": self._slopes(d),
            "prices": [str(p["sentence"]) for p in prices if p.get("design") == d.rank and _matters(p)],
            "remarks": [*d.advice, *d.not_checked],
            "alternatives": list(d.alternatives),
            "group": d.group,
            "near": near_ones(d.rank, ((x.rank, x.group) for x in self.front.designs)),
            "violated": list(d.violated),
            "off_grid": dict(d.off_grid),
            "next": [[label(name), str(row)] for name, row in d.next_rows.items()],
            "robust": self._robust(d),
            "files": [list(pair) for pair in files.items()],
            "drawing": drawings.get(d.rank or 0, ""),
        }
        return entry | {key: value for key, value in more.items() if value}

    def picture(self, drawing: Drawing) -> str:
        """Return a drawing as SVG."""
        return svg_of(drawing, self.frame.title, program_name(self.front), self.about)

    def _slopes(self, d: Design) -> list[list[Any]]:
        """Return requirements and limits with what 1 % more of them changes in each objective, in per cent."""
        names = {name for slopes in d.elasticity.values() for name in slopes}
        rows = [(n, [_rounded(d.elasticity.get(o, {}).get(n)) for o in self.frame.objectives]) for n in names]
        sized = [(max((abs(x) for x in row if x is not None), default=0.0), name, row) for name, row in rows]
        sized = sorted((x for x in sized if x[0] > LEAST_SLOPE), key=lambda x: (-x[0], x[1]))
        return [[label(name), row] for _, name, row in sized[:SLOPES]]

    def _robust(self, d: Design) -> dict[str, Any]:
        rating = d.robust
        if not rating:
            return {}
        share = rating.share_good
        return {
            "verdict": rating.verdict,
            "yield": yield_percent(share) if isinstance(share, float) else None,
            "words": over_range_in_words(d),
        }


def _matters(price: Mapping[str, Any]) -> bool:
    return price.get("status") != "no influence"


def label(name: str) -> str:
    """Return a name as words."""
    return name.replace("_", " ")


def page_unit(unit: str) -> str:
    """Return a unit as pages write it: ``N·m`` for ``N*m``."""
    return unit_text(unit).replace(" ", "·")


def _of(q: NamedQuantity | None, field: str) -> str:
    return "" if q is None else str(getattr(q, field) or "")


def number(si: float, unit: str) -> float | None:
    """Return a number in a unit, with as many digits as the record has."""
    return _rounded(finite_from_si(si, unit, None))


def _rounded(x: float | None) -> float | None:
    return None if x is None or not math.isfinite(x) else float(f"{x:.{DIGITS}g}")


def _in_words(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_in_words(inner)}" for key, inner in value.items())
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_in_words, value))
    return f"{typed_number(value)}" if isinstance(value, float) else _compared(str(value))


def _compared(text: str) -> str:
    return text.replace("<=", "≤").replace(">=", "≥")
