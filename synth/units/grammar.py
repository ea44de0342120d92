"""The grammar of units."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache

from synth.errors import InputError
from synth.text.input_limits import INPUT_LIMITS
from synth.text.notices import notice
from synth.units.spellings import AMBIGUOUS, SPACES, WORDS, readings

_PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")
_FAHRENHEIT = Fraction(5, 9)
# token: (factor, kelvin at its zero); these stand alone
_DEGREES = {"degC": (Fraction(1), Fraction("273.15")), "degF": (_FAHRENHEIT, Fraction("459.67") * _FAHRENHEIT)}
_KP = Fraction("9.80665")
# The yard and pound agreement of 1959: exact.
_FOOT = Fraction("0.3048")
_INCH = _FOOT / 12
_POUND = Fraction("0.45359237")
_LBF = _POUND * _KP
_TINY = Fraction(1, 10**100)


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
        Added after the factor [K]; 273.15 for degC, 255.37 for degF, else 0.
    kind : str
        Name of the kind, for example ``torque``.
    dimension : tuple of int
        Exponents of kg, m, s, K, A; an angle has none.
    ratio : Fraction
        The factor without rounding (angles: to 60 digits).
    shift : Fraction
        The offset without rounding.
    """

    text: str
    factor: float
    offset: float
    kind: str
    dimension: tuple[int, int, int, int, int]
    ratio: Fraction = field(repr=False, compare=False)
    shift: Fraction = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class _UnitText:
    """A parsed unit text before its kind is settled."""

    ratio: Fraction
    dimension: tuple[int, int, int, int, int]
    angle: int
    tokens: dict[str, int]


_NONE = (0, 0, 0, 0, 0)
_MASS = (1, 0, 0, 0, 0)
_LENGTH = (0, 1, 0, 0, 0)
_VOLUME = (0, 3, 0, 0, 0)
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


def _others(dimension: _Dimension, **factors: Fraction) -> dict[str, tuple[Fraction, _Dimension, int]]:
    return {name: (factor, dimension, 0) for name, factor in factors.items()}


