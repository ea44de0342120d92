"""Problems made up at random: formulas of every shape, under every verb that takes one.

Values stay between about -10 and 10 and change slowly, so that two evaluators agree whatever the shape.
"""

import math

import casadi as ca
import numpy as np
import pandas as pd

from synth.model.problem import DesignProblem
from synth.special import special

RODS = pd.DataFrame(
    {
        "designation": ["A", "B", "C"],
        "size [-]": [0.5, 1.0, 1.5],
        "extra [-]": [1.0, None, 2.0],
        "source": ["made up"] * 3,
    }
)


@special((0.0, 1.0))
def saturating(load):
    """Return load/(1 + load), as one node of the trace."""
    return load / (1 + load)


def bounded(x):
    """Return an expression in -1..1."""
    return x / (1 + np.abs(x))


def mixed(rng, a, b):
    """Return one operation on two expressions."""
    operations = [
        lambda: a + b,
        lambda: a - b,
        lambda: -a,
        lambda: bounded(a) * b,
        lambda: a / (1.5 + np.abs(b)),
        lambda: np.sqrt(1 + a * a),
        lambda: np.hypot(a, b),
        lambda: np.sin(a),
        lambda: np.exp(-np.abs(a)),
        lambda: np.log1p(np.abs(b)),
        lambda: np.maximum(a, b),
        lambda: np.minimum(a, 0.5 * b),
        lambda: np.where(a > b, a + 1, 2 * b),
        lambda: np.tanh(a),
        lambda: ca.erf(b),
        lambda: bounded(a) ** 2 - b,
        lambda: (1 + np.abs(a)) ** 0.3,
        lambda: saturating(np.abs(a)),
    ]
    return operations[rng.integers(len(operations))]()


def tree(rng, leaves):
    """Return a formula of some operations, of which later ones use earlier ones again and again."""
    known = list(leaves)
    for _ in range(rng.integers(1, 40)):
        known.append(bounded(mixed(rng, *(known[k] for k in rng.integers(len(known), size=2)))))
    return known[-1]


def nested(rng, leaves):
    """Return a root in a root, each of which uses the one below twice."""
    e = leaves[0]
    for k in range(rng.integers(2, 40)):
        x, y = (leaves[j] for j in rng.integers(len(leaves), size=2))
        e = np.sqrt(0.4 * e * e + (k + 2) * np.abs(x) / (k + 1 + np.abs(y)))
    return e


def chain(rng, leaves):
    """Return a function of a function, without end."""
    e = leaves[rng.integers(len(leaves))]
    for k in range(rng.integers(40, 400)):
        e = np.sin(e) if k % 3 else np.tanh(e)
    return e


def doubled(rng, leaves):
    """Return what stands there 2**n times, written out."""
    e = leaves[rng.integers(len(leaves))]
    for k in range(rng.integers(5, 60)):
        e = bounded(e + np.sin(e)) if k % 2 else np.maximum(e, bounded(np.exp(-np.abs(e))) - 0.1)
    return e


def decided(rng, leaves):
    """Return a choice by conditions inside conditions, which stand there 2**n times."""
    a, b = (leaves[k] for k in rng.integers(len(leaves), size=2))
    c = a > b
    for k in range(rng.integers(5, 40)):
        x, y = (leaves[j] for j in rng.integers(len(leaves), size=2))
        c = np.logical_and(np.logical_or(c, x > y + 0.01 * k), np.logical_or(np.logical_not(c), y > x))
    return np.where(c, a, b)


def many(rng, leaves):
    """Return a long sum of products."""
    terms = rng.integers(len(leaves), size=(rng.integers(5, 60), 2))
    return bounded(sum((k + 1) * leaves[i] * bounded(leaves[j]) for k, (i, j) in enumerate(terms)) / 100)


SHAPES = (tree, nested, chain, doubled, decided, many)


