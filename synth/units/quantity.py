"""Units and quantities: text that people write, SI numbers inside.

The grammar is small and strict. Tokens are joined by a space, ``*`` or a middle dot (products) or by ``/``, which
divides by the one factor or bracket that follows. An exponent is a digit after its token (``mm2``, also ``mm^2`` and
``mm²``). Brackets stand in a denominator only, ``1`` is an empty numerator, ``-`` is no unit.

A unit belongs to a *kind* (torque, energy, angular speed, ...). Units of one dimension may be of different kinds: a
torque is not an energy, a temperature is not a temperature rise, and ``1/min`` is a turn per minute in an angular speed
but an event per minute in a frequency.

Numbers are converted exactly: the SI value is the float nearest to the number as it is written times the exact factor.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from typing import TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from synth.errors import InputError
from synth.text.input_limits import INPUT_LIMITS
from synth.text.numbers import FULL_DIGITS, shown, typed_number
from synth.units.grammar import RefusedUnit, Unit, is_unit, parse_unit, resolve
from synth.units.spellings import SPACES

FloatArray = NDArray[np.float64]
T = TypeVar("T")


# ---- numbers --------------------------------------------------------------------------------------------------------

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# As inches are measured: 3/4, 1 3/4, 1-3/4; a character such as ¾ is one too.
_FRACTION = re.compile(r"([+-]?)(?:([0-9]{1,9})(?: +|-))?([1-9][0-9]{0,8})/([0-9]{1,9})(?![0-9./])")
_MINUS = "−‐‑‒–—﹣－"
# What a table program makes of 1.5 or 1/5 that somebody typed, and writes as a date.
_MONTH = "(?:jan|feb|mar|mär|mrz|apr|mai|may|jun|jul|aug|sep|okt|oct|nov|dez|dec)[a-zä]*\\.?"
_DATE = re.compile(
    r"\d{4}-\d\d-\d\d(?:[ T].*)?|\d{1,2}([./-])\d{1,2}\1(?:\d{4}|\d\d)|\d{1,2}:\d\d(?::\d\d)?"
    rf"|\d{{1,2}}[-. ]+{_MONTH}(?:[-. ]+\d{{2,4}})?|{_MONTH}[-. ]\d{{2,4}}",
    re.IGNORECASE,
)
# What is written in place of a number, and behind one, with what is right instead.
_NO_NUMBER = {
    r"[+-]?,[0-9]": "a decimal point instead of a decimal comma, for example 0.5",
    r"[+-] +[0-9.]": "no blank between the sign and the number",
}
_BEHIND_A_NUMBER = {
    r",[0-9]{3}(?:[,.][0-9]|\Z|[^0-9])": "a number without a comma: a decimal point for decimals (1.5), "
    "nothing between thousands (1500)",
    r",[0-9]": "a decimal point instead of a decimal comma, for example 6.5",
    r"(?: [0-9]{3}(?![0-9])|['’_][0-9])": "a number without a separator between the thousands, for example 1500",
    r"(?: [0-9]+)? ?[/⁄] ?[0-9]": "a decimal number, or a fraction of whole numbers with its unit, such as 3/4 in or "
    "1 3/4 in",
    r" ?['’′]": "feet and inches as one number with one unit, for example 63 in",
    r"[.'’_,]": "one number with at most one decimal point, for example 1500.5",
}
_NO_DATE = "a number; a table program has made a date of it: set the cell to Number or Text, and type it again"
_LARGEST_EXPONENT = 1000
_MOST_DIGITS = 40
_SURELY_NORMAL = 1e-200  # below, numbers lose digits
_FAR = 1e-14  # relative, more than floats round
_PRECISE = Context(prec=60)


def _shifted(number: str, power: int) -> float:
    """Value of a decimal number times a power of ten, rounded once."""
    mantissa, _, exponent = number.replace("E", "e").partition("e")
    return float(f"{mantissa}e{int(exponent or 0) + power}")


def _power_of_ten(ratio: Fraction) -> int | None:
    for part, sign in ((ratio.numerator, 1), (ratio.denominator, -1)):
        if (ratio.denominator if sign > 0 else ratio.numerator) == 1:
            digits = str(part)
            if digits.rstrip("0") == "1":
                return sign * (len(digits) - 1)
    return None


@lru_cache(maxsize=4096)
def _converter(ratio: Fraction, shift: Fraction) -> Callable[[str], float]:
    """Give the function from the text of a number to its SI value."""
    power = _power_of_ten(ratio)
    if power is not None and not shift:
        return lambda number: _shifted(number, power)

    def exact(number: str) -> float:
        # a fraction of 1e999999999 would fill the memory before it could be called too large
        if abs(int(re.split("[eE]", number)[1] if "e" in number.lower() else 0)) > _LARGEST_EXPONENT:
            return float(number) * float(ratio) + float(shift)
        try:
            return float(Fraction(number.removesuffix(".")) * ratio + shift)
        except OverflowError:
            return math.inf

    return exact


def number_to_si(number: str, unit: Unit) -> float:
    """Convert the text of a number to SI, rounded once.

    Parameters
    ----------
    number : str
        A decimal number that has passed the number gate, in `unit`.
    unit : Unit
        Its unit.

    Returns
    -------
    float
        SI value; infinite where it is too large for a float.
    """
    return _converter(unit.ratio, unit.shift)(number)


def check_number(text: str, name: str) -> str:
    """Let only one plain decimal number through.

    Parameters
    ----------
    text : str
        The number as written, without a unit.
    name : str
        Field named in the message.

    Returns
    -------
    str
        The number without outer blanks.

    Raises
    ------
    InputError
        Decimal comma, thousands separator, nan, infinity, a typographic minus, or no number at all.
    """
    number, unit_part = _split_number(text, text, name)
    if unit_part:
        raise InputError(name, text, "a plain number without a unit in this place")
    return number


def _refuse_any(faults: Mapping[str, str], text: str, value: object, name: str) -> None:
    """Refuse a text that begins as one of some patterns says, with what is right instead."""
    for pattern, right in faults.items():
        if re.match(pattern, text):
            raise InputError(name, value, right)


def _split_number(text: str, value: object, name: str, declared: str = "-") -> tuple[str, str]:
    """Split a quantity written as text into its number and its unit; the declared unit serves as an example."""
    plain = as_decimal(text).translate(SPACES).strip()
    if not plain:
        raise InputError(name, value, "a number, not an empty text")
    if any(sign in plain for sign in _MINUS) and re.search(rf"(?:^|[eE])[{_MINUS}]\s*[0-9.]", plain):
        raise InputError(name, value, "the keyboard's minus sign (-) instead of a typographic dash")
    if re.match(r"[+-]?(?:nan|inf|infinity|\.nan|\.inf)\b", plain, re.IGNORECASE):
        raise InputError(name, value, "a finite number")
    if _DATE.fullmatch(plain):
        raise InputError(name, value, _NO_DATE)
    match = _NUMBER.match(plain)
    if match is None:
        _refuse_any(_NO_NUMBER, plain, value, name)
        if is_unit(plain):
            raise InputError(name, value, f"a number before the unit, for example 1 {plain}")
        both = f"a number, with a unit if it is not in {declared}, for example 30 or 30 {declared}"
        raise InputError(name, value, "a number, for example 30" if declared == "-" else both)
    number, unit_part = match[0], plain[match.end() :]
    if len(number) > INPUT_LIMITS.quantity:
        raise InputError(name, value, f"a number of at most {INPUT_LIMITS.quantity} characters")
    _refuse_any(_BEHIND_A_NUMBER, unit_part, value, name)
    if number == "1" and unit_part.startswith("/") and is_unit(plain):
        raise InputError(name, value, f"a number before the unit, for example 1 {plain}")
    return number, unit_part.strip()


def is_date(text: str) -> bool:
    """True if a text is a date or a time, as table programs write them for what they took for one."""
    return _DATE.fullmatch(text.strip()) is not None


def as_decimal(text: str) -> str:
    """Text of a quantity with a decimal number for a fraction; unchanged without one, or with no unit behind it.

    Examples
    --------
    >>> as_decimal("1 3/4 in"), as_decimal("¾ in"), as_decimal("3/4"), as_decimal("60 1/min")
    ('1.75 in', '0.75 in', '3/4', '60 1/min')
    """
    if "/" not in text and text.isascii():
        return text  # as nearly all are
    written = (unicodedata.normalize("NFKC", letter) if letter > "\x7f" else letter for letter in text)
    plain = "".join(f" {new.replace('⁄', '/')}" if "⁄" in new else old for old, new in zip(text, written, strict=True))
    match = _FRACTION.match(plain := plain.translate(SPACES).strip())
    unit_part = plain[match.end() :].strip() if match else ""
    if match is None or not unit_part:
        return text
    integer, above, below = (int(part or 0) for part in match.groups()[1:])
    if below == 0 or (match[2] and above >= below):
        return text
    return f"{match[1]}{_PRECISE.divide(Decimal(integer * below + above), Decimal(below)):f} {unit_part}"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that is known in SI: it stands wherever a user may type one, and is taken as it is.

    Parameters
    ----------
    si : float
        SI value.
    unit : str
        Unit in which people are shown it.
    """

    si: float
    unit: str

    def __str__(self) -> str:
        """Return it as a user would type it: as many digits as are read back as the same number."""
        return typed_quantity(self.si, self.unit, None)

    def __repr__(self) -> str:
        """Return it as messages show what was typed."""
        return repr(str(self))


