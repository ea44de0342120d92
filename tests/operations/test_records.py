"""The records of elementary operations, each against its own values: what they say of it holds on samples."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields
from typing import Any

import numpy as np
import pytest
from scipy.special import erf

from synth.operations.record import Domain, Operation, Trait
from synth.operations.records import BY_NAME, BY_TEXT, LOG_BELOW_ONE

RNG = np.random.default_rng(5)
STEP = 1e-5
CURVED = [(o, e, False) for o in BY_NAME.values() if (e := o.elasticity)]
CURVED += [(o, e, True) for o in BY_NAME.values() if (e := o.mirrored)] + [(BY_NAME["LOG"], LOG_BELOW_ONE, False)]


def value(operation: Operation, *arguments: Any) -> Any:
    """Result over arrays, by the code that programs are made of."""
    code = operation.numeric.format(*(f"a[{k}]" for k in range(len(arguments))))
    with np.errstate(all="ignore"):
        return eval(code, {"np": np, "erf": erf, "a": arguments})


def samples(operation: Operation, low: float = -3.0, high: float = 3.0) -> list[Any]:
    """Arguments for which an operation is defined."""
    domain = operation.domain or Domain(-math.inf, math.inf)
    low, high = max(low, domain.low + 0.02), min(max(high, domain.low + 3), domain.high - 0.02)
    found = [RNG.uniform(low, high, 500) for _ in range(operation.arity)]
    return [np.abs(found[0]), *found[1:]] if "POW" in operation.name else found


class Arrays:
    """Arrays in place of the nodes of a program."""

    def __init__(self, *arrays: Any) -> None:
        self.arrays = list(arrays)

    def put(self, name: str, *args: int) -> int:
        self.arrays.append(value(BY_NAME[name], *(self.arrays[k] for k in args)))
        return len(self.arrays) - 1

    def size(self, node: int) -> int:
        return self.put("FABS", node)

    def number(self, value: float) -> int:
        self.arrays.append(np.float64(value))
        return len(self.arrays) - 1


KNOWN = {
    "name": "HALF",
    "numeric": "(0.5 * {0})",
    "text": "half",
    "scalar": lambda a: 0.5 * a,
    "enclosure": None,
    "backward": (None,),
    "domain": None,
    "instruction": "",
}


@pytest.mark.parametrize("missing", sorted(KNOWN))
def test_a_record_without_a_field_is_refused(missing: str) -> None:
    assert {f.name for f in fields(Operation) if f.default is MISSING} == set(KNOWN)
    with pytest.raises(TypeError, match=missing):
        Operation(**{name: known for name, known in KNOWN.items() if name != missing})  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [{"backward": (None, None)}, {"text": ""}, {"scalar": None}])
def test_a_record_that_contradicts_itself_is_refused(wrong: dict[str, Any]) -> None:
    assert Operation(**KNOWN).arity == 1  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="HALF"):
        Operation(**KNOWN | wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(name for name, o in BY_NAME.items() if o.scalar))
def test_plain_numbers_have_the_values_of_arrays(name: str) -> None:
    operation = BY_NAME[name]
    assert operation.scalar is not None
    arguments = samples(operation)
    if "logical" in operation.numeric:
        arguments = [np.round(a) for a in arguments]
    plain = [operation.scalar(*x) for x in zip(*(a.tolist() for a in arguments), strict=True)]
    np.testing.assert_allclose(np.array(plain, dtype=float), value(operation, *arguments), rtol=1e-14, atol=1e-300)


@pytest.mark.parametrize("name", sorted(name for name, o in BY_NAME.items() if o.domain or o.finite))
def test_values_are_finite_on_the_domain_and_nowhere_else(name: str) -> None:
    operation = BY_NAME[name]
    for domain in (x for x in (operation.domain, operation.finite) if x):
        for end, outward in ((domain.low, -np.inf), (domain.high, np.inf)):
            if np.isfinite(end):
                inward = np.nextafter(end, -outward)
                assert domain.holds((inward, inward))
                assert np.isfinite(value(operation, inward))
                assert not domain.holds((np.nextafter(end, outward),) * 2)
                assert domain.holds((end, end)) is not domain.open
                beyond = np.nextafter(end, outward) if domain is operation.domain else 1.02 * end
                assert not np.isfinite(value(operation, beyond))
                if domain is operation.domain:
                    assert np.isfinite(value(operation, end)) is np.bool_(not domain.open)


@pytest.mark.parametrize("name", sorted(BY_NAME))
def test_traits_hold(name: str) -> None:
    operation = BY_NAME[name]
    arguments = samples(operation)
    result = value(operation, *arguments)
    if Trait.NEVER_NEGATIVE in operation.traits:
        assert np.all(result >= 0)
    if Trait.KEEPS_SIGN in operation.traits:
        assert np.all(value(operation, *map(np.abs, samples(operation))) >= 0)
    if Trait.COMMUTES in operation.traits:
        np.testing.assert_array_equal(result, value(operation, *arguments[::-1]))
    if Trait.TRUTH in operation.traits:
        assert set(np.unique(result)) <= {0.0, 1.0}
    if Trait.DIVIDES in operation.traits:
        assert not np.isfinite(value(operation, *arguments[:-1], np.zeros(500))).any()
    if Trait.STAYS_INFINITE in operation.traits:
        assert not np.isfinite(value(operation, np.full(500, np.inf), *arguments[1:])).any()
        assert not np.isfinite(value(operation, np.full(500, -np.inf), *arguments[1:])).any()
    if Trait.CROSSES_ZERO in operation.traits:
        assert set(np.sign(result)) == {-1.0, 1.0}
    if Trait.ADDS in operation.traits:
        assert np.all(np.abs(result) <= sum(map(np.abs, arguments)) * (1 + 1e-15))


@pytest.mark.parametrize("name", sorted(name for name, o in BY_NAME.items() if o.exponent))
def test_exponents_are_slopes_of_logarithms(name: str) -> None:
    operation = BY_NAME[name]
    x = RNG.uniform(0.1, 3, 500)
    ratio = np.abs(value(operation, 4 * x) / value(operation, x))
    np.testing.assert_allclose(ratio, 4.0 ** (operation.exponent or 0.0), rtol=1e-14)


@pytest.mark.parametrize("name", sorted(name for name, o in BY_NAME.items() if o.slope))
def test_slopes_are_sizes_of_derivatives(name: str) -> None:
    operation = BY_NAME[name]
    assert operation.slope is not None
    (x,) = samples(operation, -1.2, 1.2)
    x = x[np.abs(x) > 0.1]
    if operation.domain:
        x = x[x > operation.domain.low + 0.1]
    arrays = Arrays(x, value(operation, x))
    claimed = arrays.arrays[operation.slope(arrays, 1, 0)]
    slope = np.abs(value(operation, x + STEP) - value(operation, x - STEP)) / (2 * STEP)
    if name in ("ATAN", "TANH", "ASINH", "ERF"):
        assert np.all(slope <= 1.13 * claimed)
    else:
        np.testing.assert_allclose(claimed, slope, rtol=1e-6)


@pytest.mark.parametrize(("operation", "elasticity", "mirrored"), CURVED, ids=lambda x: getattr(x, "name", ""))
def test_elasticities_are_derivatives_of_logarithms(operation: Operation, elasticity: Any, mirrored: bool) -> None:
    low, high = elasticity.domain
    y = low + (min(high, 20.0) - low) * np.linspace(0.05, 0.95, 500)
    side = -1.0 if mirrored else 1.0
    more, less = (np.log(np.abs(value(operation, side * y * np.exp(step)))) for step in (STEP, -STEP))
    np.testing.assert_allclose(elasticity.at(y), (more - less) / (2 * STEP), rtol=1e-6, atol=1e-9)
    assert np.all(np.sign(value(operation, side * y)) == elasticity.sign)


@pytest.mark.parametrize("text", sorted(text for text, o in BY_TEXT.items() if o.plain))
def test_functions_near_one_are_plain_functions(text: str) -> None:
    operation = BY_TEXT[text]
    assert operation.plain is not None
    name, inner, outer = operation.plain
    (x,) = samples(operation)
    np.testing.assert_allclose(value(BY_TEXT[name], x + inner) + outer, value(operation, x), rtol=1e-9, atol=1e-12)
