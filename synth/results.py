"""Results: designs and fronts, immutable, and the files they are saved to."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from synth.errors import InputError
from synth.feasibility import Status
from synth.rated import COLUMNS, limits_table, rating_row
from synth.units import format_quantity, from_si, header

if TYPE_CHECKING:
    import pandas as pd

    from synth.verify import Verification

FORMAT = 1
RECORDED_PACKAGES = ("clutchsynth", "casadi", "numpy", "scipy", "moocore")


class PartRow(Mapping[str, Any]):
    """One catalogue row that fills a slot: designation, columns in SI, source, confidence, table.

    ``str()`` is the designation.
    """

    def __init__(self, table: str, digest: str, columns: Mapping[str, Any]) -> None:
        self._columns = {**columns, "table": table, "hash": digest}

    def __getitem__(self, key: str) -> Any:
        return self._columns[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __str__(self) -> str:
        return str(self._columns["designation"])

    def __repr__(self) -> str:
        return f"PartRow({self._columns['table']}: {self})"


@dataclass(frozen=True)
class Frame:
    """What the designs of one front share: how to show them and how to state them again.

    ``restated`` holds what a DESIGN.yaml must repeat so that a check sees the same question: limits, catalogs.
    """

    family: str
    title: str
    options: Mapping[str, str]
    requirements: Mapping[str, str]
    requirement_values: Mapping[str, float]
    not_asked: tuple[str, ...]
    objectives: Mapping[str, str]
    units: Mapping[str, str]
    kinds: Mapping[str, str]
    limit_units: Mapping[str, str]
    limit_senses: Mapping[str, str]
    restated: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Design:
    """One evaluated design.

    ``values`` holds every variable, count and derived quantity in SI (not-a-number where it does not
    exist), ``utilisation`` every limit (None where it is void), ``limits`` both sides of it in SI. ``robust`` tells,
    where that was asked, how the design stands what scatters: ``holds``, ``proof``, ``yield`` with ``yield_low`` and
    ``yield_high``, ``worst_limit``, and per limit its worst point.
    """

    frame: Frame
    values: Mapping[str, float]
    parts: Mapping[str, PartRow]
    choices: Mapping[str, str]
    objectives: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    residuals: Mapping[str, float]
    utilisation: Mapping[str, float | None]
    status: Status
    elasticity: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    gap: float | None = None
    rank: int | None = None
    score: float | None = None
    note: str = ""
    alternatives: tuple[str, ...] = ()
    off_grid: Mapping[str, str] = field(default_factory=dict)
    advice: tuple[str, ...] = ()
    violated: tuple[str, ...] = ()
    not_checked: tuple[str, ...] = ()
    robust: Mapping[str, Any] = field(default_factory=dict)

    def to_spec(self) -> dict[str, Any]:
        """Return the design as a DESIGN.yaml mapping: strings with units that read back exactly."""
        frame = self.frame
        named = [n for n, kind in frame.kinds.items() if kind in ("variable", "count")]
        values: dict[str, str] = {n: format_quantity(self.values[n], frame.units[n], None) for n in named}
        values.update(self.choices)
        spec: dict[str, Any] = {"family": frame.family}
        if frame.options:
            spec["options"] = dict(frame.options)
        spec["requirements"] = dict(frame.requirements)
        spec.update(frame.restated)
        spec["values"] = values
        spec["parts"] = {slot: str(row) for slot, row in self.parts.items()}
        return spec

    def yaml(self) -> str:
        """Return the text of a DESIGN.yaml."""
        text: str = yaml.safe_dump(self.to_spec(), sort_keys=False, allow_unicode=True, width=120)
        return text

    def _as_json(self) -> dict[str, Any]:
        return {
            "rank": self.rank,
            "score": self.score,
            "status": self.status.value,
            "gap": self.gap,
            "note": self.note,
            "alternatives": list(self.alternatives),
            "objectives": _clean(self.objectives),
            "values": _clean(self.values),
            "choices": dict(self.choices),
            "parts": {slot: f"{row['table']}/{row}" for slot, row in self.parts.items()},
            "limits": {n: [_finite(v), _finite(x)] for n, (v, x) in self.limits.items()},
            "residuals": _clean(self.residuals),
            "utilisation": {n: None if u is None else _finite(u) for n, u in self.utilisation.items()},
            "elasticity": {o: _clean(e) for o, e in self.elasticity.items()},
            "off_grid": dict(self.off_grid),
            "advice": list(self.advice),
            "violated": list(self.violated),
            "not_checked": list(self.not_checked),
            **({"robust": _plain(self.robust)} if self.robust else {}),
        }


@dataclass(frozen=True)
class Certificate:
    """How far a front is proven.

    ``kind`` is ``global`` (valid bounds prove the gap), ``exhaustive`` (every combination that no valid
    bound excludes was solved from several starts) or ``heuristic``.
    """

    kind: str
    gap: float | None
    combinations: int
    excluded_by_bound: int
    solved: int
    unresolved: int = 0

    def sentence(self) -> str:
        """Return the certificate in words."""
        n = f"{self.combinations:,}".replace(",", " ")
        if self.kind == "global" and self.gap is None:
            return f"proven: none of the {n} combinations of parts and counts can meet the requirements"
        if self.kind == "global":
            return (
                f"proven: over all {n} combinations of parts and counts no design improves one listed here "
                f"by more than {100 * (self.gap or 0):.3g} % in every objective"
            )
        if self.kind == "exhaustive":
            return (
                f"exhaustive: of {n} combinations {self.excluded_by_bound} are excluded by bounds; every other one "
                f"was solved from several starts ({self.unresolved} boxes could not be closed by bounds)"
            )
        return f"not proven: stopped before all of {n} combinations were covered; gap {_percent(self.gap)}"


@dataclass(frozen=True)
class ParetoFront:
    """The ranked non-dominated designs for one requirement.

    ``question`` is the instance it answers, ``record`` and ``folder`` what it was read from: of these three a front
    that was just computed has the first, one that was loaded the others.
    """

    frame: Frame
    designs: list[Design]
    status: Status
    complete: bool
    statistics: Mapping[str, Any]
    certificate: Certificate
    explanation: Mapping[str, Any] | None
    settings: Mapping[str, Any]
    interrupted: str = ""
    question: Any = field(default=None, repr=False, compare=False)
    record: Mapping[str, Any] | None = field(default=None, repr=False, compare=False)
    folder: Path | None = field(default=None, repr=False, compare=False)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers."""
        import pandas as pd  # costly to import; most runs write CSV only

        columns, rows = self._table()
        frame = pd.DataFrame(rows, columns=columns)
        return frame.set_index("rank", drop=False).rename_axis(None) if len(frame) else frame

    def save(self, folder: str | Path) -> Path:
        """Write designs.csv, front.json and one design_NN.yaml per design; return the folder.

        Every file is written beside its place and then renamed, so nothing half-written is ever seen.
        """
        return save_files(folder, self.files())

    def files(self) -> dict[str, str]:
        """Return what ``save`` writes: file name -> text."""
        width = max(2, len(str(len(self.designs))))
        found = {"designs.csv": self._csv(), "front.json": self._json()}
        if any(design.robust for design in self.designs):
            found["robust.csv"] = csv_text(*limits_table(self.designs))
        for design in self.designs:
            found[f"design_{design.rank:0{width}d}.yaml"] = design.yaml()
        return found

    def verify(self, problem: Any = None, catalogs: Any = None, time_limit: float = 120.0) -> Verification:
        """Check the front without help of the search: the record, every design, and the claim of the certificate.

        Parameters
        ----------
        problem : family name, DesignProblem subclass or instance, optional
            For a loaded front of a problem of your own.
        catalogs : folder or mapping, optional
            Own tables that were in memory; those that were files are read again.
        time_limit : float
            Seconds for the proof.

        Returns
        -------
        Verification
            ``holds``, ``findings``, ``proven_gap`` and a ``sentence()``.

        Raises
        ------
        InputError
            When the problem or its tables cannot be had.
        """
        from synth.verify import verify  # most runs do not need it

        return verify(self, problem, catalogs, time_limit)

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        first = self.designs[0] if self.designs else None
        columns = ["rank", "score", "status", "gap", "note", "alternatives"]
        columns += design_columns(self.frame, first.choices if first else (), first.parts if first else ())
        rows: list[list[Any]] = [
            [d.rank, d.score, d.status.value, d.gap, d.note, "; ".join(d.alternatives), *design_row(self.frame, d)]
            for d in self.designs
        ]
        if any(d.robust for d in self.designs):
            columns += COLUMNS
            rows = [[*row, *rating_row(d)] for row, d in zip(rows, self.designs, strict=True)]
        return columns, rows

    def _csv(self) -> str:
        return csv_text(*self._table())

    def _json(self) -> str:
        rows: dict[str, dict[str, Any]] = {}
        for design in self.designs:
            for row in design.parts.values():
                rows.setdefault(f"{row['table']}/{row}", {k: _finite(v) for k, v in row.items()})
        frame = self.frame
        content = {
            "format": FORMAT,
            "family": frame.family,
            "title": frame.title,
            "options": dict(frame.options),
            "requirements": dict(frame.requirements),
            "requirement_values_si": dict(frame.requirement_values),
            "not_asked": list(frame.not_asked),
            "objectives": dict(frame.objectives),
            "units": dict(frame.units),
            "kinds": dict(frame.kinds),
            "limit_units": dict(frame.limit_units),
            "limit_senses": dict(frame.limit_senses),
            "restated": _plain(frame.restated),
            "settings": dict(self.settings),
            "versions": installed_versions(),
            "status": self.status.value,
            "interrupted": self.interrupted,
            "complete": self.complete,
            "certificate": self.certificate.__dict__ | {"gap": _finite(self.certificate.gap)},
            "statistics": _plain(self.statistics),
            "explanation": _plain(self.explanation),
            "parts": rows,
            "designs": [d._as_json() for d in self.designs],
        }
        content["digest"] = self.digest_of(content)
        return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"

    @staticmethod
    def digest_of(content: Mapping[str, Any]) -> str:
        """Return the SHA-256 of the content of a front.json, without regard to the order of its keys."""
        text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
        return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def load_front(folder: str | Path) -> ParetoFront:
    """Rebuild a front from the files that ``save`` wrote.

    Parameters
    ----------
    folder : path
        The folder, or its front.json.

    Raises
    ------
    InputError
        When there is no front, or it is of another format.
    """
    path = Path(folder)
    path = path / "front.json" if path.is_dir() else path
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError) as error:
        raise InputError("front", str(path), f"a front.json that clutchsynth wrote ({error})") from error
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(
            f"front {path}", content.get("format") if isinstance(content, dict) else None, f"format {FORMAT}"
        )
    return front_of_record(content, path)


