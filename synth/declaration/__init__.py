"""Declaring a problem: what a family says about requirements, sizes, parts, limits and objectives."""

from synth.declaration.faults import declaring
from synth.declaration.grids import grid_values
from synth.declaration.records import (
    Choice,
    Count,
    Limit,
    NextRowRecord,
    Objective,
    Origin,
    Part,
    Refusal,
    RequirementRecord,
    RowRange,
    Setting,
    VariableRecord,
)
from synth.declaration.verbs import Block, Declaration, Option, Requirement, Slot, Variable
from synth.errors import DeclarationError

__all__ = [
    "Block",
    "Choice",
    "Count",
    "Declaration",
    "DeclarationError",
    "Limit",
    "NextRowRecord",
    "Objective",
    "Option",
    "Origin",
    "Part",
    "Refusal",
    "Requirement",
    "RequirementRecord",
    "RowRange",
    "Setting",
    "Slot",
    "Variable",
    "VariableRecord",
    "declaring",
    "grid_values",
]
