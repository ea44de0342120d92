"""Statements of interval code as Python text over arrays of NumPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from synth.bounds.intervals import BACKWARD, FORWARD, Interval, loosened, whole
from synth.bounds.statements import Assign, Enclose, Hold, Kill, Narrow, Statement, SweepStatements, special_range
from synth.model.program import Program
from synth.special import SpecialFunction


def python_text(sweeps: SweepStatements, narrowed: np.ndarray) -> str:
    """Return the code of ``contract(V, L, K, B, C, F, RL, RH, passes, n) -> (dead, goals, open)``.

    V: ends of the variables (tightened in place), L: ends of tables, K: constants, B: constant right
    sides, C: cutoffs of the goals, F: their floors, RL and RH: what holds over the whole question. Only nodes that
    are ``narrowed`` are held within it.
    """
    out = ["def contract(V, L, K, B, C, F, RL, RH, passes, n):"]
    out += [f"    l{k} = h{k} = K[{i}]" for i, k in enumerate(sweeps.constants)]
    out += [f"    l{k}, h{k} = L[{i}]" for i, k in enumerate(sweeps.tables)]
    out += [f"    l{k}, h{k} = V[{i}]" for k, i in sweeps.variables]
    out.append("    dead = np.zeros(n, dtype=bool)")
    out += [f"    {line}" for statement in sweeps.first for line in _in_python(statement, narrowed)]
    out.append("    for _ in range(1, passes):")
    out += [f"        {line}" for statement in sweeps.later for line in _in_python(statement, narrowed)]
    out.append("        pass")
    out += [f"    V[{i}] = l{k}, h{k}" for k, i in sweeps.variables]
    opens = ", ".join(f"o{j}" for j in range(sweeps.limits))
    out.append(f"    return dead, [{', '.join(sweeps.goals)}], [{opens}]")
    return "\n".join(out)


def _in_python(statement: Statement, narrowed: np.ndarray) -> list[str]:
    if isinstance(statement, Assign):
        return [f"{statement.target} = {statement.value}"]
    if isinstance(statement, Kill):
        return [f"dead |= {statement.condition}"]
    if isinstance(statement, Enclose):
        return [f"s, t = {statement.function}({', '.join(f'(l{a}, h{a})' for a in statement.args)})"]
    if isinstance(statement, Hold) and narrowed[statement.node]:
        k = statement.node
        return [f"l{k} = v_fmax(l{k}, RL[{k}])", f"h{k} = v_fmin(h{k}, RH[{k}])"]
    if isinstance(statement, Narrow):
        ends = ", ".join(f"(l{k}, h{k})" for k in (statement.node, *statement.args))
        lines = [f"found = backward_{statement.op + 100}({ends})"]
        for i in statement.positions:
            k = statement.args[i]
            lines.append(f"if found[{i}] is not None:")
            lines.append(f"    l{k} = v_fmax(l{k}, found[{i}][0])")
            lines.append(f"    h{k} = v_fmin(h{k}, found[{i}][1])")
        return lines
    return []


def python_function(text: str, program: Program) -> Callable[..., Any]:
    """Return generated code as a function."""
    scope: dict[str, Any] = {
        "np": np,
        "v_fmax": np.fmax,
        "v_fmin": np.fmin,
        "v_sqrt": np.sqrt,
        "v_abs": np.abs,
        "choose": np.where,
        "loosened": loosened,
        "all": float,  # a number for all boxes, as the kernel has it
        "whole": whole,
    }
    scope |= {f"forward_{op + 100}": rule for op, rule in FORWARD.items()}
    scope |= {f"backward_{op + 100}": rule for op, rule in BACKWARD.items()}
    for i, function in enumerate(program.specials):
        scope[f"special_{i}"] = function.formula
        scope[f"range_of_special_{i}"] = _range_of(function)
    exec(compile(text, "<generated interval code>", "exec"), scope)
    return scope["contract"]  # type: ignore[no-any-return]


def _range_of(function: SpecialFunction) -> Callable[..., Interval]:
    return lambda *args: special_range(function, args)
