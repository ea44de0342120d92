"""Reports: what stands in the folder of a front is gathered, and the reports that are installed make files of it."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from synth.analysis.calculation import calculation, calculation_of
from synth.analysis.drawing import drawings_of
from synth.analysis.restate import kept_tables, question_of, table_differences
from synth.drawing import Drawing
from synth.errors import ExtraNeededError, InputError, first_with_others
from synth.folders.csv_style import unstyled
from synth.folders.files import read_bytes, read_json
from synth.folders.output_folder import save_files
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.order.feasibility import Status
from synth.order.pareto import KNEE, knee_of
from synth.question.arguments import Family, UserTables
from synth.question.catalogs import as_catalogs
from synth.question.instance import Instance
from synth.results import Design, ParetoFront, design_columns, design_row, foremost, named_designs
from synth.results.calculation import Calculation
from synth.results.drawings import report as report_named
from synth.results.front_record import FRONT_FILE, result_digest
from synth.results.hookspecs import Made
from synth.results.loading import COMPARISON, load_front
from synth.results.notebook import NotebookFrame
from synth.results.offered import Offered
from synth.results.report_request import AboutSource, ComparisonRequest, ReportOptions, ReportRequest
from synth.robust.counterpart import nominal
from synth.text.plain_text import csv_cell

CURVES = ("*.svg",)
PLAIN = ReportOptions()
DRAWN = 8  # designs whose drawings the explorer has, the first by rank
Hook = TypeVar("Hook")


@dataclass(frozen=True)
class WrittenReport:
    """A report that stands in a folder.

    Parameters
    ----------
    folder : Path
    files : list of str
        Their names.
    notes : list of str
        What else is to be told.
    feasible : bool
        Whether there are designs, and a single one keeps its limits.
    lacking : sequence of ExtraNeededError
        Why formats that were asked for are not among the files.
    """

    folder: Path
    files: Sequence[str]
    notes: Sequence[str]
    feasible: bool
    lacking: Sequence[ExtraNeededError] = ()

    def complete(self) -> Path:
        """Folder of a report that has every requested file.

        Raises
        ------
        InputError
            An extra is not installed; what can be made without it is written.
        """
        if self.lacking:
            raise first_with_others(self.lacking)
        return self.folder


def installed(hook: Hook | None, verb: str) -> Hook:
    """Hook of the reports.

    Raises
    ------
    InputError
        They are not installed; ``verb`` is what needs them.
    """
    if hook is None:
        raise InputError(verb, None, "the package reports, which clutchsynth is installed with")
    return hook


def write_report(
    folder: Path,
    files: Mapping[str, str | bytes],
    notes: Sequence[str],
    feasible: bool,
    lacking: Sequence[ExtraNeededError],
) -> WrittenReport:
    """Write the files of a report that can be made here; arguments as for :class:`WrittenReport`.

    Raises
    ------
    InputError
        All lack an extra, or the folder cannot be written; then nothing is written.
    """
    if lacking and not files:
        raise first_with_others(lacking)
    save_files(folder, files)
    return WrittenReport(folder, list(files), list(notes), feasible, tuple(lacking))


def report(
    front: ParetoFront,
    folder: str | Path,
    how: ReportOptions = PLAIN,
    *,
    design: int | str | Sequence[int | str] = 1,
    full: int = 5,
    problem: Family | None = None,
    catalogs: UserTables = None,
) -> WrittenReport:
    """Write the report of a front, and calculation sheets of some of its designs.

    Parameters
    ----------
    front : ParetoFront
    folder : path
    how : ReportOptions
    design : int, str or list of these
        Designs that get sheets: ranks, or ``knee``.
    full : int
        Designs that the front report tells in full.
    problem, catalogs : optional
        For a loaded front of a problem of one's own, and own tables that were in memory.

    Returns
    -------
    WrittenReport
        Formats whose extra is not installed are left out of it, and told.

    Raises
    ------
    InputError
        Something asked is wrong, or no format that is asked for can be made; then nothing is written.
    """
    place = Path(folder)
    _refuse_another_front(front, place)
    chosen = list(design) if isinstance(design, (list, tuple)) else [design]
    files, notes, lacking = _of_front(front, chosen, full, how, place, problem, catalogs)
    return write_report(place, files, notes, bool(front.designs), lacking)


def explore(
    front: ParetoFront,
    height: int = 760,
    *,
    about: AboutSource = None,
    problem: Family | None = None,
    catalogs: UserTables = None,
) -> NotebookFrame:
    """Return the explorer of a front as a frame for a notebook; arguments as for :func:`report`.

    Raises
    ------
    InputError
        The formulas of a loaded front cannot be read, or reports are not installed.
    """
    frame = installed(report_named("explorer_frame"), "explore")
    return NotebookFrame(frame(explored(front, about=about, problem=problem, catalogs=catalogs), height))


def explored(
    front: ParetoFront,
    *,
    about: AboutSource = None,
    problem: Family | None = None,
    catalogs: UserTables = None,
    drawn: int = DRAWN,
) -> dict[str, Any]:
    """Explorer record of a front, as JSON holds it; arguments as for :func:`report`.

    ``drawn``: designs, from the first by rank, whose drawings it holds.

    Raises
    ------
    InputError
        The formulas of a loaded front cannot be read, or reports are not installed.
    """
    record = installed(report_named("explorer_record"), "explore")
    read = _calculation(front, problem, catalogs)
    pictures, _ = _drawings(front, read, front.designs[:drawn], problem)
    how = ReportOptions.read(about=about)
    return record(ReportRequest(calculation=read, front=front, how=how, drawings=pictures, **_related_results(front)))


def explored_comparison(source: Path, about: AboutSource = None) -> dict[str, Any]:
    """Explorer record of the common front of several families, as JSON holds it.

    Raises
    ------
    InputError
        The comparison cannot be read, or reports are not installed.
    """
    record = installed(report_named("explorer_comparison"), "explore")
    content, _, fronts = _compared(source)
    return record(_explored(ComparisonRequest(content=content, fronts=fronts, how=ReportOptions.read(about=about))))


def _explored(request: ComparisonRequest) -> ComparisonRequest:
    """Request with what the explorer needs: calculations, and drawings of the first designs by rank."""
    calculations = {family: calculation(front) for family, front in request.fronts.items()}
    drawings: dict[int, Drawing] = {}
    for family, front in request.fronts.items():
        ranks = {x["own_rank"]: int(x["rank"]) for x in request.content["designs"][:DRAWN] if x["family"] == family}
        drawn, _ = _drawings(front, calculations[family], [d for d in front.designs if d.rank in ranks])
        drawings |= {ranks[family_rank]: drawing for family_rank, drawing in drawn.items()}
    return replace(request, calculations=calculations, drawings=drawings)


def _of_front(
    front: ParetoFront,
    chosen: Sequence[Any],
    full: int,
    how: ReportOptions,
    place: Path,
    problem: Family | None = None,
    catalogs: UserTables = None,
) -> Made:
    """Return the files of the report of a front, which will stand in a place."""
    if full < 0 or full != int(full):
        raise InputError("full", full, "a whole number from 0", ("full",))
    read = _calculation(front, problem, catalogs)
    drawings, untold = _drawings(front, read, named_designs(front, chosen), problem, requested=_draws(how))
    shown = foremost(front, int(full)) if {"html", "pdf"} & set(how.formats) else []
    shown += front.designs[:DRAWN] if "explorer" in how.formats else ()
    more = {d.rank: d for d in shown if d.rank not in drawings}
    request = ReportRequest(
        calculation=read,
        front=front.placed(place),
        chosen=[str(x) for x in chosen],
        full=int(full),
        how=how,
        rows=_offered(front, problem, catalogs) if "xlsx" in how.formats else {},
        drawings=drawings | _drawings(front, read, list(more.values()), problem)[0],
        **_related_results(front),
    )
    files, notes, lacking = installed(report_named("files"), "report")(request)
    return files, [*notes, *untold, *_differences(front, read, problem, catalogs)], lacking


def _draws(how: ReportOptions) -> bool:
    """True if files of drawings are requested."""
    return bool({"svg", "dxf", "step", "glb"} & set(how.formats))


def _calculation(front: ParetoFront, problem: Family | None, catalogs: UserTables) -> Calculation:
    """Calculation of a front: the one that was saved with it, whatever is given, where there is one."""
    saved = "calculation" in front.kept
    return calculation(front) if saved else calculation(front, problem=problem, catalogs=catalogs if problem else None)


def _family(front: ParetoFront, read: Calculation, problem: Family | None) -> DesignProblem:
    """Family of a front, whose hooks need no trace: all options are stated, as its calculation has them.

    Raises
    ------
    InputError
        It is not installed.
    """
    if problem is None and front.question is not None:
        return nominal(front.question.problem)
    return load(front.frame.family, **read.options) if problem is None else load(problem)


def _differences(front: ParetoFront, read: Calculation, problem: Family | None, catalogs: UserTables) -> list[str]:
    """Remarks on tables that have changed; none without the family."""
    if front.question is not None:
        return []
    with suppress(InputError):
        _family(front, read, problem)
        tables = kept_tables(front) if catalogs is None else as_catalogs(catalogs)
        away, changed = table_differences(front, tables)
        return [*away, *changed]
    return []


def _drawings(
    front: ParetoFront,
    read: Calculation,
    designs: Sequence[Design],
    problem: Family | None = None,
    *,
    requested: bool = False,
) -> tuple[dict[int, Drawing], list[str]]:
    """Return drawings of some designs of a front by rank, and why there is none of others; none without the family."""
    try:
        family = _family(front, read, problem)
    except InputError as error:
        return {}, [f"no drawing: {error}"] if requested else []
    return drawings_of(family, designs, requested=requested)


def _refuse_another_front(front: ParetoFront, place: Path) -> None:
    """Refuse a folder that holds another front: its files would speak of two machines."""
    same_folder = front.folder is not None and Path(front.folder).resolve() == place.resolve()
    if not same_folder and (place / FRONT_FILE).is_file():
        there = read_json(place / FRONT_FILE, "output", "a folder for reports")
        if not isinstance(there, Mapping) or result_digest(there) != front.result_digest:
            raise InputError("output", str(place), "another folder: this one holds another front")


def report_design(
    design: Design, instance: Instance, folder: str | Path, how: ReportOptions = PLAIN, *, name: str = "design"
) -> WrittenReport:
    """Write the calculation sheet of one design that was checked; arguments and returns as for :func:`report`."""
    place = Path(folder)
    # The sheet of a front's design says how far the front is proven; this one must not take its place.
    name = f"{name}_checked" if (place / FRONT_FILE).is_file() else name
    drawings, untold = drawings_of(instance.problem, [design], requested=_draws(how))
    request = ReportRequest(
        calculation=calculation_of(instance),
        design=design.placed(place),
        name=name,
        how=how,
        rows=instance.offered() if "xlsx" in how.formats else {},
        drawings=drawings,
    )
    files, notes, lacking = installed(report_named("files"), "report")(request)
    return write_report(place, files, [*notes, *untold], design.status is not Status.INFEASIBLE, lacking)


def report_comparison(
    source: Path, folder: Path, how: ReportOptions = PLAIN, *, design: Sequence[str] = ("1",), full: int = 5
) -> WrittenReport:
    """Write the report of several families that were asked the same, and that of each family in a folder of its name.

    Arguments and returns as for :func:`report`; ranks and knee are those of the common front.

    Raises
    ------
    InputError
        As for :func:`report`, or the comparison cannot be read; then nothing is written.
    """
    content, places, fronts = _compared(source)
    listed = content["designs"]
    chosen = _chosen_of_all(listed, design)
    files: dict[str, str | bytes] = {}
    notes, links, lacking = list[str](), dict[str, str](), dict[str, ExtraNeededError]()
    for family, place in places.items():
        ranks = [x["own_rank"] for x in chosen if x["family"] == family]
        made, messages, lacks = _of_front(fronts[family], ranks, full, how, folder / place)
        lacking |= {error.extra: error for error in lacks}
        files |= {f"{place}/{name}": file for name, file in made.items()}
        notes += [note for note in messages if note not in notes]
        first = next((name for name in made if name.startswith(("report.", "explorer."))), "")
        links |= {family: f"{place}/{first}"}
    make = installed(report_named("comparison"), "report")
    request = ComparisonRequest(content=content, fronts=fronts, how=how, links=links)
    shared, messages, lacks = make(_explored(request) if "explorer" in how.formats else request)
    lacking |= {error.extra: error for error in lacks}
    notes += [note for note in messages if note not in notes]
    return write_report(folder, {**shared, **files}, notes, bool(listed), list(lacking.values()))


def _compared(source: Path) -> tuple[dict[str, Any], dict[str, str], dict[str, ParetoFront]]:
    """Return a comparison, whose designs have their rank in their family as well, folders and fronts by family."""
    right = "a comparison.json as clutchsynth has written it"
    content = read_json(source / COMPARISON, "comparison", right)
    try:
        places = {str(x["family"]): str(x["folder"]) for x in content["families"] if x["folder"]}
        fronts = {family: load_front(source / place) for family, place in places.items()}
        listed = [_listed(x, fronts) for x in content["designs"]]
    except (KeyError, TypeError) as error:
        where = f"comparison {source / COMPARISON}"
        raise InputError(where, str(error), f"{right}; this one is not complete") from error
    return {**content, "designs": listed}, places, fronts


def _listed(entry: Mapping[str, Any], fronts: Mapping[str, ParetoFront]) -> dict[str, Any]:
    """Return a design of a common front with the rank that it has in its family."""
    family, objectives = entry["family"], entry["objectives"]
    for design in fronts[family].designs:
        if all(design.values.get(name) == value for name, value in objectives.items()):
            return {**entry, "own_rank": design.rank}
    raise KeyError(f"design #{entry['rank']} of {family}")


def _chosen_of_all(listed: Sequence[Mapping[str, object]], words: Sequence[str]) -> list[Mapping[str, Any]]:
    """Return the designs of a common front that are named by rank, or as its knee."""
    if not listed and list(words) in (["1"], [KNEE]):
        return []
    known = {str(x["rank"]): x for x in listed}
    known |= {KNEE: listed[knee_of([str(x.get("note")) for x in listed])]} if listed else {}
    for word in words:
        if word not in known:
            right = f"a rank from 1 to {len(listed)} of the common front or knee" if listed else "a front with designs"
            raise InputError("design", word, right, ("design",))
    return list({known[word]["rank"]: known[word] for word in words}.values())


def _related_results(front: ParetoFront) -> dict[str, Any]:
    """Further results on a front, in its folder or in one below; nothing where it has none."""
    if front.folder is None:
        return {}
    folder = Path(front.folder)
    results: dict[str, Any] = {"curves": sorted(p.name for pattern in CURVES for p in folder.glob(pattern))}
    digest = front.result_digest
    for path in (folder / "prices.json", *sorted(folder.glob("*/prices.json"))):
        if path.is_file():
            content = read_json(path, "prices", "a prices.json as clutchsynth has written it")
            if isinstance(content, Mapping) and content.get("front") == digest:
                results["prices"] = [row for rows in dict(content.get("designs", {})).values() for row in rows]
                break
    near = [_near_of(path, front) for path in sorted(folder.glob("*/near_equals.csv"))]
    results["near_equals"] = [x for x in near if x]
    return results


def _near_of(path: Path, front: ParetoFront) -> dict[str, Any]:
    """Return near-equal designs with the rank of the design they are near; nothing where that is none of ours."""
    right = "a table as clutchsynth has written it"
    text = read_bytes(path, "near_equals", right).decode("utf-8", "replace")
    rows = list(csv.DictReader(unstyled(text).splitlines()))
    content = read_json(path.with_suffix(".json"), "near_equals", "a near_equals.json as clutchsynth has written it")
    if not rows or not isinstance(content, Mapping):
        return {}
    for design in front.designs:
        columns = design_columns(front.frame, design.choices, design.parts)
        cells = dict(zip(columns, design_row(front.frame, design), strict=True))
        if all(rows[0].get(column) == str(csv_cell(value)) for column, value in cells.items()):
            return {"rank": design.rank, "sentence": str(content.get("sentence", "")), "rows": rows[1:]}
    return {}


def _offered(front: ParetoFront, problem: Family | None, catalogs: UserTables) -> Offered:
    """Rows that slots offer; of a front that was saved without them the question is posed again where it can be."""
    if front.question is None and not front.kept.get("offered"):
        with suppress(InputError):
            return question_of(front, problem, catalogs, kept=True).offered()
    return front.offered()
