"""Quantities: numbers with units, read and written."""

from synth.units.for_people import in_unit, in_words, miss_text, quantity_text, unit_text
from synth.units.grammar import TORQUE_OF_POWER, Unit, parse_unit, si_text
from synth.units.quantity import (
    Quantity,
    as_decimal,
    check_number,
    finite_from_si,
    from_si,
    header,
    is_date,
    number_to_si,
    outward,
    parse_quantity,
    split_header,
    to_si,
    typed_quantity,
    written_quantity,
)

__all__ = [
    "TORQUE_OF_POWER",
    "Quantity",
    "Unit",
    "as_decimal",
    "check_number",
    "finite_from_si",
    "from_si",
    "header",
    "in_unit",
    "in_words",
    "is_date",
    "miss_text",
    "number_to_si",
    "outward",
    "parse_quantity",
    "parse_unit",
    "quantity_text",
    "si_text",
    "split_header",
    "to_si",
    "typed_quantity",
    "unit_text",
    "written_quantity",
]
