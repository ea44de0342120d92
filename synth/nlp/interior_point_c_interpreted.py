"""The interior-point solver compiled once for all row functions there are.

Code of a question's own runs fastest, but takes seconds to compile. Here the method is compiled as well, while formulas
are carried out instruction by instruction, from a list: what was compiled for one question serves all others.
"""

from __future__ import annotations

import ctypes
import threading
from functools import cache

import casadi as ca
import numpy as np

from synth.compiled.c_text import EXPRESSIONS, bodies, filled, template
from synth.compiled.compilation import switched_on
from synth.compiled.compiler import QUICK, LibraryBeside, library
from synth.model.program import COMPARISONS, OP_SELECT
from synth.nlp.interior_point import Ends, Problems, SparsityPattern
from synth.nlp.interior_point_c import Solver
from synth.nlp.interior_point_c_source import settings, translation_unit
from synth.nlp.row_functions import RowFunctions
from synth.tuning import InteriorPointSettings, NlpSettings

# Sizes that the code has room for; what is larger is solved without it.
# Variables are goals as well: the last that settle ties.
MOST = {"N": 24, "ROWS": 96, "GOALS": 40, "NONZEROS": 1024, "CURVATURES": 300}
WIDTH = 5  # of an instruction: what is done, where the result goes, and up to three operands
INTEGERS = ctypes.POINTER(ctypes.c_int)
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
        ("constant", ctypes.POINTER(ctypes.c_double)),
    )


def source(method: InteriorPointSettings) -> str:
    """Return the translation unit."""
    sizes = [f"#define MOST_{name} {most}" for name, most in MOST.items()]
    formulas, parts = bodies(template("nlp", "interpreter"))
    parts |= {
        "SIZES": "\n".join([*settings(method), *sizes, f"#define WIDTH {WIDTH}"]),
        "STORED_IN_STATE": "vd *stored;",
        "FORMULAS": formulas,
        "POINT": filled(parts["POINT"], {"CASES": "\n".join(_cases())}),
        "MORE_ARGUMENTS": ", const Shape *given",
    }
    return translation_unit(parts)


def _cases() -> list[str]:
    """Return what is done for each operation."""
    code = {op: text.format("a", "b") for op, text in EXPRESSIONS.items()}
    code |= {op: f"keep({code[op]}, all(1.0))" for op in COMPARISONS if op in code}
    code |= {
        ca.OP_NOT: "keep(a == 0.0, all(1.0))",
        ca.OP_AND: "keep((a != 0.0) & (b != 0.0), all(1.0))",
        ca.OP_OR: "keep((a != 0.0) | (b != 0.0), all(1.0))",
        ca.OP_IF_ELSE_ZERO: "keep(a != 0.0, b)",
        OP_SELECT: "choose(a != 0.0, b, r[code[4]])",
    }
    return [f"        case {op}: result = {text}; break;" for op, text in code.items()]


class General(Solver):
    """The solver for one set of row functions, whose formulas are carried out from a list.

    Parameters
    ----------
    functions : RowFunctions
        Not too large, as :func:`fits` tells.
    code : CDLL

    Attributes
    ----------
    evaluations : int
        How often the formulas of one problem were carried out: what the solver has cost.
    """

    def __init__(self, functions: RowFunctions, code: ctypes.CDLL) -> None:
        super().__init__(functions, code)
        self.evaluations = 0
        self._counting = threading.Lock()  # several threads may solve at a time
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
        terms = [
            (a, b, i, j)
            for a, b, first, second in layout.pairs
            for i, j in zip(first.tolist(), second.tolist(), strict=True)
        ]
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
        self._shape = _Shape(
            **numbers,
            terms=len(terms),
            constant=self._constants.ctypes.data_as(ctypes.POINTER(ctypes.c_double)),
            **{name: x.ctypes.data_as(INTEGERS) for name, x in self._lists.items()},
        )
        self._more = [ctypes.byref(self._shape)]

    def solve(self, problems: Problems) -> Ends:
        """Solve all problems, each from its start."""
        ends = super().solve(problems)
        with self._counting:
            self.evaluations += int(ends.evaluations.sum())
        return ends


def _listed(functions: RowFunctions) -> tuple[list[float], list[tuple[int, ...]], list[int], int]:
    """Return constants, instructions, the slots of the outputs, and the number of slots."""
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
    """Tell whether the code has room for row functions."""
    sizes = {
        "N": functions.n,
        "ROWS": functions.n_rows,
        "GOALS": functions.n_goals,
        "NONZEROS": len(functions.row),
        "CURVATURES": len(functions.hessian),
    }
    return functions.n > 0 and all(size <= MOST[name] for name, size in sizes.items())


def general(functions: RowFunctions, settings: NlpSettings) -> General | None:
    """Return the solver; None where row functions are too large, or code cannot be compiled, kept or loaded."""
    if not switched_on() or not fits(functions):
        return None
    loaded = library("nlp_general", _text(settings.method), settings.effort, QUICK)
    return None if loaded is None else General(functions, loaded)


def begin(settings: NlpSettings) -> None:
    """Let the code be compiled beside other work, where it is not there yet."""
    LibraryBeside("nlp_general", _text(settings.method), settings.effort, QUICK).loaded()


@cache
def _text(method: InteriorPointSettings) -> str:
    return source(method)
