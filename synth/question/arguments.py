"""Types of what the verbs take from a caller, who may pass the wrong things all the same: readers check."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from pathlib import Path

    from synth.model.problem import DesignProblem
    from synth.question.uncertainty import Uncertainty
    from synth.results import Design
    from synth.tables.catalogs import Catalogs, TableSource
    from synth.units import Quantity

# The registered name of a family, or a problem of the caller's.
Family: TypeAlias = "str | type[DesignProblem] | DesignProblem"

# Families of a comparison: "any", or each with what concerns it alone, {"family": "cone_clutch", "limits": ...}.
Families: TypeAlias = "str | Sequence[Family | Mapping[str, object]]"

# Tables of the caller: a folder, or by name where the rows are; a list that begins with "+" stands beside the shipped
# rows. None are the shipped tables.
UserTables: TypeAlias = "Catalogs | str | Path | Mapping[str, TableSource | Sequence[TableSource]] | None"

# A text with a unit, or a number in the declared unit: "600 N*m", 600.
Value: TypeAlias = "str | float | Quantity"

# By name or symbol of the requirement; None is not stated.
Requirements: TypeAlias = "Mapping[str, Value | None]"

# A design, or its "values" and "parts", as a DESIGN.yaml has them.
DesignSource: TypeAlias = "Design | Mapping[str, Any]"

# Sizes, counts and choices of a given design, by name or symbol.
DesignValues: TypeAlias = "Mapping[str, Value]"

# By quantity: a comparison, "<= 260 mm", or several; of a count also the set of allowed values, [8, 12, 16].
Limits: TypeAlias = "Mapping[str, str | Sequence[Value]]"

# By variable, count, choice, slot or derived quantity: its one value; of a count also the set of allowed values.
Pins: TypeAlias = "Mapping[str, Value | Sequence[Value]]"

# By slot: a designation, several, or a condition on columns, "friction >= 0.1".
PartRules: TypeAlias = "Mapping[str, str | Sequence[str]]"

# Names of quantities, or names with "min" or "max"; None is what the family names.
Objectives: TypeAlias = "str | Sequence[str] | Mapping[str, str] | None"

# What scatters with its range, {"friction": "catalogue range"}, beside the settings of the block.
Scatter: TypeAlias = "Mapping[str, object] | Uncertainty"

# What a study varies, by requirement, limit, "weights.NAME", "parts.SLOT" and the like: its values, or the ends and the
# count of them, {"from": "200 mm", "to": "300 mm", "count": 11}.
Variations: TypeAlias = "Mapping[str, str | Sequence[Value | Sequence[str]] | Mapping[str, Value]]"
