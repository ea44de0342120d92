"""Emits the instructions that tighten boxes: forward-backward sweeps for the signs that hold over a question."""

from __future__ import annotations

import math
from collections.abc import Sequence

import casadi as ca
import numpy as np

from synth.bounds.instructions import (
    COMPARED,
    ELEMENTARY,
    OP_NAMES,
    POWERS,
    RULE_NUMBERS,
    InstructionList,
    Op,
    Regions,
    Row,
)
from synth.bounds.intervals import BACKWARD, FORWARD, ROUNDING
from synth.bounds.propagated_nodes import CONSTANT, INNER, VARIABLE, PropagatedNodes
from synth.bounds.root_propagation import Root
from synth.model.constraint import NodeConstraint
from synth.model.program import EXPONENTS, OP_SELECT, OP_SPECIAL, Program
from synth.operations.enclosures import CANCELLATION
from synth.special import SpecialFunction

# Instructions that do two things at once.
MEETING: dict[tuple[Op, Op], Op] = {
    (Op.FMAX, Op.MOVE): Op.FMAX,
    (Op.FMAX, Op.MUL): Op.FMAX_MUL,
    (Op.FMAX, Op.DIV): Op.FMAX_DIV,
    (Op.FMAX, Op.MUL_SUB): Op.FMAX_MUL_SUB,
    (Op.FMAX, Op.SQRT): Op.FMAX_SQRT,
    (Op.FMIN, Op.MOVE): Op.FMIN,
    (Op.FMIN, Op.MUL): Op.FMIN_MUL,
    (Op.FMIN, Op.DIV): Op.FMIN_DIV,
    (Op.FMIN, Op.MUL_SUB): Op.FMIN_MUL_SUB,
    (Op.FMIN, Op.SQRT): Op.FMIN_SQRT,
}
PAIRS: dict[tuple[bool, Op], Op] = {
    (False, Op.ADD): Op.ENDS_ADD,
    (False, Op.SUB): Op.ENDS_SUB,
    (False, Op.MUL): Op.ENDS_MUL,
    (False, Op.DIV): Op.ENDS_DIV,
    (True, Op.ADD): Op.MET_ADD,
    (True, Op.SUB): Op.MET_SUB,
    (True, Op.MUL): Op.MET_MUL,
    (True, Op.DIV): Op.MET_DIV,
}
SCRATCH = 5  # registers on the way: s and t side by side, m, p and q
FROM_LITERALS = 1 << 24  # their registers are known when all else is

Operands = tuple[int, ...]
Computed = tuple[Op, Operands, Operands]  # an operation, and its operands for the lower and for the upper end


