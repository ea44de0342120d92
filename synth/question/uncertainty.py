"""What scatters around a design, as a question states it: the ``robust`` block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from synth.errors import InputError, at, whole_number
from synth.text.input_limits import INPUT_LIMITS
from synth.units import parse_quantity

LIMITS, RATE = "limits", "rate"
NONE = "none"  # in place of a range: does not scatter here
SAMPLES, LEAST_SAMPLES = 4096, 64
CONFIDENCE = 0.95
KEYS = ("friction", "wear", "tolerance", "mode", "samples", "seed", "confidence", "scenarios")
EXAMPLE = "'+-5 %', '+10 %', '+-0.1 mm' or '10 .. 20 mm'"


@dataclass(frozen=True)
class Uncertainty:
    """A ``robust`` block: what scatters and by how much, as it was written, and what is to be done about it.

    ``scenarios`` are further points of the range at which single limits are posed: name of the limit -> positions.
    """

    ranges: Mapping[str, Any]
    tolerance: Mapping[str, Any] = field(default_factory=dict)
    mode: str = LIMITS
    samples: int = SAMPLES
    seed: int = 0
    confidence: float = CONFIDENCE
    scenarios: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Scattering quantities, as the block names them, in the order of the positions of scenarios."""
        return (*self.ranges, *self.tolerance)

    def block(self) -> dict[str, Any]:
        """Return the block again, as it may stand in a spec."""
        block: dict[str, Any] = dict(self.ranges)
        if self.tolerance:
            block["tolerance"] = dict(self.tolerance)
        block |= {"mode": self.mode, "samples": self.samples, "seed": self.seed, "confidence": self.confidence}
        if self.scenarios:
            block["scenarios"] = {name: [list(p) for p in points] for name, points in self.scenarios.items()}
        return block

    def with_scenarios(self, more: Mapping[str, Sequence[tuple[float, ...]]]) -> Uncertainty:
        """Return the same with more points at which limits are posed."""
        every = {name: self.scenarios.get(name, ()) for name in dict.fromkeys([*self.scenarios, *more])}
        joined = {name: tuple(dict.fromkeys([*known, *more.get(name, ())])) for name, known in every.items()}
        return replace(self, scenarios=MappingProxyType(joined))


def read_block(robust: object, where: str = "robust") -> Uncertainty:
    """Read a ``robust`` block.

    Parameters
    ----------
    robust : mapping or Uncertainty
        What scatters (``friction``, ``wear``, ``tolerance``, a requirement, a ``slot.column``) with its range, and
        ``mode``, ``samples``, ``seed``, ``confidence``.
    where : str
        Its name, for messages.

    Raises
    ------
    InputError
        When something is not understood.
    """
    if isinstance(robust, Uncertainty):
        return robust
    if not isinstance(robust, Mapping):
        raise InputError(where, robust, "names with ranges, for example {'friction': 'catalogue range'}", ("robust",))
    empty = ("tolerance", "scenarios")  # may stand with nothing under them
    block = {str(key): value for key, value in robust.items() if value is not None or key not in empty}
    tolerance = block.get("tolerance", {})
    if not isinstance(tolerance, Mapping):
        expected = "variables with tolerances, for example {'length': '+-0.1 mm'}"
        raise InputError(f"{where}: tolerance", tolerance, expected, ("robust", "tolerance"))
    ranges = {key: value for key, value in block.items() if key not in KEYS[2:]}
    for key, value in [*ranges.items(), *((f"tolerance: {k}", v) for k, v in tolerance.items())]:
        if not isinstance(value, str):
            path = ("robust", *key.split(": ", 1)) if key not in ranges else ("robust", key)
            raise InputError(f"{where}: {key}", value, f"a range with its unit, for example {EXAMPLE}", path)
    if not ranges and not tolerance:
        right = "at least one range, for example 'friction: catalogue range'"
        raise InputError(where, "nothing that scatters", right, ("robust",))
    check_number_of_ranges(len(ranges) + len(tolerance), where)
    mode = block.get("mode", LIMITS)
    if mode not in (LIMITS, RATE):
        right = f"{LIMITS} (limits hold over the range) or {RATE} (designs are rated)"
        raise InputError(f"{where}: mode", mode, right, ("robust", "mode"))
    with at("robust", "samples"):
        samples = _samples(block.get("samples", SAMPLES), f"{where}: samples")
    seed = whole_number(block.get("seed", 0), f"{where}: seed", INPUT_LIMITS.seed, least=0, path=("robust", "seed"))
    with at("robust", "confidence"):
        confidence = _confidence(block.get("confidence", CONFIDENCE), f"{where}: confidence")
    with at("robust", "scenarios"):
        scenarios = _scenarios(block.get("scenarios", {}), f"{where}: scenarios")
    return Uncertainty(
        MappingProxyType(ranges),
        MappingProxyType({str(k): v for k, v in tolerance.items()}),
        mode,
        samples,
        seed,
        confidence,
        scenarios,
    )


