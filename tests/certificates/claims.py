"""What a front may claim, checked against the independent reference; a list of sentences tells what is wrong."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

import synth
from synth.search.settings import TUNING, Tuning
from tests.certificates.reference import TOLERANCE, Points, Reference
from tests.certificates.structures import Case, RandomProblem, make
from tests.tuned import synthesize

ROUNDING = 2e-6  # twice the tolerance of a limit: a design may gain from it what the limit is worth
SAME = 1e-9
PATIENT = 120  # seconds; a question that is stopped by its own limit may get another answer each time
ATTACKED = 12  # so many designs of a front are tried to be improved, those of the first ranks


@dataclass(frozen=True)
class Answer:
    """A front beside the reference for the same case."""

    case: Case
    front: synth.ParetoFront
    reference: Reference

    @property
    def proven(self) -> bool:
        return self.front.certificate.kind == "global"


def run(case: Case, tuning: Tuning = TUNING, **more) -> synth.ParetoFront:
    problem = RandomProblem(structure=case.structure, seed=str(case.seed))
    return synthesize(tuning, problem, case.requirements, **case.question() | more)


@cache
def answer(structure: str, seed: int) -> Answer:
    case = make(structure, seed)
    return Answer(case, run(case, time_limit=PATIENT), Reference(case))


# -- what a front may claim ------------------------------------------------------------------------


def signed(a: Answer) -> np.ndarray:
    """Return the objectives of the listed designs, as reported; those to be made large with a minus sign."""
    rows = [[d.objectives[n] for n in a.case.objectives] for d in a.front.designs]
    return a.reference.signs * np.array(rows, dtype=float).reshape(len(rows), len(a.case.objectives))


def slack(a: Answer, gap: float, listed: np.ndarray) -> np.ndarray:
    """Return, per listed design and objective, what a claim forgives: what the certificate says, and nothing else."""
    told = a.front.certificate.resolution
    amounts = np.array([told.get(n, np.nan) for n in a.case.objectives])
    return np.where(np.isnan(amounts), gap * np.abs(listed), amounts)


def wrong_resolution(a: Answer) -> list[str]:
    """Tell where the certificate forgives what no gap stands for, or does not say what it forgives."""
    front, found = a.front, list[str]()
    if not front.designs or front.certificate.gap is None:
        return []
    listed, known = signed(a), a.reference.feasible().objectives
    for j, (name, sense) in enumerate(a.case.objectives.items()):
        told = front.certificate.resolution.get(name)
        if told is None:
            if sense != "min" or not np.all(np.concatenate([listed, known])[:, j] > 0):
                found.append(f"{name} need not be positive, yet its gap is told as a share of its value")
            continue
        size = np.ptp(known[:, j]) + np.abs(listed[:, j]).max()
        gap = front.certificate.gap
        if not 0 <= told <= 1.02 * gap * size:
            found.append(f"{name}: a resolution of {told} where the gap is a share of {size}")
    return found


def rounding(listed: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return what the tolerance of the limits may be worth, per objective."""
    seen = np.concatenate([listed, known])
    return ROUNDING * np.maximum(np.abs(listed), np.subtract(*np.percentile(seen, [75, 25], axis=0))) + 1e-12


def wrong_designs(a: Answer) -> list[str]:
    """Tell what is wrong with the listed designs themselves, whatever the certificate says."""
    case, reference, found = a.case, a.reference, list[str]()
    for d in a.front.designs:
        name = f"design {d.rank}"
        u, _ = reference.point_of(d)
        if reference.tuple_of(d) is None:
            found.append(f"{name} is made of what was not offered")
        for n, (low, high) in reference.bounds.items():
            if not low - SAME * abs(low) <= d.values[n] <= high + SAME * abs(high):
                found.append(f"{name}: {n} = {d.values[n]} outside {low} .. {high}")
        with np.errstate(all="ignore"):
            worst = float(np.max(reference.worst(u)))
            own = reference.objectives(u, 1)[0]
        if not worst <= TOLERANCE:
            found.append(f"{name} misses a limit by {worst:.3g}: {reference.residuals(u)}")
        told = reference.signs * [d.objectives[n] for n in case.objectives]
        if not np.allclose(own, told, rtol=1e-9, atol=1e-12):
            found.append(f"{name} tells objectives {told}, the formulas give {own}")
    phi = signed(a)
    for i, j in product(range(len(phi)), repeat=2):
        if i != j and np.all(phi[i] <= phi[j] + SAME * np.abs(phi[j])):
            found.append(f"listed {phi[i]} dominates or equals listed {phi[j]}")
    return found


def wrong_form(a: Answer) -> list[str]:
    """Tell where certificate, status and designs contradict each other."""
    front, certificate, found = a.front, a.front.certificate, list[str]()
    designs = front.designs

    def expect(holds: bool, words: str) -> None:
        if not holds:
            found.append(words)

    expect(certificate.kind in ("global", "exhaustive", "heuristic"), f"kind {certificate.kind}")
    expect(certificate.combinations == a.reference.combinations, f"{certificate.combinations} combinations")
    expect(len(designs) <= a.case.points, "more designs than points")
    expect(not (front.interrupted and certificate.kind != "heuristic"), "interrupted, yet not heuristic")
    if a.proven:
        expect(certificate.gap == (a.case.gap if designs else None), f"front gap {certificate.gap}")
    else:  # what bounds prove of a front that is not proven as asked
        expect(certificate.gap is None or certificate.gap >= a.case.gap * (1 - 1e-9), f"front gap {certificate.gap}")
    expect(all(d.gap == (a.case.gap if a.proven else None) for d in designs), "gap of a design")
    expect(all((d.status == "optimal") == a.proven for d in designs), "status of a design")
    if designs:
        expect(front.status == ("optimal" if a.proven else "feasible"), f"status {front.status}")
    elif a.proven:
        expect(front.status == "infeasible", f"status {front.status}")
    else:
        expect(front.status == ("not_solved" if front.interrupted else "not_found"), f"status {front.status}")
    expect(a.proven or not front.complete, "complete, yet not proven")
    if a.proven and designs:
        expect(front.complete or len(designs) == a.case.points, "not complete, yet fewer designs than points")
    return found


