"""What a study varies: requirements, limits, weights, parts, options, scatter; one or two at a time, and checked."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.declaration.verbs import labels_meant
from synth.errors import InputError, at, shortened
from synth.model.model import Model
from synth.order.margins import MARGINS
from synth.question.arguments import Variations
from synth.question.uncertainty import KEYS, name_in_block
from synth.robust.uncertainty import AROUND
from synth.text.input_limits import INPUT_LIMITS
from synth.text.numbers import number_text, typed_number
from synth.text.plain_text import listed, words
from synth.units import as_decimal, parse_quantity, parse_unit
from synth.verbs.requests import VARIED_ENDS

DIGITS = 12
KEY = re.compile(r"^\s*(?:(weights|parts|options|robust)\.)?([^\s<>=]+)\s*(<=|>=|==|<|>)?\s*$")
NUMBER = re.compile(r"^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*$", re.DOTALL)
COMMA = re.compile(r"^\s*([+-]?\d+),(\d+)(\s*[^\d\s,].*)?$", re.DOTALL)  # one comma, without a blank, in digits alone
TIGHT = re.compile(r"(\d+),(?=(\d+))")
RANGE = "'200:300:10 mm' (from, to, step), '500, 600, 700 N*m', or in Python ('200 mm', '300 mm', 11)"
SIGN = {"<": "<=", ">": ">=", "=": "=="}
LIMIT_NAMES = {"<=": "largest {} allowed", ">=": "least {} asked for", "==": "{} asked for"}
PLACES = {"weight": "weights.", "part": "parts.", "option": "options.", "scatter": "robust."}

Value = float | str | tuple[str, ...]


@dataclass(frozen=True)
class Varied:
    """One thing that a study varies.

    ``kind`` is requirement, limit, weight, part, option or scatter, ``name`` the public name of what is varied,
    ``sign`` that of a limit. ``values`` are numbers in ``unit``; of parts and options designations, conditions (or
    several designations) and words, of what scatters ranges or "none". ``remark`` tells what a reader of the values
    might not expect.
    """

    kind: str
    name: str
    sign: str
    unit: str
    values: tuple[Value, ...]
    remark: str = ""

    @property
    def numeric(self) -> bool:
        """True if there is something between two values."""
        return self.kind in ("requirement", "limit", "weight")

    @property
    def label(self) -> str:
        """Heading of a column of its values, without the unit."""
        return f"{PLACES.get(self.kind, '')}{self.name}{self.sign and ' ' + self.sign}"

    @property
    def in_words(self) -> str:
        """Name for people: ``largest mass allowed``, ``friction pair``."""
        name = words(self.name)
        if self.kind == "weight":
            return f"weight of {name}"
        if self.kind == "scatter":
            return f"scatter of {name}"
        return LIMIT_NAMES[self.sign].format(name) if self.sign else name

    def valued(self, value: Value) -> str:
        """Return a value as people write it: designations as they are, units without signs."""
        return self.shown(value).replace("*", " ") if isinstance(value, float) else self.shown(value)

    def measured(self, value: float) -> str:
        """Number in the unit of what is varied, with its unit, for people."""
        return f"{number_text(value)} {self.unit.replace('*', ' ')}".removesuffix(" -").rstrip()

    def spec_value(self, value: Value) -> Any:
        """Value as it stands in a spec."""
        if not isinstance(value, float):
            return value if isinstance(value, str) else list(value)
        return float(f"{value:.{DIGITS}g}") if self.kind == "weight" else _written(value, self.unit)

    def shown(self, value: Value) -> str:
        """Return a value for people."""
        if isinstance(value, tuple):
            return ", ".join(value)
        return typed_number(float(value), DIGITS) if self.kind == "weight" else str(self.spec_value(value))

    def text(self, value: Value) -> str:
        """Return name and value for people: ``mass <= 40 kg``."""
        return f"{self.label} {'' if self.sign else '= '}{self.shown(value)}"


def read_vary(vary: Variations, model: Model, chosen: Sequence[str]) -> list[Varied]:
    """Read what a study varies.

    Parameters
    ----------
    vary : mapping
        Name (or symbol) -> values, as ``synth.whatif`` describes.
    model : Model
        Model of the question, for names and units.
    chosen : list of str
        The objectives, which alone have weights.

    Raises
    ------
    InputError
        When a name or a value cannot be meant.
    """
    if not isinstance(vary, Mapping) or not vary:
        raise InputError("vary", vary, "names with values, for example {'load_torque': '500:700:50 N*m'}", ("vary",))
    if len(vary) > 2:
        raise InputError("vary", ", ".join(map(str, vary)), "one or two things at a time", ("vary",))
    varied = []
    for key, values in vary.items():
        with at("vary", str(key)):
            if isinstance(values, Mapping) and set(values) == set(VARIED_ENDS):
                values = tuple(values[end] for end in VARIED_ENDS)
            varied.append(_read_one(str(key), values, model, chosen))
    if len({(x.kind, x.name, x.sign) for x in varied}) < len(varied):
        raise InputError("vary", varied[0].label, "each thing once (name and symbol mean the same)", ("vary",))
    with at("vary"):
        _check_number("vary", math.prod(len(x.values) for x in varied))
    return varied


def _check_number(field: str, steps: float) -> None:
    """Refuse more steps than a study may have, before any of them is made."""
    if steps > INPUT_LIMITS.steps:
        raise InputError(field, f"{steps} steps", f"at most {INPUT_LIMITS.steps} steps")


def _read_one(key: str, values: object, model: Model, chosen: Sequence[str]) -> Varied:
    """Return one thing that is varied, with its values."""
    match = KEY.match(key)
    if match is None:
        raise InputError(
            "vary",
            key,
            "a requirement, a limit such as 'mass <=', weights.NAME, parts.SLOT, options.NAME or robust.NAME",
        )
    place, word, sign = match.group(1), match.group(2), match.group(3) or ""
    if place is None and f"{word}." in PLACES.values():
        raise InputError("vary", key, f"{word}.NAME")
    if place is not None and sign:
        raise InputError("vary", key, f"{place}.{word} without {sign}")
    if place == "weights":
        name = model.name_of(word, "vary", list(chosen), "a chosen objective", ())
        _, numbers, remark = _numbers(key, values, "-")
        return Varied("weight", name, "", "-", numbers, remark)
    if place is not None:
        return _in_place(place, word, key, values, model)
    if sign:
        name = model.name_of(word, "vary", list(model.quantity_sx), "a quantity", ())
        return Varied("limit", name, SIGN.get(sign, sign), *_numbers(key, values, model.units[name]))
    return _requirement(word, key, values, model)


def _in_place(place: str, word: str, key: str, values: object, model: Model) -> Varied:
    """Varied parts, options or scatter, with their values."""
    d = model.declaration
    if place == "parts":
        name = model.name_of(word, "vary", list(d.slots), "a slot", ())
        return Varied("part", name, "", "", _words(key, values, several=True))
    if place == "options":
        name = model.name_of(word, "vary", list(d.options), "an option", ())
        words = _words(key, values, several=False)
        for label in words:
            if len(labels_meant(label, d.options[name].choices)) != 1:
                raise InputError(f"vary {key}", label, "one of " + ", ".join(d.options[name].choices))
        return Varied("option", name, "", "", words)
    if word in KEYS[2:]:
        raise InputError("vary", key, "what scatters: friction, wear, a requirement, a variable or slot.column")
    return Varied("scatter", name_in_block(word, d.names()), "", "", _ranges(key, values))


def _requirement(word: str, key: str, values: object, model: Model) -> Varied:
    """Return a requirement that is varied, with its values."""
    d = model.declaration
    spelled = d.names().get(word)
    if spelled in model.quantity_sx:
        kind = model.kind_of(str(spelled))
        raise InputError("vary", key, f"a requirement, or a limit such as '{word} <=': {word} is {kind}")
    for kind, members in (("parts", d.slots), ("options", d.options)):
        if spelled in members:
            raise InputError("vary", key, f"{kind}.{word}")
    name = model.name_of(word, "vary", list(d.requirements), "a requirement", ())
    return Varied("requirement", name, "", *_numbers(key, values, d.requirements[name].unit))


# ---- values ---------------------------------------------------------------------------------------------------------


def _numbers(key: str, values: object, declared: str) -> tuple[str, tuple[Value, ...], str]:
    """Return the unit in which a range or list is given, the numbers that it stands for, and a remark on them."""
    field, seen, remark = f"vary {key}", list[str](), ""
    if isinstance(values, str):
        pieces = values.split(":")
        if len(pieces) == 3:
            ends = [_number(field, x, declared, seen, values) for x in pieces]
            numbers = _steps(field, values, ends)
            remark = _end_missed(ends, numbers[-1], seen[0] if seen else declared)
        elif len(pieces) > 1:
            raise InputError(field, values, f"three numbers from:to:step, as in {RANGE}")
        else:
            _check_number(field, values.count(",") + 1)
            _refuse_decimal_comma(field, values)
            numbers = [_number(field, x, declared, seen, values) for x in values.split(",")]
    elif isinstance(values, tuple) and len(values) == 3 and type(values[2]) is int:
        first, last, count = values
        if not isinstance(first, str) and not isinstance(last, str):
            raise InputError(field, values, f"a list, {list(values)}, or ends with a unit: {RANGE}")
        if count < 2:
            raise InputError(field, values, "a count of at least 2 as the third entry: ('200 mm', '300 mm', 11)")
        _check_number(field, count)
        low, high = (_number(field, x, declared, seen, values) for x in (first, last))
        numbers = [float(f"{low + (high - low) * k / (count - 1):.{DIGITS}g}") for k in range(count)]
    elif isinstance(values, (list, tuple)) and not isinstance(values, str):
        if isinstance(values, tuple) and len(values) == 3 and not isinstance(values[2], (str, int, float)):
            raise InputError(field, values, f"a list of values, or {RANGE}")
        _check_number(field, len(values))
        numbers = [_number(field, x, declared, seen, values) for x in values]
    else:
        raise InputError(field, values, f"values such as {RANGE}")
    if not numbers:
        raise InputError(field, values, "at least one value")
    if len(set(numbers)) < len(numbers):
        raise InputError(field, values, "each value once")
    for number in numbers:
        parse_quantity(f"{number:.{DIGITS}g} {seen[0]}" if seen else number, declared, field)
    return (seen[0] if seen else declared), tuple(numbers), remark


def _number(field: str, value: str | float, declared: str, seen: list[str], source: object) -> float:
    """Return one number; its unit, if it has one, is that of all."""
    if not isinstance(value, str):
        parse_quantity(value, declared, field)
        return float(value)
    match, shown = NUMBER.match(as_decimal(value)), source if isinstance(source, str) else value
    if match is None or not math.isfinite(float(match.group(1))):
        raise InputError(field, shown, f"numbers with one unit, as in {RANGE}")
    number, unit = match.groups()
    if re.match(r",\s*[0-9]", unit):
        raise InputError(field, shown, "a decimal point instead of a decimal comma")
    if unit:
        parse_quantity(f"{number} {unit}", declared, field)
        unit = parse_unit(unit, parse_unit(declared).kind).text
        if seen and seen[0] != unit:
            raise InputError(field, source, f"one unit for all values, here {seen[0]} and {unit}")
        seen[:] = [unit]
    return float(number)


def _refuse_decimal_comma(field: str, text: str) -> None:
    """Refuse what may be one number with a decimal comma: two numbers of three digits, upwards, are none."""
    if re.search(r",\s", text) and any(_may_be_decimal(*pair) for pair in TIGHT.findall(text)):
        raise InputError(field, text, "decimal points (1.5, 2.5), or a blank after every comma between two values")
    match = COMMA.match(text)
    if match is None or not _may_be_decimal(match.group(1).lstrip("+-"), match.group(2)):
        return
    integer, decimals, unit = (shortened(x or "") for x in match.groups())
    raise InputError(
        field,
        text,
        f"a decimal point for one number ({integer}.{decimals}{unit}), a blank after the comma for two values "
        f"({integer}, {decimals}{unit})",
    )


def _may_be_decimal(integer: str, decimals: str) -> bool:
    """True if digits on both sides of a comma may be one number; ``500,600`` is none that anybody types."""
    return not (len(decimals) >= len(integer) >= 3 and int(decimals) >= int(integer))


def _steps(field: str, text: str, numbers: Sequence[float]) -> list[float]:
    """Values of from:to:step; the end is one of them where a step meets it."""
    first, last, step = numbers
    if step == 0 or (last - first) * step < 0:
        raise InputError(field, text, f"a step that leads from the first value to the last, as in {RANGE}")
    steps = (last - first) / step * (1 + MARGINS.conversion) + MARGINS.step
    _check_number(field, math.floor(steps) + 1 if math.isfinite(steps) else steps)
    count = math.floor(steps) + 1
    if count == 1 and first != last:
        raise InputError(field, text, f"a step that is not larger than the whole range, as in {RANGE}")
    return [float(f"{first + k * step:.{DIGITS}g}") for k in range(count)]


def _end_missed(numbers: Sequence[float], reached: float, unit: str) -> str:
    """Last step of from:to:step, if that is before its end; None where they meet it."""
    first, last, step = numbers
    if (last - reached) / step < 1e-6:  # a float's rounding, not a step that is missing
        return ""
    begin, end, size, stop = (_written(x, unit) for x in (first, last, abs(step), reached))
    return f"the steps end at {stop}: {end} is no whole number of steps of {size} from {begin}"


def _written(number: float, unit: str) -> str:
    """Return a number with its unit as it stands in a spec."""
    text = f"{number:.{DIGITS}g}"
    return text if unit == "-" else f"{text} {unit}"


def _words(key: str, values: object, several: bool) -> tuple[Value, ...]:
    """Return designations, conditions or labels; of parts an entry may be a list of several designations."""
    field = f"vary {key}"
    entries = listed(values) if isinstance(values, str) else values
    if not isinstance(entries, (list, tuple)) or not entries:
        raise InputError(field, values, "words with commas between them, or a list of them")
    _check_number(field, len(entries))
    words: list[Value] = []
    for entry in entries:
        if isinstance(entry, str) and entry.strip():
            words.append(entry)
        elif several and isinstance(entry, (list, tuple)) and entry and all(isinstance(x, str) for x in entry):
            words.append(tuple(entry))
        else:
            raise InputError(field, entry, "a word" + (", or a list of designations" if several else ""))
    if len(set(words)) < len(words):
        raise InputError(field, values, "each value once")
    return tuple(words)


def _ranges(key: str, values: object) -> tuple[Value, ...]:
    """Return ranges as a ``robust`` block takes them, or "none"; ``+-5:20:5 %`` stands for four of them.

    As of numbers, a unit counts for those before it that have none.
    """
    field, ranges, unit = f"vary {key}", list[str](), ""
    entries = values.split(",") if isinstance(values, str) else values
    if not isinstance(entries, (list, tuple)) or not all(isinstance(x, str) and x.strip() for x in entries):
        raise InputError(field, values, "ranges as text, such as '+-10 %' or '60 .. 80 N*m', or 'none'")
    _check_number(field, len(entries))
    for entry in reversed(entries):
        more, unit = _one_range(field, entry.strip(), unit)
        ranges[:0] = more
    if not ranges:
        raise InputError(field, values, "at least one range, or 'none'")
    if len(set(ranges)) < len(ranges):
        raise InputError(field, values, "each value once")
    return tuple(ranges)


def _one_range(field: str, text: str, unit: str) -> tuple[list[str], str]:
    """Return the ranges that one entry stands for, and their unit; ``unit`` is that of the entry behind it."""
    around = AROUND.match(text)
    if around is None:
        end = re.split(r"\.\.|:", text)[-1]
        match = NUMBER.match(as_decimal(end))
        if match is None or end == text:
            return [text], unit
        range_unit = match.group(2)
        return [text if range_unit or not unit else f"{text} {unit}"], range_unit or unit
    matches = [NUMBER.match(as_decimal(x)) for x in around.group(1).split(":")]
    units = {m.group(2) for m in matches if m is not None} - {""}
    if None in matches or len(matches) not in (1, 3) or len(units) > 1:
        raise InputError(field, text, "a range such as '+-10 %', or from, to and step with one unit: '+-5:20:5 %'")
    range_unit, numbers = (units or {unit}).pop(), [float(m.group(1)) for m in matches if m is not None]
    numbers = _steps(field, text, numbers) if len(numbers) == 3 else numbers
    return [f"+-{_written(x, range_unit or '-')}" for x in numbers], range_unit
