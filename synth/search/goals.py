"""Objectives that a search compares designs by: those chosen, then those that settle ties."""

from __future__ import annotations

from collections.abc import Mapping

from synth.bounds.existence import surely_exist
from synth.question.objectives import with_ties
from synth.question.search_space import SearchSpace


def goals_of(space: SearchSpace, chosen: Mapping[str, str]) -> dict[str, str]:
    """Chosen objectives, then those that settle ties, with their senses.

    An objective that was not chosen settles ties only where every design has a value of it: what a row or a formula
    leaves without one is a design all the same. Where a family names guards, they keep designs where it exists.

    Parameters
    ----------
    space : SearchSpace
    chosen : mapping
        Objectives that are traded off, with their sense.
    """
    model, every = space.model, with_ties(space.model, chosen)
    doubtful = [name for name in every if name not in chosen and not model.guards_of(name)]
    there = surely_exist(space, [model.quantity_node[name] for name in doubtful])
    missing = {name for name, exists in zip(doubtful, there, strict=True) if not exists}
    return {name: sense for name, sense in every.items() if name not in missing}
