"""Several families asked the same: each is searched by itself, and all designs together make one ranked front.

Of the designs of all families those stay that no other one beats. What a family's own proof says of its designs says
nothing of those of the others; so each is asked again, by its own tree, whether it can beat them. Better designs that
it finds take their places, until nothing changes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.deadline import Stopped, until
from synth.errors import InputError
from synth.feasibility import Status
from synth.margins import MARGINS
from synth.pareto import spread_subset
from synth.question.instance import Instance
from synth.question.settings import LEAST_SECONDS, Progress, SearchSettings, check_progress
from synth.question.uncertainty import RATE, Uncertainty
from synth.results import Certificate, Design, ParetoFront
from synth.results.assembly import ranked
from synth.robust.rating import Rater
from synth.robust.robust_front import NOTHING_STANDS, robust_front
from synth.search.front_report import further_designs
from synth.search.front_state import FrontState
from synth.search.question import Question, pose
from synth.search.resolution import rounded_up
from synth.search.stages.challenge import challenge
from synth.search.warm_start import WarmStart
from synth.studies.families.comparison import Comparison, FamilyOutcome
from synth.studies.families.requirement_sheet import (
    Applicant,
    Sheet,
    applicants,
    common_objectives,
    refuse_all,
    sheet_of,
)
from synth.study_limits import COMPARING
from synth.tables.catalogs import Catalogs
from synth.tuning import TUNING, Tuning
from synth.units import format_quantity

KINDS = ("heuristic", "exhaustive", "global")


def compare(
    families: Any,
    requirements: Mapping[str, Any],
    objectives: Any = None,
    points: int = 30,
    catalogs: Any = None,
    parts: Mapping[str, Any] | None = None,
    limits: Mapping[str, Any] | None = None,
    fix: Mapping[str, Any] | None = None,
    weights: Mapping[str, float] | None = None,
    gap: float = 1e-3,
    grid: bool = True,
    workers: int = 1,
    seed: int = 0,
    progress: Callable[[Mapping[str, Any]], None] | None = None,
    time_limit: float | None = None,
    options: Mapping[str, str] | None = None,
    finished: Callable[[str, ParetoFront], object] | None = None,
    robust: Mapping[str, Any] | None = None,
) -> Comparison:
    """Search all families that can serve one requirement sheet, and rank their designs on one front.

    Parameters
    ----------
    families : "any" or list
        Every registered family, or some: names, DesignProblem subclasses or instances, or mappings with ``family`` and
        what concerns that family alone (``options``, ``requirements``, ``limits``, ``fix``, ``parts``, ``robust``).
    requirements : mapping
        What all are asked: names that several families understand.
    objectives : names, or mapping name -> "min"/"max", optional
        Quantities that all have. By default what all families that can serve offer, their defaults first.
    points : int
        At most this many designs on the common front.
    catalogs, parts, limits, fix, weights, gap, grid, workers, seed, progress : optional
        As for ``synthesize``; a family that does not know a name of ``parts``, ``limits`` or ``fix`` is left out.
    time_limit : float, optional
        Seconds for all families together.
    options : mapping, optional
        Options of every family.
    finished : callable, optional
        Called with the label and the front of each family as soon as it is searched.
    robust : mapping, optional
        What scatters, as for ``synthesize``: designs of all families stand it, or are rated. Under a family "none" in
        place of a range tells that it does not scatter there.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        When something is wrong for every family: a name that none knows, a sheet that none can serve.
    """
    settings = SearchSettings(points=points, gap=gap, workers=workers, seed=seed, time_limit=time_limit)
    check_progress(progress)
    sheet = sheet_of(options=options, requirements=requirements, limits=limits, fix=fix, parts=parts, robust=robust)
    tables = catalogs if isinstance(catalogs, Catalogs) else Catalogs(catalogs)
    found = applicants(families, sheet, tables)
    refuse_all(found, sheet)
    chosen = common_objectives(found, objectives)
    refuse_all(found, sheet)
    ranked = {"objectives": chosen, "weights": weights, "grid": grid}
    return _Comparing(found, sheet, ranked, tables, settings, progress).run(finished)


@dataclass
class _Member:
    """A family that is searched, and its designs on the way to the common front.

    Parameters
    ----------
    one : Applicant
    state : FrontState
        What its own search knows, of which more is asked.
    front : ParetoFront
        Of its own search.
    designs : list of Design
        Those of its front, and more that were found against the others.
    beaten_by : array (objectives,)
        In SI: by how much designs of others had to be beaten to count.
    rater : Rater, optional
        Rates its designs where something scatters.
    """

    one: Applicant
    state: FrontState
    front: ParetoFront
    designs: list[Design]
    beaten_by: np.ndarray
    rater: Rater | None = None

    @property
    def incomplete(self) -> bool:
        """Tell whether designs are missing that did not stand the range: others may have been left out for them."""
        return bool(self.front.statistics.get("robust", {}).get("taken_off"))

    def standing(self, designs: Sequence[Design], deadline: float) -> list[Design]:
        """Return those of its designs that stand the range, if they must; rated, if anything scatters.

        Raises
        ------
        Stopped
            When there was no time to rate them.
        """
        if self.rater is None:
            return list(designs)
        ratings, stopped = self.rater.rate(designs, None, deadline)
        if stopped:
            raise Stopped(stopped)
        rated = [replace(d, frame=self.front.frame, robust=r) for d, r in zip(designs, ratings, strict=True)]
        return [d for d in rated if d.robust["holds"] or self.rater.asked.mode == RATE]


class _Kept:
    """A question that keeps the search by which it was answered, as more is asked of it."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self.state: FrontState | None = None

    @property
    def instance(self) -> Instance:
        """The model with its requirements and restrictions."""
        return self.question.instance

    @property
    def tuning(self) -> Tuning:
        """What its search goes by."""
        return self.question.tuning

    def within(self, seconds: float | None) -> _Kept:
        """Limit the time of what is asked next."""
        self.question = self.question.within(seconds)
        return self

    def answer(self, progress: Progress | None = None, known: Sequence[Design] = ()) -> ParetoFront:
        """Search the designs; the arguments are those of ``Question.answer``."""
        search = self.question.search(progress, WarmStart(designs=known))
        self.state = search.state
        return search.run(self.question.report())


