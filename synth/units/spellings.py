"""Units as name plates, data sheets and keyboards of many countries have them, as texts of our own grammar.

Nothing is decided here: a spelling may have several readings, and which of them is meant is for whoever knows the kind
of the quantity. ``lb-ft`` is ``lbf*ft`` in a torque, and ``lb*ft`` elsewhere.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection

SPACES = dict.fromkeys((0x00A0, 0x2007, 0x2009, 0x202F), " ")
# Words that stand for units of the grammar. Case is folded here alone: elsewhere it tells mN from MN.
WORDS = {
    "u": "rev",
    "r": "rev",
    "tr": "rev",
    "upm": "rpm",
    "sec": "s",
    "hr": "h",
    "hour": "h",
    "hours": "h",
    "l": "l",
    "ml": "cm3",
    "inch": "in",
    "inches": "in",
    '"': "in",
    "″": "in",
    "foot": "ft",
    "feet": "ft",
    "lbs": "lb",
    "lbm": "lb",
    "cv": "PS",
    "degree": "deg",
    "degrees": "deg",
    "celsius": "degC",
    "c": "degC",
    "fahrenheit": "degF",
    "f": "degF",
    "ω": "ohm",
    # American plates are in capitals throughout.
    **{word.upper(): word for word in ("rpm", "hp", "psi", "min", "in", "ft", "lb", "lbf", "oz", "ozf")},
}
# What has several meanings in every kind, with what is right in its place.
AMBIGUOUS = {
    "gpm": "US gpm instead of gpm: an imperial gallon is a fifth larger",
    "gal": "USgal instead of gal: an imperial gallon is a fifth larger",
    "gd": "the inertia J = GD2/4 in kg*m2, where GD2 is in kg m2",
}
FORCES = {"lb": "lbf", "oz": "ozf"}  # masses that forces are called by in products
MOST_READINGS = 64
MOST_LETTERS = 8  # of a product that is written as one word
_CHARACTERS = {
    **dict.fromkeys(map(ord, "⋅∙•×"), "·"),
    **dict.fromkeys(map(ord, "−‐‑‒–—﹣－⁻"), "-"),
    **{ord(raised): str(digit) for digit, raised in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")},
}
_DEGREES = re.compile(r"(?:°|deg(?:rees?)?) ?([CF])", re.IGNORECASE)
_GALLONS = re.compile(r"\bUS ?(?:gal|(gpm))\b", re.IGNORECASE)
_PER = re.compile(r" ?\bper\b ?", re.IGNORECASE)
_FACTOR = re.compile(r"([^\W\d_]+|[°\"″])(?:\^?(-[1-9]|[2-9]))?")
_JOINT = re.compile(r" *[*·] *| *- *(?=[^\W\d_])| +")

Powers = list[tuple[str, int]]  # tokens with their exponents


def readings(text: str, tokens: Collection[str]) -> list[str]:
    """Texts of our grammar that a spelling may stand for; none where it is no unit.

    Parameters
    ----------
    text : str
        The unit as it was typed.
    tokens : collection of str
        Those of the grammar.

    Examples
    --------
    >>> known = ("kg", "m", "min", "rev", "N", "lb", "lbf", "ft")
    >>> readings("kgm²", known), readings("U/min", known), readings("min^-1", known), readings("lb-ft", known)
    (['kg*m2'], ['rev/min'], ['1/min'], ['lb*ft', 'lbf*ft'])
    """
    plain = " ".join(text.translate(SPACES).translate(_CHARACTERS).split())
    degrees = _DEGREES.fullmatch(plain)
    if degrees:
        return [f"deg{degrees[1].upper()}"]
    plain = re.sub(r"\.(?=[ *·/-]|$)", "", plain).replace(".", "·")  # in.-lb., N.m
    plain = _PER.sub("/", _GALLONS.sub(lambda match: "USgal" + ("/min" if match[1] else ""), plain))
    signed = _signed_factors(plain)
    every = [_powers(factor, sign, tokens) for factor, sign in signed]
    if not every or math.prod(map(len, every)) > MOST_READINGS:
        return []
    texts: dict[str, None] = {}
    for chosen in itertools.product(*every):
        powers = [power for part in chosen for power in part]
        texts[_text(powers)] = None
        if len(powers) > 1:
            texts[_text([(FORCES.get(token, token), exponent) for token, exponent in powers])] = None
    return list(texts)


def _signed_factors(text: str) -> list[tuple[str, int]]:
    """Factors of a unit, with -1 for what a slash divides by; none where it is not put together as units are."""
    above, *below = re.split(" */ *", text)
    factors = [] if above in ("", "1") else [(factor, 1) for factor in _JOINT.split(above)]
    for part in below:
        bracket = re.fullmatch(r"\(([^()]*)\)()", part) or re.fullmatch(rf"(.*?)(?:{_JOINT.pattern}(.*))?", part)
        assert bracket is not None
        factors += [(factor, -1) for factor in _JOINT.split(bracket[1].strip())]
        factors += [(factor, 1) for factor in _JOINT.split(bracket[2] or "") if bracket[2]]
    return factors


def _powers(factor: str, sign: int, tokens: Collection[str]) -> list[Powers]:
    """Possible meanings of one factor: of a product written as one word the exponent is that of the last."""
    match = _FACTOR.fullmatch(factor)
    if match is None:
        return []
    last = int(match[2] or 1)
    words = _split(match[1], tokens)
    return [[*((token, sign * power) for token, power in w[:-1]), (w[-1][0], sign * w[-1][1] * last)] for w in words]


def _split(word: str, tokens: Collection[str]) -> list[Powers]:
    if word in tokens:
        return [[(word, 1)]]
    known = WORDS.get(word) or WORDS.get(word.casefold())
    if known is not None:
        return [[(known.rstrip("3"), 3 if known.endswith("3") else 1)]]
    if len(word) > MOST_LETTERS or any(word.casefold() == token.casefold() for token in tokens):
        return []  # of capitals only a person knows what is meant
    heads = [word[:k] for k in range(1, len(word)) if word[:k] in tokens]
    return [[(head, 1), *tail] for head in heads for tail in _split(word[len(head) :], tokens)]


def _text(powers: Powers) -> str:
    """Text of a product in our grammar, pounds and ounces of force before their levers."""
    ordered = sorted(powers, key=lambda power: power[0] not in FORCES.values())
    above = [_power(token, exponent) for token, exponent in ordered if exponent > 0]
    below = [_power(token, -exponent) for token, exponent in ordered if exponent < 0]
    divided = "" if not below else f"/{below[0]}" if len(below) == 1 else f"/({' '.join(below)})"
    return f"{'*'.join(above) or '1'}{divided}"


def _power(token: str, exponent: int) -> str:
    return token if exponent == 1 else f"{token}{exponent}"
