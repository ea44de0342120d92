"""Instructions on arrays, recorded once with constants folded, and run over thousands of boxes at a time.

The proof tree of ``verify`` records here what it does with a batch of boxes. Values that are the same in all boxes
are plain numbers and computed while recording; each distinct instruction is recorded once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np


class Ref:
    """A value that differs from box to box: where it is recorded, and its sign where that is known."""

    __slots__ = ("index", "sign")

    def __init__(self, index: int, sign: int = 0) -> None:
        self.index, self.sign = index, sign


Expr: TypeAlias = Any  # a Ref, or a float or bool that is the same in all boxes


def _erf(x: np.ndarray, out: np.ndarray | None = None) -> Any:
    from scipy.special import erf  # only formulas that name it need it

    return erf(x, out) if out is not None else erf(x)


def _minimum(a: np.ndarray, b: np.ndarray, out: np.ndarray | None = None) -> Any:
    return np.minimum(a, b, out=out)  # these two take no third argument by position


def _maximum(a: np.ndarray, b: np.ndarray, out: np.ndarray | None = None) -> Any:
    return np.maximum(a, b, out=out)


def _choose(mask: np.ndarray, yes: np.ndarray, no: np.ndarray, out: np.ndarray) -> None:
    np.copyto(out, no)
    np.copyto(out, yes, where=mask)


def _as_number(mask: np.ndarray, out: np.ndarray) -> None:
    np.copyto(out, mask)


FUNCTIONS: dict[str, Callable[..., Any]] = {
    name: getattr(np, name)
    for name in (
        "add subtract multiply divide fmin fmax power negative absolute exp log log1p expm1 sqrt sin "
        "cos arcsin arctan sinh cosh tanh arcsinh arccosh arctanh floor ceil sign less less_equal equal logical_not "
        "logical_and"
    ).split()
} | {"erf": _erf, "minimum": _minimum, "maximum": _maximum}
WRITERS: dict[str, Callable[..., Any]] = {"where": _choose, "number": _as_number}
MASKS = {"less", "less_equal", "equal", "logical_not", "logical_and"}
KEEPS_SIGN = {"log1p", "expm1", "arcsin", "arctan", "sinh", "tanh", "arcsinh", "arctanh", "sign", "erf"}


def sign_of(x: Expr) -> int:
    """Return +1 for surely positive or zero, -1 for negative or zero, 0 where that is not known."""
    if isinstance(x, Ref):
        return x.sign
    return 1 if x >= 0 else -1 if x < 0 else 0


class Tape:
    """Records instructions on arrays; what does not differ from box to box is computed at once."""

    def __init__(self) -> None:
        self.refs: list[Ref] = []
        self.instructions: dict[int, tuple[str, tuple[Expr, ...]]] = {}
        self.masks: set[int] = set()
        self._memo: dict[tuple[Any, ...], Ref] = {}
        self._formulas: dict[str, Callable[..., Any]] = {}

    def leaf(self, sign: int = 0) -> Ref:
        """Return a value that is handed over with the boxes."""
        self.refs.append(Ref(len(self.refs), sign))
        return self.refs[-1]

    def do(self, name: str, *args: Expr) -> Expr:
        """Record one instruction and return its result."""
        if not any(isinstance(a, Ref) for a in args):
            result = FUNCTIONS[name](*args)
            return bool(result) if name in MASKS else float(result)
        simple = self._simplified(name, args)
        return self._record(name, args) if simple is None else simple

    def call(self, name: str, formula: Callable[..., Any], args: Sequence[Expr]) -> Expr:
        """Record a call of a positive function."""
        if not any(isinstance(a, Ref) for a in args):
            return float(formula(*map(np.float64, args)))
        self._formulas[name] = formula
        return self._record(name, tuple(args), 1)

    def where(self, mask: Expr, yes: Expr, no: Expr) -> Expr:
        """Record a choice."""
        if not isinstance(mask, Ref):
            return yes if mask else no
        if yes is no or (not isinstance(yes, Ref) and not isinstance(no, Ref) and yes == no):
            return yes
        sign = sign_of(yes) if sign_of(yes) == sign_of(no) else 0
        return self._record("where", (mask, yes, no), sign)

    def number(self, mask: Expr) -> Expr:
        """Record a mask as 0 or 1."""
        return self._record("number", (mask,), 1) if isinstance(mask, Ref) else float(mask)

    def _record(self, name: str, args: tuple[Expr, ...], sign: int | None = None) -> Ref:
        key = (name, *args)
        if key not in self._memo:
            ref = self.leaf(self._sign(name, args) if sign is None else sign)
            self.instructions[ref.index] = (name, args)
            if name in MASKS:
                self.masks.add(ref.index)
            self._memo[key] = ref
        return self._memo[key]

    @staticmethod
    def _simplified(name: str, args: tuple[Expr, ...]) -> Expr | None:
        a = args[0]
        b = args[-1]
        plain_a, plain_b = not isinstance(a, Ref), not isinstance(b, Ref)
        if name == "add" and (plain_a and a == 0):
            return b
        if name in ("add", "subtract") and (plain_b and b == 0):
            return a
        if name in ("multiply", "divide") and plain_b and b == 1:
            return a
        if name == "multiply" and plain_a and a == 1:
            return b
        if name == "multiply" and ((plain_a and a == 0) or (plain_b and b == 0)):
            return 0.0
        if name in ("minimum", "maximum", "fmin", "fmax") and a is b:
            return a
        if name == "logical_and" and (plain_a or plain_b):
            return (b if a else False) if plain_a else (a if b else False)
        return None

    @staticmethod
    def _sign(name: str, args: tuple[Expr, ...]) -> int:
        signs = [sign_of(a) for a in args]
        first, last = signs[0], signs[-1]
        if name == "add" or (name in ("minimum", "maximum", "fmin", "fmax") and first == last):
            return first if first == last else 0
        if name == "subtract":
            return first if first == -last else 0
        if name in ("multiply", "divide"):
            return first * last
        if name in ("maximum", "fmax"):
            return 1 if 1 in signs else 0
        if name in ("minimum", "fmin"):
            return -1 if -1 in signs else 0
        if name in ("exp", "sqrt", "absolute", "cosh"):
            return 1
        if name in KEEPS_SIGN:
            return first
        if name == "negative":
            return -first
        return 1 if name == "power" and first > 0 else 0

    def kernel(self, inputs: Sequence[Ref], outputs: Sequence[Expr]) -> Kernel:
        """Function that computes some outputs from arrays of the inputs."""
        needed = {x.index for x in outputs if isinstance(x, Ref)}
        kept: list[int] = []
        for index in sorted(self.instructions, reverse=True):
            if index in needed:
                kept.append(index)
                needed.update(a.index for a in self.read(index))
        return Kernel(self, inputs, outputs, kept[::-1])

    def read(self, index: int) -> list[Ref]:
        """Operands of an instruction."""
        return [a for a in self.instructions[index][1] if isinstance(a, Ref)]

    def function(self, name: str) -> Callable[..., Any]:
        """Function that carries out an instruction; it takes the array of the result last."""
        if name in FUNCTIONS:
            return FUNCTIONS[name]
        if name in WRITERS:
            return WRITERS[name]
        formula = self._formulas[name]

        def call(*args: Any) -> None:
            np.copyto(args[-1], formula(*args[:-1]))

        return call


class Kernel:
    """Instructions with their registers; a register is handed on as soon as its last reader is done.

    The arrays that ``run`` returns are the registers themselves: they hold until the next run.

    Parameters
    ----------
    tape : Tape
    inputs : list of Ref
        In the order in which arrays are handed over.
    outputs : list
        What is wanted.
    order : list of int
        The instructions that are needed.
    """

    def __init__(self, tape: Tape, inputs: Sequence[Ref], outputs: Sequence[Expr], order: Sequence[int]) -> None:
        self._inputs = len(inputs)
        self._slots: list[Any] = [None] * len(inputs)  # inputs, constants and registers
        self._registers: list[tuple[int, bool]] = []  # where they are, and whether they hold masks
        self._constants: dict[Any, int] = {}
        self._free: dict[bool, list[int]] = {True: [], False: []}
        self._place = {ref.index: k for k, ref in enumerate(inputs)}
        last = {a.index: step for step, k in enumerate(order) for a in tape.read(k)}
        last.update({x.index: len(order) for x in outputs if isinstance(x, Ref)})
        # Function, number of slots (the result is the last), the slots, and the first three of them by themselves.
        self._plan: list[tuple[Callable[..., Any], int, list[int], int, int, int]] = []
        for step, k in enumerate(order):
            name, args = tape.instructions[k]
            slots = [self._place[a.index] if isinstance(a, Ref) else self._constant(a) for a in args]
            done = {a.index for a in tape.read(k) if last[a.index] == step and self._place[a.index] >= self._inputs}
            # An instruction of one step may write over what it reads; others write before they have read all.
            at_once = name in FUNCTIONS and k not in tape.masks
            if at_once:
                self._hand_on(tape, done)
            slots.append(self._register(k in tape.masks))
            self._place[k] = slots[-1]
            if not at_once:
                self._hand_on(tape, done)
            first = (slots + slots[-1:] * 2)[:3]
            self._plan.append((tape.function(name), len(slots), slots, first[0], first[1], first[2]))
        self._outputs = [(self._place[x.index], None) if isinstance(x, Ref) else (None, x) for x in outputs]
        self._store: dict[bool, np.ndarray] = {}

    def __len__(self) -> int:
        return len(self._plan)

    def _constant(self, value: float | bool) -> int:
        key = (type(value), value if value == value else "nan")
        if key not in self._constants:
            self._constants[key] = len(self._slots)
            self._slots.append(value)
        return self._constants[key]

    def _register(self, mask: bool) -> int:
        if self._free[mask]:
            return self._free[mask].pop()
        self._registers.append((len(self._slots), mask))
        self._slots.append(None)
        return len(self._slots) - 1

    def _hand_on(self, tape: Tape, done: set[int]) -> None:
        for k in done:
            self._free[k in tape.masks].append(self._place[k])

    def run(self, inputs: Sequence[np.ndarray]) -> list[Any]:
        """Return the outputs for arrays of the inputs, all of one length."""
        count = len(inputs[0])
        slots = self._slots
        slots[: self._inputs] = inputs
        if not self._store or self._store[False].shape[1] < count:
            masks = sum(mask for _, mask in self._registers)
            self._store = {
                False: np.empty((len(self._registers) - masks, count)),
                True: np.empty((masks, count), dtype=bool),
            }
        rows = {mask: iter(store[:, :count]) for mask, store in self._store.items()}
        for slot, mask in self._registers:
            slots[slot] = next(rows[mask])
        for function, size, where, a, b, c in self._plan:
            if size == 3:
                function(slots[a], slots[b], slots[c])
            elif size == 2:
                function(slots[a], slots[b])
            else:
                function(*[slots[k] for k in where])
        return [fixed if slot is None else slots[slot] for slot, fixed in self._outputs]