class _Comparing:
    """One comparison in progress."""

    def __init__(
        self,
        found: Sequence[Applicant],
        sheet: Sheet,
        ranked: Mapping[str, Any],
        tables: Catalogs,
        settings: SearchSettings,
        progress: Progress | None,
        tuning: Tuning = TUNING,
    ) -> None:
        self.started, self.tuning = time.monotonic(), tuning
        self.found, self.sheet, self.ranked, self.tables = found, sheet, ranked, tables
        self.objectives: dict[str, str] = dict(ranked["objectives"])
        self.settings, self.progress = settings, progress
        limit = settings.time_limit
        self.deadline = math.inf if limit is None else self.started + limit
        self.senses = np.array([1.0 if sense == "min" else -1.0 for sense in self.objectives.values()])
        self.members: list[_Member] = []
        self.faults: dict[str, InputError] = {}
        self.interrupted = ""
        self.proven = True

    def run(self, finished: Callable[[str, ParetoFront], object] | None) -> Comparison:
        serving = [one for one in self.found if not one.misfits]
        self._search_all(serving, finished)
        if len(self.faults) == len(serving):
            raise next(iter(self.faults.values()))
        try:
            with until(self.deadline):
                self._challenge_all()
        except Stopped as stop:
            self._stop(stop.reason)
        except KeyboardInterrupt:
            self._stop("interrupted")
        return self._compared()

    def _stop(self, reason: str) -> None:
        self.interrupted, self.proven = self.interrupted or reason, False

    # -- every family by itself ----------------------------------------------------------------

    def _search_all(self, serving: Sequence[Applicant], finished: Callable[[str, ParetoFront], object] | None) -> None:
        for number, one in enumerate(serving):
            if self.interrupted == "interrupted" or (self.interrupted and time.monotonic() > self.deadline):
                break
            try:
                member = self._searched(one, number, len(serving))
            except InputError as error:
                self.faults[one.label] = error
                continue
            except KeyboardInterrupt:
                self._stop("interrupted")
                break
            self.members.append(member)
            if finished is not None:
                finished(one.label, member.front)
            if member.front.interrupted:
                self._stop(member.front.interrupted)

    def _searched(self, one: Applicant, number: int, count: int) -> _Member:
        """Search one family, in its share of the time that is left."""
        limit = None
        if math.isfinite(self.deadline):
            limit = max((self.deadline - time.monotonic()) / (count - number), LEAST_SECONDS)
        shown, kept = self._shown(one.label, number, count), list[_Kept]()

        request, rater = one.request(self.sheet, self.tables, **self.ranked), None

        def ask(block: Uncertainty | None) -> _Kept:
            kept.append(_Kept(pose(replace(request, robust=block), self.settings, tuning=self.tuning)))
            return kept[-1]

        if request.robust is None:
            front = ask(None).within(limit).answer(shown)
        else:
            rater = Rater(request, request.robust, self.tuning.robust)
            front = robust_front(ask, rater, shown, limit)
        state = next(k.state for k in reversed(kept) if k.state is not None)
        return _Member(one, state, front, list(front.designs), np.zeros(len(self.objectives)), rater)

    def _shown(self, label: str, number: int, count: int) -> Progress | None:
        progress = self.progress
        if progress is None:
            return None

        def show(state: Mapping[str, Any]) -> None:
            done = (number + float(state.get("done") or 0.0)) / count
            progress({**state, "stage": f"{label}: {state.get('stage', '')}", "done": done})

        return show

    # -- against each other --------------------------------------------------------------------

    def _signed(self, designs: Sequence[Design]) -> np.ndarray:
        rows = [[d.values[n] for n in self.objectives] for d in designs]
        signed: np.ndarray = np.array(rows, dtype=float).reshape(len(designs), len(self.objectives)) * self.senses
        return signed

    def _challenge_all(self) -> None:
        """Let every family look for designs that beat those of the others, until none finds any."""
        able = [m for m in self.members if m.designs or m.front.status is Status.FEASIBLE]
        if len(able) < 2 or len(self.objectives) < 2 or self.interrupted:
            return
        for _ in range(COMPARING.rounds):
            quiet = closed = True
            for member in able:
                listed, _ = self._listed()
                others = [d for m, d in listed if m is not member]
                if others:
                    asked = challenge(member.state, self._signed(others), self.deadline)
                    member.beaten_by = np.maximum(member.beaten_by, asked.amounts)
                    useful = self._useful(further_designs(member.state, asked.better)) if asked.better else []
                    fresh = member.standing(useful, self.deadline)
                    member.designs += fresh
                    closed = closed and asked.closed and len(fresh) == len(useful)
                    quiet = quiet and not fresh
            if quiet:
                # What did not stand the range may have kept the search from what does, and beats others as well.
                self.proven = closed and not any(m.incomplete for m in self.members)
                return
        self.proven = False

    def _useful(self, designs: Sequence[Design]) -> list[Design]:
        """Return those that no design known beats or equals."""
        known = self._signed([d for m in self.members for d in m.designs])
        return [d for d, own in zip(designs, self._signed(designs), strict=True) if not _beaten(known, own).any()]

    def _listed(self) -> tuple[list[tuple[_Member, Design]], list[tuple[_Member, Design]]]:
        """Return the designs of the common front, and all that nothing beats."""
        every = [(m, d) for m in self.members for d in m.designs]
        signed = self._signed([d for _, d in every])
        stay: list[int] = []
        for k, own in enumerate(signed):
            beaten = _beaten(signed, own) & (_strictly(signed, own) | (np.arange(len(signed)) < k))
            if not beaten.any():
                stay.append(k)
        front = [every[k] for k in stay]
        return [front[k] for k in self._spread([m for m, _ in front], signed[stay])], front

    def _spread(self, owners: Sequence[_Member], signed: np.ndarray) -> list[int]:
        """Return designs that spread best, at most so many as asked for; no family is left out that has one."""
        most = self.settings.points
        taken = [int(k) for k in spread_subset(signed, most)]
        kept = [owners[k].one.label for k in taken]
        for label in dict.fromkeys(m.one.label for m in owners):
            if label not in kept:
                spare = [k for k, own in enumerate(kept) if kept.count(own) > 1]
                if not spare:
                    break
                low, high = signed.min(axis=0), signed.max(axis=0)
                unit = (signed - low) / np.where(high > low, high - low, 1.0)
                own = [k for k, m in enumerate(owners) if m.one.label == label]
                best = min(own, key=lambda k: float(np.linalg.norm(unit[k])))
                # It takes the place of the design nearest to it of a family that has more.
                gone = min(spare, key=lambda k: float(np.linalg.norm(unit[taken[k]] - unit[best])))
                taken[gone], kept[gone] = best, label
        return sorted(taken)

    # -- the report ----------------------------------------------------------------------------

    def _compared(self) -> Comparison:
        listed, every = self._listed()
        certificate = self._certificate(bool(listed))
        weights = [float((self.ranked["weights"] or {}).get(n, 1.0)) for n in self.objectives]
        proven = certificate.kind == "global"
        complete = proven and all(m.front.complete for m in self.members)
        order, designs = ranked([d for _, d in listed], self.objectives, weights, complete)
        owners = [listed[k][0].one.label for k in order]
        designs = [
            replace(d, status=d.status if proven else Status.FEASIBLE, gap=certificate.gap if proven else None)
            for d in designs
        ]
        outcomes = [self._outcome(one, designs, owners, every) for one in self.found]
        settings = {
            "points": self.settings.points,
            "weights": self.ranked["weights"],
            "gap": self.settings.gap,
            "grid": self.ranked["grid"],
            "workers": self.settings.workers,
            "seed": self.settings.seed,
            "time_limit": self.settings.time_limit,
            "sheet": {key: _plain(self.sheet[key]) for key in self.sheet},
        }
        return Comparison(
            self.objectives,
            designs,
            owners,
            outcomes,
            certificate,
            settings,
            self.interrupted,
            time.monotonic() - self.started,
        )

    def _certificate(self, any_design: bool) -> Certificate:
        own = [m.front.certificate for m in self.members]
        weakest = min((KINDS.index(c.kind) for c in own), default=0)
        kind = KINDS[weakest] if not self.interrupted else KINDS[0]
        if kind == "global" and not self.proven:
            kind = KINDS[0]
        gap = self.settings.gap if kind == "global" and any_design else None
        amounts = self._amounts() if gap is not None else {}
        units = {name: next(c.units[name] for c in own if name in c.units) for name in amounts}
        return Certificate(
            kind,
            gap,
            sum(c.combinations for c in own),
            sum(c.excluded_by_bound for c in own),
            sum(c.solved for c in own),
            sum(c.unresolved for c in own),
            resolution=amounts,
            units=units,
        )

    def _amounts(self) -> dict[str, float]:
        """Return in SI by how much a design must be better where that is no share of its value in every family."""
        told = [m.front.certificate for m in self.members if m.designs]
        values = np.abs(self._signed([d for m in self.members for d in m.designs]))
        result = {}
        for k, name in enumerate(self.objectives):
            unit = next((c.units[name] for c in told if name in c.resolution), None)
            if unit is not None:
                # In some families the share of a value, in others an amount: the largest of them all serves every one.
                own = [c.resolution.get(name, self.settings.gap * float(values[:, k].max())) for c in told]
                least = max(*own, *(float(m.beaten_by[k]) for m in self.members))
                result[name] = rounded_up(least, unit)
        return result

    def _outcome(
        self,
        one: Applicant,
        designs: Sequence[Design],
        owners: Sequence[str],
        every: Sequence[tuple[_Member, Design]],
    ) -> FamilyOutcome:
        d = one.declaration
        quantities: Mapping[str, Any] = {**d.variables, **d.counts, **d.derived}
        meanings = {n: quantities[n].text for n in self.objectives if n in quantities}
        told = FamilyOutcome(one.label, one.title, "refused", "", meanings=meanings)
        if one.misfits:
            return replace(told, sentence=f"it {' and '.join(one.misfits)}")
        if one.label in self.faults:
            return replace(told, sentence=str(self.faults[one.label]))
        member = next((m for m in self.members if m.one is one), None)
        if member is None:
            return replace(told, outcome="stopped", sentence=f"not searched ({self.interrupted})")
        listed = owners.count(one.label)
        told = replace(told, front=member.front, listed=listed)
        if listed:
            words = "1 design" if listed == 1 else f"{listed} designs"
            return replace(told, outcome="listed", sentence=f"{words} on the common front")
        if not member.designs and member.front.interrupted:
            reason = f"no design was found until it was stopped ({member.front.interrupted})"
            return replace(told, outcome="stopped", sentence=reason)
        if not member.designs:
            nothing = NOTHING_STANDS if member.incomplete else "No design is feasible."
            explanation = member.front.explanation
            message = nothing if explanation is None else explanation.get("message", nothing)
            return replace(told, outcome="infeasible", sentence=str(message))
        if any(m is member for m, _ in every):
            reason = "it has designs that nothing beats, but there is no room for them among so few points"
            return replace(told, outcome="beaten", sentence=reason)
        winner, sentence = self._beaten(member, designs, owners, every)
        return replace(told, outcome="beaten", sentence=sentence, beaten_by=winner)

    def _beaten(
        self,
        member: _Member,
        designs: Sequence[Design],
        owners: Sequence[str],
        every: Sequence[tuple[_Member, Design]],
    ) -> tuple[Design | None, str]:
        """Say by which design a family is beaten in most of its own, and how its best values compare with that one's.

        Where no listed design beats any, they are compared with the best values of all.
        """
        own = self._signed(member.designs)
        beats = [int(_beaten(own, row, of_others=True).sum()) for row in self._signed(designs)]
        best = int(np.argmax(beats)) if beats else -1
        if best < 0 or not beats[best]:
            words = self._against(member, own, self._signed([d for _, d in every]))
            return None, f"everywhere, by designs between those listed: {words}"
        by = f"by #{designs[best].rank} ({owners[best]})"
        if len(own) > 1:
            by = f"in {'all' if beats[best] == len(own) else f'{beats[best]} of {len(own)}'} of its designs {by}"
        return designs[best], f"everywhere, {by}: {self._against(member, own, self._signed([designs[best]]))}"

    def _against(self, member: _Member, own: np.ndarray, others: np.ndarray) -> str:
        """Return the best values of a family's designs beside those of others."""
        words = []
        for k, (name, sense) in enumerate(self.objectives.items()):
            mine, theirs = (
                format_quantity(float(rows[:, k].min() * self.senses[k]), member.front.frame.units[name], 4)
                for rows in (own, others)
            )
            words.append(f"{'least' if sense == 'min' else 'largest'} {name} {mine} against {theirs}")
        return ", ".join(words)


def _beaten(signed: np.ndarray, own: np.ndarray, of_others: bool = False) -> np.ndarray:
    """Tell which rows are as good as a design in every objective; ``of_others``: which ones it is as good as."""
    room = MARGINS.same * np.maximum(np.abs(own), np.abs(signed))
    better = own <= signed + room if of_others else signed <= own + room
    result: np.ndarray = np.all(better, axis=1)
    return result


def _strictly(signed: np.ndarray, own: np.ndarray) -> np.ndarray:
    room = MARGINS.same * np.maximum(np.abs(own), np.abs(signed))
    result: np.ndarray = np.any(signed < own - room, axis=1)
    return result


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return value if isinstance(value, (str, int, float, bool)) else str(value)
