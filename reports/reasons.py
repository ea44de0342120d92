"""Why a design is on its front, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence

from synth.results import Design, ParetoFront
from synth.results.design import lines_of, reached_limits
from synth.text.numbers import percent
from synth.text.plain_text import words

SIGN_OF = {"at_most": "≤", "at_least": "≥", "equal": "="}  # of a limit, by its sense
EQUAL = 1e-9  # relative; objectives closer than this are the same


def why(front: ParetoFront, design: Design, limits: bool = True) -> str:
    """Return in one sentence why a design is on the front: what it is best in, what it trades, which limits it meets.

    Parameters
    ----------
    front : ParetoFront
        The front it belongs to.
    design : Design
        One of its designs.
    limits : bool
        Name also the limits that it meets.
    """
    objectives = front.frame.objectives
    clauses = [
        f"{'smallest' if sense == 'min' else 'largest'} {words(name)}{dear(design, name)}"
        for name, sense in objectives.items()
        if _is_best(front, design, name, sense)
    ]
    if design.rank == 1 and len(front.designs) > 2 and len(objectives) > 1:
        clauses.insert(0, "nearest to the best, the knee too" if "knee" in design.note else "nearest to the best")
    elif "knee" in design.note:
        those = "both" if len(objectives) == 2 else "all"
        clauses.insert(0, f"knee of the front (least sum of {those}; #1: least distance)")
    others = [d for d in lines_of(front.designs) if d is not design]
    if len(objectives) == 2 and others:
        clauses.append(_between(front, design, others))
    elif len(objectives) > 2 and others:
        nearest = min(others, key=lambda d: _distance(front, design, d))
        clauses.append(f"against #{nearest.rank} next to it {_comparison(design, nearest, list(objectives))}")
    if limits:
        met = reached_limits(design)
        clauses.append(f"at the limit of {', '.join(map(words, met))}" if met else "no limit is reached")
    if design.alternatives:
        others_like_it = "1 other" if len(design.alternatives) == 1 else f"{len(design.alternatives)} others"
        clauses.append(f"{others_like_it} with the same objectives")
    return "; ".join(clause for clause in clauses if clause)


def dear(design: Design, name: str) -> str:
    """Remark that being best in an objective costs a design much for little, where its note says so."""
    _, separator, more = next((n for n in design.note.split("; ") if f" {name}," in n), "").partition(f" {name}")
    return more if separator else ""


def _is_best(front: ParetoFront, design: Design, name: str, sense: str) -> bool:
    values = [d.objectives[name] for d in front.designs]
    best = min(values) if sense == "min" else max(values)
    return abs(design.objectives[name] - best) <= EQUAL * max(abs(best), 1e-300)


def _between(front: ParetoFront, design: Design, others: Sequence[Design]) -> str:
    """Gain of a design of a front of two objectives over each of its two neighbours among others."""
    first, second = front.frame.objectives
    line = sorted([design, *others], key=lambda d: d.objectives[first])
    place = next(k for k, d in enumerate(line) if d is design)
    sides = [line[k] for k in (place - 1, place + 1) if 0 <= k < len(line)]
    if len(sides) == 2:
        # The neighbour that is better in the first objective is worse in the second: name what is gained.
        lower, upper = sides
        toward = (second, first) if front.frame.objectives[first] == "min" else (first, second)
        gains = [_comparison(design, other, [name]) for other, name in zip((lower, upper), toward, strict=True)]
        return f"between #{lower.rank} and #{upper.rank}: {gains[0]} than #{lower.rank}, {gains[1]} than #{upper.rank}"
    return f"{_comparison(design, sides[0], [first, second])} than #{sides[0].rank} next to it"


def _comparison(design: Design, other: Design, names: Sequence[str]) -> str:
    parts = []
    for name in names:
        mine, theirs = design.objectives[name], other.objectives[name]
        difference = mine - theirs
        if abs(difference) <= EQUAL * max(abs(mine), abs(theirs)):
            parts.append(f"the same {words(name)}")
            continue
        size = f"{percent(abs(difference / theirs), 2)} " if theirs else ""
        parts.append(f"{size}{'more' if difference > 0 else 'less'} {words(name)}")
    return " and ".join(parts) if len(parts) < 3 else ", ".join(parts)


def _distance(front: ParetoFront, design: Design, other: Design) -> float:
    """Return the distance of two designs, every objective measured by its range on the front."""
    total = 0.0
    for name in front.frame.objectives:
        values = [d.objectives[name] for d in front.designs]
        span = max(values) - min(values)
        if span > 0:
            total += ((design.objectives[name] - other.objectives[name]) / span) ** 2
    return total
