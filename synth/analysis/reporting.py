"""Reports: what stands in the folder of a front is gathered, and the reports that are installed make files of it."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from synth.analysis.calculation import calculation, calculation_of
from synth.analysis.designs import part_row
from synth.analysis.restate import question_of
from synth.errors import InputError
from synth.files import read_json, read_text
from synth.output_folder import REPORT_FILES, save_files
from synth.plain_text import csv_cell
from synth.question.instance import Instance
from synth.results import Design, ParetoFront, design_columns, design_row
from synth.results.drawings import report as report_named
from synth.results.loading import COMPARISON, load_front

FORMATS = ("html", "pdf", "xlsx", "json")
CURVES = ("*.svg",)


def report(
    front: ParetoFront,
    folder: str | Path,
    *,
    design: Any = 1,
    full: int = 5,
    formats: Sequence[str] = ("html",),
    about: Any = None,
    length: str = "normal",
    fonts: Sequence[str | Path] = (),
    problem: Any = None,
    catalogs: Any = None,
    about_folder: Path | None = None,
) -> tuple[Path, list[str], list[str]]:
    """Write the report of a front, and calculation sheets of some of its designs.

    Parameters
    ----------
    front : ParetoFront
    folder : path
    design : int, str or list of these
        Designs that get sheets: ranks, or ``knee``.
    full : int
        Designs that the front report tells in full.
    formats : list of str
        Some of ``html``, ``pdf``, ``xlsx``, ``json``.
    about : mapping, optional
        Project, customer, number, author, date, ...
    length : {"summary", "normal", "full"}
        Of the sheets.
    fonts : list of path
        Folders of fonts for the PDF beside its own.
    problem, catalogs : optional
        For a loaded front of a problem of one's own, and own tables that were in memory.
    about_folder : Path, optional
        Where a logo is looked for.

    Returns
    -------
    tuple
        The folder, the names of the files, and what else is to be told.

    Raises
    ------
    InputError
        Something asked is wrong, or an extra is not installed; then nothing is written.
    """
    place = Path(folder)
    if full < 0 or full != int(full):
        raise InputError("full", full, "a whole number from 0", ("full",))
    asked: dict[str, Any] = {
        "calculation": calculation_of(question_of(front, problem, catalogs)) if problem else calculation(front),
        "front": front,
        "chosen": [str(x) for x in (design if isinstance(design, (list, tuple)) else [design])],
        "full": int(full),
    }
    if "xlsx" in formats:
        asked["rows"] = _offered(front, problem, catalogs)
    if front.folder is not None:
        asked |= _beside(Path(front.folder), front)
    own = front.folder is not None and Path(front.folder).resolve() == place.resolve()
    return _written(asked, place, formats, about, length, fonts, about_folder, replaces=not own)


def report_design(
    design: Design,
    instance: Instance,
    folder: str | Path,
    *,
    name: str = "design",
    formats: Sequence[str] = ("html",),
    about: Any = None,
    length: str = "normal",
    fonts: Sequence[str | Path] = (),
    about_folder: Path | None = None,
) -> tuple[Path, list[str], list[str]]:
    """Write the calculation sheet of one design that was checked; arguments and returns as for :func:`report`."""
    asked: dict[str, Any] = {"calculation": calculation_of(instance), "design": design, "name": name}
    if "xlsx" in formats:
        asked["rows"] = _rows(instance)
    return _written(asked, Path(folder), formats, about, length, fonts, about_folder, replaces=False)


def report_comparison(
    source: Path, folder: Path, *, formats: Sequence[str] = ("html",), about: Any = None, **how: Any
) -> tuple[Path, list[str], list[str], bool]:
    """Write the report of several families that were asked the same, and that of each family in a folder of its name.

    Arguments as for :func:`report`, of which ``design`` and ``full`` are meant of each family. Returns folder, files,
    what else is to be told, and whether there are designs.

    Raises
    ------
    InputError
        As for :func:`report`, or the comparison cannot be read.
    """
    right = "a comparison.json as clutchsynth has written it"
    content = read_json(source / COMPARISON, "comparison", right)
    try:
        names = [(str(x["family"]), str(x["folder"])) for x in content["families"] if x["folder"]]
        feasible = bool(content["designs"])
    except (KeyError, TypeError) as error:
        raise InputError(
            f"comparison {source / COMPARISON}", str(error), f"{right}; this one is not complete"
        ) from error
    fronts = {family: load_front(source / place) for family, place in names}
    written, notes, links = list[str](), list[str](), dict[str, str]()
    for family, place in names:
        _, files, told = report(fronts[family], folder / place, formats=formats, about=about, **how)
        written += [f"{place}/{name}" for name in files]
        notes += [note for note in told if note not in notes]
        first = next(name for name in files if name.startswith("report."))
        links[family] = f"{place}/{first}"
    make = report_named("comparison")
    assert make is not None
    asked = {"content": content, "fronts": fronts, "links": links, "formats": list(formats), "about": about}
    fonts = [Path(x) for x in how.get("fonts", ())]
    files, told = make({**asked, "about_folder": how.get("about_folder"), "fonts": fonts})
    save_files(folder, files)
    notes += [note for note in told if note not in notes]
    return folder, [*files, *written], notes, feasible


def _written(
    asked: dict[str, Any],
    place: Path,
    formats: Sequence[str],
    about: Any,
    length: str,
    fonts: Sequence[str | Path],
    about_folder: Path | None,
    replaces: bool,
) -> tuple[Path, list[str], list[str]]:
    make = report_named("files")
    if make is None:
        raise InputError("report", None, "the package reports, which clutchsynth is installed with")
    asked |= {
        "formats": list(formats),
        "about": about,
        "about_folder": about_folder,
        "length": length,
        "fonts": [Path(x) for x in fonts],
    }
    files, notes = make(asked)
    earlier = [p.name for pattern in REPORT_FILES for p in place.glob(pattern)] if replaces else []
    save_files(place, files, earlier)
    return place, list(files), notes


def _beside(folder: Path, front: ParetoFront) -> dict[str, Any]:
    """Return what other commands have found out about a front, in its folder or in one below."""
    found: dict[str, Any] = {"curves": sorted(p.name for pattern in CURVES for p in folder.glob(pattern))}
    digest = (front.record or {}).get("digest")
    for path in (folder / "prices.json", *sorted(folder.glob("*/prices.json"))):
        if path.is_file():
            content = read_json(path, "prices", "a prices.json as clutchsynth has written it")
            if isinstance(content, Mapping) and content.get("front") == digest:
                found["prices"] = [row for rows in dict(content.get("designs", {})).values() for row in rows]
                break
    near = [_near_of(path, front) for path in sorted(folder.glob("*/near_equals.csv"))]
    found["near_equals"] = [x for x in near if x]
    return found


def _near_of(path: Path, front: ParetoFront) -> dict[str, Any]:
    """Return near-equal designs with the rank of the design they are near; nothing where that is none of ours."""
    text = read_text(path, "near_equals", "a table as clutchsynth has written it")
    rows = list(csv.DictReader(text.splitlines()))
    told = read_json(path.with_suffix(".json"), "near_equals", "a near_equals.json as clutchsynth has written it")
    if not rows or not isinstance(told, Mapping):
        return {}
    for design in front.designs:
        columns = design_columns(front.frame, design.choices, design.parts)
        own = dict(zip(columns, design_row(front.frame, design), strict=True))
        if all(rows[0].get(column) == str(csv_cell(value)) for column, value in own.items()):
            return {"rank": design.rank, "sentence": str(told.get("sentence", "")), "rows": rows[1:]}
    return {}


def _offered(front: ParetoFront, problem: Any, catalogs: Any) -> dict[str, list[Any]]:
    """Return the rows that slots offer; where the question cannot be posed again those that the designs use."""
    try:
        return _rows(question_of(front, problem, catalogs))
    except InputError:
        used: dict[str, dict[str, Any]] = {}
        for design in front.designs:
            for slot, row in design.parts.items():
                used.setdefault(slot, {})[str(row)] = row
        return {slot: list(rows.values()) for slot, rows in used.items()}


def _rows(instance: Instance) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {}
    chosen = {s.slot: (s.table, s.rows) for s in instance.selection.slots}
    for slot, part in instance.model.declaration.slots.items():
        whole = instance.catalogs.table(part.table)
        table, rows = chosen.get(slot) or (whole, range(len(whole)))
        found[slot] = [part_row(table, int(k)) for k in rows]
    return found