def parse_quantity(value: object, declared_unit: str | Unit, field: str) -> float:
    """SI value of what a user gave for a quantity.

    Parameters
    ----------
    value : float, int, str or Quantity
        A number in the declared unit, or text: ``600``, ``"600"``, ``"600 N*m"``, ``"254 rpm"``.
    declared_unit : str or Unit
        Unit of a bare number; any other unit must be of the same kind.
    field : str
        Name of the quantity, for the message.

    Returns
    -------
    float
        SI value, finite.

    Raises
    ------
    InputError
        Not a finite number, not a unit, or a unit of another kind.

    Examples
    --------
    >>> parse_quantity("60 kp/cm2", "N/mm2", "pressure")
    5883990.0
    >>> parse_quantity(20, "degC", "ambient_temperature")
    293.15
    """
    unit = declared_unit if isinstance(declared_unit, Unit) else parse_unit(declared_unit)
    if value is None:
        raise InputError(field, None, f"a number in {unit.text}" if unit.text != "-" else "a number")
    if isinstance(value, str):
        number, unit_part = _split_number(value, value, field, unit.text)
        if unit_part:
            try:
                unit = resolve(unit_part, unit.kind)
            except RefusedUnit as refusal:
                raise InputError(field, value, refusal.expected) from None
        else:
            _ask_for_unit(float(number), unit, value, field)
    elif isinstance(value, Quantity):
        number = ""
        unit = parse_unit(value.unit, unit.kind)
    elif isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InputError(
            field, value, f"a number, or text such as '600 {unit.text}'" if unit.text != "-" else "a number"
        )
    else:
        try:
            plain = float(value)
        except OverflowError:
            plain = math.inf
        if not math.isfinite(plain):
            raise InputError(field, value, "a finite number")
        number = repr(plain)
        _ask_for_unit(plain, unit, value, field)
    si = value.si if isinstance(value, Quantity) else number_to_si(number, unit)
    if not math.isfinite(si):
        raise InputError(field, value, "a number that a computer can hold (below 1e308 in SI units)")
    if unit.kind == "temperature" and si < 0.0:
        raise InputError(field, value, "a temperature above absolute zero (-273.15 degC)")
    return si