# token: (SI factor, dimension, power of an angle)
_TOKENS: dict[str, tuple[Fraction, _Dimension, int]] = {
    **_decades(_LENGTH, um=-6, mm=-3, cm=-2, dm=-1, m=0, km=3),
    "in": (_INCH, _LENGTH, 0),
    "ft": (_FOOT, _LENGTH, 0),
    **_decades(_VOLUME, l=-3),
    **_others(_VOLUME, USgal=231 * _INCH**3),
    **_decades(_MASS, g=-3, kg=0, t=3),
    **_others(_MASS, lb=_POUND, oz=_POUND / 16, slug=_LBF / _FOOT),
    **_decades(_TIME, ms=-3, s=0),
    **_others(_TIME, min=Fraction(60), h=Fraction(3600)),
    **_decades(_RATE, Hz=0, kHz=3),
    **_decades(_FORCE, mN=-3, cN=-2, N=0, daN=1, kN=3, MN=6),
    **_others(_FORCE, kp=_KP, kgf=_KP, lbf=_LBF, ozf=_LBF / 16),
    **_decades(_ENERGY, Nmm=-3, mNm=-3, Nm=0, kNm=3),
    **_others(_ENERGY, mkp=_KP, kpm=_KP),
    **_decades(_PRESSURE, Pa=0, kPa=3, bar=5, MPa=6, GPa=9),
    **_others(_PRESSURE, psi=_LBF / _INCH**2),
    **_decades(_ENERGY, mJ=-3, J=0, kJ=3, MJ=6),
    **_others(_ENERGY, Wh=Fraction(3600), kWh=Fraction(3600000)),
    **_decades(_POWER, W=0, kW=3, MW=6),
    **_others(_POWER, hp=550 * _FOOT * _LBF, PS=75 * _KP),
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
_ALIASES = {"µm": "um", "μm": "um", "°C": "degC", "°F": "degF"}
_FORCE_TOKENS = frozenset({"mN", "cN", "N", "daN", "kN", "MN", "kp", "kgf", "lbf", "ozf"})
_MOMENT_TOKENS = frozenset({"Nmm", "mNm", "Nm", "kNm"})
# The metre of these forces, or the foot, measures torque and work alike.
_TORQUE_OR_WORK_TOKENS = frozenset({"kp", "mkp", "kpm", "kgf", "lbf", "ozf"})
_ENERGY_TOKENS = frozenset({"mJ", "J", "kJ", "MJ", "Wh", "kWh", "W", "kW", "MW", "hp", "PS"})
_LENGTH_TOKENS = frozenset({"um", "mm", "cm", "dm", "m", "km", "in", "ft"})

# kind: (in words, units to type)
_KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "dimensionless": ("a number without a unit", ("-", "%")),
    "angle": ("an angle", ("deg", "rad")),
    "length": ("a length", ("mm", "cm", "m")),
    "area": ("an area", ("mm2", "cm2", "m2")),
    "volume": ("a volume", ("mm3", "cm3", "dm3")),
    "flow": ("a flow (volume per time)", ("l/min", "l/s", "m3/h")),
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

TORQUE_OF_POWER = "T = P/omega, the angular speed of the same shaft"

# (dimension, power of the angle): kind, where flavour plays no part
_BY_DIMENSION: dict[tuple[_Dimension, int], str] = {
    (_NONE, 0): "dimensionless",
    (_NONE, 1): "angle",
    (_LENGTH, 0): "length",
    ((0, 2, 0, 0, 0), 0): "area",
    (_VOLUME, 0): "volume",
    ((0, 3, -1, 0, 0), 0): "flow",
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
_MASSES = re.compile(r"\b(kg|lb|oz)(?![^\W\d])")
_TOKEN = re.compile(r"([^\W\d_]+|°)(\^?)([2-9])?\Z")
_GRAMMAR = (
    "a unit such as N*m, J/(mm2 h) or 1/min: tokens joined by a space, * or /, exponent as a digit after the token"
)


class RefusedUnit(Exception):
    """A sentence on its way to the place that knows the field."""

    def __init__(self, expected: str) -> None:
        self.expected = expected
        super().__init__(expected)


def _factor(text: str, unit_text: str) -> tuple[str, int]:
    """Token and exponent of one factor of a unit."""
    plain = text.translate(_SUPERSCRIPTS)
    name = _ALIASES.get(plain, plain)
    if name in (*_DEGREES, "%", "-"):
        if name in _DEGREES:
            raise RefusedUnit("K inside a compound unit, where a temperature is a difference")
        raise RefusedUnit(f"{plain!r} to stand alone as a unit")
    match = _TOKEN.match(plain)
    if match is None:
        if "^-" in plain or "⁻" in text:
            raise RefusedUnit("a fraction instead of a negative exponent, for example 1/min")
        raise RefusedUnit(_GRAMMAR if text else f"a token on both sides of every joint of {unit_text!r}; {_GRAMMAR}")
    name = _ALIASES.get(match[1], match[1])
    if match[2] and not match[3]:
        raise RefusedUnit("an exponent 2 to 9 after ^")
    if name not in _TOKENS:
        raise RefusedUnit(_unknown(name))
    return name, int(match[3] or 1)


def _unknown(name: str) -> str:
    """Say what is right instead of a token that is not in the grammar."""
    known = [*_TOKENS, *_DEGREES]
    same = [token for token in known if token.casefold() == name.casefold()]
    if same:
        return f"{' or '.join(same)} instead of {name} (capitals matter in units)"
    meant = WORDS.get(name) or WORDS.get(name.casefold())
    if meant is not None:
        return f"{meant} instead of {name}"
    if name.casefold() in AMBIGUOUS:
        return AMBIGUOUS[name.casefold()]
    return f"a known unit instead of {name}: one of {', '.join(known)}, - or %"


def _read(text: str) -> _UnitText:
    """Read a unit text; the kind is not settled yet."""
    if not text:
        raise RefusedUnit("a unit; - where there is none")
    if len(text) > INPUT_LIMITS.quantity:
        raise RefusedUnit(f"a unit of at most {INPUT_LIMITS.quantity} characters")
    if text == "-":
        return _UnitText(Fraction(1), _NONE, 0, {"-": 1})
    if text == "%":
        return _UnitText(Fraction(1, 100), _NONE, 0, {"%": 1})
    token = _ALIASES.get(text, text)
    if token in _DEGREES:
        return _UnitText(_DEGREES[token][0], _KELVIN, 0, {token: 1})
    if "**" in text:
        raise RefusedUnit("an exponent as a digit after the token, for example mm2")
    if text[0] == "/":
        raise RefusedUnit(f"1 as an empty numerator: 1{text}")
    powers: dict[str, int] = {}
    remainder = _tight(text)
    sign, first = 1, True
    while True:
        if remainder.startswith("("):
            if sign > 0:
                raise RefusedUnit("brackets in a denominator only, for example J/(mm2 h)")
            inside, closed, remainder = remainder[1:].partition(")")
            if not closed:
                raise RefusedUnit("a closing bracket")
            factors = re.split(r"[ *·]", inside)
            if "/" in inside or "(" in inside:
                raise RefusedUnit("a product of tokens in the bracket, for example J/(mm2 h)")
        else:
            match = re.match(r"[^ *·/()]*", remainder)
            one = match[0] if match else ""
            remainder = remainder[len(one) :]
            if one == "1" and first and remainder.startswith("/"):
                factors = []
            else:
                factors = [one]
        for item in factors:
            name, exponent = _factor(item, text)
            powers[name] = powers.get(name, 0) + sign * exponent
        first = False
        if not remainder:
            break
        if remainder[0] not in " *·/":
            raise RefusedUnit(_GRAMMAR)
        sign = -1 if remainder[0] == "/" else 1
        remainder = remainder[1:]
    return _combine(powers)


def _tight(text: str) -> str:
    """Drop the spaces that mean nothing: around a joint and inside a bracket."""
    return re.sub(r" *([*·/]) *", lambda m: m[1], re.sub(r"\( *", "(", re.sub(r" *\)", ")", text.translate(SPACES))))


def _combine(powers: dict[str, int]) -> _UnitText:
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
        raise RefusedUnit("a unit that is neither this large nor this small")
    return _UnitText(ratio, (kg, m, s, kelvin, ampere), angle, powers)


def si_text(dimension: Sequence[int], angle: int = 0) -> str:
    """Write a dimension (exponents of kg, m, s, K, A) as a unit in SI in the grammar of this module.

    Examples
    --------
    >>> si_text((1, 2, -2, 0, 0)), si_text((0, 0, 0, 0, 0))
    ('kg*m2/s2', '1')
    """
    above: list[str] = []
    below: list[str] = []
    for name, power in zip(("kg", "m", "s", "K", "A", "rad"), (*dimension, angle), strict=True):
        if power:
            (above if power > 0 else below).append(name + (str(abs(power)) if abs(power) != 1 else ""))
    text = "*".join(above) or "1"
    if below:
        text += "/" + (below[0] if len(below) == 1 else f"({' '.join(below)})")
    return text


def _kinds(reading: _UnitText) -> dict[str, tuple[Fraction, Fraction]]:
    """Kinds a unit may be read as, the first by default, each with factor and offset."""
    tokens, dimension, ratio = reading.tokens, reading.dimension, reading.ratio
    plain = (ratio, Fraction(0))
    if not tokens.keys().isdisjoint(_DEGREES):
        return {"temperature": _DEGREES[next(iter(tokens))]}
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
            if used & _TORQUE_OR_WORK_TOKENS or not used & (_FORCE_TOKENS | _MOMENT_TOKENS):
                # base units say neither
                return {of_force: plain, of_energy: plain}
            return {of_force: plain}
        return {of_energy: plain} if moment else {of_force: plain}
    kind = _BY_DIMENSION.get((dimension, reading.angle))
    return {kind or f"quantity in {si_text(dimension, reading.angle)}": plain}


def _in_words(kind: str) -> tuple[str, tuple[str, ...]]:
    if kind in _KINDS:
        return _KINDS[kind]
    return f"a {kind}", (kind.removeprefix("quantity in "),)


def _wrong_kind(text: str, kind: str, actual: str) -> str:
    """Sentence on the units that fit a kind, and on the actual kind of the given unit."""
    words, units = _in_words(kind)
    listed = units[0] if len(units) == 1 else f"{', '.join(units[:-1])} or {units[-1]}"
    measures = f"{text} measures {_in_words(actual)[0]}"
    if kind == "dimensionless":
        return f"{words}, or one in %; {measures}"
    if kind not in _KINDS:
        return f"{words}; {measures}"
    if kind == "temperature_rise" and actual == "temperature":
        return f"{words} in K: a difference of 20 degC (36 degF) is typed as 20 K"
    if kind == "angular_speed" and actual == "frequency":
        return (
            f"{words}: type 1/min or rpm for revolutions per minute, rad/s or deg/s for an angle per time; "
            f"{text} counts events (50 turns per second are 3000 1/min)"
        )
    if kind == "frequency" and actual == "angular_speed":
        return f"{words}: type 1/h, 1/min, 1/s or Hz; {text} is an angular speed"
    if kind == "torque" and actual == "power":
        measures += f" ({TORQUE_OF_POWER})"
    return f"{words}, for example in {listed}; {measures}"


@lru_cache(maxsize=4096)
def _resolve(text: str, kind: str | None) -> Unit:
    """Return the unit that a text names strictly, of a kind where one is asked; raise RefusedUnit where none."""
    reading = _read(text)
    kinds = _kinds(reading)
    chosen = next(iter(kinds)) if kind is None else kind
    if chosen not in kinds:
        raise RefusedUnit(_wrong_kind(text, chosen, next(iter(kinds))))
    ratio, shift = kinds[chosen]
    return Unit(text, float(ratio), float(shift), chosen, reading.dimension, ratio, shift)


@lru_cache(maxsize=4096)
def _respelled(text: str, kind: str) -> Unit | None:
    """Find the unit of a kind that a text outside the grammar stands for; None where it is no unit.

    Raises
    ------
    RefusedUnit
        It is of another kind, or may stand for several units.
    """
    possible = readings(text, {*_TOKENS, *_ALIASES}) if len(text) <= INPUT_LIMITS.quantity else []
    fitting, others = _fitting(possible, kind)
    if len(fitting) > 1:
        raise RefusedUnit(f"{' or '.join(unit.text for unit in fitting.values())} instead of {text}: it may be either")
    if fitting:
        return next(iter(fitting.values()))
    forces, _ = _fitting([_MASSES.sub(lambda mass: f"{mass[0]}f", read) for read in possible], kind)
    if forces:
        raise RefusedUnit(f"{next(iter(forces.values())).text} instead of {text}: a mass is no force")
    if others:
        raise others[0]
    return None


def _fitting(texts: Iterable[str], kind: str) -> tuple[dict[Fraction, Unit], list[RefusedUnit]]:
    """Units of a kind among texts of the grammar, by their factors, and what is wrong with the others."""
    fitting: dict[Fraction, Unit] = {}
    others: list[RefusedUnit] = []
    for text in texts:
        try:
            unit = _resolve(text, kind)
            fitting.setdefault(unit.ratio, unit)
        except RefusedUnit as refusal:
            others.append(refusal)
    return fitting, others


def resolve(text: str, kind: str) -> Unit:
    """Find the unit of a kind that a text names, in our grammar or as name plates have it.

    Raises
    ------
    RefusedUnit
        It names none.
    """
    try:
        return _resolve(text, kind)
    except RefusedUnit:
        unit = _respelled(text, kind)
        if unit is None:
            raise
        notice(f"read as {unit.text}: {text}")
        return unit


def parse_unit(text: str, kind: str | None = None) -> Unit:
    """Read a unit.

    Parameters
    ----------
    text : str
        The unit, for example ``N/mm2``.
    kind : str, optional
        Read the unit as one of this kind, in whatever way people write it. Without it the unit is a declared one, in
        our grammar, and the kind follows from it.

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
        return _resolve(text, None) if kind is None else resolve(text, kind)
    except RefusedUnit as refusal:
        raise InputError(name, text, refusal.expected) from None


def is_unit(text: str) -> bool:
    """True if a text names a unit."""
    try:
        _resolve(text, None)
    except RefusedUnit:
        return False
    return True
