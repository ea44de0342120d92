"""Fronts that were saved, built again from their files."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

import msgspec
from msgspec import structs

from synth.errors import InputError
from synth.folders.files import read_json
from synth.folders.output_folder import settle
from synth.order.pareto import Scale
from synth.results.certificate import Certificate
from synth.results.design import Design, DesignSteps, Frame, PartRow
from synth.results.front import ParetoFront
from synth.results.front_file import DesignEntry, FrontFile
from synth.results.front_record import FRONT_FILE, FRONT_FORMAT, changed
from synth.results.record import Number
from synth.units import parse_unit

COMPARISON = "comparison.json"


def load_front(folder: str | Path) -> ParetoFront:
    """Rebuild a front from the files that ``save`` wrote.

    Parameters
    ----------
    folder : path
        The folder, or its front.json.

    Raises
    ------
    InputError
        When there is no front, it is of another format, or it was changed after it was saved.
    """
    path, content = _read(folder)
    fault = changed(content)
    if fault:
        raise InputError("front", str(path), f"a front.json as clutchsynth has written it; {fault}")
    return front_of_record(content, path)


def rows_kept(folder: Path | None) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the rows that the front in a folder has kept, by table and designation; none without a front there."""
    with suppress(InputError, AttributeError, KeyError, TypeError):
        if folder is not None and (folder / FRONT_FILE).is_file():
            _, content = _read(folder / FRONT_FILE)
            rows = dict[str, dict[str, dict[str, Any]]]()
            for row in content["parts"].values():
                rows.setdefault(str(row["table"]), {})[str(row["designation"])] = dict(row)
            return rows
    return {}


def unchecked_front(folder: str | Path) -> ParetoFront:
    """Rebuild a front whatever its checksum says, for whoever checks everything again.

    Raises
    ------
    InputError
        As for ``load_front``, but for changes.
    """
    path, content = _read(folder)
    return front_of_record(content, path)


def _read(folder: str | Path) -> tuple[Path, dict[str, Any]]:
    """Return the front.json of a folder and its content; of a comparison there is none."""
    path = Path(folder)
    if (path / COMPARISON).is_file():
        one = next((x.parent.name for x in sorted(path.glob("*/front.json"))), "FAMILY")
        raise InputError("front", str(path), f"the folder of one family of this comparison, for example {path / one}")
    if path.is_dir():
        settle(path)
        path = path / "front.json"
    content = read_json(path, "front", "a folder that clutchsynth run has written, or its front.json")
    if not isinstance(content, dict):
        raise InputError("front", str(path), "a front.json as clutchsynth has written it; this one is no JSON object")
    if content.get("format") != FRONT_FORMAT:
        raise InputError(f"front {path}: format", content.get("format"), f"format {FRONT_FORMAT}")
    return path, content


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
        return _front_from_file(msgspec.convert(content, FrontFile), content, path.parent)
    except KeyError as error:
        raise InputError(f"front {path}: {error.args[0]}", None, "a front.json that is complete") from error
    except (TypeError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(f"front {path}", str(error), "a front.json that is complete") from error


def _front_from_file(file: FrontFile, content: dict[str, Any], folder: Path) -> ParetoFront:
    same = {f.name: getattr(file, f.name) for f in fields(Frame) if f.name in file.__struct_fields__}
    frame = Frame(**same, requirement_values=file.requirement_values_si).located(folder)
    if not frame.objectives:
        raise ValueError("objectives: there is none")
    gap = None if file.certificate.gap is None else float(file.certificate.gap)
    return ParetoFront(
        frame=frame,
        designs=[_design_from_file(frame, entry, content["parts"]) for entry in file.designs],
        status=file.status,
        complete=file.complete,
        statistics=file.statistics,
        certificate=Certificate(**{**structs.asdict(file.certificate), "gap": gap}),
        explanation=file.explanation,
        settings=file.settings,
        interrupted=file.interrupted,
        scale=Scale.read(file.scale, frame.objectives) if file.scale else None,
        record=content,
        folder=folder,
    )


def _design_from_file(frame: Frame, entry: DesignEntry, rows: dict[str, dict[str, Any]]) -> Design:
    for row in entry.next_rows.values():
        parse_unit(row.unit)
    read = {
        "parts": {slot: PartRow.read(rows[key]) for slot, key in entry.parts.items()},
        "rows": tuple(PartRow.read(rows[key]) for key in entry.rows),
        "limits": {n: (_number(value), _number(bound)) for n, (value, bound) in entry.limits.items()},
        "utilisation": {n: None if used is None else float(used) for n, used in entry.utilisation.items()},
        "elasticity": {objective: _numbers(shares) for objective, shares in entry.elasticity.items()},
        "steps": DesignSteps(_numbers(entry.steps)),
    }
    read |= {name: _numbers(getattr(entry, name)) for name in ("values", "objectives", "residuals")}
    return Design(frame=frame, **{**structs.asdict(entry), **read})


def _numbers(values: Mapping[str, Number]) -> dict[str, float]:
    return {name: _number(value) for name, value in values.items()}


def _number(value: Number) -> float:
    return float("nan") if value is None else float(value)