class BoxEmitter:
    """Emits the instructions of one sign pattern.

    Parameters
    ----------
    nodes : PropagatedNodes
    root : Root
        Root bounds; they settle the signs.
    capped : bool
        Whether objectives have cutoffs; then they may have floors as well.
    """

    def __init__(self, nodes: PropagatedNodes, root: Root, capped: bool) -> None:
        self.nodes, self.program, self.root, self.capped = nodes, nodes.program, root, capped
        self.kind = nodes.kind
        self.rows: list[Row] = []
        self.literals: list[float] = []
        self.literal_at: dict[str, int] = {}
        self.formulas: dict[int, Program] = {}  # of special functions
        self.used = self.most = 0  # temporary registers
        self.low: dict[int, int] = {}  # node -> register of its lower end
        self._lay_out()

    def _lay_out(self) -> None:
        """Give every node, limit and objective its registers."""
        nodes, self.places, at = self.nodes, dict[str, int](), 0
        moved = [*nodes.variables, *nodes.auxiliary]
        inner = [k for k in nodes.inner if k not in nodes.auxiliary]
        limits, goals = len(nodes.constraints), len(nodes.goals)
        regions: dict[str, Sequence[int] | int] = {
            "constants": nodes.constants,
            "right_sides": limits,
            "cutoffs": goals,
            "floors": goals,
            "tables": nodes.tables,
            "variables": moved,
            "inner": inner,
            "open": limits,
            "goals": goals,
            "scratch": SCRATCH,
        }
        for region, indices in regions.items():
            self.places[region] = at
            if isinstance(indices, int):
                at += indices
            else:
                self.low |= {k: at + 2 * i for i, k in enumerate(indices)}
                at += 2 * len(indices)
        self.free_at = at
        self.s, self.t, self.m, self.p, self.q = (self.places["scratch"] + k for k in range(SCRATCH))

    def emitted(self) -> InstructionList:
        """Instructions of all sweeps."""
        nodes = self.nodes
        lists = [self._sweep(later=False), self._sweep(later=True), self._goals()]
        literals_at = self.free_at + self.most
        first, later, last = (
            tuple(tuple(x - FROM_LITERALS + literals_at if x >= FROM_LITERALS else x for x in row) for row in rows)
            for rows in lists
        )
        return InstructionList(
            first,
            later,
            last,
            Regions(**self.places, literals=literals_at, count=literals_at + len(self.literals)),
            np.array(self.literals, dtype=float),
            variables=(
                *(nodes.position(k) for k in nodes.variables),
                *(nodes.layout.n_variables + i for i in range(len(nodes.auxiliary))),
            ),
            constants=len(nodes.constants),
            tables=len(nodes.tables),
            limits=len(nodes.constraints),
            goals=len(nodes.goals),
        )

    # -- registers and rows

    def _high(self, k: int) -> int:
        return self.low[k] + 1

    def _literal(self, value: float) -> int:
        digits = value.hex()  # tells zeros apart
        if digits not in self.literal_at:
            self.literal_at[digits] = FROM_LITERALS + len(self.literals)
            self.literals.append(value)
        return self.literal_at[digits]

    def _new(self, count: int = 1) -> int:
        first, self.used = self.free_at + self.used, self.used + count
        self.most = max(self.most, self.used)
        return first

    def _put(self, op: int, target: int, *operands: int) -> None:
        self.rows.append((int(op), target, *operands))

    def _value(self, op: Op, *operands: int) -> int:
        place = self._new()
        self._put(op, place, *operands)
        return place

    def _end(self, target: int, meet: Op, met: bool, op: Op, operands: Operands) -> None:
        """Put one end of a node, met with what is known of it or not."""
        if not met:
            self._put(op, target, *operands)
        elif (meet, op) in MEETING:
            self._put(MEETING[meet, op], target, target, *operands)
        else:
            self._put(op, self.s, *operands)
            self._put(meet, target, target, self.s)

    def _both(self, k: int, met: bool, computed: Computed) -> None:
        """Put both ends of a node."""
        op, low, high = computed
        if (met, op) in PAIRS:
            self._put(PAIRS[met, op], self.low[k], *low, *high)
            return
        self._end(self.low[k], Op.FMAX, met, op, low)
        self._end(self._high(k), Op.FMIN, met, op, high)

    def _meet(self, k: int, register: int) -> None:
        """Put both ends of a node met with two registers side by side."""
        self._both(k, True, (Op.MOVE, (register,), (register + 1,)))

    # -- signs

    def _positive(self, k: int) -> bool:
        return bool(self.root.low[k] > 0)

    def _not_negative(self, k: int) -> bool:
        return bool(self.root.low[k] >= 0)

    def _moves(self, k: int) -> bool:
        return self.nodes.narrows[k]

    # -- sweeps

    def _sweep(self, later: bool) -> list[Row]:
        self.rows = []
        self._forward(later)
        self._put(Op.END_IF_DEAD, 0)
        self._backward()
        self._put(Op.END, 0)
        return self.rows

    def _goals(self) -> list[Row]:
        self.rows = []
        for j, goal in enumerate(self.nodes.goals):
            end = (Op.MOVE, self.low[goal.node]) if goal.sign > 0 else (Op.NEG, self._high(goal.node))
            self._put(end[0], self.places["goals"] + j, end[1])
        self._put(Op.END, 0)
        return self.rows

    def _forward(self, later: bool) -> None:
        constraints_at: dict[int, list[int]] = {}
        position = {k: i for i, k in enumerate(self.nodes.order)}
        for j, constraint in enumerate(self.nodes.constraints):
            constraints_at.setdefault(max(constraint.nodes, key=lambda k: position[k]), []).append(j)
        goals_at: dict[int, list[int]] = {}
        for j, goal in enumerate(self.nodes.goals):
            goals_at.setdefault(goal.node, []).append(j)
        for k in self.nodes.order:
            self.used = 0
            if self.kind[k] == INNER:
                self._node(k, later)
            for j in goals_at.get(k, ()) if self.capped else ():
                self._cap(j)
            for j in constraints_at.get(k, ()):
                self._cut(j)

    def _node(self, k: int, later: bool) -> None:
        """Put the ends of a node from those of its arguments.

        Ends that were narrowed may miss the value of a design by rounding. Where large terms cancel that would grow
        from sweep to sweep, so that later sweeps widen what they find there.
        """
        met, op, args = later or k in self.nodes.auxiliary, self.program.nodes[k].op, self.program.nodes[k].args
        if op == OP_SPECIAL:
            self._special_ends(k, met)
        elif later and self._cancels(op, args):
            self._widened(k, op, *args)
        elif (computed := self._of_known_sign(op, args)) is not None:
            self._both(k, met, computed)
        else:
            place = self.s if met else self.low[k]
            self._put(RULE_NUMBERS[self._forward_rule(op, args)], place, *(self.low[a] for a in args))
            if met:
                self._meet(k, self.s)
        if not later:
            self._put(Op.HOLD, self.low[k], k)

    def _of_known_sign(self, op: int, args: Operands) -> Computed | None:
        """Operands of a node whose ends follow from one end of each argument; None for others."""
        a, b = args[0], args[-1]
        low, high = self.low[a], self._high(a)
        if op == ca.OP_ADD:
            return Op.ADD, (low, self.low[b]), (high, self._high(b))
        if op == ca.OP_SUB:
            return Op.SUB, (low, self._high(b)), (high, self.low[b])
        if op == ca.OP_NEG:
            return Op.NEG, (high,), (low,)
        if op == ca.OP_TWICE:
            two = self._literal(2.0)
            return Op.MUL, (two, low), (two, high)
        if not self._not_negative(a):
            return None
        if op == ca.OP_MUL and self._not_negative(b):
            return Op.MUL, (low, self.low[b]), (high, self._high(b))
        if op == ca.OP_DIV and self._positive(b):
            return Op.DIV, (low, self._high(b)), (high, self.low[b])
        if op == ca.OP_SQ:
            return Op.MUL, (low, low), (high, high)
        if op == ca.OP_INV and self._positive(a):
            one = self._literal(1.0)
            return Op.DIV, (one, high), (one, low)
        return (Op.SQRT, (low,), (high,)) if EXPONENTS.get(op) == 0.5 else None

    def _forward_rule(self, op: int, args: Operands) -> str:
        if op in POWERS:
            return f"FORWARD_POW_{'CONSTANT' if self.kind[args[-1]] == CONSTANT else 'ANY'}"
        return f"FORWARD_{OP_NAMES[op]}" if op in FORWARD else f"WHOLE_{len(args)}"

    def _cancels(self, op: int, args: Operands) -> bool:
        return op == ca.OP_SUB or (op == ca.OP_ADD and not all(self._not_negative(a) for a in args))

    def _widened(self, k: int, op: int, a: int, b: int) -> None:
        """Put the ends of a sum or difference, widened by what the ends of its first term may have lost by rounding."""
        lost, low, high = self._literal(CANCELLATION), self.low[a], self._high(a)
        if op == ca.OP_ADD:
            less, more, low_b, high_b = Op.ADD_SUB_MUL, Op.ADD_ADD_MUL, self.low[b], self._high(b)
        else:
            less, more, low_b, high_b = Op.SUB_SUB_MUL, Op.SUB_ADD_MUL, self._high(b), self.low[b]
        known = self._not_negative(a)
        self._end(self.low[k], Op.FMAX, True, less, (low, low_b, lost, low if known else self._value(Op.ABS, low)))
        self._end(
            self._high(k), Op.FMIN, True, more, (high, high_b, lost, high if known else self._value(Op.ABS, high))
        )

    # -- special functions

    def _special_ends(self, k: int, met: bool) -> None:
        """Put the ends of a special function: it is monotone; nothing is known where an argument may be negative."""
        node, place = self.program.nodes[k], self.s if met else self.low[k]
        least, most = self._corners(k)
        self._special(int(node.constant), least, place)
        self._special(int(node.constant), most, place + 1)
        if not all(self._not_negative(a) for a in node.args):
            zero = self._literal(0.0)
            inside = self._value(Op.GE, self.low[node.args[0]], zero)
            for a in node.args[1:]:
                inside = self._value(Op.AND, inside, self._value(Op.GE, self.low[a], zero))
            self._put(Op.CHOOSE, place, inside, place, self._literal(-math.inf))
            self._put(Op.CHOOSE, place + 1, inside, place + 1, self._literal(math.inf))
        if met:
            self._meet(k, self.s)

    def _corners(self, k: int) -> tuple[list[int], list[int]]:
        """Registers of the corners at which a special function is least and largest."""
        node = self.program.nodes[k]
        rising = [low >= 0 for low, _ in self.program.specials[int(node.constant)].elasticity]
        least = [self.low[a] + (not up) for a, up in zip(node.args, rising, strict=True)]
        most = [self.low[a] + up for a, up in zip(node.args, rising, strict=True)]
        return least, most

    def _special(self, number: int, args: Sequence[int], target: int) -> None:
        """Put the formula of a special function, which stands in the list as often as it is used."""
        function = self.program.specials[number]
        if number not in self.formulas:
            self.formulas[number] = formula_of(function)
        program, places, mark = self.formulas[number], dict[int, int](), self.used
        for k in program.needed(program.outputs):
            node = program.nodes[k]
            if node.op == ca.OP_INPUT:
                places[k] = args[int(node.constant)]
            elif node.op == ca.OP_CONST:
                places[k] = self._literal(float(node.constant))
            else:
                places[k] = self._elementary(node.op, [places[a] for a in node.args])
        result = places[program.outputs[0]]
        if function.above is not None:
            inside = self._value(Op.GE, *(args[i] for i in function.above))
            self._put(Op.CHOOSE, target, inside, result, self._literal(math.nan))
        elif result >= self.free_at and self.rows[-1][1] == result:
            self.rows[-1] = (self.rows[-1][0], target, *self.rows[-1][2:])
        else:
            self._put(Op.MOVE, target, result)
        self.used = mark

    def _elementary(self, op: int, args: Sequence[int]) -> int:
        """Put one operation of a formula; return the register of its value."""
        if op in ELEMENTARY:
            return self._value(ELEMENTARY[op], *args)
        if op == ca.OP_SQ:
            return self._value(Op.MUL, args[0], args[0])
        if op == ca.OP_TWICE:
            return self._value(Op.ADD, args[0], args[0])
        if op == ca.OP_INV:
            return self._value(Op.DIV, self._literal(1.0), args[0])
        if op in COMPARED:
            return self._value(Op.TRUTH, self._value(COMPARED[op], *args))
        truths = [self._value(Op.NE, a, self._literal(0.0)) for a in args[: 2 if op in (ca.OP_AND, ca.OP_OR) else 1]]
        if op == OP_SELECT:
            return self._value(Op.CHOOSE, truths[0], *args[1:])
        if op == ca.OP_IF_ELSE_ZERO:
            return self._value(Op.KEEP, truths[0], args[1])
        mask = {ca.OP_NOT: Op.NOT, ca.OP_AND: Op.AND, ca.OP_OR: Op.OR}[op]
        return self._value(Op.TRUTH, self._value(mask, *truths))

    # -- limits and cutoffs

    def _cap(self, j: int) -> None:
        """Put the cutoff of an objective, and its floor."""
        goal, cutoff, floor = self.nodes.goals[j], self.places["cutoffs"] + j, self.places["floors"] + j
        low, high, moves = self.low[goal.node], self._high(goal.node), self._moves(goal.node)
        if goal.sign > 0:
            self._put(Op.KILL_ABOVE, 0, low, cutoff)
            if moves:
                self._put(Op.FMIN, high, high, cutoff)
            self._put(Op.KILL_BELOW, 0, high, floor)
            if moves:
                self._put(Op.FMAX, low, low, floor)
            return
        self._put(Op.KILL_ABOVE, 0, self._value(Op.NEG, high), cutoff)
        if moves:
            self._put(Op.FMAX, low, low, self._value(Op.NEG, cutoff))
        self._put(Op.KILL_BELOW, 0, self._value(Op.NEG, low), floor)
        if moves:
            self._put(Op.FMIN, high, high, self._value(Op.NEG, floor))

    def _loose(self, end: int, k: int | None, constraint: NodeConstraint, side: int) -> tuple[Op, Operands]:
        """Operation that moves an end by the slack of a limit, and its operands."""
        share, terms = side * constraint.slack, constraint.terms
        if terms is None and k is not None and self._positive(k) and self.root.low[k] > constraint.scale:
            return Op.MUL, (end, self._literal(1 + share))
        size = self._literal(float(constraint.scale)) if terms is None else self._high(terms)
        op = Op.LOOSEN_DOWN if math.copysign(1.0, share) < 0 else Op.LOOSEN_UP
        return op, (end, size, self._literal(abs(share)))

    def _cut(self, j: int) -> None:
        """Put a limit: boxes that break it die, what is left of its sides is narrowed, and it is open or not."""
        constraint, opened = self.nodes.constraints[j], self.places["open"] + j
        v, w = constraint.value, constraint.limit
        side = self.places["right_sides"] + j
        low, high = (side, side) if w is None else (self.low[w], self._high(w))
        moving = w is not None and self._moves(w)
        if constraint.sense in ("at_most", "equal"):
            self._side(high, w, constraint, +1)
            self._put(Op.KILL_ABOVE, 0, self.low[v], self.s)
            if moving:
                self._other_side(Op.FMAX, low, self.low[v], constraint, -1)
            if self._moves(v):
                self._put(Op.FMIN, self._high(v), self._high(v), self.s)
            self._put(Op.GT, opened, self._high(v), low)
            if moving:
                self._put(Op.MOVE, low, self.t)
        if constraint.sense in ("at_least", "equal"):
            self._side(low, w, constraint, -1)
            self._put(Op.KILL_BELOW, 0, self._high(v), self.s)
            if moving:
                self._other_side(Op.FMIN, high, self._high(v), constraint, +1)
            if self._moves(v):
                self._put(Op.FMAX, self.low[v], self.low[v], self.s)
            if constraint.sense == "equal":
                self._put(Op.OR, opened, opened, self._value(Op.LT, self.low[v], high))
            else:
                self._put(Op.LT, opened, self.low[v], high)
            if moving:
                self._put(Op.MOVE, high, self.t)

    def _side(self, end: int, k: int | None, constraint: NodeConstraint, side: int) -> None:
        op, operands = self._loose(end, k, constraint, side)
        self._put(op, self.s, *operands)

    def _other_side(self, meet: Op, end: int, value_end: int, constraint: NodeConstraint, side: int) -> None:
        op, operands = self._loose(value_end, constraint.value, constraint, side)
        if (meet, op) in MEETING:
            self._put(MEETING[meet, op], self.t, end, *operands)
        else:
            self._put(meet, self.t, end, self._value(op, *operands))

    # -- backward

    def _backward(self) -> None:
        for k in reversed(self.nodes.inner):
            self.used = 0
            if not self.nodes.sizes[k]:
                self._back(k)
        blur = self._literal(ROUNDING)
        for k in [*self.nodes.variables, *self.nodes.tables, *self.nodes.auxiliary]:
            self.used = 0
            size = self._high(k) if self._positive(k) else self._value(Op.ABS, self._high(k))
            self._put(Op.KILL_CROSSED, 0, self.low[k], self._high(k), blur, size)
        # Ends that cross by rounding change places: either may be the right one, and sweeps would pull them apart.
        for k in [*self.nodes.variables, *self.nodes.tables, *self.nodes.inner]:
            if not self.nodes.sizes[k]:
                self._put(Op.IN_ORDER, self.low[k])

    def _narrow(self, k: int, computed: Computed) -> None:
        if self._moves(k):
            self._both(k, True, computed)

    def _narrow_two(self, a: int, first: Computed, b: int, second: Computed) -> None:
        """Narrow two arguments by what was known of both before."""
        if self._moves(a) and self._moves(b):
            op, low, high = second
            self._put(op, self.s, *low)
            self._put(op, self.t, *high)
            second = Op.MOVE, (self.s,), (self.t,)
        self._narrow(a, first)
        self._narrow(b, second)

    def _back(self, k: int) -> None:
        """Put what the ends of a node say of its arguments."""
        node = self.program.nodes[k]
        op, args, known = node.op, node.args, self._not_negative
        if not any(self._moves(a) for a in args):
            return
        a, b = args[0], args[-1]
        low, high = self.low[k], self._high(k)
        if op == OP_SPECIAL:
            self._shave(k)
        elif op in (ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_DIV) and a != b and self._all_positive(op, k, a, b):
            self._back_of_two(op, k, a, b)
        elif op == ca.OP_NEG:
            self._narrow(a, (Op.NEG, (high,), (low,)))
        elif op == ca.OP_TWICE:
            half = self._literal(0.5)
            self._narrow(a, (Op.MUL, (half, low), (half, high)))
        elif op == ca.OP_SQ and known(a) and known(k):
            self._narrow(a, (Op.SQRT, (low,), (high,)))
        elif EXPONENTS.get(op) == 0.5 and known(k):
            self._narrow(a, (Op.MUL, (low, low), (high, high)))
        elif op == ca.OP_INV and self._positive(k) and self._positive(a):
            one = self._literal(1.0)
            self._narrow(a, (Op.DIV, (one, high), (one, low)))
        elif op in BACKWARD:
            self._back_by_rules(k)

    def _all_positive(self, op: int, k: int, a: int, b: int) -> bool:
        result = self._not_negative(k) if op == ca.OP_MUL else self._positive(k)
        return result and self._positive(a) and self._positive(b)

    def _back_of_two(self, op: int, k: int, a: int, b: int) -> None:
        """Put what a positive sum, difference, product or quotient of positive numbers says of them."""
        low, high, low_a, high_a, low_b, high_b = (self.low[x] + end for x in (k, a, b) for end in (0, 1))
        # Widened by what rounding may have cost where large terms cancel.
        less, more = self._literal(1 - CANCELLATION), self._literal(1 + CANCELLATION)
        first: Computed
        second: Computed
        if op == ca.OP_ADD:
            first = Op.MUL_SUB, (low, less, high_b), (high, more, low_b)
            second = Op.MUL_SUB, (low, less, high_a), (high, more, low_a)
        elif op == ca.OP_SUB:
            first = Op.ADD, (low, low_b), (high, high_b)
            second = Op.MUL_SUB, (low_a, less, high), (high_a, more, low)
        elif op == ca.OP_MUL:
            first = Op.DIV, (low, high_b), (high, low_b)
            second = Op.DIV, (low, high_a), (high, low_a)
        else:
            first = Op.MUL, (low, low_b), (high, high_b)
            second = Op.DIV, (low_a, high), (high_a, low)
        self._narrow_two(a, first, b, second)

    def _back_by_rules(self, k: int) -> None:
        """Put the rules of an operation, each by what was known of all arguments before."""
        op, args = self.program.nodes[k].op, self.program.nodes[k].args
        power = op in POWERS
        if power and self.kind[args[1]] != CONSTANT:
            return
        read, narrowed = [self.low[k], *(self.low[a] for a in args)], list[tuple[int, int]]()
        for i, a in enumerate(args):
            if self._moves(a) and BACKWARD[op][i] is not None:
                narrowed.append((a, self._new(2)))
                rule = "BACKWARD_POW_CONSTANT" if power else f"BACKWARD_{OP_NAMES[op]}_{i}"
                self._put(RULE_NUMBERS[rule], narrowed[-1][1], *read)
        for a, place in narrowed:
            self._meet(a, place)

    def _shave(self, k: int) -> None:
        """Cut halves off the arguments of a special function: it is monotone, so its value in the middle tells."""
        node = self.program.nodes[k]
        number = int(node.constant)
        if not all(self._not_negative(a) for a in node.args):
            return
        for i, a in enumerate(node.args):
            if self.kind[a] not in (INNER, VARIABLE):
                continue
            low, high = self.low[a], self._high(a)
            self._put(Op.MUL_SUM, self.m, self._literal(0.5), low, high)
            # Too much in the middle although all else is at its least: the half beyond is empty, and so on.
            masks = ((Op.GT_MUL, self._high(k), 1 + ROUNDING, self.p), (Op.LT_MUL, self.low[k], 1 - ROUNDING, self.q))
            for corner, (op, end, factor, mask) in zip(self._corners(k), masks, strict=True):
                corner[i] = self.m
                self._special(number, corner, self.s)
                self._put(op, mask, self.s, end, self._literal(factor))
            rising = self.program.specials[number].elasticity[i][0] >= 0
            beyond, before = (self.p, self.q) if rising else (self.q, self.p)
            self._put(Op.CHOOSE, high, beyond, self.m, high)
            self._put(Op.CHOOSE, low, before, self.m, low)


def formula_of(function: SpecialFunction) -> Program:
    """The formula of a special function, traced with symbols."""
    symbols = [ca.SX.sym(f"a{k}") for k in range(len(function.elasticity))]
    return Program(symbols, [function.formula(*symbols)])
