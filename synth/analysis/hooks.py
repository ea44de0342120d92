"""What a family adds to its declaration: curves, simulations in time, and the second opinion they allow."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth.analysis.evaluate import evaluate
from synth.errors import InputError, at
from synth.folders.files import table_frame
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import DesignSource, DesignValues, Family, Requirements, UserTables
from synth.question.catalogs import catalogs_for
from synth.question.instance import Instance
from synth.question.names import as_mapping
from synth.question.request import Request
from synth.tables.catalogs import Catalogs
from synth.units import finite_from_si, parse_quantity, split_header

if TYPE_CHECKING:
    import pandas as pd

    from synth.declaration import Setting
    from synth.results import Design

FILE_NAME = re.compile(r"[a-z][a-z0-9_]*")
OPINION = ["quantity", "unit", "closed_form", "simulation", "difference", "relative_difference"]


def simulate(
    p: Family,
    requirements: Requirements,
    design: DesignSource | None = None,
    *,
    values: DesignValues | None = None,
    parts: Mapping[str, str] | None = None,
    catalogs: UserTables = None,
    settings: Mapping[str, object] | None = None,
) -> dict[str, pd.DataFrame]:
    """Simulate one design in time.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        As for ``synthesize``.
    design, values, parts, catalogs : optional
        The design, as for ``evaluate``.
    settings : mapping, optional
        What the simulation is told beside the requirements, by the names of ``simulation_settings`` of the family.

    Returns
    -------
    dict
        pandas frames by name; ``attrs`` tell how to draw them.

    Raises
    ------
    InputError
        When the family has no simulation, or something is missing, unknown or not possible.
    """
    problem = load(p)
    catalogs = catalogs_for(problem, catalogs)
    chosen = read_settings(problem, settings, catalogs)
    return simulate_design(
        problem, evaluate(problem, requirements, design, values=values, parts=parts, catalogs=catalogs), chosen
    )


def simulate_design(problem: DesignProblem, design: Design, chosen: Mapping[str, object]) -> dict[str, pd.DataFrame]:
    """Simulate a design that was just evaluated, with settings that were already read."""
    frames = problem.simulate({**requirements_of(design), **chosen}, design)
    return _checked(problem, "simulate", "simulation", frames)


def curves(
    p: Family,
    requirements: Requirements,
    design: DesignSource | None = None,
    *,
    values: DesignValues | None = None,
    parts: Mapping[str, str] | None = None,
    catalogs: UserTables = None,
) -> dict[str, pd.DataFrame]:
    """Return the curves of a family for a requirement, and for a design if there is one.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        As for ``synthesize``.
    design, values, parts, catalogs : optional
        The design, as for ``evaluate``; without one only what the requirement alone allows is returned.

    Returns
    -------
    dict
        pandas frames by name; ``attrs`` tell how to draw them.

    Raises
    ------
    InputError
        When the family has no curves, or something is missing, unknown or not possible.
    """
    problem = load(p)
    catalogs = catalogs_for(problem, catalogs)
    if design is None and values is None:
        instance = Instance(Request(problem=problem, requirements=requirements, catalogs=catalogs), restrict=False)
        spec = {**instance.values.requirements, **dict.fromkeys(instance.values.not_asked)}
        return _checked(problem, "curves", "curves", problem.curves(spec))
    evaluated = evaluate(problem, requirements, design, values=values, parts=parts, catalogs=catalogs)
    return _checked(problem, "curves", "curves", problem.curves(requirements_of(evaluated), evaluated))


def second_opinion(design: Design, frames: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Set what a simulation found beside the closed forms of a design.

    Parameters
    ----------
    design : Design
        The design that was simulated.
    frames : mapping
        What ``simulate`` returned.

    Returns
    -------
    pandas.DataFrame
        One row per quantity, in its declared unit: closed form, simulation, difference, and that over the closed form.
    """
    rows: list[list[Any]] = []
    for frame in frames.values():
        for name, simulated in frame.attrs.get("quantities", {}).items():
            if name in design.values and not any(row[0] == name for row in rows):
                unit = design.frame.units[name]
                values = design.values[name], simulated
                closed, second = (finite_from_si(value, unit, math.nan) for value in values)
                relative = (second - closed) / closed if closed else math.nan
                rows.append([name, unit, closed, second, second - closed, relative])
    return table_frame(OPINION, rows)


def read_settings(problem: DesignProblem, settings: Mapping[str, object] | None, catalogs: Catalogs) -> dict[str, Any]:
    """Return the settings of a simulation that the user gave: SI numbers, words, rows.

    Raises
    ------
    InputError
        When one is unknown or has an impossible value.
    """
    declared = problem.simulation_settings
    chosen: dict[str, Any] = {}
    for name, value in as_mapping(settings, "settings", "{'time': '5 s'}").items():
        if name not in declared:
            close = difflib.get_close_matches(str(name), declared, n=2)
            listed = " or ".join(close) or ", ".join(declared) or "no settings: this family has none"
            raise InputError("settings", name, listed, ("settings", str(name)))
        with at("settings", name):
            chosen[name] = _read_setting(f"settings: {name}", declared[name], value, catalogs)
    return chosen


def _read_setting(field: str, setting: Setting, value: object, catalogs: Catalogs) -> Any:
    if setting.table:
        table = catalogs.table(setting.table)
        return table.row(table.row_index(str(value)))
    if setting.choices:
        if value not in setting.choices:
            raise InputError(field, value, "one of " + ", ".join(setting.choices))
        return value
    return parse_quantity(value, setting.unit, field)


def requirements_of(design: Design) -> dict[str, float | None]:
    """Requirements as hooks get them: SI by name, None where an optional one is not given."""
    return {**design.frame.requirement_values, **dict.fromkeys(design.frame.not_asked)}


def _checked(
    problem: DesignProblem, hook: str, kind: str, frames: Mapping[str, pd.DataFrame] | None
) -> dict[str, pd.DataFrame]:
    """Return the frames of a hook once they keep to the convention; a fault there is one of the family's author."""
    if not frames:
        raise InputError("family", problem.name, f"a family that has {'a ' if kind == 'simulation' else ''}{kind}")
    for key, frame in frames.items():
        where = f"{type(problem).__name__}.{hook}: {key!r}"
        if not FILE_NAME.fullmatch(key):
            raise ValueError(f"{where} is no file name in small letters")
        if not frame.attrs.get("title"):
            raise ValueError(f"{where} needs attrs['title']")
        for column in frame.columns:
            if not split_header(str(column))[1]:
                raise ValueError(f"{where}: column {column!r} needs a unit, such as 'time [s]'")
    return dict(frames)
