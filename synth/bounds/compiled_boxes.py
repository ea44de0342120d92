"""The contraction of boxes compiled, where there is a C compiler: the same statements, over registers of boxes.

One call tightens boxes, snaps them to the grid, scores what is left of them and packs what is alive. Requirement
values, tables and ends are arguments, so that the code is compiled once per family and pattern of signs.
"""

from __future__ import annotations

import ctypes
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds import compiled_rules as rules
from synth.bounds.compiled_subtrees import CapTables, Grown, Halves, bind, grow
from synth.bounds.contractor import CONSTANT, Code, Contractor, Root
from synth.bounds.statements import Assign, Enclose, EndOfFirstSweep, Hold, Kill, Narrow, Statement
from synth.compiled.c_text import EXPRESSIONS, template
from synth.compiled.compilation import NotCompiled, switched_on
from synth.compiled.compiler import FLAGS, library
from synth.model.program import COMPARISONS, OP_SELECT, Program, UnsupportedOperation
from synth.special import SpecialFunction
from synth.tuning import CodeSizes, CompilingEffort

# No contraction of products and sums: the ends of an interval must round as they do in NumPy.
BOX_FLAGS = (*FLAGS, "-O2", "-ffp-contract=off")
# Threads take the next so many boxes when they are free: a core that is busy with something else holds nobody up.
SCORE_WIDTH = 16

NUMBERS = {
    "count": "long long",
    "passes": "long long",
    "factors": "long long",
    "goals": "long long",
    "caps_step": "long long",
    "weights_step": "long long",
    "bits": "long long",
    "score_width": "long long",
    "snap": "double",
    "pinned": "double",
}
GIVEN = {
    "cell": "int",
    "low": "double",
    "high": "double",
    "bounds": "double",
    "tag": "int",
    "caps": "double",
    "constants": "double",
    "rights": "double",
    "root_low": "double",
    "root_high": "double",
    "lower": "double",
    "upper": "double",
    "spans": "double",
    "weights": "double",
    "steep": "double",
    "rows": "double *const",
    "spreads": "float *const",
    "grids": "double *const",
    "grid_sizes": "long long",
}
TAKEN = {
    "out_cell": "int",
    "out_low": "double",
    "out_high": "double",
    "out_bounds": "double",
    "out_tag": "int",
    "out_scores": "float",
    "alive": "unsigned char",
    "open": "unsigned char",
}
CTYPES: dict[str, type[ctypes.c_longlong | ctypes.c_double]] = {
    "long long": ctypes.c_longlong,
    "double": ctypes.c_double,
}


class _BatchStructure(ctypes.Structure):
    """The structure of the same name in the C source."""

    _fields_ = (
        *((name, CTYPES[kind]) for name, kind in NUMBERS.items()),
        *((name, ctypes.c_void_p) for name in (*GIVEN, *TAKEN)),
    )


@dataclass(frozen=True)
class CompiledQuestion:
    """What the contraction of boxes reads of one question.

    Parameters
    ----------
    tables : list of (factor, low, high)
        Ends of every tabulated node per cluster.
    constants, rights : array
        Values of constant nodes, and constant right sides.
    root : Root
        What holds over the whole question.
    lower, upper : array (variables,)
    spans : array (variables,)
        Unit of the width of each variable; 0 where widths are logarithms of ratios.
    steep : array (limits + objectives, variables)
    spreads : list of array (clusters, limits + objectives)
        Per factor.
    grids : list of arrays
        Makeable values per variable; empty where it is continuous.
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    sizes : CodeSizes
    """

    tables: Sequence[tuple[int, np.ndarray, np.ndarray]]
    constants: np.ndarray
    rights: np.ndarray
    root: Root
    lower: np.ndarray
    upper: np.ndarray
    spans: np.ndarray
    steep: np.ndarray
    spreads: Sequence[np.ndarray]
    grids: Sequence[np.ndarray]
    margins: tuple[float, float]
    sizes: CodeSizes


