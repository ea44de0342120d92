"""The interior-point method as a kernel: one code for all row functions, whose formulas it carries out from a list."""

from __future__ import annotations

import ctypes
from dataclasses import astuple

import casadi as ca
import numpy as np

from synth.kernels.loading import kernel
from synth.nlp.interior_point import Ends, Problems, SparsityPattern
from synth.nlp.row_functions import RowFunctions
from synth.nlp.settings import InteriorPointSettings

# Sizes that the kernel has room for; what is larger is solved over arrays.
# Variables are goals as well: the last that settle ties.
MOST = {"N": 24, "ROWS": 96, "GOALS": 40, "NONZEROS": 1024, "CURVATURES": 300}
WIDTH = 5  # of an instruction: what is done, where the result goes, and up to three operands
DOUBLES = ctypes.POINTER(ctypes.c_double)
INTEGERS = ctypes.POINTER(ctypes.c_int)
LONGS = ctypes.POINTER(ctypes.c_longlong)
NUMBERS = (
    "n",
    "rows",
    "constraints",
    "goals",
    "nonzeros",
    "curvatures",
    "stored",
    "slots",
    "constants",
    "steps",
    "terms",
)
LISTS = ("equal", "guard", "row", "column", "curvature", "term", "code", "output")


class _Shape(ctypes.Structure):
    """The structure of the same name in the C source."""

    _fields_ = (
        *((name, ctypes.c_int) for name in NUMBERS),
        *((name, INTEGERS) for name in LISTS),
        ("constant", DOUBLES),
        ("method", DOUBLES),
    )


class _Problems(ctypes.Structure):
    """The structure of the same name in the C source."""

    _fields_ = (
        ("count", ctypes.c_longlong),
        ("stored", ctypes.POINTER(DOUBLES)),
        ("stored_steps", LONGS),
        *((name, DOUBLES) for name in ("start", "low", "high", "slopes", "rights", "weights", "t_weight")),
        ("counts", ctypes.POINTER(ctypes.c_ubyte)),
        *((name, DOUBLES) for name in ("y", "t", "rows", "multipliers")),
        ("status", LONGS),
        ("evaluations", LONGS),
    )


class KernelSolver:
    """The solver of one set of row functions, as the kernel has it.

    Parameters
    ----------
    functions : RowFunctions
        Not too large: :func:`fits`.
    method : InteriorPointSettings
    code : CDLL
    """

    def __init__(self, functions: RowFunctions, method: InteriorPointSettings, code: ctypes.CDLL) -> None:
        self.functions = functions
        self._solve = code.solve
        self._solve.restype = None
        layout = SparsityPattern(functions)
        constants, steps, outputs, slots = _listed(functions)
        numbers = {
            "n": layout.n,
            "rows": layout.rows,
            "constraints": layout.constraints,
            "goals": layout.goals,
            "nonzeros": len(layout.row),
            "curvatures": len(layout.hessian),
            "stored": len(functions.stored),
            "slots": slots,
            "constants": len(constants),
            "steps": len(steps),
        }
        terms = [(a, b, *pair) for a, b, *places in layout.pairs for pair in np.column_stack(places).tolist()]
        lists = {
            "equal": layout.equal,
            "guard": layout.guard,
            "row": layout.row,
            "column": layout.column,
            "curvature": layout.hessian,
            "term": terms,
            "code": steps,
            "output": outputs,
        }
        # What the structure points to must live as long as it does.
        self._lists = {name: np.array(x, dtype=np.intc).ravel() for name, x in lists.items()}
        self._constants = np.array(constants, dtype=float)
        self._method = np.array(astuple(method), dtype=float)
        self._shape = _Shape(
            **numbers,
            terms=len(terms),
            constant=self._constants.ctypes.data_as(DOUBLES),
            method=self._method.ctypes.data_as(DOUBLES),
            **{name: x.ctypes.data_as(INTEGERS) for name, x in self._lists.items()},
        )

    def solve(self, problems: Problems) -> Ends:
        """Solve all problems, each from its start."""
        n, rows, count = self.functions.n, self.functions.n_rows, len(problems)
        ends = Ends.empty(n, rows, count)
        stored = [np.ascontiguousarray(x, dtype=float).reshape(-1) for x in problems.stored]
        steps = np.array([0 if len(x) == 1 else 1 for x in stored] or [0], dtype=np.int64)
        columns = np.array([x.ctypes.data for x in stored] or [0], dtype=np.uintp)
        # The arrays must outlive the call, so they are kept by name until it is over.
        inputs = {
            name: np.ascontiguousarray(getattr(problems, name), dtype=float)
            for name in ("start", "low", "high", "slopes", "rights", "weights", "t_weight")
        }
        counts = np.ascontiguousarray(problems.counts, dtype=np.uint8)
        problem_record = _Problems(
            count=count,
            stored=columns.ctypes.data_as(ctypes.POINTER(DOUBLES)),
            stored_steps=steps.ctypes.data_as(LONGS),
            counts=counts.ctypes.data_as(ctypes.POINTER(ctypes.c_ubyte)),
            status=ends.status.ctypes.data_as(LONGS),
            evaluations=ends.evaluations.ctypes.data_as(LONGS),
            **{name: array.ctypes.data_as(DOUBLES) for name, array in inputs.items()},
            **{name: getattr(ends, name).ctypes.data_as(DOUBLES) for name in ("y", "t", "rows", "multipliers")},
        )
        self._solve(ctypes.byref(problem_record), ctypes.byref(self._shape))
        return ends