def _ask_for_unit(number: float, declared: Unit, value: object, name: str) -> None:
    """Refuse a bare number that is as likely meant in a larger unit.

    From 100 N m torques are given in kN*m as well; 50 N m are never called 0.05.
    """
    if declared.kind == "torque" and declared.ratio == 1 and 0.1 <= abs(number) < 1:
        right = f"its unit, {typed_number(number)} N*m or {typed_number(number)} kN*m: without one it may be either"
        raise InputError(name, float(value) if isinstance(value, float) else value, right)  # NumPy's as plain ones


# ---- SI to people ---------------------------------------------------------------------------------------------------


@overload
def to_si(value: float, unit: str | Unit) -> float: ...
@overload
def to_si(value: FloatArray, unit: str | Unit) -> FloatArray: ...
def to_si(value: float | FloatArray, unit: str | Unit) -> float | FloatArray:
    """Convert numbers in a unit to SI.

    Parameters
    ----------
    value : float or ndarray
        Numbers in `unit`; nan stays nan.
    unit : str or Unit
        Their unit.

    Returns
    -------
    float or ndarray
        SI values.

    Examples
    --------
    >>> to_si(254.0, "mm")
    0.254
    """
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    if isinstance(value, np.ndarray):
        return _multiply(np.asarray(value, dtype=np.float64), unit.ratio) + unit.offset
    return _multiply(float(value), unit.ratio) + unit.offset


