"""Where boxes are split of which all limits were taken together: along what blurs the linear bounds most.

Nothing here proves anything: any score whatever leaves every bound right, and only the number of boxes changes.
"""

from __future__ import annotations

import numpy as np

from synth.bounds.log_forms import ELASTIC, LARGEST, SUM, LogForms, Relation
from synth.bounds.log_relaxation import RelaxedPoints
from synth.bounds.propagated_nodes import TABLE, VARIABLE, PropagatedNodes

LEAST_SHARE = 1e-3  # of a sum: what is left after taking off nearly all of it is steeper than this says


def relaxed_scores(nodes: PropagatedNodes, points: RelaxedPoints, width: int, factors: int) -> np.ndarray:
    """Return, per variable and factor, how far relations between nodes are off where linear programs ended.

    What a relation is off by is shared among the columns by how far its interval is spread by each: linear bounds are
    off by the square of that. A box for which everything holds where its program ended has no scores.

    Parameters
    ----------
    nodes : PropagatedNodes
    points : RelaxedPoints
    width : int
        How many variables and auxiliary variables boxes have; the scores of factors come after them.
    factors : int

    Returns
    -------
    array (boxes, width + factors)
    """
    forms, place = points.forms, points.forms.place
    middle, spread = 0.5 * (points.low + points.high), points.high - points.low
    gradient = _gradients(forms, middle)
    widths = spread[:, [place[k] for k in forms.columns]]
    moving = np.array([nodes.kind[k] in (VARIABLE, TABLE) for k in forms.columns], dtype=bool)
    blame = np.zeros((len(middle), len(forms.columns)))
    for relation in forms.relations:
        slopes = [forms.matrix[place[k]] @ gradient for k in relation.nodes]
        steep = np.abs(slopes[2] - slopes[1]) if relation.kind != ELASTIC else sum(np.abs(g) for g in slopes[1:])
        part = np.where(moving, np.nan_to_num(steep) * widths, 0.0)
        total = part.sum(axis=1, keepdims=True)
        off = _off(nodes, relation, [points.logs[:, place[k]] for k in relation.nodes])
        blame += off[:, None] * part / np.maximum(total, 1e-300)
    result = np.zeros((len(middle), width + factors))
    for column, k in enumerate(forms.columns):
        if moving[column]:
            at = nodes.position(k) if nodes.kind[k] == VARIABLE else width + nodes.factor[k]
            result[:, at] += blame[:, column]
    return result


def _gradients(forms: LogForms, middle: np.ndarray) -> np.ndarray:
    """Derivatives of all columns by those that relations do not explain (boxes, columns, columns)."""
    place, number = forms.place, {k: column for column, k in enumerate(forms.columns)}
    gradient = np.tile(np.eye(len(forms.columns)), (len(middle), 1, 1))
    for relation in forms.relations:
        explained = max(relation.nodes)  # arguments come first
        values = [middle[:, place[k]] for k in relation.nodes]
        node_gradients = [forms.matrix[place[k]] @ gradient for k in relation.nodes]
        gradient[:, number[explained]] = _derivative(relation, values, node_gradients)
    return gradient


def _derivative(relation: Relation, values: list[np.ndarray], gradients: list[np.ndarray]) -> np.ndarray:
    """Derivatives of the column that a relation explains, from the values and derivatives of its nodes."""
    explained = relation.nodes.index(max(relation.nodes))
    if relation.kind == SUM:
        share = np.exp(-np.logaddexp(0.0, values[1] - values[2]))[:, None]
        if explained == 0:
            return np.asarray((1 - share) * gradients[1] + share * gradients[2])
        share = share if explained == 1 else 1 - share
        other = gradients[2] if explained == 1 else gradients[1]
        result: np.ndarray = (gradients[0] - share * other) / np.maximum(1 - share, LEAST_SHARE)
        return result
    if relation.kind == ELASTIC:
        return np.asarray(np.sum(gradients[1:], axis=0))
    first = (values[1] >= values[2]) == (relation.kind == LARGEST)
    return np.asarray(np.where(first[:, None], gradients[1], gradients[2]))


def _off(nodes: PropagatedNodes, relation: Relation, logs: list[np.ndarray]) -> np.ndarray:
    """Return by how much a relation is missed, in logarithm."""
    if relation.kind == SUM:
        value = np.logaddexp(logs[1], logs[2])
    elif relation.kind == ELASTIC:
        function = nodes.program.specials[int(nodes.program.nodes[relation.nodes[0]].constant)]
        with np.errstate(all="ignore"):
            value = np.log(function.formula(*(np.exp(x) for x in logs[1:])))
    else:
        value = np.maximum(*logs[1:]) if relation.kind == LARGEST else np.minimum(*logs[1:])
    result: np.ndarray = np.nan_to_num(np.abs(logs[0] - value), posinf=0.0)
    return result
