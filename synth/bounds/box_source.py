"""The C source of the contraction of boxes: the statements that NumPy code is made of, over registers of boxes."""

from __future__ import annotations

import re
from collections.abc import Sequence

import casadi as ca
import numpy as np

from synth.bounds import compiled_rules as rules
from synth.bounds.box_batches import structure_source
from synth.bounds.contractor import Code
from synth.bounds.propagated_nodes import CONSTANT, PropagatedNodes
from synth.bounds.statements import Assign, Enclose, EndOfFirstSweep, Hold, Kill, Narrow, Statement
from synth.compiled.c_text import EXPRESSIONS, template
from synth.model.program import COMPARISONS, OP_SELECT, Program, UnsupportedOperation
from synth.special import SpecialFunction


def source(code: Code) -> str | None:
    """Return the translation unit of generated code; None where something in it has no form in C."""
    sweeps, nodes = code.sweeps, code.nodes
    statements = [*sweeps.first, *sweeps.later]
    try:
        parts = [
            template("compiled", "vectors"),
            template("bounds", "margins"),
            rules.common(),
            structure_source(),
            _sizes(code),
            template("bounds", "registers"),
            *_specials(statements, nodes.program),
            *_rules(statements, nodes),
            _loading(code),
            _tighten(code),
            template("bounds", "boxes"),
            template("bounds", "subtrees"),
        ]
    except (UnsupportedOperation, KeyError):
        return None
    return "\n".join(parts)


def _sizes(code: Code) -> str:
    nodes = code.nodes
    sizes = {
        "N": nodes.layout.n_variables + len(nodes.auxiliary),
        "LIMITS": len(nodes.constraints),
        "GOALS": len(nodes.goals),
        "TABLES": len(nodes.tables),
        "NODES": len(nodes.program.nodes),
    }
    lines = [f"#define {name} {value}\n#define MOST_{name} ({value} + 1)" for name, value in sizes.items()]
    return "\n".join([*lines, "#define REGISTERS 1"])


def _specials(statements: Sequence[Statement], program: Program) -> list[str]:
    """Return the special functions that are used, and their ranges where signs are not known."""
    texts = [s.value if isinstance(s, Assign) else s.function if isinstance(s, Enclose) else "" for s in statements]
    used = sorted({int(number) for text in texts for number in re.findall(r"special_(\d+)", text)})
    ranges = {s.function for s in statements if isinstance(s, Enclose)}
    result = []
    for k in used:
        result.append(formula_source(f"special_{k}", program.specials[k]))
        if f"range_of_special_{k}" in ranges:
            result.append(_range_source(k, program.specials[k]))
    return result


def formula_source(name: str, function: SpecialFunction) -> str:
    """Return the C function of a special function."""
    steps, result = formula_steps(function)
    arguments = ", ".join(f"vd a{k}" for k in range(len(function.elasticity)))
    lines = [f"static __attribute__((noinline)) vd {name}({arguments}) {{"]
    lines += [f"    const vd {step} = {value};" for step, value in steps]
    return "\n".join([*lines, f"    return {result};", "}"])


def formula_steps(function: SpecialFunction) -> tuple[list[tuple[str, str]], str]:
    """Return the formula of a special function, traced with symbols, in C: names with their values, and the result.

    Its arguments are a0, a1 and so on.
    """
    symbols = [ca.SX.sym(f"a{k}") for k in range(len(function.elasticity))]
    program = Program(symbols, [function.formula(*symbols)])
    steps: list[tuple[str, str]] = []
    names: dict[int, str] = {}
    for k in program.needed(program.outputs):
        node = program.nodes[k]
        args = [names[a] for a in node.args]
        truths = [f"({x} != 0.0)" for x in args]
        if node.op == ca.OP_INPUT:
            names[k] = f"a{int(node.constant)}"
            continue
        if node.op == ca.OP_CONST:
            value = f"all({_literal(node.constant)})"
        elif node.op == ca.OP_NOT:
            value = f"TRUTH(~{truths[0]})"
        elif node.op in (ca.OP_AND, ca.OP_OR):
            value = f"TRUTH({truths[0]} {'&' if node.op == ca.OP_AND else '|'} {truths[1]})"
        elif node.op in COMPARISONS:
            value = f"TRUTH({EXPRESSIONS[node.op].format(*args)})"
        elif node.op == OP_SELECT:
            value = f"choose({truths[0]}, {args[1]}, {args[2]})"
        elif node.op == ca.OP_IF_ELSE_ZERO:
            value = f"keep({truths[0]}, {args[1]})"
        else:
            value = EXPRESSIONS[node.op].format(*args)
        names[k] = f"x{k}"
        steps.append((names[k], value))
    result = names[program.outputs[0]]
    if function.above is not None:
        first, second = function.above
        result = f"choose(a{first} >= a{second}, {result}, all(NAN))"
    return steps, result


def _range_source(k: int, function: SpecialFunction) -> str:
    numbers = range(len(function.elasticity))
    rising = [low >= 0 for low, _ in function.elasticity]
    least = ", ".join(f"a{i}.{'low' if up else 'high'}" for i, up in zip(numbers, rising, strict=True))
    most = ", ".join(f"a{i}.{'high' if up else 'low'}" for i, up in zip(numbers, rising, strict=True))
    inside = " & ".join(f"(a{i}.low >= 0.0)" for i in numbers)
    arguments = ", ".join(f"Interval a{i}" for i in numbers)
    return (
        f"RULE range_of_special_{k}({arguments}) {{\n"
        f"    return where({inside}, both(special_{k}({least}), special_{k}({most})), unknown());\n}}"
    )