@overload
def from_si(value: float, unit: str | Unit) -> float: ...
@overload
def from_si(value: FloatArray, unit: str | Unit) -> FloatArray: ...
def from_si(value: float | FloatArray, unit: str | Unit) -> float | FloatArray:
    """Convert SI numbers to a unit.

    Where a number of at most 15 digits stands for the SI value, that number is given: 0.0023 m is 2.3 mm, not
    2.3000000000000003 mm. Converted back, the result is within two units in the last place.

    Parameters
    ----------
    value : float or ndarray
        SI values; nan stays nan.
    unit : str or Unit
        Wanted unit.

    Returns
    -------
    float or ndarray
        Numbers in `unit`.

    Examples
    --------
    >>> from_si(0.0023, "mm")
    2.3
    """
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    if isinstance(value, np.ndarray):
        flat = [_from_si(x, unit) for x in np.asarray(value, dtype=np.float64).ravel().tolist()]
        return np.array(flat, dtype=np.float64).reshape(value.shape)
    return _from_si(float(value), unit)


def finite_from_si(value: float | None, unit: str | Unit, otherwise: T) -> float | T:
    """Convert a SI number that may be missing.

    Parameters
    ----------
    value : float, optional
        SI; None, nan and infinities are no value.
    unit : str or Unit
        Wanted unit.
    otherwise
        What is returned where there is no value.

    Returns
    -------
    float
        Number in `unit`, or ``otherwise``.
    """
    return otherwise if value is None or not math.isfinite(value) else float(from_si(value, unit))


def _from_si(si: float, unit: Unit) -> float:
    raw = _multiply(si - unit.offset, 1 / unit.ratio)
    if not math.isfinite(raw):
        return raw
    # 12 digits first: an offset leaves noise in the last ones
    for short in (float(f"{raw:.12g}"), float(f"{raw:.15g}")):
        if abs(_multiply(short, unit.ratio) + unit.offset - si) <= math.ulp(si):
            return short
    return raw


@overload
def _multiply(value: float, ratio: Fraction) -> float: ...
@overload
def _multiply(value: FloatArray, ratio: Fraction) -> FloatArray: ...
def _multiply(value: float | FloatArray, ratio: Fraction) -> float | FloatArray:
    # 254/1000 is rounded once, 254*0.001 twice
    return value / float(ratio.denominator) if ratio.numerator == 1 else value * float(ratio)


def _as_text(number: Decimal) -> str:
    """Write a decimal number as people do: an exponent only for very large and very small ones."""
    number = number.normalize(_PRECISE)
    sign, digits, _ = number.as_tuple()
    if not number:
        return "0"
    adjusted = number.adjusted()
    if -5 <= adjusted < 16:
        return format(number, "f")
    text = "".join(map(str, digits))
    return f"{'-' if sign else ''}{text[0]}{'.' + text[1:] if len(text) > 1 else ''}e{adjusted}"


def typed_quantity(si: float, unit: str | Unit, digits: int | None = FULL_DIGITS) -> str:
    """SI value with its unit as specs have it, for messages: what they name may be typed as it stands.

    Parameters
    ----------
    si : float
        SI value.
    unit : str or Unit
        Unit to write.
    digits : int, optional
        Significant digits; None = the fewest digits that `parse_quantity` reads back as the same float.

    Returns
    -------
    str
        Number and unit; the number alone where the unit is ``-``.

    Examples
    --------
    >>> typed_quantity(600.0, "N*m"), typed_quantity(0.1, "-")
    ('600 N*m', '0.1')
    >>> typed_quantity(26.6, "1/min", digits=None)
    '254.01128917466497 1/min'
    """
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    si = float(si)
    if not math.isfinite(si):
        number = repr(si)
    elif digits is None:
        number = _shortest(si, unit)
    else:
        number = shown(_in_unit(si, unit), digits).typed()
    return _with_unit(number, unit)


