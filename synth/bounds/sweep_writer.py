"""Writes the statements that tighten boxes: forward-backward sweeps for the signs that hold over a question."""

from __future__ import annotations

import casadi as ca

from synth.bounds.intervals import BACKWARD, CANCELLATION, FORWARD, ROUNDING
from synth.bounds.propagated_nodes import INNER, VARIABLE, PropagatedNodes
from synth.bounds.root_propagation import Root
from synth.bounds.statements import Assign, Enclose, EndOfFirstSweep, Hold, Kill, Narrow, Statement, SweepStatements
from synth.model.constraint import NodeConstraint
from synth.model.program import OP_SELECT, OP_SPECIAL


class SweepWriter:
    """Writes the statements of one sign pattern.

    Parameters
    ----------
    nodes : PropagatedNodes
    root : Root
        Tells the signs that hold over the whole question.
    capped : bool
        Whether objectives have cutoffs; then they may have floors as well.

    Attributes
    ----------
    sweeps : SweepStatements
    """

    def __init__(self, nodes: PropagatedNodes, root: Root, capped: bool) -> None:
        self.nodes, self.program, self.root, self.capped = nodes, nodes.program, root, capped
        self.kind = nodes.kind
        self.out: list[Statement] = []
        self.sweeps = SweepStatements(
            first=self._sweep(later=False),
            later=self._sweep(later=True),
            constants=tuple(nodes.constants),
            tables=tuple(nodes.tables),
            variables=(
                *((k, nodes.position(k)) for k in nodes.variables),
                *((k, nodes.layout.n_variables + i) for i, k in enumerate(nodes.auxiliary)),
            ),
            goals=tuple(f"l{g.node}" if g.sign > 0 else f"-h{g.node}" for g in nodes.goals),
            limits=len(nodes.constraints),
        )

    def _positive(self, k: int) -> bool:
        return bool(self.root.low[k] > 0)

    def _not_negative(self, k: int) -> bool:
        return bool(self.root.low[k] >= 0)

    def _moves(self, k: int) -> bool:
        return self.nodes.narrows[k]

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
        constraints_at: dict[int, list[int]] = {}
        position = {k: i for i, k in enumerate(self.nodes.order)}
        for j, constraint in enumerate(self.nodes.constraints):
            constraints_at.setdefault(max(constraint.nodes, key=lambda k: position[k]), []).append(j)
        goals_at: dict[int, list[int]] = {}
        for j, goal in enumerate(self.nodes.goals):
            goals_at.setdefault(goal.node, []).append(j)
        for k in self.nodes.order:
            if self.kind[k] == INNER:
                self._node(k, later)
            for j in goals_at.get(k, ()) if self.capped else ():
                self._cap(j)
            for j in constraints_at.get(k, ()):
                self._cut(j)

    def _node(self, k: int, later: bool) -> None:
        low, high = self._natural(k, later)
        if later or k in self.nodes.auxiliary:
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
        goal = self.nodes.goals[j]
        k = goal.node
        self.out.append(Kill(f"l{k} > C[{j}]" if goal.sign > 0 else f"-h{k} > C[{j}]"))
        if self._moves(k) and goal.sign > 0:
            self._set(f"h{k}", f"v_fmin(h{k}, C[{j}])")
        elif self._moves(k):
            self._set(f"l{k}", f"v_fmax(l{k}, -C[{j}])")
        self.out.append(Kill(f"h{k} < F[{j}]" if goal.sign > 0 else f"-l{k} < F[{j}]"))
        if self._moves(k) and goal.sign > 0:
            self._set(f"l{k}", f"v_fmax(l{k}, F[{j}])")
        elif self._moves(k):
            self._set(f"h{k}", f"v_fmin(h{k}, -F[{j}])")

    def _loose(self, end: str, k: int | None, constraint: NodeConstraint, side: int) -> str:
        share, terms = side * constraint.slack, constraint.terms
        if terms is None and k is not None and self._positive(k) and self.root.low[k] > constraint.scale:
            return f"{end} * {1 + share!r}"
        size = f"all({constraint.scale!r})" if terms is None else f"h{terms}"
        return f"loosened({end}, {size}, {share!r})"

    def _cut(self, j: int) -> None:
        constraint = self.nodes.constraints[j]
        v, w = constraint.value, constraint.limit
        low, high = (f"B[{j}]", f"B[{j}]") if w is None else (f"l{w}", f"h{w}")
        moving = w is not None and self._moves(w)
        opens = []
        if constraint.sense in ("at_most", "equal"):
            self._set("s", self._loose(high, w, constraint, +1))
            self.out.append(Kill(f"l{v} > s"))
            if moving:
                self._set("t", f"v_fmax({low}, {self._loose(f'l{v}', v, constraint, -1)})")
            if self._moves(v):
                self._set(f"h{v}", f"v_fmin(h{v}, s)")
            self._set(f"o{j}", f"h{v} > {low}")
            opens.append(f"o{j}")
            if moving:
                self._set(f"l{w}", "t")
        if constraint.sense in ("at_least", "equal"):
            self._set("s", self._loose(low, w, constraint, -1))
            self.out.append(Kill(f"h{v} < s"))
            if moving:
                self._set("t", f"v_fmin({high}, {self._loose(f'h{v}', v, constraint, +1)})")
            if self._moves(v):
                self._set(f"l{v}", f"v_fmax(l{v}, s)")
            self._set(f"o{j}", " | ".join([*opens, f"(l{v} < {high})"]))
            if moving:
                self._set(f"h{w}", "t")

    # -- backward

    def _backward(self) -> None:
        for k in reversed(self.nodes.inner):
            if not self.nodes.sizes[k]:
                self._back(k)
        for k in [*self.nodes.variables, *self.nodes.tables, *self.nodes.auxiliary]:
            size = f"h{k}" if self._positive(k) else f"v_abs(h{k})"
            self.out.append(Kill(f"l{k} > h{k} + {ROUNDING!r} * {size}"))
        # Ends that cross by rounding change places: either may be the right one, and sweeps would pull them apart.
        for k in [*self.nodes.variables, *self.nodes.tables, *self.nodes.inner]:
            if self.nodes.sizes[k]:
                continue
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
