"""Checks that apply to any formula: units, symbols, arrays."""

from functools import partial, wraps

import casadi as ca
import numpy as np
import pytest

ca.GlobalOptions.setNumpyMode(-1)

# Exponents of kilogram, metre, second, kelvin and, where there is one, ampere.
DIMENSION = {
    "-": (0, 0, 0, 0),
    "kg": (1, 0, 0, 0),
    "kg m": (1, 1, 0, 0),
    "m": (0, 1, 0, 0),
    "m2": (0, 2, 0, 0),
    "m3": (0, 3, 0, 0),
    "m4": (0, 4, 0, 0),
    "1/m": (0, -1, 0, 0),
    "s": (0, 0, 1, 0),
    "1/s": (0, 0, -1, 0),
    "1/s2": (0, 0, -2, 0),
    "1/s3": (0, 0, -3, 0),
    "K": (0, 0, 0, 1),
    "N": (1, 1, -2, 0),
    "N/m": (1, 0, -2, 0),
    "N m": (1, 2, -2, 0),
    "J": (1, 2, -2, 0),
    "W": (1, 2, -3, 0),
    "Pa": (1, -1, -2, 0),
    "Pa s": (1, -1, -1, 0),
    "J/m2": (1, 0, -2, 0),
    "W/m2": (1, 0, -3, 0),
    "m/s": (0, 1, -1, 0),
    "kg/m3": (1, -3, 0, 0),
    "kg m2": (1, 2, 0, 0),
    "kg m2/s": (1, 2, -1, 0),
    "W/K": (1, 2, -3, -1),
    "J/(m3 K)": (1, -1, -2, -1),
    "m3/s": (0, 3, -1, 0),
    "J/K": (1, 2, -2, -1),
    "m3/J": (-1, 1, 2, 0),
    "K/J": (-1, -2, 2, 1),
    "J/(kg K)": (0, 2, -2, -1),
    "J/kg": (0, 2, -2, 0),
    "W/(m K)": (1, 1, -3, -1),
    "W/(m2 K)": (1, 0, -3, -1),
    "K/W": (-1, -2, 3, 1),
    "1/K": (0, 0, 0, -1),
    "A": (0, 0, 0, 0, 1),
    "A/m": (0, -1, 0, 0, 1),
    "A/(m T)": (-1, -1, 2, 0, 2),
    "T": (1, 0, -2, 0, -1),
    "V": (1, 2, -3, 0, -1),
    "V s/(A m)": (1, 1, -2, 0, -2),
    "ohm m": (1, 3, -3, 0, -2),
}


def positional(function):
    """Formulas that the search keeps as one node take their arguments by position."""

    @wraps(function)
    def call(**values):
        return function(*values.values())

    return call


def name_of(function):
    """Return the name of a formula, also of one with some arguments set."""
    return function.func.__name__ if isinstance(function, partial) else function.__name__


def draw(units, ranges, rng):
    """Random arguments; those without a range lie in 0.5 .. 2."""
    return {name: rng.uniform(*ranges.get(name, (0.5, 2.0))) for name in units}


def assert_homogeneous(function, units, result_unit, ranges, seed=0, trials=20, constants=()):
    """Rescale kilogram, metre, second, kelvin and ampere at random: a sound formula scales as its unit.

    ``constants`` are the numbers with a unit that the formula holds: (module, name, unit).
    """
    rng = np.random.default_rng(seed)
    for _ in range(trials):
        values = draw(units, ranges, rng)
        scale = rng.uniform(0.3, 3.0, size=5)
        factor = {unit: np.prod(scale[: len(e)] ** np.array(e)) for unit, e in DIMENSION.items()}
        rescaled = {name: value * factor[units[name]] for name, value in values.items()}
        expected = np.asarray(function(**values), dtype=float) * factor[result_unit]
        with pytest.MonkeyPatch.context() as patch:
            for module, name, unit in constants:
                patch.setattr(module, name, getattr(module, name) * factor[unit])
            found = np.asarray(function(**rescaled), dtype=float)
        np.testing.assert_allclose(found, expected, rtol=1e-9)


def assert_same_on_symbols_and_arrays(function, units, ranges, seed=1, trials=12):
    """One trace on CasADi symbols and one call on arrays give what the floats give."""
    rng = np.random.default_rng(seed)
    points = [draw(units, ranges, rng) for _ in range(trials)]
    numbers = np.array([float(function(**point)) for point in points])
    symbols = {name: ca.SX.sym(name) for name in units}
    traced = ca.SX(function(**symbols))
    assert traced.shape == (1, 1)
    compiled = ca.Function("formula", list(symbols.values()), [traced])
    symbolic = np.array([float(compiled(*point.values())) for point in points])
    np.testing.assert_allclose(symbolic, numbers, rtol=1e-13)
    arrays = {name: np.array([point[name] for point in points]) for name in units}
    np.testing.assert_allclose(np.broadcast_to(function(**arrays), numbers.shape), numbers, rtol=1e-13)
