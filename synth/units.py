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
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from typing import overload

import numpy as np
from numpy.typing import NDArray

from synth.errors import InputError

FloatArray = NDArray[np.float64]

_PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")
_ABSOLUTE_ZERO = Fraction("273.15")
_KP = Fraction("9.80665")
_TINY = Fraction(1, 10**100)
_LONGEST = 100


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit read as one of its kind.

    Parameters
    ----------
    text : str
        The unit as it was written.
    factor : float
        SI value of one of this unit [SI unit per unit].
    offset : float
        Added after the factor [K]; 273.15 for degC, else 0.
    kind : str
        Name of the kind, for example ``torque``.
    dimension : tuple of int
        Exponents of kg, m, s, K, A; an angle has none.
    ratio : Fraction
        The factor without rounding (angles: to 60 digits).
    """

    text: str
    factor: float
    offset: float
    kind: str
    dimension: tuple[int, int, int, int, int]
    ratio: Fraction = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class _Reading:
    """A parsed unit text before its kind is settled."""

    ratio: Fraction
    dimension: tuple[int, int, int, int, int]
    angle: int
    tokens: dict[str, int]


_NONE = (0, 0, 0, 0, 0)
_MASS = (1, 0, 0, 0, 0)
_LENGTH = (0, 1, 0, 0, 0)
_TIME = (0, 0, 1, 0, 0)
_KELVIN = (0, 0, 0, 1, 0)
_CURRENT = (0, 0, 0, 0, 1)
_RATE = (0, 0, -1, 0, 0)
_FORCE = (1, 1, -2, 0, 0)
_PRESSURE = (1, -1, -2, 0, 0)
_ENERGY = (1, 2, -2, 0, 0)
_POWER = (1, 2, -3, 0, 0)
_VOLTAGE = (1, 2, -3, 0, -1)
_FLUX = (1, 0, -2, 0, -1)
_RESISTANCE = (1, 2, -3, 0, -2)

_Dimension = tuple[int, int, int, int, int]


def _decades(dimension: _Dimension, **powers: int) -> dict[str, tuple[Fraction, _Dimension, int]]:
    return {name: (Fraction(10) ** power, dimension, 0) for name, power in powers.items()}


# token: (SI factor, dimension, power of an angle)
_TOKENS: dict[str, tuple[Fraction, _Dimension, int]] = {
    **_decades(_LENGTH, um=-6, mm=-3, cm=-2, dm=-1, m=0, km=3),
    **_decades(_MASS, g=-3, kg=0, t=3),
    **_decades(_TIME, ms=-3, s=0),
    "min": (Fraction(60), _TIME, 0),
    "h": (Fraction(3600), _TIME, 0),
    **_decades(_RATE, Hz=0, kHz=3),
    **_decades(_FORCE, mN=-3, N=0, kN=3, MN=6),
    "kp": (_KP, _FORCE, 0),
    **_decades(_ENERGY, Nmm=-3, Nm=0, kNm=3),
    "mkp": (_KP, _ENERGY, 0),
    "kpm": (_KP, _ENERGY, 0),
    **_decades(_PRESSURE, Pa=0, kPa=3, bar=5, MPa=6, GPa=9),
    **_decades(_ENERGY, mJ=-3, J=0, kJ=3, MJ=6),
    "Wh": (Fraction(3600), _ENERGY, 0),
    "kWh": (Fraction(3600000), _ENERGY, 0),
    **_decades(_POWER, W=0, kW=3, MW=6),
    "rad": (Fraction(1), _NONE, 1),
    "deg": (_PI / 180, _NONE, 1),
    "°": (_PI / 180, _NONE, 1),
    "rev": (2 * _PI, _NONE, 1),
    "rpm": (2 * _PI / 60, _RATE, 1),
    "K": (Fraction(1), _KELVIN, 0),
    **_decades(_CURRENT, mA=-3, A=0, kA=3),
    **_decades(_VOLTAGE, mV=-3, V=0),
    **_decades(_FLUX, mT=-3, T=0),
    "ohm": (Fraction(1), _RESISTANCE, 0),
}
_ALIASES = {"µm": "um", "μm": "um"}
_FORCE_TOKENS = frozenset({"mN", "N", "kN", "MN", "kp"})
_MOMENT_TOKENS = frozenset({"Nmm", "Nm", "kNm"})
_HISTORIC_TOKENS = frozenset({"kp", "mkp", "kpm"})
_ENERGY_TOKENS = frozenset({"mJ", "J", "kJ", "MJ", "Wh", "kWh", "W", "kW", "MW"})
_LENGTH_TOKENS = frozenset({"um", "mm", "cm", "dm", "m", "km"})

# what people type who are used to other spellings
_SPELLINGS = {
    "sec": "s",
    "hr": "h",
    "hour": "h",
    "u": "1/min",
    "kgf": "kp",
    "l": "dm3",
    "degree": "deg",
    "degrees": "deg",
    "celsius": "degC",
    "c": "degC",
    "°c": "degC",
    "ω": "ohm",
}

# kind: (in words, units to type)
_KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "dimensionless": ("a number without a unit", ("-", "%")),
    "angle": ("an angle", ("deg", "rad")),
    "length": ("a length", ("mm", "cm", "m")),
    "area": ("an area", ("mm2", "cm2", "m2")),
    "volume": ("a volume", ("mm3", "cm3", "dm3")),
    "second_moment_of_area": ("a second moment of area", ("mm4", "cm4")),
    "mass": ("a mass", ("kg", "g", "t")),
    "density": ("a density", ("kg/m3", "g/cm3", "kg/dm3")),
    "inertia": ("a moment of inertia", ("kg*m2", "g*cm2", "kg*mm2")),
    "time": ("a time", ("s", "min", "h")),
    "frequency": ("a frequency (events per time)", ("1/h", "1/min", "Hz")),
    "angular_speed": ("an angular speed", ("1/min", "rpm", "rad/s")),
    "angular_acceleration": ("an angular acceleration", ("rad/s2", "1/s2", "deg/s2")),
    "angular_jerk": ("an angular jerk", ("rad/s3", "1/s3")),
    "speed": ("a speed", ("m/s", "mm/s", "km/h")),
    "acceleration": ("an acceleration", ("m/s2", "mm/s2")),
    "force": ("a force", ("N", "kN", "kp")),
    "torque": ("a torque", ("N*m", "kNm", "mkp")),
    "torque_rate": ("a torque per time", ("N*m/s", "kNm/s")),
    "torsional_stiffness": ("a torsional stiffness", ("N*m/rad", "N*m/deg")),
    "stiffness": ("a stiffness (force per length)", ("N/mm", "N/m", "kN/mm")),
    "pressure": ("a pressure or stress", ("N/mm2", "MPa", "bar")),
    "energy": ("an energy", ("J", "kJ", "mkp")),
    "energy_per_area": ("an energy per area", ("J/mm2", "J/cm2", "kJ/m2")),
    "energy_density": ("an energy per volume", ("J/mm3", "J/cm3")),
    "power": ("a power", ("W", "kW", "MW")),
    "power_per_area": ("a power per area", ("W/mm2", "J/(mm2 h)", "W/cm2")),
    "temperature": ("a temperature", ("degC", "K")),
    "temperature_rise": ("a temperature rise", ("K",)),
    "heat_transfer": ("a heat transfer coefficient", ("W/(m2 K)", "W/(mm2 K)")),
    "conductivity": ("a thermal conductivity", ("W/(m K)", "W/(mm K)")),
    "specific_heat": ("a specific heat", ("J/(kg K)", "kJ/(kg K)")),
    "expansion": ("a thermal expansion", ("um/(m K)", "1/K")),
    "viscosity": ("a dynamic viscosity", ("Pa*s", "N*s/m2")),
    "wear": ("a wear volume per energy", ("mm3/MJ", "mm3/J", "mm3/(N m)")),
    "flux_density": ("a flux density", ("T", "mT")),
    "current": ("a current", ("A", "mA", "kA")),
    "current_density": ("a current density", ("A/mm2", "A/m2")),
    "voltage": ("a voltage", ("V", "mV")),
    "resistance": ("a resistance", ("ohm",)),
}

# (dimension, power of the angle): kind, where flavour plays no part
_BY_DIMENSION: dict[tuple[_Dimension, int], str] = {
    (_NONE, 0): "dimensionless",
    (_NONE, 1): "angle",
    (_LENGTH, 0): "length",
    ((0, 2, 0, 0, 0), 0): "area",
    ((0, 3, 0, 0, 0), 0): "volume",
    ((0, 4, 0, 0, 0), 0): "second_moment_of_area",
    (_MASS, 0): "mass",
    ((1, -3, 0, 0, 0), 0): "density",
    ((1, 2, 0, 0, 0), 0): "inertia",
    (_TIME, 0): "time",
    (_RATE, 0): "frequency",
    (_RATE, 1): "angular_speed",
    ((0, 0, -2, 0, 0), 1): "angular_acceleration",
    ((0, 0, -3, 0, 0), 1): "angular_jerk",
    ((0, 1, -1, 0, 0), 0): "speed",
    ((0, 1, -2, 0, 0), 0): "acceleration",
    (_FORCE, 0): "force",
    (_ENERGY, -1): "torsional_stiffness",
    ((1, 0, -3, 0, 0), 0): "power_per_area",
    (_KELVIN, 0): "temperature_rise",
    ((1, 0, -3, -1, 0), 0): "heat_transfer",
    ((1, 1, -3, -1, 0), 0): "conductivity",
    ((0, 2, -2, -1, 0), 0): "specific_heat",
    ((0, 0, 0, -1, 0), 0): "expansion",
    ((1, -1, -1, 0, 0), 0): "viscosity",
    ((-1, 1, 2, 0, 0), 0): "wear",
    (_FLUX, 0): "flux_density",
    (_CURRENT, 0): "current",
    ((0, -2, 0, 0, 1), 0): "current_density",
    (_VOLTAGE, 0): "voltage",
    (_RESISTANCE, 0): "resistance",
}

# dimension: (kind of a force flavour, kind of an energy flavour)
_BY_FLAVOUR: dict[_Dimension, tuple[str, str]] = {
    _ENERGY: ("torque", "energy"),
    (1, 0, -2, 0, 0): ("stiffness", "energy_per_area"),
    _PRESSURE: ("pressure", "energy_density"),
    _POWER: ("torque_rate", "power"),
}

_SUPERSCRIPTS = str.maketrans("²³⁴⁵⁶⁷⁸⁹", "23456789")
_TOKEN = re.compile(r"([^\W\d_]+|°)(\^?)([2-9])?\Z")
_SPACES = dict.fromkeys((0x00A0, 0x2007, 0x2009, 0x202F), " ")
_GRAMMAR = (
    "a unit such as N*m, J/(mm2 h) or 1/min: tokens joined by a space, * or /, exponent as a digit after the token"
)


class _Refused(Exception):
    """A sentence on its way to the place that knows the field."""

    def __init__(self, expected: str) -> None:
        self.expected = expected
        super().__init__(expected)


def _factor(text: str, whole: str) -> tuple[str, int]:
    """Token and exponent of one factor of a unit."""
    plain = text.translate(_SUPERSCRIPTS)
    if plain in ("degC", "°C", "%", "-"):
        if plain in ("degC", "°C"):
            raise _Refused("K inside a compound unit, where a temperature is a difference")
        raise _Refused(f"{plain!r} to stand alone as a unit")
    match = _TOKEN.match(plain)
    if match is None:
        if "^-" in plain or "⁻" in text:
            raise _Refused("a fraction instead of a negative exponent, for example 1/min")
        raise _Refused(_GRAMMAR if text else f"a token on both sides of every joint of {whole!r}; {_GRAMMAR}")
    name = _ALIASES.get(match[1], match[1])
    if match[2] and not match[3]:
        raise _Refused("an exponent 2 to 9 after ^")
    if name not in _TOKENS:
        raise _Refused(_unknown(name))
    return name, int(match[3] or 1)


def _unknown(name: str) -> str:
    """Say what is right instead of a token that is not in the grammar."""
    known = [*_TOKENS, "degC"]
    same = [token for token in known if token.casefold() == name.casefold()]
    if same:
        return f"{' or '.join(same)} instead of {name} (capitals matter in units)"
    if name.casefold() in _SPELLINGS:
        return f"{_SPELLINGS[name.casefold()]} instead of {name}"
    return f"a known unit instead of {name}: one of {', '.join(known)}, - or %"


def _read(text: str) -> _Reading:
    """Read a unit text; the kind is not settled yet."""
    if not text:
        raise _Refused("a unit; - where there is none")
    if len(text) > _LONGEST:
        raise _Refused(f"a unit of at most {_LONGEST} characters")
    if text == "-":
        return _Reading(Fraction(1), _NONE, 0, {"-": 1})
    if text == "%":
        return _Reading(Fraction(1, 100), _NONE, 0, {"%": 1})
    if text in ("degC", "°C"):
        return _Reading(Fraction(1), _KELVIN, 0, {"degC": 1})
    if "**" in text:
        raise _Refused("an exponent as a digit after the token, for example mm2")
    if text[0] == "/":
        raise _Refused(f"1 as an empty numerator: 1{text}")
    powers: dict[str, int] = {}
    rest = _tight(text)
    sign, first = 1, True
    while True:
        if rest.startswith("("):
            if sign > 0:
                raise _Refused("brackets in a denominator only, for example J/(mm2 h)")
            inside, closed, rest = rest[1:].partition(")")
            if not closed:
                raise _Refused("a closing bracket")
            factors = re.split(r"[ *·]", inside)
            if "/" in inside or "(" in inside:
                raise _Refused("a product of tokens in the bracket, for example J/(mm2 h)")
        else:
            match = re.match(r"[^ *·/()]*", rest)
            one = match[0] if match else ""
            rest = rest[len(one) :]
            if one == "1" and first and rest.startswith("/"):
                factors = []
            else:
                factors = [one]
        for item in factors:
            name, exponent = _factor(item, text)
            powers[name] = powers.get(name, 0) + sign * exponent
        first = False
        if not rest:
            break
        if rest[0] not in " *·/":
            raise _Refused(_GRAMMAR)
        sign = -1 if rest[0] == "/" else 1
        rest = rest[1:]
    return _combine(powers)


def _tight(text: str) -> str:
    """Drop the spaces that mean nothing: around a joint and inside a bracket."""
    return re.sub(r" *([*·/]) *", lambda m: m[1], re.sub(r"\( *", "(", re.sub(r" *\)", ")", text.translate(_SPACES))))


def _combine(powers: dict[str, int]) -> _Reading:
    ratio, angle = Fraction(1), 0
    dimension = [0, 0, 0, 0, 0]
    for name, power in powers.items():
        factor, exponents, turn = _TOKENS[name]
        ratio *= factor**power
        angle += turn * power
        for i, exponent in enumerate(exponents):
            dimension[i] += exponent * power
    kg, m, s, kelvin, ampere = dimension
    if not _TINY < ratio < 1 / _TINY:
        raise _Refused("a unit that is neither this large nor this small")
    return _Reading(ratio, (kg, m, s, kelvin, ampere), angle, powers)


def _si_text(dimension: _Dimension, angle: int) -> str:
    """Write a dimension as an SI unit in the grammar of this module."""
    above: list[str] = []
    below: list[str] = []
    for name, power in zip(("kg", "m", "s", "K", "A", "rad"), (*dimension, angle), strict=True):
        if power:
            (above if power > 0 else below).append(name + (str(abs(power)) if abs(power) > 1 else ""))
    text = "*".join(above) or "1"
    if below:
        text += "/" + (below[0] if len(below) == 1 else f"({' '.join(below)})")
    return text


def _kinds(reading: _Reading) -> dict[str, tuple[Fraction, Fraction]]:
    """Kinds a unit may be read as, the first by default, each with factor and offset."""
    tokens, dimension, ratio = reading.tokens, reading.dimension, reading.ratio
    plain = (ratio, Fraction(0))
    if tokens == {"degC": 1}:
        return {"temperature": (ratio, _ABSOLUTE_ZERO)}
    if tokens == {"K": 1}:
        return {"temperature_rise": plain, "temperature": plain}
    if tokens == {"min": -1}:
        return {"angular_speed": (ratio * 2 * _PI, Fraction(0)), "frequency": plain}
    if tokens == {"s": -1}:
        return {"frequency": plain, "angular_speed": plain}
    if tokens == {"s": -2}:
        return {"angular_acceleration": plain}
    if tokens == {"s": -3}:
        return {"angular_jerk": plain}
    if dimension in _BY_FLAVOUR and reading.angle == 0:
        of_force, of_energy = _BY_FLAVOUR[dimension]
        used = set(tokens)
        if used & _ENERGY_TOKENS:
            return {of_energy: plain}
        lever = any(tokens[name] > 0 for name in used & _LENGTH_TOKENS)
        moment = bool(used & (_MOMENT_TOKENS | {"mkp", "kpm"})) or (bool(used & _FORCE_TOKENS) and lever)
        if dimension in (_ENERGY, _POWER):
            if used & _HISTORIC_TOKENS or not used & (_FORCE_TOKENS | _MOMENT_TOKENS):
                # the kilopond metre measured torque and work alike, and base units say neither
                return {of_force: plain, of_energy: plain}
            return {of_force: plain}
        return {of_energy: plain} if moment else {of_force: plain}
    kind = _BY_DIMENSION.get((dimension, reading.angle))
    return {kind or f"quantity in {_si_text(dimension, reading.angle)}": plain}


def _in_words(kind: str) -> tuple[str, tuple[str, ...]]:
    if kind in _KINDS:
        return _KINDS[kind]
    return f"a {kind}", (kind.removeprefix("quantity in "),)


def _wrong_kind(text: str, kind: str, found: str) -> str:
    """Say which units fit a kind, and what the given unit would have been."""
    words, units = _in_words(kind)
    listed = units[0] if len(units) == 1 else f"{', '.join(units[:-1])} or {units[-1]}"
    measures = f"{text} measures {_in_words(found)[0]}"
    if kind == "dimensionless":
        return f"{words}, or one in %; {measures}"
    if kind not in _KINDS:
        return f"{words}; {measures}"
    if kind == "temperature_rise" and found == "temperature":
        return f"{words} in K: a difference of 20 degC is typed as 20 K"
    if kind == "angular_speed" and found == "frequency":
        return (
            f"{words}: type 1/min or rpm for revolutions per minute, rad/s or deg/s for an angle per time; "
            f"{text} counts events (50 turns per second are 3000 1/min)"
        )
    if kind == "frequency" and found == "angular_speed":
        return f"{words}: type 1/h, 1/min, 1/s or Hz; {text} is an angular speed"
    return f"{words}, for example in {listed}; {measures}"


@lru_cache(maxsize=4096)
def _resolve(text: str, kind: str | None) -> Unit:
    reading = _read(text)
    kinds = _kinds(reading)
    chosen = next(iter(kinds)) if kind is None else kind
    if chosen not in kinds:
        raise _Refused(_wrong_kind(text, chosen, next(iter(kinds))))
    ratio, offset = kinds[chosen]
    return Unit(text, float(ratio), float(offset), chosen, reading.dimension, ratio)


def parse_unit(text: str, kind: str | None = None) -> Unit:
    """Read a unit.

    Parameters
    ----------
    text : str
        The unit, for example ``N/mm2``.
    kind : str, optional
        Read the unit as one of this kind. Without it the unit is a declared one and the kind follows from it.

    Returns
    -------
    Unit
        Factor, offset, kind and dimension.

    Raises
    ------
    InputError
        The text is not in the grammar, or the unit is not one of the kind.

    Examples
    --------
    >>> parse_unit("N/mm2").factor
    1000000.0
    >>> parse_unit("1/min").kind, parse_unit("1/min", "frequency").factor
    ('angular_speed', 0.016667)
    """
    return _unit(text, kind, "unit")


def _unit(text: object, kind: str | None, name: str) -> Unit:
    if not isinstance(text, str):
        raise InputError(name, text, "a unit as text, for example 'N*m'")
    try:
        return _resolve(text, kind)
    except _Refused as refusal:
        raise InputError(name, text, refusal.expected) from None


# ---- numbers --------------------------------------------------------------------------------------------------------

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_MINUS = "−‐‑‒–—﹣－"
_LARGEST_EXPONENT = 1000
_MOST_DIGITS = 40
_SURELY_NORMAL = 1e-200  # below, numbers lose digits
_FAR = 1e-14  # relative, more than floats round
_WIDE = Context(prec=60)


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
def _converter(ratio: Fraction, offset: float) -> Callable[[str], float]:
    """Give the function from the text of a number to its SI value."""
    power = _power_of_ten(ratio)
    if power is not None and offset == 0.0:
        return lambda number: _shifted(number, power)
    shift = _ABSOLUTE_ZERO if offset else Fraction(0)

    def exact(number: str) -> float:
        # a fraction of 1e999999999 would fill the memory before it could be called too large
        if abs(int(re.split("[eE]", number)[1] if "e" in number.lower() else 0)) > _LARGEST_EXPONENT:
            return float(number) * float(ratio) + offset
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
    return _converter(unit.ratio, unit.offset)(number)


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
    number, rest = _split_number(text, text, name)
    if rest:
        raise InputError(name, text, "a plain number without a unit in this place")
    return number


def _split_number(text: str, value: object, name: str, declared: str = "-") -> tuple[str, str]:
    """Split a quantity written as text into its number and the rest; the declared unit serves as an example."""
    plain = text.translate(_SPACES).strip()
    if not plain:
        raise InputError(name, value, "a number, not an empty text")
    if any(sign in plain for sign in _MINUS) and re.search(rf"(?:^|[eE])[{_MINUS}]\s*[0-9.]", plain):
        raise InputError(name, value, "the keyboard's minus sign (-) instead of a typographic dash")
    if re.match(r"[+-]?(?:nan|inf|infinity|\.nan|\.inf)\b", plain, re.IGNORECASE):
        raise InputError(name, value, "a finite number")
    match = _NUMBER.match(plain)
    if match is None:
        if re.match(r"[+-]?,[0-9]", plain):
            raise InputError(name, value, "a decimal point instead of a decimal comma, for example 0.5")
        if re.match(r"[+-] +[0-9.]", plain):
            raise InputError(name, value, "no blank between the sign and the number")
        if _is_unit(plain):
            raise InputError(name, value, f"a number before the unit, for example 1 {plain}")
        if declared == "-":
            raise InputError(name, value, "a number, for example 30")
        raise InputError(
            name, value, f"a number, with a unit if it is not in {declared}, for example 30 or 30 {declared}"
        )
    number, rest = match[0], plain[match.end() :]
    if len(number) > _LONGEST:
        raise InputError(name, value, f"a number of at most {_LONGEST} characters")
    if re.match(r",[0-9]{3}(?:[,.][0-9]|\Z|[^0-9])", rest):
        raise InputError(
            name,
            value,
            "a number without a comma: a decimal point for decimals (1.5), nothing between thousands (1500)",
        )
    if re.match(r",[0-9]", rest):
        raise InputError(name, value, "a decimal point instead of a decimal comma, for example 6.5")
    if re.match(r"(?: [0-9]{3}(?![0-9])|['’_][0-9])", rest):
        raise InputError(name, value, "a number without a separator between the thousands, for example 1500")
    if re.match(r"[.'’_,]", rest):
        raise InputError(name, value, "one number with at most one decimal point, for example 1500.5")
    return number, rest.strip()


def _is_unit(text: str) -> bool:
    try:
        _resolve(text, None)
    except _Refused:
        return False
    return True


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
        return format_quantity(self.si, self.unit, None)

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
        number, rest = _split_number(value, value, field, unit.text)
        if rest:
            try:
                unit = _resolve(rest, unit.kind)
            except _Refused as refusal:
                raise InputError(field, value, refusal.expected) from None
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
    si = value.si if isinstance(value, Quantity) else number_to_si(number, unit)
    if not math.isfinite(si):
        raise InputError(field, value, "a number that a computer can hold (below 1e308 in SI units)")
    if unit.kind == "temperature" and si < 0.0:
        raise InputError(field, value, "a temperature above absolute zero (-273.15 degC)")
    return si


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
    number = number.normalize(_WIDE)
    sign, digits, _ = number.as_tuple()
    if not number:
        return "0"
    adjusted = number.adjusted()
    if -5 <= adjusted < 16:
        return format(number, "f")
    text = "".join(map(str, digits))
    return f"{'-' if sign else ''}{text[0]}{'.' + text[1:] if len(text) > 1 else ''}e{adjusted}"


def format_quantity(si: float, unit: str | Unit, digits: int | None = 6) -> str:
    """Write an SI value with its unit.

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
    >>> format_quantity(600.0, "N*m"), format_quantity(0.1, "-")
    ('600 N*m', '0.1')
    >>> format_quantity(26.6, "1/min", digits=None)
    '254.01128917466497 1/min'
    """
    unit = unit if isinstance(unit, Unit) else parse_unit(unit)
    si = float(si)
    if not math.isfinite(si):
        number = repr(si)
    elif digits is None:
        number = _shortest(si, unit)
    else:
        number = _as_text(Context(prec=digits).plus(_in_unit(si, unit)))
    if unit.text == "-":
        return number
    return f"{number}{'' if unit.text == '°' else ' '}{unit.text}"


def _in_unit(si: float, unit: Unit) -> Decimal:
    """Convert an SI value to a unit, to 60 digits."""
    exact = (Fraction(si) - (_ABSOLUTE_ZERO if unit.offset else 0)) / unit.ratio
    return _WIDE.divide(Decimal(exact.numerator), Decimal(exact.denominator))


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
        whole = math.ceil(shown / step - 0.01) if up else math.floor(shown / step + 0.01)
        # The first is rounded; then comes the next number, and those of fewer digits beyond it.
        whole += (1 if up else -1) if less else 0
        text = f"{float(f'{whole * step:.{digits}g}'):.{digits}g}"
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