def front_of_record(content: dict[str, Any], path: Path) -> ParetoFront:
    """Rebuild a front from the content of its front.json.

    Parameters
    ----------
    content : dict
    path : Path
        Where it stands, for messages.

    Raises
    ------
    InputError
        When it is not complete.
    """
    try:
        return _front_from_json(content, path.parent)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"front {path}", str(error), "a front.json that is complete") from error


def _front_from_json(content: dict[str, Any], folder: Path) -> ParetoFront:
    frame = Frame(
        family=content["family"],
        title=content["title"],
        options=content["options"],
        requirements=content["requirements"],
        requirement_values=content["requirement_values_si"],
        not_asked=tuple(content["not_asked"]),
        objectives=content["objectives"],
        units=content["units"],
        kinds=content["kinds"],
        limit_units=content["limit_units"],
        limit_senses=content["limit_senses"],
        restated=dict(content["restated"]),
    )
    rows = content["parts"]
    designs = [_design_from_json(frame, d, rows) for d in content["designs"]]
    return ParetoFront(
        frame=frame,
        designs=designs,
        status=Status(content["status"]),
        complete=content["complete"],
        statistics=content["statistics"],
        certificate=Certificate(**content["certificate"]),
        explanation=content["explanation"],
        settings=content["settings"],
        interrupted=content["interrupted"],
        record=content,
        folder=folder,
    )


