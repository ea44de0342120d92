"""C source of the interior-point solver for one set of row functions.

The same method as in :mod:`synth.nlp.interior_point`, step by step, over vector registers instead of arrays: a lane is
one element of a register, and a lane that is done takes the next problem.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields

import casadi as ca
import numpy as np

from synth.compiled.c_text import EXPRESSIONS, filled, template
from synth.model.program import COMPARISONS, OP_SELECT, Node
from synth.nlp import interior_point as method
from synth.nlp.row_functions import RowFunctions
from synth.tuning import InteriorPointSettings


def source(functions: RowFunctions, own: InteriorPointSettings) -> str:
    """Return the translation unit of one set of row functions."""
    layout = method.SparsityPattern(functions)
    parts = {
        "SIZES": _sizes(functions, own),
        "STORED_IN_STATE": "vd stored[AT_LEAST_ONE(STORED)];",
        "POINT": _point(functions),
        "TRANSPOSED": _transposed(layout),
        "TIMES": _times(layout),
        "GRAM": _gram(layout),
        "CURVATURE": "\n".join(
            f"    matrix[{a}][{b}] += keep(~strange & free[{a}] & free[{b}], hessian[{k}]);"
            for k, (a, b) in enumerate(layout.hessian)
        ),
    }
    return translation_unit(parts)


def translation_unit(parts: Mapping[str, str]) -> str:
    """Return the source of the solver with its places filled; those that are not named stay empty."""
    return template("compiled", "vectors") + filled(template("nlp", "solver"), parts)


def settings(own: InteriorPointSettings) -> list[str]:
    """Return definitions of the settings of the method, each under its name in capitals, and of how lanes end."""
    ends = ("CONVERGED", "INFEASIBLE", "STUCK", "STOPPED")
    lines = [f"#define {name} {getattr(method, name)}" for name in ends]
    numbers = {field.name.upper(): getattr(own, field.name) for field in fields(own)}
    return lines + [f"#define {name} {_number(x) if isinstance(x, float) else x}" for name, x in numbers.items()]


def _sizes(functions: RowFunctions, own: InteriorPointSettings) -> str:
    layout = method.SparsityPattern(functions)
    numbers = {
        "N": layout.n,
        "ROWS": layout.rows,
        "CONSTRAINTS": layout.constraints,
        "GOALS": layout.goals,
        "NONZEROS": len(layout.row),
        "CURVATURES": len(layout.hessian),
        "STORED": len(functions.stored),
    }
    lines = settings(own) + [f"#define {name} {value}" for name, value in numbers.items()]
    lines += [f"#define MOST_{name} {name}" for name in ("N", "ROWS", "GOALS")]
    lines += [f"#define MOST_{name} AT_LEAST_ONE({name})" for name in ("NONZEROS", "CURVATURES")]
    for name, flags in (("EQUAL", layout.equal.ravel()), ("GUARD", layout.guard)):
        lines.append(f"static const int {name}[] = {{{', '.join(str(int(x)) for x in flags)}}};")
    for name, places in (("ROW", layout.row), ("COLUMN", layout.column)):
        lines.append(f"static const int {name}[] = {{{', '.join(str(int(x)) for x in [*places, 0])}}};")
    return "\n".join(lines)


def _number(value: float) -> str:
    if np.isnan(value):
        return "NAN"
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(value)


def _point(functions: RowFunctions) -> str:
    """Return statements that compute rows, derivatives and second derivatives at one point per lane."""
    nodes, first = functions.nodes, functions.input_number("weights", 0)
    names = {k: f"stored[{position}]" for position, k in enumerate(functions.stored)}
    lines = []

    def value(k: int) -> str:
        return f"all({_number(nodes[k].constant)})" if nodes[k].op == ca.OP_CONST else names.get(k, f"x{k}")

    def truth(k: int) -> str:
        return f"m{k}" if k not in names and nodes[k].op in COMPARISONS else f"({value(k)} != 0.0)"

    for k in functions.point_order:
        node = nodes[k]
        if node.op == ca.OP_INPUT:
            number = int(node.constant)
            names[k] = f"y[{number}]" if number < functions.n else f"weights[{number - first}]"
        elif node.op in COMPARISONS:
            lines.append(f"    const vi m{k} = {_comparison(node, value, truth)};")
            lines.append(f"    const vd x{k} = keep(m{k}, all(1.0));")
        elif node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            other = f"choose({truth(node.args[0])}, {value(node.args[1])}, {value(node.args[-1])})"
            kept = f"keep({truth(node.args[0])}, {value(node.args[1])})"
            lines.append(f"    const vd x{k} = {other if node.op == OP_SELECT else kept};")
        else:
            lines.append(f"    const vd x{k} = {EXPRESSIONS[node.op].format(*(value(a) for a in node.args))};")
    for k, output in enumerate(functions.outputs):
        lines.append(f"    {_place(functions, k)} = {value(output)};")
    return "\n".join(lines)


def _comparison(node: Node, value: Callable[[int], str], truth: Callable[[int], str]) -> str:
    if node.op == ca.OP_NOT:
        return f"~{truth(node.args[0])}"
    if node.op in (ca.OP_AND, ca.OP_OR):
        return f"{truth(node.args[0])} {'&' if node.op == ca.OP_AND else '|'} {truth(node.args[1])}"
    return EXPRESSIONS[node.op].format(*(value(a) for a in node.args))


def _place(functions: RowFunctions, k: int) -> str:
    rows, nonzeros = functions.n_rows, len(functions.row)
    if k < rows:
        return f"form[{k}]"
    return f"jacobian[{k - rows}]" if k < rows + nonzeros else f"hessian[{k - rows - nonzeros}]"


def _transposed(layout: method.SparsityPattern) -> str:
    lines = []
    for a, places in enumerate(layout.columns):
        terms = [f"jacobian[{k}] * vector[{layout.row[k]}]" for k in places]
        lines.append(f"    result[{a}] = {' + '.join(terms) or 'all(0.0)'};")
    return "\n".join(lines)


def _times(layout: method.SparsityPattern) -> str:
    lines = []
    for r in range(layout.rows):
        terms = [f"jacobian[{k}] * direction[{layout.column[k]}]" for k in np.flatnonzero(layout.row == r)]
        lines.append(f"    result[{r}] = {' + '.join([*terms, f'-slopes[{r}] * direction[N]'])};")
    return "\n".join(lines)


def _gram(layout: method.SparsityPattern) -> str:
    lines = [f"    const vd w{k} = jacobian[{k}] * vector[{layout.row[k]}];" for k in range(len(layout.row))]
    for a, b, first, second in layout.pairs:
        terms = [f"w{i} * jacobian[{j}]" for i, j in zip(first, second, strict=True)]
        lines.append(f"    matrix[{a}][{b}] = {' + '.join(terms) or 'all(0.0)'};")
    for a, places in enumerate(layout.columns):
        terms = [f"w{k} * slopes[{layout.row[k]}]" for k in places]
        lines.append(f"    matrix[N][{a}] = -({' + '.join(terms) or 'all(0.0)'});")
    terms = [f"vector[{r}] * slopes[{r}] * slopes[{r}]" for r in range(layout.rows)]
    lines.append(f"    matrix[N][N] = {' + '.join(terms) or 'all(0.0)'};")
    return "\n".join(lines)