def _listed(functions: RowFunctions) -> tuple[list[float], list[tuple[int, ...]], list[int], int]:
    """Constants, instructions, the slots of the outputs, and the number of slots."""
    nodes, order = functions.nodes, functions.point_order
    first = functions.input_number("weights", 0)
    read = {a for k in order for a in nodes[k].args} | set(functions.outputs)
    constants = sorted(k for k in read if nodes[k].op == ca.OP_CONST)
    slot = {k: number for number, k in enumerate([*constants, *functions.stored])}
    inputs = len(slot)
    slots = inputs + functions.n + functions.n_rows
    # A slot is handed on as soon as the last reader of what it holds is done: what is in use stays in the cache.
    last = {a: k for k in order for a in nodes[k].args} | dict.fromkeys(functions.outputs, len(nodes))
    free: list[int] = []
    steps: list[tuple[int, ...]] = []
    results = set[int]()
    for k in order:
        node = nodes[k]
        if node.op == ca.OP_INPUT:
            number = int(node.constant)
            slot[k] = inputs + (number if number < functions.n else functions.n + number - first)
            continue
        operands = [slot[a] for a in node.args]
        free += [slot[a] for a in dict.fromkeys(node.args) if a in results and last[a] == k]
        if not free:
            free.append(slots)
            slots += 1
        slot[k] = free.pop()
        results.add(k)
        steps.append((int(node.op), slot[k], *(operands + [operands[-1]] * 3)[:3]))
    return [nodes[k].constant for k in constants], steps, [slot[k] for k in functions.outputs], slots


def fits(functions: RowFunctions) -> bool:
    """True if the kernel has room for row functions."""
    sizes = {
        "N": functions.n,
        "ROWS": functions.n_rows,
        "GOALS": functions.n_goals,
        "NONZEROS": len(functions.row),
        "CURVATURES": len(functions.hessian),
    }
    return functions.n > 0 and all(size <= MOST[name] for name, size in sizes.items())


def kernel_solver(functions: RowFunctions, method: InteriorPointSettings) -> KernelSolver | None:
    """Solver of row functions by the kernel; None where they are too large, or no kernel is there."""
    code = kernel("solver") if fits(functions) else None
    return None if code is None else KernelSolver(functions, method, code)
