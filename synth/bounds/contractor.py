"""Generated code that tightens many boxes at once: forward-backward interval propagation as straight-line NumPy.

A box is a range per variable and a cluster of rows per slot (a count or choice is a slot with one column).
The program of a problem is read once: what depends on requirements only is a constant of the question, what
depends on a single slot is tabulated per cluster, and the rest becomes two arrays per node. Signs that hold
over the whole question are settled when the code is written, so that a product of positive nodes is two
multiplications and no test. Not-a-number stands for "nothing known" and never excludes a box.

The rules are written once, as statements whose expressions read the same in Python and in C; the Python is made
here, the C in :mod:`synth.bounds.compiled_boxes`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.intervals import BACKWARD, CANCELLATION, FORWARD, ROUNDING, SLACK, Interval, loosened, whole
from synth.bounds.numpy_code import python_function, python_text
from synth.bounds.statements import (
    Assign,
    Enclose,
    EndOfFirstSweep,
    Hold,
    Kill,
    Narrow,
    Statement,
    SweepStatements,
    special_range,
)
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import OP_SELECT, OP_SPECIAL, Node, Program

ROOT_SWEEPS = 4

CONSTANT, TABLE, VARIABLE, INNER = range(4)


@dataclass(frozen=True)
class MovingInputs:
    """Which inputs of a program move, and with what.

    Parameters
    ----------
    n_variables : int
        The first inputs.
    factor_of : tuple of int
        Per data input: the number of the factor (slot, count or choice) it belongs to, -1 for constants.
    may_lack : tuple of int
        Data inputs that some rows have no value for: limits that read them are void there.
    """

    n_variables: int
    factor_of: tuple[int, ...]
    may_lack: tuple[int, ...] = ()


@dataclass(frozen=True)
class Root:
    """What is known of every node over the whole question.

    ``low``, ``high``: intervals; ``narrowed``: nodes of which limits tell more than their arguments do.
    """

    low: np.ndarray
    high: np.ndarray
    narrowed: np.ndarray
    empty: bool


@dataclass
class Code:
    """The generated code of one sign pattern.

    ``compiled`` is machine code, if there is any; ``hopeless``: there will be none.
    """

    contractor: Contractor
    sweeps: SweepStatements
    compiled: Any = None
    hopeless: bool = False
    _functions: dict[bytes, Callable[..., Any]] = field(default_factory=dict)

    def function(self, root: Root) -> Callable[..., Any]:
        """Return the code as a Python function; it holds those nodes alone of which the root tells more."""
        key = root.narrowed.tobytes()
        if key not in self._functions:
            text = python_text(self.sweeps, root.narrowed)
            self._functions[key] = python_function(text, self.contractor.program)
        return self._functions[key]


class Contractor:
    """Propagation of some limits and objectives of one program.

    Parameters
    ----------
    program : Program
    layout : MovingInputs
    cuts : list of NodeConstraint
        Limits; ``bound`` of a constant right side is handed over with each question.
    goals : list of Goal
    pivots : list of int
        Inner nodes whose ends belong to a box as those of a variable do: they are handed over, met with what the
        arguments say, and handed back.
    """

    def __init__(
        self,
        program: Program,
        layout: MovingInputs,
        cuts: Sequence[NodeConstraint],
        goals: Sequence[Goal],
        pivots: Sequence[int] = (),
    ) -> None:
        self.program, self.layout, self.pivots = program, layout, tuple(pivots)
        self.cuts, self.goals = list(cuts), list(goals)
        wanted = [c.value for c in cuts] + [c.limit for c in cuts if c.limit is not None] + [g.node for g in goals]
        self.order = program.needed(wanted) if wanted else []
        self.kind, self.factor = self._kinds()
        # What a limit says of a column that may lack a value holds only for rows that have one: it is read, never cut.
        lacking = [program.input_nodes[layout.n_variables + k] for k in layout.may_lack]
        untouchable = program.downstream(lacking)
        self.narrows = [kind != CONSTANT and not void for kind, void in zip(self.kind, untouchable, strict=True)]
        read = {a for k in self.order if self.kind[k] == INNER for a in program.nodes[k].args} | set(wanted)
        self.tables = [k for k in self.order if self.kind[k] == TABLE and k in read]
        self.constants = [k for k in self.order if self.kind[k] == CONSTANT and k in read]
        self.inner = [k for k in self.order if self.kind[k] == INNER]
        self.tabulate = program.compile(self.tables)
        self.constant_values = program.compile(self.constants)
        self._codes: dict[object, Code] = {}

    def _kinds(self) -> tuple[list[int], list[int]]:
        """Return, per node, what it is and (for tables) of which factor."""
        n = self.layout.n_variables
        kinds, factors = list[int](), list[int]()
        for node in self.program.nodes:
            if node.op == ca.OP_CONST:
                kind, factor = CONSTANT, -1
            elif node.op == ca.OP_INPUT:
                position = int(node.constant)
                factor = -1 if position < n else self.layout.factor_of[position - n]
                kind = VARIABLE if position < n else CONSTANT if factor < 0 else TABLE
            else:
                below = {kinds[a] for a in node.args}
                owners = {factors[a] for a in node.args if kinds[a] == TABLE}
                factor = -1
                if below <= {CONSTANT}:
                    kind = CONSTANT
                elif below <= {CONSTANT, TABLE} and len(owners) == 1:
                    kind, factor = TABLE, owners.pop()
                else:
                    kind = INNER
            kinds.append(kind)
            factors.append(factor)
        return kinds, factors

    # -- what holds over the whole question ----------------------------------------------------

    def root(
        self,
        low: np.ndarray,
        high: np.ndarray,
        tables: tuple[np.ndarray, np.ndarray],
        constants: Sequence[float],
        bounds: Sequence[float],
    ) -> Root:
        """Propagate over the hull of everything.

        Parameters
        ----------
        low, high : array (variables,)
        tables : pair of arrays (tables,)
            Least and largest value of every tabulated node.
        constants : list of float
            Values of the constant nodes.
        bounds : list of float
            Constant right sides of the cuts.
        """
        n = len(self.program.nodes)
        a, b = np.full(n, -np.inf), np.full(n, np.inf)
        for k, value in zip(self.constants, constants, strict=True):
            a[k] = b[k] = value
        for k, x, y in zip(self.tables, *tables, strict=True):
            a[k], b[k] = x, y
        for k in self.order:
            if self.kind[k] == VARIABLE:
                position = int(self.program.nodes[k].constant)
                a[k], b[k] = low[position], high[position]
        empty = False
        narrowed = np.zeros(n, dtype=bool)
        with np.errstate(all="ignore"):
            for sweep in range(ROOT_SWEEPS):
                for k in self.inner:
                    natural = self._forward(k, a, b)
                    if sweep:
                        narrowed[k] = bool(a[k] > natural[0]) or bool(b[k] < natural[1])
                        natural = float(np.fmax(a[k], natural[0])), float(np.fmin(b[k], natural[1]))
                    a[k], b[k] = natural
                if sweep == ROOT_SWEEPS - 1:
                    break
                empty |= self._cut_all(a, b, bounds)
                for k in reversed(self.inner):
                    self._backward(k, a, b)
            empty |= bool(np.any(a > b + ROUNDING * np.abs(b)))
        return Root(np.where(a > b, b, a), b, narrowed, empty)

    def _forward(self, k: int, a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
        node = self.program.nodes[k]
        args = [(np.float64(a[j]), np.float64(b[j])) for j in node.args]
        low, high = forward_of(self.program, node, args)
        return float(low), float(high)

    def _backward(self, k: int, a: np.ndarray, b: np.ndarray) -> None:
        node = self.program.nodes[k]
        backward = BACKWARD.get(node.op)
        if backward is None:
            return
        args = [(np.float64(a[j]), np.float64(b[j])) for j in node.args]
        known = (np.float64(a[k]), np.float64(b[k]))
        for j, bound in zip(node.args, backward(known, *args), strict=True):
            if bound is not None and self.narrows[j]:
                a[j] = np.fmax(a[j], bound[0])
                b[j] = np.fmin(b[j], bound[1])

    def _cut_all(self, a: np.ndarray, b: np.ndarray, bounds: Sequence[float]) -> bool:
        empty = False
        for cut, constant in zip(self.cuts, bounds, strict=True):
            v, w = cut.value, cut.limit
            low, high = (constant, constant) if w is None else (a[w], b[w])
            if cut.sense in ("at_most", "equal"):
                top, bottom = loosened(high, cut.scale, +1), loosened(a[v], cut.scale, -1)
                empty |= bool(a[v] > top)
                self._narrow(v, -np.inf, top, a, b)
                if w is not None:
                    self._narrow(w, bottom, np.inf, a, b)
            if cut.sense in ("at_least", "equal"):
                bottom, top = loosened(low, cut.scale, -1), loosened(b[v], cut.scale, +1)
                empty |= bool(b[v] < bottom)
                self._narrow(v, bottom, np.inf, a, b)
                if w is not None:
                    self._narrow(w, -np.inf, top, a, b)
        return empty

    def _narrow(self, k: int, low: float, high: float, a: np.ndarray, b: np.ndarray) -> None:
        if self.narrows[k]:
            a[k], b[k] = np.fmax(a[k], low), np.fmin(b[k], high)

    # -- the code ------------------------------------------------------------------------------

    def code(self, root: Root, capped: bool) -> Code:
        """Return the generated code for the signs that hold over the question; written once per sign pattern."""
        sides = [(k, c.scale) for c in self.cuts for k in (c.value, c.limit) if k is not None]
        large = tuple(bool(root.low[k] > scale) for k, scale in sides)
        key = (capped, (root.low > 0).tobytes(), (root.low >= 0).tobytes(), large)
        if key not in self._codes:
            self._codes[key] = Code(self, _Writer(self, root, capped).sweeps)
        return self._codes[key]


def forward_of(program: Program, node: Node, args: Sequence[Interval]) -> Interval:
    """Return the interval of a node from those of its arguments."""
    if node.op == OP_SPECIAL:
        return special_range(program.specials[int(node.constant)], args)
    forward = FORWARD.get(node.op)
    return forward(*args) if forward else whole(*args)


class _Writer:
    """Writes the statements of one sign pattern."""

    def __init__(self, owner: Contractor, root: Root, capped: bool) -> None:
        self.owner, self.program, self.root, self.capped = owner, owner.program, root, capped
        self.kind = owner.kind
        self.out: list[Statement] = []
        self.sweeps = SweepStatements(
            first=self._sweep(later=False),
            later=self._sweep(later=True),
            constants=tuple(owner.constants),
            tables=tuple(owner.tables),
            variables=(
                *((k, int(self.program.nodes[k].constant)) for k in self._variables()),
                *((k, owner.layout.n_variables + i) for i, k in enumerate(owner.pivots)),
            ),
            goals=tuple(f"l{g.node}" if g.sign > 0 else f"-h{g.node}" for g in owner.goals),
            limits=len(owner.cuts),
        )

    def _variables(self) -> list[int]:
        return [k for k in self.owner.order if self.kind[k] == VARIABLE]

    def _positive(self, k: int) -> bool:
        return bool(self.root.low[k] > 0)

    def _not_negative(self, k: int) -> bool:
        return bool(self.root.low[k] >= 0)

    def _moves(self, k: int) -> bool:
        return self.owner.narrows[k]

    def _set(self, target: str, value: str) -> None:
        self.out.append(Assign(target, value))

    def _sweep(self, later: bool) -> tuple[Statement, ...]:
        self.out = []
        self._forward(later)
        self.out.append(EndOfFirstSweep())
        self._backward()
        return tuple(self.out)

    # -- forward

    def _forward(self, later: bool) -> None:
        cut_at: dict[int, list[int]] = {}
        position = {k: i for i, k in enumerate(self.owner.order)}
        for j, cut in enumerate(self.owner.cuts):
            sides = [k for k in (cut.value, cut.limit) if k is not None]
            cut_at.setdefault(max(sides, key=lambda k: position[k]), []).append(j)
        goals_at: dict[int, list[int]] = {}
        for j, goal in enumerate(self.owner.goals):
            goals_at.setdefault(goal.node, []).append(j)
        for k in self.owner.order:
            if self.kind[k] == INNER:
                self._node(k, later)
            for j in goals_at.get(k, ()) if self.capped else ():
                self._cap(j)
            for j in cut_at.get(k, ()):
                self._cut(j)

    def _node(self, k: int, later: bool) -> None:
        low, high = self._natural(k, later)
        if later or k in self.owner.pivots:
            low, high = f"v_fmax(l{k}, {low})", f"v_fmin(h{k}, {high})"
        self._set(f"l{k}", low)
        self._set(f"h{k}", high)
        if not later:
            self.out.append(Hold(k))

    def _natural(self, k: int, later: bool) -> tuple[str, str]:
        """Return the code of both ends.

        Ends that were narrowed may miss the value of a design by rounding. Where large terms cancel that would grow
        from sweep to sweep, so that later sweeps widen what they find there.
        """
        node = self.program.nodes[k]
        op, args = node.op, node.args
        if op == OP_SPECIAL:
            name = f"special_{int(node.constant)}"
            if all(self._not_negative(a) for a in args):
                least, most = self._corners(k)
                return f"{name}({', '.join(least)})", f"{name}({', '.join(most)})"
            self.out.append(Enclose(f"range_of_{name}", args))
            return "s", "t"
        a = args[0]
        b = args[1] if len(args) > 1 else a
        if op == ca.OP_ADD:
            cancels = later and not (self._not_negative(a) and self._not_negative(b))
            less, more = self._rounding(a) if cancels else ("", "")
            return f"l{a} + l{b}{less}", f"h{a} + h{b}{more}"
        if op == ca.OP_SUB:
            less, more = self._rounding(a) if later else ("", "")
            return f"l{a} - h{b}{less}", f"h{a} - l{b}{more}"
        if op == ca.OP_NEG:
            return f"-h{a}", f"-l{a}"
        if op == ca.OP_TWICE:
            return f"2.0 * l{a}", f"2.0 * h{a}"
        if op == ca.OP_MUL and self._not_negative(a) and self._not_negative(b):
            return f"l{a} * l{b}", f"h{a} * h{b}"
        if op == ca.OP_DIV and self._not_negative(a) and self._positive(b):
            return f"l{a} / h{b}", f"h{a} / l{b}"
        if op == ca.OP_SQ and self._not_negative(a):
            return f"l{a} * l{a}", f"h{a} * h{a}"
        if op == ca.OP_INV and self._positive(a):
            return f"1.0 / h{a}", f"1.0 / l{a}"
        if op == ca.OP_SQRT and self._not_negative(a):
            return f"v_sqrt(l{a})", f"v_sqrt(h{a})"
        name = f"forward_{op + 100}" if op in FORWARD else "whole"
        self.out.append(Enclose(name, args))
        return "s", "t"

    def _rounding(self, a: int) -> tuple[str, str]:
        """Return the code of what the ends of a term may have lost by rounding."""
        low, high = (f"l{a}", f"h{a}") if self._not_negative(a) else (f"v_abs(l{a})", f"v_abs(h{a})")
        return f" - {CANCELLATION!r} * {low}", f" + {CANCELLATION!r} * {high}"

    def _corners(self, k: int) -> tuple[list[str], list[str]]:
        """Return the corners at which a special function is least and largest."""
        node = self.program.nodes[k]
        rising = [low >= 0 for low, _ in self.program.specials[int(node.constant)].elasticity]
        least = [f"l{a}" if up else f"h{a}" for a, up in zip(node.args, rising, strict=True)]
        most = [f"h{a}" if up else f"l{a}" for a, up in zip(node.args, rising, strict=True)]
        return least, most

    # -- limits and cutoffs

    def _cap(self, j: int) -> None:
        goal = self.owner.goals[j]
        k = goal.node
        self.out.append(Kill(f"l{k} > C[{j}]" if goal.sign > 0 else f"-h{k} > C[{j}]"))
        if self._moves(k) and goal.sign > 0:
            self._set(f"h{k}", f"v_fmin(h{k}, C[{j}])")
        elif self._moves(k):
            self._set(f"l{k}", f"v_fmax(l{k}, -C[{j}])")

    def _loose(self, end: str, k: int | None, scale: float, side: int) -> str:
        if k is not None and self._positive(k) and self.root.low[k] > scale:
            return f"{end} * {1 + side * SLACK!r}"
        return f"loosened({end}, {scale!r}, {side})"

    def _cut(self, j: int) -> None:
        cut = self.owner.cuts[j]
        v, w = cut.value, cut.limit
        low, high = (f"B[{j}]", f"B[{j}]") if w is None else (f"l{w}", f"h{w}")
        moving = w is not None and self._moves(w)
        opens = []
        if cut.sense in ("at_most", "equal"):
            self._set("s", self._loose(high, w, cut.scale, +1))
            self.out.append(Kill(f"l{v} > s"))
            if moving:
                self._set("t", f"v_fmax({low}, {self._loose(f'l{v}', v, cut.scale, -1)})")
            if self._moves(v):
                self._set(f"h{v}", f"v_fmin(h{v}, s)")
            self._set(f"o{j}", f"h{v} > {low}")
            opens.append(f"o{j}")
            if moving:
                self._set(f"l{w}", "t")
        if cut.sense in ("at_least", "equal"):
            self._set("s", self._loose(low, w, cut.scale, -1))
            self.out.append(Kill(f"h{v} < s"))
            if moving:
                self._set("t", f"v_fmin({high}, {self._loose(f'h{v}', v, cut.scale, +1)})")
            if self._moves(v):
                self._set(f"l{v}", f"v_fmax(l{v}, s)")
            self._set(f"o{j}", " | ".join([*opens, f"(l{v} < {high})"]))
            if moving:
                self._set(f"h{w}", "t")

    # -- backward

    def _backward(self) -> None:
        for k in reversed(self.owner.inner):
            self._back(k)
        for k in [*self._variables(), *self.owner.tables, *self.owner.pivots]:
            size = f"h{k}" if self._positive(k) else f"v_abs(h{k})"
            self.out.append(Kill(f"l{k} > h{k} + {ROUNDING!r} * {size}"))
        # Ends that cross by rounding change places: either may be the right one, and sweeps would pull them apart.
        for k in [*self._variables(), *self.owner.tables, *self.owner.inner]:
            self._set("m", f"choose(l{k} > h{k}, h{k}, l{k})")
            self._set(f"h{k}", f"choose(l{k} > h{k}, l{k}, h{k})")
            self._set(f"l{k}", "m")

    def _narrow(self, k: int, low: str, high: str) -> None:
        if self._moves(k):
            self._set(f"l{k}", f"v_fmax(l{k}, {low})")
            self._set(f"h{k}", f"v_fmin(h{k}, {high})")

    def _narrow_both(self, a: int, first: tuple[str, str], b: int, second: tuple[str, str]) -> None:
        """Narrow two arguments by what was known of both before."""
        if self._moves(a) and self._moves(b):
            self._set("s", second[0])
            self._set("t", second[1])
            second = "s", "t"
        self._narrow(a, *first)
        self._narrow(b, *second)

    def _back(self, k: int) -> None:
        node = self.program.nodes[k]
        op, args = node.op, node.args
        if not any(self._moves(a) for a in args):
            return
        a = args[0]
        b = args[1] if len(args) > 1 else a
        known = self._not_negative
        if op == OP_SPECIAL:
            self._shave(k)
        elif op in (ca.OP_ADD, ca.OP_SUB) and a != b and all(self._positive(x) for x in (k, a, b)):
            # Widened by what rounding may have cost where large terms cancel.
            less, more = f" * {1 - CANCELLATION!r}", f" * {1 + CANCELLATION!r}"
            if op == ca.OP_ADD:
                first = f"l{k}{less} - h{b}", f"h{k}{more} - l{b}"
                second = f"l{k}{less} - h{a}", f"h{k}{more} - l{a}"
            else:
                first = f"l{k} + l{b}", f"h{k} + h{b}"
                second = f"l{a}{less} - h{k}", f"h{a}{more} - l{k}"
            self._narrow_both(a, first, b, second)
        elif op == ca.OP_MUL and a != b and known(k) and self._positive(a) and self._positive(b):
            self._narrow_both(a, (f"l{k} / h{b}", f"h{k} / l{b}"), b, (f"l{k} / h{a}", f"h{k} / l{a}"))
        elif op == ca.OP_DIV and a != b and self._positive(k) and self._positive(a) and self._positive(b):
            self._narrow_both(a, (f"l{k} * l{b}", f"h{k} * h{b}"), b, (f"l{a} / h{k}", f"h{a} / l{k}"))
        elif op == ca.OP_NEG:
            self._narrow(a, f"-h{k}", f"-l{k}")
        elif op == ca.OP_TWICE:
            self._narrow(a, f"0.5 * l{k}", f"0.5 * h{k}")
        elif op == ca.OP_SQ and known(a) and known(k):
            self._narrow(a, f"v_sqrt(l{k})", f"v_sqrt(h{k})")
        elif op == ca.OP_SQRT and known(k):
            self._narrow(a, f"l{k} * l{k}", f"h{k} * h{k}")
        elif op == ca.OP_INV and self._positive(k) and self._positive(a):
            self._narrow(a, f"1.0 / h{k}", f"1.0 / l{k}")
        elif op in BACKWARD:
            positions = tuple(i for i, x in enumerate(args) if self._moves(x) and self._answers(op, i))
            self.out.append(Narrow(op, k, args, positions))

    def _answers(self, op: int, position: int) -> bool:
        """Tell whether the backward rule ever speaks of an argument (conditions of where are never narrowed)."""
        return not (op in (ca.OP_IF_ELSE_ZERO, OP_SELECT) and position == 0)

    def _shave(self, k: int) -> None:
        """Cut halves off the arguments of a special function: it is monotone, so its value in the middle tells."""
        node = self.program.nodes[k]
        function = self.program.specials[int(node.constant)]
        if not all(self._not_negative(a) for a in node.args):
            return
        name = f"special_{int(node.constant)}"
        for i, a in enumerate(node.args):
            if self.kind[a] not in (INNER, VARIABLE):
                continue
            least, most = self._corners(k)
            least[i] = most[i] = "m"
            self._set("m", f"0.5 * (l{a} + h{a})")
            # Too much in the middle although all else is at its least: the half beyond is empty, and so on.
            self._set("p", f"{name}({', '.join(least)}) > h{k} * {1 + ROUNDING!r}")
            self._set("q", f"{name}({', '.join(most)}) < l{k} * {1 - ROUNDING!r}")
            beyond, before = ("p", "q") if function.elasticity[i][0] >= 0 else ("q", "p")
            self._set(f"h{a}", f"choose({beyond}, m, h{a})")
            self._set(f"l{a}", f"choose({before}, m, l{a})")
