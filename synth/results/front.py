"""Fronts: immutable, with the tables and files that are made of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from synth.errors import InputError, derived
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, table_frame
from synth.folders.output_folder import FRONT, save_files, save_result
from synth.order.feasibility import Status
from synth.order.pareto import KNEE, Scale, knee_of
from synth.results.calculation import CALCULATION
from synth.results.certificate import Certificate
from synth.results.design import Design, Frame, PartRow, design_columns, design_row, lines_of, with_groups
from synth.results.door import door
from synth.results.drawings import front_picture, report
from synth.results.front_record import FRONT_FILE, FRONT_FORMAT, KEPT, design_record, record_text, result_digest
from synth.results.least_infeasible import LeastInfeasible
from synth.results.notebook import NotebookFrame, notebook_html
from synth.results.offered import OFFERED, Offered, load_offered, offered_content
from synth.results.plain import compact_json, digest_of, finite, plain
from synth.results.provenance import installed_versions
from synth.results.rating_tables import COLUMNS, limits_table, rating_row, robust_sentence
from synth.results.report_request import AboutSource, ReportOptions
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics

if TYPE_CHECKING:
    import pandas as pd

    from synth.results.verification import Verification


LEADING = 6  # columns of the table before those that say what a design is


@dataclass(frozen=True)
class ParetoFront:
    """The ranked non-dominated designs for one requirement.

    ``scale`` is what its designs are measured by where they are ranked (of two objectives or more), ``question`` the
    instance it answers, ``record`` and ``folder`` what it was read from: of these three a front
    that was just computed has the first, one that was loaded the others.
    """

    frame: Frame
    designs: list[Design]
    status: Status
    complete: bool
    statistics: SearchStatistics
    certificate: Certificate
    explanation: LeastInfeasible | None
    settings: SettingsRecord
    interrupted: str = ""
    scale: Scale | None = None
    question: Any = field(default=None, repr=False, compare=False)
    record: Mapping[str, Any] | None = field(default=None, repr=False, compare=False)
    folder: Path | None = field(default=None, repr=False, compare=False)

    @property
    def lines(self) -> list[Design]:
        """Return the designs that lists show: without those that are nearly the same as a better one."""
        return lines_of(self.designs)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers."""
        frame = table_frame(*self.table())
        return frame.set_index("rank", drop=False).rename_axis(None) if len(frame) else frame

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write designs.csv, front.json, design_NN.yaml, then calculation.json and offered.json; return the folder.

        The first are written all or none, before anything is derived from them: where the others cannot be made
        the front is kept, and a warning says so.

        A search that was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        if self.question is None:
            return save_result(folder, lambda place: csv.files(self.files(place)), FRONT, bool(self.interrupted))
        written = save_result(
            folder, lambda place: csv.files(self.record_files(folder=place)), FRONT, bool(self.interrupted)
        )
        if derived_files := self.derived_files(written):
            save_files(written, derived_files)
        return written

    def placed(self, folder: Path) -> ParetoFront:
        """Return the front with tables named from a folder, as files in it name them."""
        return replace(self, frame=self.frame.placed(folder), designs=[d.placed(folder) for d in self.designs])

    def files(self, folder: Path | None = None) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text; without those that cannot be derived, with a warning.

        Tables are named from the folder where the files will stand.

        Raises
        ------
        InputError
            The calculation of a front that was loaded cannot be read.
        """
        files = self.record_files(folder=folder) | self.derived_files(folder)
        first = {name: files.pop(name) for name in ("designs.csv", FRONT_FILE, CALCULATION, OFFERED) if name in files}
        return {**first, **files}

    def derived_files(self, folder: Path | None = None) -> dict[str, str]:
        """Calculation, rows offered, and the record that names both; without those that cannot be made, with a warning.

        Raises
        ------
        InputError
            A file of a front that was loaded cannot be read.
        """
        makers: dict[str, Callable[[], dict[str, Any]]] = {
            CALCULATION: lambda: door().calculation(self).content,
            OFFERED: lambda: offered_content(self.offered()),
        }
        if self.question is not None:
            made = {name: derived(name, make) for name, make in makers.items()}
        else:  # those that were saved before there were such files have none
            made = {name: make() for name, make in makers.items() if name.removesuffix(".json") in self.kept}
        available = {name: content for name, content in made.items() if content}
        digests = {name.removesuffix(".json"): str(content["digest"]) for name, content in available.items()}
        record = {FRONT_FILE: self.record_files(digests, folder)[FRONT_FILE]} if available else {}
        return {**record, **{name: compact_json(content) for name, content in available.items()}}

    @property
    def kept(self) -> dict[str, str]:
        """Digests of the files that were saved beside front.json, by their names without ending."""
        return {name: str(self.record[name]) for name in KEPT if self.record.get(name)} if self.record else {}

    def offered(self) -> Offered:
        """Rows that slots offer; of a front that was saved before they were kept, those of its designs.

        Raises
        ------
        InputError
            The file beside a front that was loaded is not the one that was saved with it.
        """
        if self.question is not None:
            rows: Offered = self.question.offered()
            return rows
        if self.folder is not None and "offered" in self.kept:
            return load_offered(self.folder, self.kept["offered"])
        used: dict[str, dict[str, PartRow]] = {}
        for design in self.designs:
            for slot, row in design.parts.items():
                used.setdefault(slot, {})[row.key] = row
        return {slot: list(rows.values()) for slot, rows in used.items()}

    def record_files(self, digests: Mapping[str, str] | None = None, folder: Path | None = None) -> dict[str, str]:
        """Return the files that follow from the record alone.

        ``digests`` are those of files beside it, by default as :attr:`kept`; ``folder`` is where they will stand, by
        default where the front was read from.
        """
        place = self.folder if folder is None else folder
        placed = self if place is None else self.placed(place)
        return placed._record_files(self.kept if digests is None else digests)

    def _record_files(self, digests: Mapping[str, str]) -> dict[str, str]:
        """Return the files with tables as they are named here."""
        width = max(2, len(str(len(self.designs))))
        files = {"designs.csv": self._csv(), FRONT_FILE: record_text(front_record(self, digests))}
        if any(design.robust for design in self.designs):
            files["robust.csv"] = csv_text(*limits_table(self.designs))
        for design in self.designs:
            files[f"design_{design.rank:0{width}d}.yaml"] = design.yaml()
        return files

    def verify(self, problem: object = None, catalogs: object = None, time_limit: float = 120.0) -> Verification:
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
        return door().verify(self, problem, catalogs, time_limit)

    def improve(
        self,
        time_limit: float | None = None,
        problem: object = None,
        catalogs: object = None,
        workers: int = 1,
        progress: Callable[[Mapping[str, object]], None] | None = None,
    ) -> ParetoFront:
        """Go on with the search from the designs of this front; the result is never worse.

        Parameters
        ----------
        time_limit : float, optional
            Seconds; by default the search goes on as long as one from the start would.
        problem : family name, DesignProblem subclass or instance, optional
            For a loaded front of a problem of your own.
        catalogs : folder or mapping, optional
            Own tables that were in memory; those that were files are read again.
        workers, progress
            As for ``synthesize``.

        Returns
        -------
        ParetoFront

        Raises
        ------
        InputError
            When the question cannot be posed again.
        """
        options = {"time_limit": time_limit, "workers": workers, "progress": progress}
        return door().improve(self, problem=problem, catalogs=catalogs, **options)

    def report(
        self,
        folder: str | Path,
        *,
        design: int | str | Sequence[int | str] = 1,
        full: int = 5,
        formats: Sequence[str] = ("html",),
        about: AboutSource = None,
        length: str = "normal",
        fonts: Sequence[str | Path] = (),
        problem: object = None,
        catalogs: object = None,
    ) -> Path:
        """Write report.html and the calculation sheets of some designs.

        Parameters
        ----------
        folder : path
        design : int, str or list of these
            Designs that get sheets: ranks, or ``knee``.
        full : int
            Designs that the report tells in full.
        formats : list of str
            Some of ``html``, ``explorer``, ``pdf``, ``xlsx``, ``json``.
        about : mapping, optional
            ``company``, ``project``, ``customer``, ``number``, ``title``, ``author``, ``checked_by``, ``revision``,
            ``date``, ``note``, ``logo`` (a file).
        length : {"summary", "normal", "full"}
            Of the sheets: without the steps, or with a list of symbols.
        fonts : list of path
            Folders of fonts for the PDF beside its own.
        problem, catalogs : optional
            For a loaded front of a problem of one's own, and own tables that were in memory.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            Something asked is wrong; then nothing is written. Or an extra is not installed: what can be made without
            it is written.
        """
        how = ReportOptions.read(formats, about, length, fonts)
        options = {"design": design, "full": full, "problem": problem, "catalogs": catalogs}
        return door().report(self, folder, how, **options).complete()

    def explore(
        self, height: int = 760, *, about: AboutSource = None, problem: object = None, catalogs: object = None
    ) -> NotebookFrame:
        """Show the front in a notebook, to be explored: charts, table and single designs linked.

        The frame holds all it shows and works without a network, also in a notebook that was exported.

        Parameters
        ----------
        height : int
            Of the frame, in pixels.
        about : mapping, optional
            ``title``, ``project`` and the like, as for :meth:`report`.
        problem, catalogs : optional
            For a loaded front of a problem of one's own, and own tables that were in memory.

        Raises
        ------
        InputError
            The formulas of a loaded front cannot be read, or reports are not installed.
        """
        return door().explore(self, height, about=about, problem=problem, catalogs=catalogs)

    @property
    def result_digest(self) -> str:
        """Checksum of the result alone: a search for the same with the same versions gives it again."""
        return result_digest(self.record or front_record(self))

    def svg(self) -> str:
        """Return the front drawn as an SVG file; nothing where it has no two designs or objectives."""
        proven = self.certificate.sentence()
        return front_picture(self.designs, self.frame.objectives, self.frame.title, proven, self.interrupted)

    def table(self) -> tuple[list[str], list[list[Any]]]:
        """Return headers with units, and one row per design; None where there is no value."""
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
        return with_groups(columns, rows, self.designs)

    def _repr_html_(self) -> str:
        """Show the front in a notebook: how far it is proven, its drawing, and the ranked designs."""
        draw = report("plot")
        columns, rows = self.table()
        shown = len(design_columns(self.frame, (), ())) - len(self.frame.limit_units)
        derived = sum(kind == "derived" and n not in self.frame.objectives for n, kind in self.frame.kinds.items())
        parts = len(self.designs[0].choices) + len(self.designs[0].parts) if self.designs else 0
        keep = [0, 1, *range(LEADING, LEADING + shown - derived + parts)]
        level = "bad" if not self.designs else "good" if self.certificate.kind == "global" else "open"
        count = "1 design" if len(self.designs) == 1 else f"{len(self.designs)} designs"
        return notebook_html(
            f"{self.frame.title}: {count}",
            [
                self.certificate.sentence(),
                self.interrupted and f"stopped: {self.interrupted}",
                robust_sentence(self.designs) if any(d.robust for d in self.designs) else "",
            ],
            [columns[k] for k in keep],
            [[row[k] for k in keep] for row in rows],
            level,
            draw(self, (), False) if draw is not None else "",
        )

    def _csv(self) -> str:
        return csv_text(*self.table())

    @staticmethod
    def digest_of(content: Mapping[str, object]) -> str:
        """Return the SHA-256 of the content of a front.json, without regard to the order of its keys."""
        return digest_of(content)


def front_record(front: ParetoFront, digests: Mapping[str, str] = MappingProxyType({})) -> dict[str, Any]:
    """Return the content of the front.json of a front; ``digests`` are those of files beside it."""
    rows: dict[str, dict[str, Any]] = {}
    for design in front.designs:
        for row in (*design.parts.values(), *design.rows):
            rows.setdefault(row.key, row.record())
    frame = front.frame
    content = {
        "format": FRONT_FORMAT,
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
        "restated": plain(frame.restated),
        **({"headline": list(frame.headline)} if frame.headline else {}),
        **({"sized_by": frame.sized_by} if frame.sized_by else {}),
        **({"tables": dict(frame.tables)} if frame.tables else {}),
        "settings": plain(front.settings),
        "versions": installed_versions(),
        "status": front.status.value,
        "interrupted": front.interrupted,
        "complete": front.complete,
        "certificate": front.certificate.__dict__ | {"gap": finite(front.certificate.gap)},
        "statistics": plain(front.statistics),
        "explanation": plain(front.explanation),
        "parts": rows,
        **({"scale": front.scale.as_record(frame.objectives)} if front.scale is not None else {}),
        **digests,
        "designs": [design_record(d) for d in front.designs],
    }
    content["result"] = result_digest(content)
    content["digest"] = digest_of(content)
    return content


def named_designs(front: ParetoFront, words: Iterable[Any]) -> list[Design]:
    """Return the designs of a front that are named by rank, or as its knee; each once.

    Of a front without designs the first and the knee are none.

    Raises
    ------
    InputError
        There is no such design.
    """
    names = [str(word).strip() for word in words]
    known = {str(d.rank): d for d in front.designs}
    if known:
        known[KNEE] = front.designs[knee_of([d.note for d in front.designs])]
    elif names in (["1"], [KNEE]):
        return []
    for name in names:
        if name not in known:
            right = f"a rank from 1 to {len(front.designs)}, or {KNEE}" if known else "a front with designs"
            raise InputError("design", name, right, ("design",))
    return list({known[name].rank: known[name] for name in names}.values())


def foremost(front: ParetoFront, count: int) -> list[Design]:
    """Designs by importance: rank 1, the knee, the best of each objective, then by rank."""
    first = list(front.designs[:1]) + [d for d in front.designs if KNEE in d.note]
    for name, sense in front.frame.objectives.items():
        if front.designs:
            sign = 1 if sense == "min" else -1
            first.append(min(front.designs, key=lambda d: (sign * d.objectives[name], d.rank or 0)))
    unique = list({d.rank: d for d in (*first, *front.designs)}.values())[:count]
    return sorted(unique, key=lambda d: d.rank or 0)
