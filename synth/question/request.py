"""What is asked: one record of everything that decides which designs are right, checked where it is made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import Family, Limits, Objectives, PartRules, Pins, Requirements, Scatter, UserTables
from synth.question.catalogs import as_catalogs, catalogs_for
from synth.question.count_domain import stated
from synth.question.names import as_mapping
from synth.question.request_fields import ASKED
from synth.question.spec_keys import read_keys, refuse_several, refuse_values
from synth.question.uncertainty import Uncertainty, read_remaining
from synth.tables.catalogs import Catalogs

EXAMPLES = {
    "requirements": "{'mass': '20 kg'}",
    "parts": "{'slot': ['designation', 'designation']}",
    "limits": "{'mass': '<= 20 kg'}",
    "fix": "{'mass': '20 kg'}",
    "weights": "{'mass': 2}",
}


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked: a problem, its requirements and restrictions, and by what designs are ranked.

    Names and numbers are those that were stated; what they mean for the problem is read when the request is posed.

    Parameters
    ----------
    problem : DesignProblem
        With its options.
    requirements : mapping
        Name or symbol -> text with unit, or bare number in the declared unit.
    catalogs : Catalogs
        The part tables in force.
    objectives : names, or mapping name -> "min"/"max", optional
        The family's defaults when not given.
    parts, limits, fix : mapping
        Restrictions, as for ``synth.synthesize``.
    weights : mapping
        Objective -> weight for the ranking; 1 where missing.
    robust : Uncertainty, optional
        What scatters.
    grid : bool
        Whether only makeable values of gridded variables are asked for.

    Raises
    ------
    InputError
        Something is not of its kind.
    """

    problem: DesignProblem
    requirements: Requirements
    catalogs: Catalogs = field(default_factory=lambda: as_catalogs(None))
    objectives: Objectives = None
    parts: PartRules = field(default_factory=dict)
    limits: Limits = field(default_factory=dict)
    fix: Pins = field(default_factory=dict)
    weights: Mapping[str, float] = field(default_factory=dict)
    robust: Uncertainty | None = None
    grid: bool = True

    def __post_init__(self) -> None:
        """Refuse what is not of its kind; None is nothing asked."""
        object.__setattr__(self, "grid", check_grid(self.grid))
        for name, example in EXAMPLES.items():
            object.__setattr__(self, name, dict(as_mapping(getattr(self, name), name, example)))

    @classmethod
    def of(
        cls,
        p: Family,
        requirements: Requirements,
        catalogs: UserTables = None,
        robust: Scatter | None = None,
        *,
        folder: Path | None = None,
        **asked: Any,
    ) -> Request:
        """Return a request as the verbs of ``synth`` take it.

        Parameters
        ----------
        p : family name, DesignProblem subclass or instance
        requirements : mapping
        catalogs : folder or mapping, optional
            Own part tables.
        robust : mapping, optional
            What scatters and by how much.
        folder : Path, optional
            Where relative paths of tables start from.
        asked
            The other fields of a request.

        Raises
        ------
        InputError
            The problem, a table or a range cannot be had, or something is not of its kind.
        """
        block = read_remaining(robust)
        problem = load(p)
        tables = catalogs_for(problem, catalogs, folder)
        return cls(problem=problem, requirements=requirements, catalogs=tables, robust=block, **asked)

    # -- JSON ----------------------------------------------------------------------------------

    @classmethod
    def from_json(
        cls,
        content: Mapping[str, object],
        where: str = "request",
        folder: Path | None = None,
        problem: DesignProblem | None = None,
        catalogs: Catalogs | None = None,
    ) -> Request:
        """Return the request that a spec states.

        Parameters
        ----------
        content : mapping
            Keys of a spec; those that say how it is searched may stand there as well.
        where : str
            The name of it, for messages.
        folder : Path, optional
            Where relative paths of tables start from.
        problem : DesignProblem, optional
            The family with its options, where it is loaded already.
        catalogs : Catalogs, optional
            The part tables, where they are read already.

        Raises
        ------
        InputError
            When a key is unknown, a value is not of its kind, or it asks several families or states a design.
        """
        read = read_keys(content, where, (*ASKED, "values"))
        refuse_values(read.pop("values"), where)
        family, options = read.pop("family"), read.pop("options")
        refuse_several(family, where)
        grid, tables = read.pop("grid"), read.pop("catalogs")
        return cls.of(
            load(family, **options) if problem is None else problem,
            catalogs=tables if catalogs is None else catalogs,
            robust=read.pop("robust") or None,
            folder=folder,
            grid=True if grid is None else grid,
            **read,
        )

    def to_json(self) -> dict[str, Any]:
        """Return the request as a spec states it: ``from_json`` makes the same of it.

        Raises
        ------
        InputError
            When a table is in memory: no spec can name it.
        """
        content = {
            "family": self.problem.name,
            "options": dict(self.problem.options),
            "requirements": stated({word: value for word, value in self.requirements.items() if value is not None}),
            "objectives": listed_objectives(self.objectives),
            "limits": stated(self.limits),
            "fix": stated(self.fix),
            "parts": self.rules(),
            "catalogs": self.catalogs.all_files(),
            "weights": dict(self.weights),
            "robust": self.problem.restated.get("robust") if self.robust is None else self.robust.block(),
        }
        return {**{key: value for key, value in content.items() if value}, "grid": self.grid}

    def rules(self) -> dict[str, Any]:
        """Conditions on the parts as files keep them: comparisons, and lists of designations."""
        return {slot: rule if isinstance(rule, str) else list(rule) for slot, rule in self.parts.items()}


def check_grid(grid: object) -> bool:
    """Return whether makeable values are asked for.

    Raises
    ------
    InputError
        It is neither true nor false.
    """
    if not isinstance(grid, (bool, np.bool_)):
        raise InputError("grid", grid, "true or false", ("grid",))
    return bool(grid)


def listed_objectives(objectives: Objectives) -> Any:
    """Return objectives as files keep them."""
    if objectives is None or isinstance(objectives, Mapping):
        return objectives if objectives is None else dict(objectives)
    return [objectives] if isinstance(objectives, str) else list(objectives)
