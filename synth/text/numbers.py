"""Numbers as people read them. One rule gives sign, digits and power of ten; printers choose characters only.

``number_cases.json`` beside this file holds cases that this module and ``synth/ui/numbers.js`` must agree on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Context, Decimal

DIGITS = 4  # significant, on screens, in messages and reports
STEP_DIGITS = 5  # in calculation steps
FULL_DIGITS = 6  # where a limit is violated, two texts would be equal, or a number was typed
SHARE_DIGITS = 3  # of per cents and factors
PLAIN = -4, 6  # exponents of numbers that are written without a power of ten
LEAST_PER_CENT = 0.001  # shown as a bound below it
GROUPED = 5  # digits before the point from which on they stand in groups of three
COLUMN_SPREAD = 30.0  # ratio of the largest to the least number of a column from which on each has its own decimals
LARGEST_IN_PER_CENT = 10.0  # shares from which on a sentence speaks of so many times
LARGEST_FACTOR = 1e6  # shares above it are no comparison
RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
UNKNOWN, NOT_A_NUMBER, INFINITE = "–", "not known", "∞"
MINUS, THIN = "\u2212", "\u202f"  # of pages and sheets
_EXACT = Context(prec=1100, rounding=ROUND_HALF_UP)  # holds every float with all its binary digits


@dataclass(frozen=True)
class Shown:
    """A number as it is shown: sign, digits without groups, power of ten."""

    sign: str
    digits: str
    power: int = 0

    def terminal(self) -> str:
        """Text in the characters of terminals and comments in CSV files."""
        return f"{self.sign}{grouped(self.digits)}{self._raised()}"

    def page(self) -> str:
        """Text in the characters of pages and sheets."""
        return f"{MINUS if self.sign else ''}{grouped(self.digits, THIN)}{self._raised()}"

    def typed(self) -> str:
        """Text as specs have it: no groups, the power of ten behind an e."""
        power = f"e{self.power}" if self.power else ""
        return f"{self.sign}{self.digits}{power}"

    def _raised(self) -> str:
        return f"·10{str(self.power).translate(RAISED)}" if self.power else ""


def shown(x: float | Decimal | None, digits: int = DIGITS) -> Shown:
    """Sign, digits and power of ten of a number.

    Parameters
    ----------
    x : float, Decimal or None
        Number; None is one that is not known.
    digits : int
        Significant digits. Digits before the point are never replaced by zeros.

    Examples
    --------
    >>> shown(1058.8235), shown(9.999e-5), shown(-1234567.8).terminal()
    (Shown(sign='', digits='1059', power=0), Shown(sign='', digits='9.999', power=-5), '-1 234 568')
    """
    if x is None:
        return Shown("", UNKNOWN)
    exact = x if isinstance(x, Decimal) else Decimal(float(x))
    if exact.is_nan():
        return Shown("", NOT_A_NUMBER)
    sign, size = "-" if exact < 0 else "", exact.copy_abs()
    if size.is_infinite():
        return Shown(sign, INFINITE)
    if not size:
        return Shown("", "0")
    rounded = Context(prec=digits, rounding=ROUND_HALF_UP).plus(size)
    exponent = rounded.adjusted()
    if PLAIN[0] <= exponent <= PLAIN[1]:
        return Shown(sign, _trimmed(_fixed(size, max(0, digits - 1 - exponent))))
    return Shown(sign, _trimmed(f"{rounded.scaleb(-exponent):f}"), exponent)


def number_text(x: float | Decimal | None, digits: int = DIGITS) -> str:
    """Number in the characters of terminals.

    Examples
    --------
    >>> [number_text(x) for x in (14.568237, 21017.3, 0.00082654, 1.0, -0.25, None, -7.3456e-23)]
    ['14.57', '21 017', '0.0008265', '1', '-0.25', '–', '-7.346·10⁻²³']
    """
    return shown(x, digits).terminal()


def page_text(x: float | Decimal | None, digits: int = DIGITS) -> str:
    """Number in the characters of pages and sheets."""
    return shown(x, digits).page()


def typed_number(x: float | Decimal | None, digits: int = FULL_DIGITS) -> str:
    """Number as specs have it, in messages that name what may be typed.

    Examples
    --------
    >>> typed_number(15577.4), typed_number(206000), typed_number(3.2e-7)
    ('15577.4', '206000', '3.2e-7')
    """
    return shown(x, digits).typed()


def signed(x: float, digits: int = SHARE_DIGITS) -> str:
    """Number with its sign, a plus too, in the characters of terminals.

    Examples
    --------
    >>> signed(0.0514), signed(-12.5, 2), signed(0.0)
    ('+0.0514', '-13', '0')
    """
    return f"{'+' if x > 0 else ''}{number_text(x, digits)}"


def percent(share: float | None, digits: int = SHARE_DIGITS) -> str:
    """Share in per cent.

    Examples
    --------
    >>> percent(0.12345), percent(12.5), percent(1e-6), percent(0.0)
    ('12.3 %', '1250 %', '< 0.001 %', '0 %')
    """
    if share is None or math.isnan(share):
        return number_text(share)
    if 0 < abs(100 * share) < LEAST_PER_CENT:
        return f"< {LEAST_PER_CENT} %" if share > 0 else f"> -{LEAST_PER_CENT} %"
    return f"{number_text(100 * share, digits)} %"


def gap_text(gap: float, digits: int = SHARE_DIGITS) -> str:
    """Proven gap in per cent: what is claimed is not rounded to "less than".

    Examples
    --------
    >>> gap_text(0.001), gap_text(1e-6)
    ('0.1 %', '0.0001 %')
    """
    return f"{number_text(100 * gap, digits)} %"


def used_share(share: float | None) -> str:
    """Used share of a limit, in per cent: more digits where a violated limit would be shown as used in full.

    Examples
    --------
    >>> used_share(0.5), used_share(1.0), used_share(1.00004), used_share(1.234)
    ('50 %', '100 %', '100.004 %', '123 %')
    """
    text = percent(share)
    return percent(share, FULL_DIGITS) if share is not None and share > 1 and text == percent(1.0) else text


def more_or_less(change: float, more: bool) -> str:
    """Change as a share of what was, in words.

    Examples
    --------
    >>> more_or_less(0.617, True), more_or_less(0.2, False), more_or_less(24.0, True)
    ('61.7 % more', '20 % less', '25 times as much')
    """
    if more and change >= LARGEST_IN_PER_CENT:
        return f"{times(1.0 + change)} as much"
    return f"{percent(change)} {'more' if more else 'less'}"


def times(factor: float) -> str:
    """Factor in words.

    Examples
    --------
    >>> times(516.3), times(1e305)
    ('516 times', 'over a million times')
    """
    return f"{number_text(factor, SHARE_DIGITS)} times" if factor < LARGEST_FACTOR else "over a million times"


def thousands(number: int) -> str:
    """Whole number in full, in the characters of terminals.

    Examples
    --------
    >>> thousands(12000), thousands(9999), thousands(123456789)
    ('12 000', '9999', '123 456 789')
    """
    return f"{'-' if number < 0 else ''}{grouped(str(abs(number)))}"


def column_texts(values: Sequence[float | None], digits: int = DIGITS) -> list[str]:
    """Numbers of a column in the characters of terminals, all with the decimals needed, as far as the largest has them.

    Numbers of very different size, or with a power of ten, have each their own digits.

    Examples
    --------
    >>> column_texts([14.568, 9.4, None]), column_texts([12.0, 8.0]), column_texts([0.0082654, 0.0033])
    (['14.57', '9.40', '–'], ['12', '8'], ['0.008265', '0.003300'])
    >>> column_texts([9.4, 0.41234]), column_texts([1234.5, 0.25]), column_texts([7.3456e-23, 1e-24])
    (['9.400', '0.412'], ['1235', '0.25'], ['7.346·10⁻²³', '1·10⁻²⁴'])
    """
    decimals = column_decimals(values, digits)
    if decimals is None:
        return [number_text(x, digits) for x in values]
    return [
        number_text(x, digits)
        if x is None or not math.isfinite(x) or x == 0
        else f"{'-' if x < 0 else ''}{grouped(_fixed(Decimal(float(x)).copy_abs(), decimals))}"
        for x in values
    ]


def column_decimals(values: Sequence[float | None], digits: int = DIGITS) -> int | None:
    """Decimals of all numbers of a column; None where each has its own digits."""
    known = [x for x in values if x is not None and math.isfinite(x) and x]
    if not known:
        return None
    each = [shown(x, digits) for x in known]
    largest, least = max(map(abs, known)), min(map(abs, known))
    if largest > COLUMN_SPREAD * least or any(one.power for one in each):
        return None
    needed = max(len(one.digits.partition(".")[2]) for one in each)
    return min(needed, max(0, digits - 1 - math.floor(math.log10(largest))))


def grouped(digits: str, gap: str = " ") -> str:
    """Digits with their integer part in groups of three, from five of them on."""
    integer, point, decimals = digits.partition(".")
    if len(integer) < GROUPED or not integer.isdigit():
        return digits
    first = len(integer) % 3 or 3
    return gap.join((integer[:first], *(integer[k : k + 3] for k in range(first, len(integer), 3)))) + point + decimals


def _fixed(size: Decimal, decimals: int) -> str:
    return f"{size.quantize(Decimal(1).scaleb(-decimals), context=_EXACT):f}"


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text