def _design_from_json(frame: Frame, d: dict[str, Any], rows: dict[str, dict[str, Any]]) -> Design:
    parts = {}
    for slot, key in d["parts"].items():
        row = rows[key]
        parts[slot] = PartRow(row["table"], row["hash"], {k: v for k, v in row.items() if k not in ("table", "hash")})
    return Design(
        frame=frame,
        values={n: _number(v) for n, v in d["values"].items()},
        parts=parts,
        choices=d["choices"],
        objectives={n: _number(v) for n, v in d["objectives"].items()},
        limits={n: (_number(v), _number(x)) for n, (v, x) in d["limits"].items()},
        residuals={n: _number(v) for n, v in d["residuals"].items()},
        utilisation={n: None if u is None else float(u) for n, u in d["utilisation"].items()},
        status=Status(d["status"]),
        elasticity={o: {n: _number(v) for n, v in e.items()} for o, e in d["elasticity"].items()},
        gap=d["gap"],
        rank=d["rank"],
        score=d["score"],
        note=d["note"],
        alternatives=tuple(d["alternatives"]),
        off_grid=d["off_grid"],
        advice=tuple(d["advice"]),
        violated=tuple(d["violated"]),
        not_checked=tuple(d["not_checked"]),
        robust=d.get("robust", {}),
    )