def written_quantity(si: float, unit: str | Unit, digits: int) -> str:
    """SI value with its unit as files of designs have it, in so many significant digits."""
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    return _with_unit(_as_text(Context(prec=digits).plus(_in_unit(float(si), unit))), unit)


def _with_unit(number: str, unit: Unit) -> str:
    return number if unit.text == "-" else f"{number}{'' if unit.text == '°' else ' '}{unit.text}"


def _in_unit(si: float, unit: Unit) -> Decimal:
    """Convert an SI value to a unit, to 60 digits."""
    exact = (Fraction(si) - unit.shift) / unit.ratio
    return _PRECISE.divide(Decimal(exact.numerator), Decimal(exact.denominator))


@lru_cache(maxsize=4096)
def _shortest(si: float, unit: Unit) -> str:
    if si == (number_to_si("0", unit) if unit.offset else 0.0):
        return "0"
    value = _in_unit(si, unit)
    text = ""
    # 17 digits name a float; only a temperature within 1e-9 K of absolute zero takes many more
    for digits in range(_least_digits(float(value), unit), _MOST_DIGITS + 1):
        text = _as_text(Context(prec=digits).plus(value))
        if number_to_si(text, unit) == si:
            break
    return text


def _least_digits(value: float, unit: Unit) -> int:
    """Return a number of digits below which a number in a unit is far from itself; exact arithmetic is slow."""
    digits = 1
    if not unit.offset and abs(value) > _SURELY_NORMAL:
        while abs(float(f"{value:.{digits - 1}e}") - value) > _FAR * abs(value):
            digits += 1
    return digits


def outward(si: float, unit: str | Unit, up: bool, digits: int = 6) -> Iterator[str]:
    """Write an SI value with its unit, rounded to one side, and then further and further on that side.

    Parameters
    ----------
    si : float
        SI value.
    unit : str or Unit
        Unit to write.
    up : bool
        Whether what is larger is on the side where it does.
    digits : int
        Significant digits of the first.

    Yields
    ------
    str
        First the nearest number on the side, or one that is nearer than a hundredth of its last digit.

    Examples
    --------
    >>> list(outward(0.1202016, "mm", up=True))
    ['120.202 mm', '120.203 mm', '120.22 mm', '120.4 mm', '122 mm']
    >>> next(outward(4.0000000001e-3, "mm", up=False))
    '4 mm'
    """
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    shown = float(from_si(si, unit))
    size = math.floor(math.log10(abs(shown))) if shown else 0
    for less in range(digits - 1):
        step = 10.0 ** (size - digits + 1 + max(less - 1, 0))
        multiple = math.ceil(shown / step - 0.01) if up else math.floor(shown / step + 0.01)
        # The first is rounded; then comes the next number, and those of fewer digits beyond it.
        multiple += (1 if up else -1) if less else 0
        text = f"{float(f'{multiple * step:.{digits}g}'):.{digits}g}"
        yield text if unit.text == "-" else f"{text} {unit.text}"


def header(name: str, unit: str | Unit) -> str:
    """Heading of a column: ``mass [kg]``.

    Parameters
    ----------
    name : str
        Name of the quantity.
    unit : str or Unit
        Its unit; ``-`` is written too.

    Returns
    -------
    str
        Name and unit in brackets.
    """
    return f"{name} [{unit.text if isinstance(unit, Unit) else unit}]"


def split_header(text: str) -> tuple[str, str | None]:
    """Name and unit of a column heading.

    Parameters
    ----------
    text : str
        ``mass [kg]`` or ``note``.

    Returns
    -------
    tuple of str and (str or None)
        Name, and unit text (unchecked) where there are brackets.

    Raises
    ------
    InputError
        Brackets that do not close, or no name.

    Examples
    --------
    >>> split_header("mass [kg]"), split_header("note")
    (('mass', 'kg'), ('note', None))
    """
    match = re.fullmatch(r"\s*([^\[\]]*?)\s*(?:\[\s*([^\[\]]*?)\s*\])?\s*", text)
    if match is None or not match[1]:
        raise InputError("header", text, "a name, with its unit in brackets if it is a number: mass [kg]")
    return match[1], match[2]
