"""The contraction of boxes compiled once for all formulas there are.

Code of a question's own runs fastest, but takes seconds to compile. Here tightening goes instruction by instruction
through a list, and the rest is the same code: the bits of what comes out are those of a question's own code, so that
either may take the other's place at any time.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from synth.bounds import box_instructions as lists
from synth.bounds import compiled_rules as rules
from synth.bounds.box_batches import structure_source
from synth.bounds.contractor import Code
from synth.compiled.c_text import filled, template

# Sizes that the code has room for; a larger question needs code of its own.
# Variables are goals as well: the last that settle ties.
MOST = {"N": 24, "LIMITS": 256, "GOALS": 40, "TABLES": 256, "NODES": 1024}
MOST_REGISTERS = 4096


@cache
def source() -> str:
    """Return the translation unit."""
    parts = {
        "SIZES": "\n".join([*lists.sizes(), *(f"#define MOST_{name} {most}" for name, most in MOST.items())]),
        "REGISTERS_OF_BOXES": template("bounds", "registers"),
        "RULES": lists.definitions(),
        "CASES": lists.cases(),
    }
    return "\n".join(
        [
            template("compiled", "vectors"),
            template("bounds", "margins"),
            rules.common(),
            structure_source(),
            filled(template("bounds", "box_interpreter"), parts),
            template("bounds", "boxes"),
            template("bounds", "subtrees"),
        ]
    )


class ListedCode:
    """Generated code as the compiled interpreter reads it.

    Parameters
    ----------
    code : Code
    listed : Instructions

    Attributes
    ----------
    record : array
        The structure ``Shape`` of the C source: numbers and addresses of eight bytes each.
    """

    def __init__(self, code: Code, listed: lists.Instructions) -> None:
        nodes, sweeps, at = code.nodes, code.sweeps, listed.places
        own = [nodes.factor[k] for k in nodes.tables]
        sizes = sizes_of(code)
        numbers = [
            *(sizes[name] for name in ("N", "LIMITS", "GOALS", "TABLES", "NODES")),
            len(sweeps.variables),
            at["registers"],
            len(listed.literals),
            len(sweeps.constants),
            *(at[name] for name in ("literals", "constants", "right_sides", "cutoffs", "floors")),
            *(at[name] for name in ("tables", "variables", "open", "goals")),
        ]
        self._kept = [
            listed.literals,
            np.array([i for _, i in sweeps.variables], dtype=np.intc),
            np.array(own, dtype=np.intc),
            np.array([2 * own.count(f) for f in own], dtype=np.intc),
            np.array([2 * own[:i].count(f) for i, f in enumerate(own)], dtype=np.intc),
            *(np.ascontiguousarray(x, dtype=np.intc) for x in (listed.first, listed.later, listed.last)),
        ]
        self.record = np.array([*numbers, *(x.ctypes.data for x in self._kept)], dtype=np.int64)


def sizes_of(code: Code) -> dict[str, int]:
    """Return how large the arrays are that tightening works in."""
    nodes = code.nodes
    return {
        "N": nodes.layout.n_variables + len(nodes.auxiliary),
        "LIMITS": len(nodes.constraints),
        "GOALS": len(nodes.goals),
        "TABLES": len(nodes.tables),
        "NODES": len(nodes.program.nodes),
    }


def listed_code(code: Code) -> ListedCode | None:
    """Return generated code as a list; None where there is no room for it, or something has no form there."""
    if any(size > MOST[name] for name, size in sizes_of(code).items()):
        return None
    listed = lists.instructions(code)
    return None if listed is None or listed.places["registers"] > MOST_REGISTERS else ListedCode(code, listed)
