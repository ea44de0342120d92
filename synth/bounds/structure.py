"""What kind of function each limit and objective is, found from the trace alone.

Every node of the program gets its sign, the curvature of log(node) as a function of the logarithms of all
inputs together (variables, counts, columns, requirements), and per input the interval of its elasticity
d log(node) / d log(input). The rules are those of disciplined geometric programming (Boyd et al. 2007, "A
tutorial on geometric programming"; Agrawal, Diamond and Boyd 2019, "Disciplined geometric programming"):
products and powers of log-affine quantities are log-affine, a sum of log-convex ones is log-convex, a
log-concave one minus a log-convex one is log-concave where it is positive, and a function that rises (falls)
keeps the curvature (the opposite curvature) of its argument where it has it itself. Special functions bring the
curvature and the elasticities that they declare.

A quantity is kept as a product of powers of *atoms* (inputs, sums, differences, functions), so that what cancels
in a quotient is gone before the rules are applied.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from synth.bounds.composition import TermComposition
from synth.bounds.log_terms import raised
from synth.bounds.shapes import Shape, worded
from synth.model.model import Model
from synth.question.ranges import declared_ranges
from synth.tables.catalogs import Catalogs


@dataclass(frozen=True)
class Structure:
    """What kind of function each node, quantity, limit and objective of a model is.

    Limits are judged by log(value) - log(limit), with the opposite sign for ``at_least``; objectives by
    log(value), with the opposite sign for ``max``: what must be small. So log-convex is what a convex problem
    allows. Everything holds where the nodes that have a sign here do have it, which every feasible design
    does. Choices have no logarithm: what is said holds for each of their labels.
    """

    inputs: tuple[str, ...]
    nodes: tuple[Shape, ...]
    quantities: dict[str, Shape]
    limits: dict[str, Shape]
    objectives: dict[str, Shape]


def classify(model: Model, low: np.ndarray, high: np.ndarray) -> Structure:
    """Classify all limits, objectives and quantities of a model.

    Differences are often positive in feasible designs only (the width of a ring). Therefore the intervals of
    all nodes are tightened once by the limits, and a node that is positive in every feasible design counts as
    positive. Nothing else is taken from the limits: elasticities and curvature hold over the whole ranges,
    as far as the nodes that count as positive are positive there.

    Parameters
    ----------
    model : Model
    low, high : array (inputs,)
        Range of every input of the program (variables, then data); not-a-number where there is no value. Inputs
        that may be 0 are taken as positive, and quantities that can be 0 for that reason are marked.

    Returns
    -------
    Structure
    """
    with np.errstate(all="ignore"):
        return _structure(TermComposition(model, low, high))


def classified(model: Model, catalogs: Catalogs) -> Structure:
    """Classification over all that may be declared and chosen, made once per model.

    Parameters
    ----------
    model : Model
    catalogs : Catalogs
        Those that the model was traced with.
    """
    made: Structure = model.function("structure", lambda: classify(model, *declared_ranges(model, catalogs)))
    return made


def _structure(analysis: TermComposition) -> Structure:
    model = analysis.model
    labels = tuple([v.name for v in model.variables] + [e.label for e in model.data_inputs])
    kinds = ["variable"] * len(model.variables) + [e.kind for e in model.data_inputs]
    # What cannot move is not worth a word, and a choice has no order.
    moving = ~(analysis.input_low == analysis.input_high)
    order = ("variable", "count", "part", "requirement", "row")
    named = [(k, labels[k]) for kind in order for k in range(len(labels)) if kinds[k] == kind and moving[k]]
    nodes = tuple(analysis.shape(term, [k]) for k, term in enumerate(analysis.terms[: model.traced]))
    quantities = {name: worded(nodes[k], named) for name, k in model.quantity_node.items()}
    limits, objectives = dict[str, Shape](), dict[str, Shape]()
    for limit in model.constraints:
        sides = limit.nodes
        shape = analysis.shape(analysis.quotient(*(sides if limit.sense != "at_least" else reversed(sides))), sides)
        # A side that can be zero has no logarithm there.
        shape = replace(shape, nonzero=all(nodes[k].nonzero for k in sides))
        limits[limit.name] = worded(shape, named, equal=limit.sense == "equal")
    for goal in model.declaration.objectives.values():
        k = model.quantity_node[goal.name]
        term = analysis.terms[k]
        turned = term if term is None or goal.sense == "min" else raised(term, -1.0, term.sign)
        objectives[goal.name] = worded(replace(analysis.shape(turned, [k]), nonzero=nodes[k].nonzero), named)
    return Structure(labels, nodes, quantities, limits, objectives)