def easy_problem(seed):
    """Return a problem that is solved at once, with one formula of each kind in limits, remarks and defaults alone."""

    def declare(self, d):
        rng = np.random.default_rng(seed)
        x = [d.variable(f"x{k}", "-", 0.5, 2) for k in range(3)]
        r = d.requirement("load", "-", 1, lower=0.1, upper=10)
        x += [r, d.requirement("peak", "-", 1.5 + bounded(nested(rng, [r, 2 * r])), lower=-100, upper=100)]
        shape = SHAPES[seed % len(SHAPES)]
        d.at_most("long", bounded(shape(rng, x)), 2, "-")
        d.at_least("opened", 3, bounded(nested(rng, x)), "-", guard=True)
        d.advise("remark", shape(rng, x) > 0.1, "told")
        d.derive("sum", "-", x[0] + 2 * x[1], needs="opened")
        d.derive("other", "-", x[2] - x[0])
        d.objective("sum")
        d.objective("other", "max", default=False)

    return type("Easy", (DesignProblem,), {"name": f"easy_{seed}", "title": "Made up", "declare": declare})


def random_problem(seed):
    """Return a problem made up from a seed, which is declared the same every time."""

    def declare(self, d):
        rng = np.random.default_rng(seed)
        shapes = iter(rng.permutation(list(range(len(SHAPES))) * 3))

        def formula(leaves):
            return SHAPES[next(shapes)](rng, leaves)

        x = [d.variable(f"u_{k + 1}" if seed % 2 else f"x{k}", "-", 0.5, 2) for k in range(rng.integers(2, 5))]
        r = d.requirement("load", "-", 1, lower=0.1, upper=10)
        x += [r, d.requirement("peak", "-", 1.5 + bounded(formula([r, 2 * r])), lower=-100, upper=100)]
        x.append(d.count("n", 1, 3) if seed % 3 else d.choice("kind", ("a", "b")).select({"a": x[0], "b": 1 + x[1]}))
        rod = d.part("rod", "rods")
        x.append(rod.size)
        shared = formula(x)
        d.at_least("open", x[0], 0.6, "-", guard=True, text="A guard")
        if rng.random() < 0.7:
            x.append(d.step("half_way", "-", bounded(formula(x) + shared)))
        made = d.derive("made", "-", formula(x) + 1, needs="open" if rng.random() < 0.5 else ())
        x.append(bounded(made))
        # What only limits and remarks use.
        alone = formula(x)
        d.at_most("nested", alone, 20 + bounded(shared), "-")
        d.at_least("mixed", bounded(alone) + formula(x), -50, "-")
        d.at_most("optional", bounded(shared) * rod.optional("extra"), 30, "-")
        d.at_most("same", 2 * alone, alone + bounded(alone) + 40, "-")
        d.at_most("opened", formula(x), 60, "-", guard=rng.random() < 0.5)
        d.advise("remark", formula(x) > bounded(alone), "told", source="habit")
        d.advise("other", np.logical_and(alone > 0.1, shared < 3), "told too")
        d.refuse("never", formula([r, x[0] * 0 + 1]) > 1e6, "less")
        d.derive("cost", "-", x[0] + 2 * x[1] + bounded(formula(x)) / 4)
        d.objective("cost")
        d.objective("made", "max", default=False)

    return type("Random", (DesignProblem,), {"name": f"random_{seed}", "title": "Made up", "declare": declare})


def inputs_at(model, rng, count):
    """Return variables and data inputs at random places of a model, and the same by the names of a calculation."""
    variables = rng.uniform(
        [v.lower for v in model.variables], [v.upper for v in model.variables], (count, len(model.variables))
    )
    data = []
    for entry in model.data_inputs:
        steps = model.declaration.counts[entry.name].values if entry.kind == "count" else [0.0, 1.0]
        if entry.kind == "part":
            steps = [math.nan, 0.5, 1.5] if entry.column == "extra" else [0.5, 1.0]
        data.append(rng.uniform(0.1, 3, count) if entry.kind == "requirement" else rng.choice(steps, count))
    labels = [v.name for v in model.variables] + [i.label for i in model.data_inputs]
    rows = np.column_stack([variables, *data])
    return variables, data, [dict(zip(labels, map(float, row), strict=True)) for row in rows]
