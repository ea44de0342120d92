"""Fronts that were saved, built again from their files."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.folders.files import read_json
from synth.folders.output_folder import settle
from synth.order.feasibility import Status
from synth.order.pareto import Scale
from synth.results.certificate import Certificate
from synth.results.design import Design, DesignSteps, Frame, PartRow
from synth.results.front import ParetoFront
from synth.results.front_record import FRONT_FILE, FRONT_FORMAT, changed
from synth.results.least_infeasible import LeastInfeasible
from synth.results.next_row import NextRow
from synth.results.ratings import DesignRating
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics

COMPARISON = "comparison.json"
MOST_DIGITS = 17  # that tell any number apart from its neighbours


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
            found = dict[str, dict[str, dict[str, Any]]]()
            for row in content["parts"].values():
                found.setdefault(str(row["table"]), {})[str(row["designation"])] = dict(row)
            return found
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
        return _front_from_json(content, path.parent)
    except KeyError as error:
        raise InputError(f"front {path}: {error.args[0]}", None, "a front.json that is complete") from error
    except (TypeError, ValueError, AttributeError, RecursionError) as error:
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
        headline=tuple(content.get("headline", ())),
        sized_by=content.get("sized_by", ""),
        tables=dict(content.get("tables", {})),
    ).located(folder)
    if not frame.objectives:
        raise ValueError("objectives: there is none")
    rows = content["parts"]
    designs = [_design_from_json(frame, d, rows) for d in content["designs"]]
    return ParetoFront(
        frame=frame,
        designs=designs,
        status=Status(content["status"]),
        complete=content["complete"],
        statistics=SearchStatistics.from_json(content["statistics"]),
        certificate=_certificate_from_json(content["certificate"]),
        explanation=LeastInfeasible.read(content["explanation"]),
        settings=SettingsRecord.read(content["settings"]),
        interrupted=content["interrupted"],
        scale=Scale.read(content["scale"], frame.objectives) if "scale" in content else None,
        record=content,
        folder=folder,
    )


def _certificate_from_json(told: dict[str, Any]) -> Certificate:
    return Certificate(**{**told, "gap": None if told["gap"] is None else float(told["gap"])})


def _design_from_json(frame: Frame, d: dict[str, Any], rows: dict[str, dict[str, Any]]) -> Design:
    return Design(
        frame=frame,
        values={n: _number(v) for n, v in d["values"].items()},
        parts={slot: PartRow.read(rows[key]) for slot, key in d["parts"].items()},
        rows=tuple(PartRow.read(rows[key]) for key in d.get("rows", ())),
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
        outside=d.get("outside", {}),
        advice=tuple(d["advice"]),
        violated=tuple(d["violated"]),
        not_checked=tuple(d["not_checked"]),
        robust=DesignRating.read(d.get("robust", {})),
        steps=DesignSteps({n: _number(v) for n, v in d.get("steps", {}).items()}),
        digits=_digits(d.get("digits")),
        next_rows={n: NextRow.read(told) for n, told in d.get("next_rows", {}).items()},
    )


def _digits(told: Any) -> int | None:
    if told is not None and (type(told) is not int or not 0 <= told <= MOST_DIGITS):
        raise ValueError(f"digits: {told!r} is no whole number from 0 to {MOST_DIGITS}")
    return told


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)
