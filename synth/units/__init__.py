"""Quantities: numbers with units, read and written."""

from synth.units.for_people import in_unit, in_words, quantity_text, unit_text
from synth.units.grammar import Unit, parse_unit, si_text
from synth.units.quantity import (
    Quantity,
    check_number,
    finite_from_si,
    format_quantity,
    from_si,
    header,
    number_to_si,
    outward,
    parse_quantity,
    split_header,
    to_si,
)

__all__ = [
    "Quantity",
    "Unit",
    "check_number",
    "finite_from_si",
    "format_quantity",
    "from_si",
    "header",
    "in_unit",
    "in_words",
    "number_to_si",
    "outward",
    "parse_quantity",
    "parse_unit",
    "quantity_text",
    "si_text",
    "split_header",
    "to_si",
    "unit_text",
]
