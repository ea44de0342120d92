"""Which questions can be answered together: those that are alike but for the numbers of some requirements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from synth.search.question import Question


def joint_key(question: Question) -> tuple[Any, ...]:
    """Key that questions must share to be answered together."""
    instance, settings = question.instance, question.settings
    ranges, selection = instance.ranges, instance.selection
    return (
        instance.model,
        ranges.grid,
        ranges.lower.tobytes(),
        ranges.upper.tobytes(),
        ranges.pinned.tobytes(),
        tuple(instance.limits.judging),
        tuple((s.slot, tuple(s.table.hashes[int(r)] for r in s.rows)) for s in selection.slots),
        tuple((n, v.tobytes()) for n, v in (*selection.counts.items(), *selection.choices.items())),
        tuple(question.chosen.items()),
        settings.gap,
        settings.seed,
        question.tuning,
    )


def groups_of(questions: Sequence[Question], least: int = 2, objectives: int = 1) -> list[list[int]]:
    """Return the positions of questions that can be answered together: so many or more, alike.

    ``objectives``: how many each must have.
    """
    groups: dict[Any, list[int]] = {}
    for k, question in enumerate(questions):
        if len(question.chosen) == objectives:
            groups.setdefault(joint_key(question), []).append(k)
    return [g for g in groups.values() if least <= len(g) <= _most(questions[g[0]])]


def _most(question: Question) -> int:
    """Number of questions such as this for which the numbers of combinations suffice."""
    return question.tuning.joint.numbers // question.instance.combinations.count
