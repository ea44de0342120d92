"""Which limits exclude each other: an irreducible infeasible subset of them."""

from __future__ import annotations

import math

from synth.order.feasibility import most_used
from synth.results import Design
from synth.studies.infeasibility.least_amount import Giving, RelaxedSearch
from synth.studies.infeasibility.patches import Patches


def irreducible_subset(search: RelaxedSearch, patches: Patches, nearest: Design | None) -> tuple[tuple[str, ...], bool]:
    """Return a minimal set of limits that cannot hold together, and whether it is proven to be minimal.

    Limits are added until no design keeps them, those first that the nearest design is stopped by; then each is
    left out in turn, and stays out where the others still exclude each other (deletion filter).

    Parameters
    ----------
    search : RelaxedSearch
    patches : Patches
    nearest : Design, optional
        That keeps all limits if they are widened by least.
    """
    limits, first = search.question.limits, search.ways.first
    near = [] if nearest is None else most_used(patches.original(nearest).utilisation)
    kept = [x for x in near if x in limits][:first]
    while True:
        least = search.least(Giving(give={}, kept=kept))
        if least.design is None:
            break
        broken = [x for x in _broken(patches.original(least.design))[:first] if x not in kept]
        if not broken:
            return tuple(kept), False
        kept += broken
    proven = least.closed
    for k, name in enumerate(list(kept)):
        search.say("conflict", 0.1 + 0.1 * k / len(kept), f"without {name}")
        least = search.least(Giving(give={}, kept=[x for x in kept if x != name]))
        if least.design is None and least.closed:
            kept.remove(name)
        proven &= least.design is not None or least.closed
    return tuple(x for x in limits if x in kept), proven


def _broken(design: Design) -> list[str]:
    """Return the limits that a design breaks, the worst first."""
    used = {name: design.utilisation[name] for name in design.violated}
    return most_used({name: math.inf if x is None else x for name, x in used.items()})