@dataclass(frozen=True)
class Packed:
    """What is alive after a contraction, packed; ``alive`` and ``open`` speak of all boxes."""

    alive: np.ndarray
    cell: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounds: np.ndarray
    scores: np.ndarray
    tag: np.ndarray
    open: np.ndarray


class Prepared:
    """The arrays of one question as the compiled code reads them.

    Parameters
    ----------
    contractor : Contractor
    question : CompiledQuestion
    """

    def __init__(self, contractor: Contractor, question: CompiledQuestion) -> None:
        self.n, self.factors, self.sizes = len(question.lower), len(question.spreads), question.sizes
        width = -(-question.steep.shape[0] // SCORE_WIDTH) * SCORE_WIDTH
        self.kept: dict[str, Any] = {
            name: np.ascontiguousarray(getattr(question, name), dtype=float)
            for name in ("constants", "rights", "lower", "upper", "spans", "steep")
        }
        for name, end in (("root_low", question.root.low), ("root_high", question.root.high)):
            self.kept[name] = np.where(question.root.narrowed, end, np.nan)
        per_factor: list[list[np.ndarray]] = [[] for _ in range(self.factors)]
        for f, low, high in question.tables:
            per_factor[f] += [low, high]
        rows = [np.stack(own, axis=1) if own else np.zeros((1, 1)) for own in per_factor]
        spreads = [np.zeros((len(s), width), dtype=np.float32) for s in question.spreads]
        for padded, spread in zip(spreads, question.spreads, strict=True):
            padded[:, : spread.shape[1]] = spread
        grids = [np.ascontiguousarray(g, dtype=float) for g in question.grids]
        self.kept["grid_sizes"] = np.array([len(g) for g in grids] or [0], dtype=np.int64)
        self._lists = {"rows": rows, "spreads": spreads, "grids": grids}
        for name, arrays in self._lists.items():
            self.kept[name] = np.array([a.ctypes.data for a in arrays] or [0], dtype=np.uintp)
        self.numbers = {
            "factors": self.factors,
            "score_width": width,
            "snap": question.margins[0],
            "pinned": question.margins[1],
        }


class BoxCode:
    """Compiled contraction of boxes.

    Parameters
    ----------
    loaded : CDLL
    limits : int
    """

    def __init__(self, loaded: ctypes.CDLL, limits: int) -> None:
        self.limits = limits
        self._contract = loaded.contract
        self._contract.argtypes = [ctypes.POINTER(_BatchStructure)]
        self._contract.restype = ctypes.c_longlong
        self._grow = bind(loaded, _BatchStructure)

    def contract(
        self,
        prepared: Prepared,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: np.ndarray | None,
        weights: np.ndarray,
        passes: int,
        workers: int = 1,
    ) -> Packed:
        """Tighten, snap and score boxes.

        Parameters
        ----------
        prepared : Prepared
        cell : array (boxes, factors)
        low, high : array (boxes, variables)
        bounds : array (boxes, objectives)
        tag : array (boxes,)
        caps : array (objectives,) or (boxes, objectives), optional
            Upper bounds of the objectives, with their sign.
        weights : array (patterns, limits + objectives)
            One row per set of capped objectives, a power of 2; or one row alone.
        passes : int
        workers : int
            Threads; the boxes are split between them and the result is the same for any number.
        """
        count, n, factors = len(cell), prepared.n, prepared.factors
        given = _rows(cell, low, high, bounds, tag)
        most = np.ascontiguousarray(np.full(bounds.shape[1], np.inf) if caps is None else caps, dtype=float)
        step = most.shape[1] if most.ndim == 2 else 0
        taken: dict[str, np.ndarray] = {
            "out_cell": np.empty((count, factors), dtype=np.int32),
            "out_low": np.empty((count, n)),
            "out_high": np.empty((count, n)),
            "out_bounds": np.empty(bounds.shape),
            "out_tag": np.empty(count, dtype=np.int32),
            "out_scores": np.empty((count, n + factors), dtype=np.float32),
            "alive": np.empty(count, dtype=bool),
            "open": np.empty((count, self.limits), dtype=bool),
        }
        moving, still = given | taken, dict[str, np.ndarray]()
        (moving if step else still)["caps"] = most
        part = _batches(prepared, weights, passes, moving, still, caps_step=step)
        parts = max(1, count // prepared.sizes.part) if workers > 1 else 1
        ends = [count * k // parts for k in range(parts + 1)]
        kept = self._run([part(first, last) for first, last in pairwise(ends)], workers)
        rows = [slice(first, first + number) for first, number in zip(ends[:-1], kept, strict=True)]

        def packed(name: str) -> np.ndarray:
            array = taken[name]
            return array[rows[0]] if parts == 1 else np.concatenate([array[own] for own in rows])

        return Packed(
            taken["alive"],
            packed("out_cell"),
            packed("out_low"),
            packed("out_high"),
            packed("out_bounds"),
            packed("out_scores"),
            packed("out_tag"),
            taken["open"],
        )

    def grow(
        self,
        prepared: Prepared,
        halves: Halves,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: CapTables,
        weights: np.ndarray,
        passes: int,
        levels: int,
        workers: int = 1,
    ) -> Grown:
        """Tighten and split boxes, and what comes of them, for some generations.

        Parameters
        ----------
        prepared, cell, low, high, tag, weights, passes, workers
            As for :meth:`contract`.
        halves : Halves
        bounds : array (boxes, objectives)
            Of the objectives that the code knows, no others.
        caps : CapTables
        levels : int
            Generations.
        """
        batch = _batches(prepared, weights, passes, _rows(cell, low, high, bounds, tag))
        widths = (prepared.factors, prepared.n, bounds.shape[1])
        return grow(
            self._grow,
            batch,
            len(cell),
            widths,
            halves,
            caps,
            levels,
            prepared.sizes,
            lambda work: _all_done(work, workers),
        )

    def _run(self, batches: Sequence[_BatchStructure], workers: int) -> list[int]:
        kept = [0] * len(batches)

        def part(k: int) -> Callable[[], None]:
            def work() -> None:
                kept[k] = self._contract(ctypes.byref(batches[k]))

            return work

        _all_done([part(k) for k in range(len(batches))], workers)
        return kept


def _rows(
    cell: np.ndarray, low: np.ndarray, high: np.ndarray, bounds: np.ndarray, tag: np.ndarray
) -> dict[str, np.ndarray]:
    """Return boxes as the compiled code reads them."""
    return {
        "cell": np.ascontiguousarray(cell, dtype=np.int32),
        "low": np.ascontiguousarray(low, dtype=float),
        "high": np.ascontiguousarray(high, dtype=float),
        "bounds": np.ascontiguousarray(bounds, dtype=float),
        "tag": np.ascontiguousarray(tag, dtype=np.int32),
    }


def _batches(
    prepared: Prepared,
    weights: np.ndarray,
    passes: int,
    moving: Mapping[str, np.ndarray],
    still: Mapping[str, np.ndarray] | None = None,
    **numbers: int,
) -> Callable[[int, int], _BatchStructure]:
    """Return what makes a batch of the boxes from a first to a last one.

    ``moving`` arrays have a row per box, so that a batch begins so many rows further on; ``still`` ones serve all.
    """
    fixed = prepared.kept | {"weights": np.ascontiguousarray(weights, dtype=float)} | dict(still or {})
    shared = {**prepared.numbers, "weights_step": weights.shape[1], "bits": len(weights).bit_length() - 1, **numbers}

    def batch(first: int, last: int) -> _BatchStructure:
        # A batch knows addresses only: the arrays live as long as this function does.
        places = {name: a.ctypes.data for name, a in fixed.items()}
        places |= {name: a.ctypes.data + first * a.strides[0] for name, a in moving.items()}
        return _BatchStructure(count=last - first, goals=moving["bounds"].shape[1], passes=passes, **shared, **places)

    return batch


def _all_done(work: Sequence[Callable[[], None]], workers: int) -> None:
    """Do all of some work, shared among threads."""
    waiting = iter(work)

    def run() -> None:
        for part in waiting:
            part()

    threads = [threading.Thread(target=run) for _ in range(min(workers, len(work)) - 1)]
    for thread in threads:
        thread.start()
    run()
    for thread in threads:
        thread.join()


def compiled(code: Code, effort: CompilingEffort) -> BoxCode | None:
    """Return the compiled form of generated code; None where it cannot be had."""
    if not switched_on():
        return None
    if code.compiled is None and not code.hopeless:
        text = source(code)
        try:
            loaded = None if text is None else library("boxes", text, effort, BOX_FLAGS)
        except NotCompiled:
            return None
        if loaded is not None:
            code.compiled = BoxCode(loaded, code.sweeps.limits)
        code.hopeless = loaded is None
    found: BoxCode | None = code.compiled
    return found


# -- the source --------------------------------------------------------------------------------


def source(code: Code) -> str | None:
    """Return the translation unit of generated code; None where something in it has no form in C."""
    sweeps, owner = code.sweeps, code.contractor
    statements = [*sweeps.first, *sweeps.later]
    try:
        parts = [
            template("compiled", "vectors"),
            template("bounds", "margins"),
            rules.common(),
            _sizes(code),
            *_specials(statements, owner.program),
            *_rules(statements, owner),
            _loading(code),
            _tighten(code),
            template("bounds", "boxes"),
            template("bounds", "subtrees"),
        ]
    except (UnsupportedOperation, KeyError):
        return None
    return "\n".join(parts)


def _struct() -> str:
    lines = [f"    {kind} {name};" for name, kind in NUMBERS.items()]
    lines += [f"    const {kind} *{name};" for name, kind in GIVEN.items()]
    lines += [f"    {kind} *{name};" for name, kind in TAKEN.items()]
    return "\n".join(["typedef struct {", *lines, "} Batch;"])


def _sizes(code: Code) -> str:
    owner = code.contractor
    sizes = {
        "N": owner.layout.n_variables + len(owner.pivots),
        "LIMITS": len(owner.cuts),
        "GOALS": len(owner.goals),
        "TABLES": len(owner.tables),
        "NODES": len(owner.program.nodes),
        "SCORE_WIDTH": SCORE_WIDTH,
    }
    lines = [f"#define {name} {value}" for name, value in sizes.items()]
    return "\n".join([*lines, "#define ANY(n) ((n) + 1)", _struct()])


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
    """Return the C function of a special function, traced with symbols."""
    symbols = [ca.SX.sym(f"a{k}") for k in range(len(function.elasticity))]
    program = Program(symbols, [function.formula(*symbols)])
    lines = [f"static __attribute__((noinline)) vd {name}({', '.join(f'vd a{k}' for k in range(len(symbols)))}) {{"]
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
        lines.append(f"    const vd x{k} = {value};")
    result = names[program.outputs[0]]
    if function.above is not None:
        first, second = function.above
        result = f"choose(a{first} >= a{second}, {result}, all(NAN))"
    return "\n".join([*lines, f"    return {result};", "}"])


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


def _rules(statements: Sequence[Statement], owner: Contractor) -> list[str]:
    """Return the rules that are used, one function per operation and argument."""
    made = dict[str, str]()
    for s in statements:
        if isinstance(s, Enclose) and not s.function.startswith("range_of"):
            name, body = _forward_rule(s, owner)
            letters = ", ".join(f"Interval {letter}" for letter in "abc"[: len(s.args)])
            made[name] = f"RULE {name}({letters}) {{ return {body}; }}"
        elif isinstance(s, Narrow):
            letters = ", ".join(f"Interval {letter}" for letter in "rabc"[: len(s.args) + 1])
            for i in s.positions:
                body = rules.POWER_BACKWARD if s.op in rules.POWERS else rules.BACKWARD[s.op][i]
                made[f"backward_{s.op + 100}_{i}"] = f"RULE backward_{s.op + 100}_{i}({letters}) {{ return {body}; }}"
    return list(made.values())


def _forward_rule(s: Enclose, owner: Contractor) -> tuple[str, str]:
    if s.function == "whole":
        return f"whole_{len(s.args)}", f"whole_of({' + '.join(f'{x}.low' for x in 'abc'[: len(s.args)])})"
    op = int(s.function.removeprefix("forward_")) - 100
    if op in rules.POWERS:
        same = owner.kind[s.args[1]] == CONSTANT
        return f"{s.function}_{'constant' if same else 'any'}", rules.POWER_FORWARD[same]
    return s.function, rules.FORWARD[op]


def _loading(code: Code) -> str:
    """Return the function that reads the tables of one box."""
    owner = code.contractor
    lines = ["INLINE void load_tables(const Batch *b, const int *cell, vd T[][2], int l) {"]
    for f in sorted({owner.factor[k] for k in owner.tables}):
        own = [i for i, k in enumerate(owner.tables) if owner.factor[k] == f]
        lines.append(f"    const double *r{f} = b->rows[{f}] + {2 * len(own)} * (long long)cell[{f}];")
        for place, i in enumerate(own):
            lines.append(f"    T[{i}][0][l] = r{f}[{2 * place}]; T[{i}][1][l] = r{f}[{2 * place + 1}];")
    return "\n".join([*lines, "}"])


def _tighten(code: Code) -> str:
    """Return the function that tightens a register of boxes."""
    sweeps, owner = code.sweeps, code.contractor
    lines = [
        "static vi tighten(const Batch *b, const vd *RL, const vd *RH, const vd *B, const vd *C,",
        "                  vd V[][2], vd T[][2], vd *goals, vi *open) {",
    ]
    lines += [f"    const vd l{k} = all(b->constants[{i}]), h{k} = l{k};" for i, k in enumerate(sweeps.constants)]
    lines += [f"    vd l{k} = T[{i}][0], h{k} = T[{i}][1];" for i, k in enumerate(sweeps.tables)]
    lines += [f"    vd l{k} = V[{i}][0], h{k} = V[{i}][1];" for k, i in sweeps.variables]
    lines += [f"    vd l{k}, h{k};" for k in owner.inner if k not in owner.pivots]
    lines += [f"    vi o{j};" for j in range(sweeps.limits)]
    lines += ["    vd s, t, m;", "    vi p, q, dead = all_i(0);"]
    lines += [f"    {line}" for statement in sweeps.first for line in _in_c(statement, owner)]
    lines.append("    for (long long sweep = 1; sweep < b->passes; sweep++) {")
    lines += [f"        {line}" for statement in sweeps.later for line in _in_c(statement, owner)]
    lines.append("    }")
    lines += [f"    V[{i}][0] = l{k}; V[{i}][1] = h{k};" for k, i in sweeps.variables]
    lines += [f"    goals[{j}] = {end};" for j, end in enumerate(sweeps.goals)]
    lines += [f"    open[{j}] = o{j};" for j in range(sweeps.limits)]
    return "\n".join([*lines, "    return dead;", "}"])


def _in_c(statement: Statement, owner: Contractor) -> list[str]:
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
        name = statement.function if statement.function.startswith("range_of") else _forward_rule(statement, owner)[0]
        return [f"{{ const Interval f = {name}({', '.join(ends)}); s = f.low; t = f.high; }}"]
    if statement.op in rules.POWERS and owner.kind[statement.args[1]] != CONSTANT:
        return []
    known = ", ".join([f"both(l{statement.node}, h{statement.node})", *ends])
    found = [f"f{i} = backward_{statement.op + 100}_{i}({known})" for i in statement.positions]
    lines = [f"{{ const Interval {', '.join(found)};"] if found else []
    for i in statement.positions:
        k = statement.args[i]
        lines.append(f"  l{k} = v_fmax(l{k}, f{i}.low); h{k} = v_fmin(h{k}, f{i}.high);")
    return [*lines, "}"] if found else []