def _order(frame: Frame) -> tuple[list[str], list[str]]:
    """Return the quantities that stand before choices and parts, and those that stand behind."""
    early = [n for n, kind in frame.kinds.items() if n not in frame.objectives and kind in ("variable", "count")]
    early.sort(key=lambda n: frame.kinds[n] != "variable")
    late = [n for n, kind in frame.kinds.items() if n not in frame.objectives and kind == "derived"]
    return [*frame.objectives, *early], late


def design_columns(frame: Frame, choices: Iterable[str], slots: Iterable[str]) -> list[str]:
    """Return headers of what tables say of a design: objectives, sizes, choices, parts, derived, utilisation."""
    early, late = _order(frame)
    columns = [header(n, frame.units[n]) for n in early] + [*choices] + [*slots]
    return columns + [header(n, frame.units[n]) for n in late] + [f"utilisation: {n}" for n in frame.limit_units]


def design_row(frame: Frame, design: Design) -> list[Any]:
    """Return what belongs under ``design_columns``; None where there is no value."""
    early, late = _order(frame)
    row: list[Any] = [shown_value(design.values[n], frame.units[n]) for n in early]
    row += [*design.choices.values(), *(str(part) for part in design.parts.values())]
    row += [shown_value(design.values[n], frame.units[n]) for n in late]
    return row + [design.utilisation.get(n) for n in frame.limit_units]


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table as CSV in full precision; nothing stands where there is no value."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if cell is None else repr(cell) if isinstance(cell, float) else cell for cell in row])
    return buffer.getvalue()


def save_files(folder: str | Path, files: Mapping[str, str]) -> Path:
    """Write the files of a result and take away designs of an earlier one; return the folder.

    Every file is written beside its place and then renamed, so nothing half-written is ever seen.
    """
    target = Path(folder)
    if target.exists() and not target.is_dir():
        raise InputError("output", str(folder), "a folder; this is a file")
    try:
        target.mkdir(parents=True, exist_ok=True)
        for stale in [*target.glob("design_*.yaml"), target / "robust.csv"]:
            if stale.name not in files:
                stale.unlink(missing_ok=True)
        for name, text in files.items():
            write_atomically(target / name, text)
    except OSError as error:
        raise InputError("output", str(folder), f"a folder that can be written ({error.strerror})") from error
    return target


def write_atomically(path: Path, text: str) -> None:
    """Write a text file so that it is either the old one or the whole new one."""
    temporary = path.with_name(f".{path.name}.{hashlib.sha256(str(path).encode()).hexdigest()[:8]}.tmp")
    try:
        temporary.write_text(text, encoding="utf-8", newline="")
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def installed_versions() -> dict[str, str]:
    """Return the versions of the packages that decide the numbers."""
    result = {}
    for name in RECORDED_PACKAGES:
        try:
            result[name] = version(name)
        except PackageNotFoundError:
            result[name] = "not installed"
    return result


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def shown_value(value: float, unit: str) -> float | None:
    """Return an SI value in the unit of its column; None where it does not exist."""
    return float(from_si(value, unit)) if math.isfinite(value) else None


def _finite(value: Any) -> Any:
    if isinstance(value, float) and math.isinf(value):
        return "inf" if value > 0 else "-inf"  # JSON has no infinity; float() reads these words back
    return None if isinstance(value, float) and math.isnan(value) else value


def _clean(mapping: Mapping[str, Any]) -> dict[str, Any]:
    return {k: _finite(float(v)) for k, v in mapping.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return _finite(value)


def _percent(gap: float | None) -> str:
    return "unknown" if gap is None or not math.isfinite(gap) else f"{100 * gap:.3g} %"
