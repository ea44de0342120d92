"""The state of a design at an operating point: a hook of families, checked like curves and simulations."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from synth.analysis.evaluate import evaluate
from synth.analysis.hooks import requirements_of
from synth.errors import InputError, at
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import DesignSource, DesignValues, Family, Requirements, UserTables
from synth.question.catalogs import catalogs_for
from synth.question.names import as_mapping
from synth.text.numbers import UNKNOWN, number_text
from synth.units import parse_quantity, split_header, typed_quantity

if TYPE_CHECKING:
    import pandas as pd

    from synth.results import Design

WORDS = ("course", "regime")  # columns that tell in words; all others have a unit


def state(
    p: Family,
    requirements: Requirements,
    design: DesignSource | None = None,
    *,
    at: Mapping[str, object],
    values: DesignValues | None = None,
    parts: Mapping[str, str] | None = None,
    catalogs: UserTables = None,
) -> pd.DataFrame:
    """Return the state of one design at an operating point, such as a speed.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        As for ``synthesize``.
    design, values, parts, catalogs : optional
        The design, as for ``evaluate``.
    at : mapping
        The operating point, by the names that the family states: ``{"speed": "900 rpm"}``.

    Returns
    -------
    pandas.DataFrame
        One row per course that leads there (speeding up, slowing down, new or worn linings): ``course`` and ``regime``
        in words, and numbers under headings with their unit.

    Raises
    ------
    InputError
        When the family knows no state, the operating point is unknown or not possible, or the design has none.

    Examples
    --------
    >>> import synth
    >>> synth.state("disc_clutch", {}, at={"speed": "900 rpm"})
    Traceback (most recent call last):
    synth.errors.InputError: family: got 'disc_clutch'; expected a family that tells its state at a point (at)
    """
    problem = load(p)
    point = read_point(problem, at)
    tables = catalogs_for(problem, catalogs)
    return state_of(
        problem, evaluate(problem, requirements, design, values=values, parts=parts, catalogs=tables), point
    )


def read_point(problem: DesignProblem, entries: Mapping[str, object]) -> dict[str, float]:
    """Return an operating point in SI.

    Raises
    ------
    InputError
        When the family knows no state, a name is unknown or missing, or a value is not of its kind or below zero.
    """
    declared = problem.operating_point
    if not declared:
        raise InputError("family", problem.name, "a family that tells its state at a point (at)")
    point: dict[str, float] = {}
    for name, value in as_mapping(entries, "at", "{'speed': '900 rpm'}").items():
        if name not in declared:
            close = difflib.get_close_matches(str(name), declared, n=2)
            raise InputError("at", name, " or ".join(close) or ", ".join(declared), ("at",))
        with at("at", str(name)):
            # Of NumPy, so that what is beyond all measure becomes infinite and is told below.
            point[name] = np.float64(parse_quantity(value, declared[name].unit, f"at: {name}"))
            if point[name] < 0:
                zero = typed_quantity(0.0, declared[name].unit)
                raise InputError(f"at: {name}", value, f"a value of {zero} or more")
    for name, setting in declared.items():
        if name not in point:
            raise InputError(f"at: {name}", None, f"{setting.text}, for example '900 {setting.unit}'", ("at", name))
    return point


def state_of(problem: DesignProblem, design: Design, point: Mapping[str, float]) -> pd.DataFrame:
    """Return the state of a design that was just evaluated.

    Raises
    ------
    InputError
        When the design has no state there.
    """
    with np.errstate(all="ignore"):
        frame = problem.state(requirements_of(design), design, point)
    where = f"{type(problem).__name__}.state"
    if frame is None or list(frame.columns[: len(WORDS)]) != list(WORDS):
        raise ValueError(f"{where} must return a frame whose first columns are {', '.join(WORDS)}")
    numbers = frame.columns[len(WORDS) :]
    for column in numbers:
        if not split_header(str(column))[1]:
            raise ValueError(f"{where}: column {column!r} needs a unit, such as 'torque [N*m]'")
    if not np.isfinite(frame[numbers].to_numpy(dtype=float)).all(axis=1).any():
        shown = ", ".join(typed_quantity(x, problem.operating_point[n].unit) for n, x in point.items())
        more = f"; this one violates {', '.join(design.violated)}" if design.violated else ""
        raise InputError("at", shown, f"a point at which the design has a state{more}", ("at",))
    return frame


def state_rows(frame: pd.DataFrame) -> list[list[str]]:
    """Return a state as a table for people: a heading per course, then the regime and a row per quantity."""
    rows = [["", *frame["course"]], ["regime", *frame["regime"]]]
    for column in frame.columns[len(WORDS) :]:
        name, unit = split_header(str(column))
        behind = "" if unit == "-" else f" {unit}"
        shown = [f"{number_text(x)}{behind}" if math.isfinite(x) else UNKNOWN for x in frame[column]]
        rows.append([name, *shown])
    return rows