def read_remaining(robust: object, where: str = "robust") -> Uncertainty | None:
    """Read a block without what has "none" for a range; None where there is none, or nothing is left that scatters.

    Raises
    ------
    InputError
        When something is not understood.
    """
    if robust is None:
        return None
    if not isinstance(robust, Mapping):
        return read_block(robust, where)
    block = _scattering(robust)
    tolerance = block.get("tolerance")
    if isinstance(tolerance, Mapping):
        block["tolerance"] = tolerance = _scattering(tolerance)
    left = [k for k, v in block.items() if k not in KEYS[2:] or (k == "tolerance" and v)]
    return None if block != robust and not left else read_block(block, where)


def _scattering(ranges: Mapping[str, object]) -> dict[str, Any]:
    return {k: v for k, v in ranges.items() if not (isinstance(v, str) and words_of(v) == NONE)}


def name_in_block(key: str, names: Mapping[str, str]) -> str:
    """Public name for a key of a block; ``names`` has those of a problem by all spellings."""
    if key in KEYS:
        return key
    slot, dot, column = key.partition(".")
    return f"{names.get(slot, slot)}.{column}" if dot else names.get(key, key)


def check_number_of_ranges(ranges: int, where: str) -> None:
    """Refuse more things that scatter than a question may have."""
    if ranges > INPUT_LIMITS.scattered:
        right = f"at most {INPUT_LIMITS.scattered} things that scatter"
        raise InputError(where, f"{ranges} ranges", right, ("robust",))


def _samples(value: object, field: str) -> int:
    number = value if isinstance(value, (int, np.integer)) and not isinstance(value, bool) else 0
    if not LEAST_SAMPLES <= number <= INPUT_LIMITS.samples or number & (number - 1):
        right = f"a power of 2 from {LEAST_SAMPLES} to {INPUT_LIMITS.samples}, such as {SAMPLES}"
        raise InputError(field, value, right)
    return int(number)


def _confidence(value: object, field: str) -> float:
    confidence = parse_quantity(value, "-", field)
    if not 0.5 <= confidence <= 0.9999:
        raise InputError(field, value, "a share from 50 % to 99.99 %, for example 95 %")
    return confidence


def _scenarios(value: object, field: str) -> Mapping[str, tuple[tuple[float, ...], ...]]:
    expected = "limits with lists of positions from 0 to 1 in the ranges, as a result repeats them"
    if not isinstance(value, Mapping):
        raise InputError(field, value, expected)
    found = {}
    for name, points in value.items():
        if not isinstance(points, (list, tuple)) or not all(
            isinstance(p, (list, tuple))
            and all(isinstance(x, (int, float)) and not isinstance(x, bool) and 0 <= x <= 1 for x in p)
            for p in points
        ):
            raise InputError(f"{field}: {name}", points, expected, (str(name),))
        found[str(name)] = tuple(tuple(float(x) for x in p) for p in points)
    return MappingProxyType(found)


def words_of(text: str) -> str:
    """Return a text as it is compared: lower case, one blank between words."""
    return " ".join(text.lower().split())