def refuted(a: Answer) -> list[str]:
    """Tell which points of the reference refute what the front claims."""
    front, reference = a.front, a.reference
    known = reference.feasible()
    if not front.designs:
        if len(known) and not front.interrupted:
            k = int(np.argmin(known.worst))
            return [f"{front.status}, {front.certificate.kind}, yet {_words(reference, known, k)} is feasible"]
        return []
    gap = front.certificate.gap
    if gap is None:
        return []
    listed, found = signed(a), list[str]()
    room, fuzz = slack(a, gap, listed), rounding(listed, known.objectives)
    tried = reference.attack(_points(a, listed).take(np.arange(min(len(listed), ATTACKED))), room[:ATTACKED])
    known = Points.joined([known, tried.take(np.flatnonzero(tried.worst <= TOLERANCE))])
    for d, own, more, small in zip(front.designs, listed, room, fuzz, strict=True):
        better = np.min(own - more - small - known.objectives, axis=1)
        if np.any(better > 0):
            k = int(np.argmax(better))
            found.append(f"design {d.rank} {own} is beaten by more than {gap}: {_words(reference, known, k)}")
    return found + (_left_out(a, listed, known, room, fuzz) if a.proven else [])


def faults(a: Answer) -> list[str]:
    """Tell all that is wrong with a front, its designs and its claim."""
    return wrong_designs(a) + wrong_form(a) + wrong_resolution(a) + refuted(a)


def _points(a: Answer, listed: np.ndarray) -> Points:
    """Return the listed designs as points of the reference."""
    which = [a.reference.tuple_of(d) or 0 for d in a.front.designs]
    x = np.array([a.reference.point_of(d)[1] for d in a.front.designs]).reshape(len(listed), len(a.reference.free))
    return Points(np.array(which), x, listed, np.zeros(len(listed)))


def _left_out(a: Answer, listed: np.ndarray, known: Points, room: np.ndarray, fuzz: np.ndarray) -> list[str]:
    """Tell which points a proven front should have listed: the best per objective, and all if it is complete."""
    case, reference, found = a.case, a.reference, list[str]()
    for j, name in enumerate(list(case.objectives)[: case.points]):
        k, best = int(np.argmin(known.objectives[:, j])), int(np.argmin(listed[:, j]))
        forgiven = room[best, j] + fuzz[best, j]
        if known.objectives[k, j] < listed[best, j] - forgiven:
            found.append(f"best {name} {listed[best, j]} is not the best: {_words(reference, known, k)}")
    if not reference.free:
        # Among makeable designs ties are common: one that is no worse in anything and better in something replaces it.
        for d, own, more in zip(a.front.designs, listed, room, strict=True):
            no_worse = np.all(known.objectives <= own + SAME * np.abs(own), axis=1)
            dominating = np.flatnonzero(no_worse & np.any(known.objectives < own - more, axis=1))
            if len(dominating):
                found.append(f"design {d.rank} {own} is dominated: {_words(reference, known, int(dominating[0]))}")
    if a.front.complete:
        covered = np.zeros(len(known), dtype=bool)
        for own, more, small in zip(listed, room, fuzz, strict=True):
            covered |= np.all(own - more - small <= known.objectives, axis=1)
        if not covered.all():
            k = int(np.flatnonzero(~covered)[0])
            found.append(f"complete, yet no listed design is near {_words(reference, known, k)}")
    return found


def _words(reference: Reference, points: Points, k: int) -> str:
    u = {n: v[points.which[k]] for n, v in reference.discrete.items()}
    u |= dict(zip(reference.free, points.x[k], strict=True))
    shown = ", ".join(f"{n} {float(v)!r}" for n, v in u.items())
    return f"{points.objectives[k]} at {shown} (worst residual {points.worst[k]:.2g})"


def weak_reference(a: Answer) -> list[str]:
    """Tell where the front is better than all that the reference found: it could not have refuted it."""
    if not a.front.designs:
        return []
    known, listed = a.reference.extremes, signed(a)
    known = known.take(np.flatnonzero(known.worst <= TOLERANCE))
    if not len(known):
        return ["the reference finds no feasible point, the front lists some"]
    room = np.maximum(slack(a, a.case.gap, listed), a.case.gap * np.abs(listed)) + rounding(listed, known.objectives)
    found = []
    for j, name in enumerate(a.case.objectives):
        best = int(np.argmin(listed[:, j]))
        if known.objectives[:, j].min() > listed[best, j] + room[best, j]:
            found.append(f"{name}: the reference reaches {known.objectives[:, j].min()}, the front {listed[best, j]}")
    return found