def _literal(value: float) -> str:
    if np.isnan(value):
        return "NAN"
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def _rules(statements: Sequence[Statement], nodes: PropagatedNodes) -> list[str]:
    """Return the rules that are used, one function per operation and argument."""
    made = dict[str, str]()
    for s in statements:
        if isinstance(s, Enclose) and not s.function.startswith("range_of"):
            name, body = _forward_rule(s, nodes)
            letters = ", ".join(f"Interval {letter}" for letter in "abc"[: len(s.args)])
            made[name] = f"RULE {name}({letters}) {{ return {body}; }}"
        elif isinstance(s, Narrow):
            letters = ", ".join(f"Interval {letter}" for letter in "rabc"[: len(s.args) + 1])
            for i in s.positions:
                body = rules.POWER_BACKWARD if s.op in rules.POWERS else rules.BACKWARD[s.op][i]
                made[f"backward_{s.op + 100}_{i}"] = f"RULE backward_{s.op + 100}_{i}({letters}) {{ return {body}; }}"
    return list(made.values())


def _forward_rule(s: Enclose, nodes: PropagatedNodes) -> tuple[str, str]:
    if s.function == "whole":
        return f"whole_{len(s.args)}", f"whole_of({' + '.join(f'{x}.low' for x in 'abc'[: len(s.args)])})"
    op = int(s.function.removeprefix("forward_")) - 100
    if op in rules.POWERS:
        same = nodes.kind[s.args[1]] == CONSTANT
        return f"{s.function}_{'constant' if same else 'any'}", rules.POWER_FORWARD[same]
    return s.function, rules.FORWARD[op]


def _loading(code: Code) -> str:
    """Return the function that reads the tables of one box."""
    nodes = code.nodes
    lines = ["INLINE void load_tables(const Batch *b, const int *cell, vd T[][2], int l) {"]
    for f in sorted({nodes.factor[k] for k in nodes.tables}):
        own = [i for i, k in enumerate(nodes.tables) if nodes.factor[k] == f]
        lines.append(f"    const double *r{f} = b->rows[{f}] + {2 * len(own)} * (long long)cell[{f}];")
        for place, i in enumerate(own):
            lines.append(f"    T[{i}][0][l] = r{f}[{2 * place}]; T[{i}][1][l] = r{f}[{2 * place + 1}];")
    return "\n".join([*lines, "}"])


def _tighten(code: Code) -> str:
    """Return the function that tightens a register of boxes."""
    sweeps, nodes = code.sweeps, code.nodes
    lines = [
        "static vi tighten_one(const Batch *b, const Whole *whole, Registers *r) {",
        "    const vd *const RL = whole->RL, *const RH = whole->RH, *const B = whole->B;",
        "    const vd *const C = r->C, *const F = r->F;",
        "    vd(*const V)[2] = r->V, (*const T)[2] = r->T;",
    ]
    lines += [f"    const vd l{k} = all(b->constants[{i}]), h{k} = l{k};" for i, k in enumerate(sweeps.constants)]
    lines += [f"    vd l{k} = T[{i}][0], h{k} = T[{i}][1];" for i, k in enumerate(sweeps.tables)]
    lines += [f"    vd l{k} = V[{i}][0], h{k} = V[{i}][1];" for k, i in sweeps.variables]
    lines += [f"    vd l{k}, h{k};" for k in nodes.inner if k not in nodes.auxiliary]
    lines += [f"    vi o{j};" for j in range(sweeps.limits)]
    lines += ["    vd s, t, m;", "    vi p, q, dead = all_i(0);"]
    lines += [f"    {line}" for statement in sweeps.first for line in _in_c(statement, nodes)]
    lines.append("    for (long long sweep = 1; sweep < b->passes; sweep++) {")
    lines += [f"        {line}" for statement in sweeps.later for line in _in_c(statement, nodes)]
    lines.append("    }")
    lines += [f"    V[{i}][0] = l{k}; V[{i}][1] = h{k};" for k, i in sweeps.variables]
    lines += [f"    r->goals[{j}] = {end};" for j, end in enumerate(sweeps.goals)]
    lines += [f"    r->undecided[{j}] = o{j};" for j in range(sweeps.limits)]
    lines += ["    return dead;", "}", template("bounds", "own_sweeps")]
    return "\n".join(lines)


def _in_c(statement: Statement, nodes: PropagatedNodes) -> list[str]:
    if isinstance(statement, Assign):
        return [f"{statement.target} = {statement.value};"]
    if isinstance(statement, Kill):
        return [f"dead |= {statement.condition};"]
    if isinstance(statement, Hold):
        # Which nodes are narrowed is a matter of requirement values: for the others the root is not a number.
        k = statement.node
        return [f"l{k} = v_fmax(l{k}, RL[{k}]); h{k} = v_fmin(h{k}, RH[{k}]);"]
    if isinstance(statement, EndOfFirstSweep):
        return ["if (!any(~dead)) return dead;"]
    ends = [f"both(l{k}, h{k})" for k in statement.args]
    if isinstance(statement, Enclose):
        name = statement.function if statement.function.startswith("range_of") else _forward_rule(statement, nodes)[0]
        return [f"{{ const Interval f = {name}({', '.join(ends)}); s = f.low; t = f.high; }}"]
    if statement.op in rules.POWERS and nodes.kind[statement.args[1]] != CONSTANT:
        return []
    known = ", ".join([f"both(l{statement.node}, h{statement.node})", *ends])
    found = [f"f{i} = backward_{statement.op + 100}_{i}({known})" for i in statement.positions]
    lines = [f"{{ const Interval {', '.join(found)};"] if found else []
    for i in statement.positions:
        k = statement.args[i]
        lines.append(f"  l{k} = v_fmax(l{k}, f{i}.low); h{k} = v_fmin(h{k}, f{i}.high);")
    return [*lines, "}"] if found else []
