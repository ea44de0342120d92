"""Random formulas over a few inputs, for tests of what is computed from traces."""

import casadi as ca
import numpy as np

import synth.declaration  # noqa: F401  (sets how NumPy functions act on symbols)
from synth.special import special


@special((0.0, 1.0), (-1.0, 0.0))
def fading(count, loss):
    return -np.expm1(-count * np.log1p(loss + 1e-12)) / (loss + 1e-12)


@special((-np.inf, -0.5), (0.0, np.inf), above=(0, 1))
def overtaking(fast, slow):
    return slow / (fast - slow) + 1 / fast


UNARY = [
    lambda e: e * e,
    lambda e: np.exp(0.3 * np.clip(e, -3, 3)),
    lambda e: np.sqrt(np.abs(e) + 0.1),
    lambda e: np.log1p(np.abs(e)),
    lambda e: np.log(np.abs(e) + 0.2),
    lambda e: -e,
    np.sin,
    np.cos,
    lambda e: np.tan(0.4 * np.tanh(e)),
    np.tanh,
    lambda e: np.sinh(0.5 * np.tanh(e)),
    lambda e: np.cosh(np.tanh(e)),
    np.arcsinh,
    lambda e: np.arcsin(0.9 * np.tanh(e)),
    lambda e: np.arccos(0.9 * np.tanh(e)),
    lambda e: np.arctanh(0.9 * np.tanh(e)),
    lambda e: np.arccosh(1.5 + np.abs(e)),
    np.arctan,
    lambda e: 1 / (np.abs(e) + 0.5),
    np.abs,
    lambda e: np.expm1(0.2 * e),
    lambda e: np.maximum(e, 0.3),
    lambda e: np.minimum(e, 1.1),
    lambda e: e**3,
    lambda e: (np.abs(e) + 0.1) ** 1.7,
    np.floor,
    np.sign,
    lambda e: fading(np.abs(e) + 1, 0.2),
]
BINARY = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (b * b + 0.3),
    lambda a, b: np.where(a < b, a * b, a + 2 * b),
    lambda a, b: np.where(np.logical_or(a <= b, b > 1), a, b),
    np.hypot,
    np.maximum,
    np.minimum,
    lambda a, b: np.arctan2(a, np.abs(b) + 0.1),
    lambda a, b: (np.abs(a) + 0.3) ** np.tanh(b),
    lambda a, b: fading(np.abs(a) + 1, 0.1 + np.abs(b)),
    lambda a, b: overtaking(np.abs(a) + 2, np.abs(b)),
]


def grown(rng, symbols, count):
    """Return random formulas, each of what came before it."""
    pool = list(symbols)
    for _ in range(count):
        first, second = rng.integers(0, len(pool), 2)
        if rng.random() < 0.5:
            pool.append(UNARY[rng.integers(len(UNARY))](pool[first]))
        else:
            pool.append(BINARY[rng.integers(len(BINARY))](pool[first], pool[second]))
    return [ca.SX(e) for e in pool[len(symbols) :]]
