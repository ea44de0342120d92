"""Several families asked the same: each is searched by itself, and all designs together make one ranked front.

Of the designs of all families those stay that no other one beats. What a family's own proof says of its designs says
nothing of those of the others; so each is asked again, by its own tree, whether it can beat them. Better designs that
it finds take their places, until nothing changes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from synth.errors import InputError
from synth.order.feasibility import Status
from synth.question.arguments import Families, Limits, Objectives, PartRules, Pins, Requirements, Scatter, UserTables
from synth.question.instance import Instance
from synth.question.settings import LEAST_SECONDS, Progress, ProgressState, SearchSettings, check_progress
from synth.question.uncertainty import Uncertainty
from synth.results import Certificate, Design, ParetoFront
from synth.results.assembly import ranked
from synth.robust.rating import Rater
from synth.robust.robust_front import robust_front
from synth.search.archive import Candidate
from synth.search.front_report import further_designs
from synth.search.question import pose
from synth.search.resolution import rounded_up
from synth.search.settings import TUNING, Tuning
from synth.search.stages.challenge import challenge
from synth.search.stages.first_by_rank import nearest_among
from synth.studies.families.common_front import CommonFront
from synth.studies.families.comparison import Comparison
from synth.studies.families.competitor import Competitor, KeptQuestion
from synth.studies.families.outcomes import Outcomes
from synth.studies.families.requirement_sheet import (
    Applicant,
    Sheet,
    applicants,
    common_objectives,
    refuse_all,
    sheet_of,
)
from synth.studies.settings import COMPARING, ComparisonLimits
from synth.system.deadline import INTERRUPTED, stoppable
from synth.tables.catalogs import Catalogs

KINDS = ("heuristic", "exhaustive", "global")
UNDER_WAY = "under way"
PASSES = 2  # over the families: each in its share of the time, and those that are not finished once more


def compare(
    families: Families,
    requirements: Requirements,
    objectives: Objectives = None,
    points: int = 30,
    *,
    catalogs: UserTables = None,
    parts: PartRules | None = None,
    limits: Limits | None = None,
    fix: Pins | None = None,
    weights: Mapping[str, float] | None = None,
    gap: float = 1e-3,
    grid: bool = True,
    workers: int = 1,
    seed: int = 0,
    progress: Progress | None = None,
    time_limit: float | None = None,
    options: Mapping[str, str] | None = None,
    finished: Callable[[str, ParetoFront], object] | None = None,
    robust: Scatter | None = None,
    serving: Callable[[Sequence[str]], object] | None = None,
    so_far: Callable[[Comparison], object] | None = None,
) -> Comparison:
    """Search all families that can serve one requirement sheet, and rank their designs on one front.

    Those with the fewest combinations come first, and each may take its share of the time that is left, so that none
    keeps the others waiting. What the first ones leave goes to those that were not finished.

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
        Seconds for all families together; by default ``COMPARING.budget``, after which the best found is told.
    options : mapping, optional
        Options of every family.
    finished : callable, optional
        Called with the label and the front of each family as soon as it is searched; again where it is searched once
        more.
    robust : mapping, optional
        What scatters, as for ``synthesize``: designs of all families stand it, or are rated. Under a family "none" in
        place of a range tells that it does not scatter there.
    serving : callable, optional
        Called with the labels of the families that can serve, in the order of the search, before it begins.
    so_far : callable, optional
        Called with the comparison as it stands, after each family.

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
    candidates = applicants(families, sheet, tables)
    refuse_all(candidates, sheet)
    chosen = common_objectives(candidates, objectives)
    refuse_all(candidates, sheet)
    ranked = {"objectives": chosen, "weights": weights, "grid": grid}
    comparing = _Comparing(candidates, sheet, ranked, tables, settings, progress, objectives is not None)
    return comparing.run(finished, serving, so_far)


class _Comparing:
    """One comparison in progress."""

    def __init__(
        self,
        candidates: Sequence[Applicant],
        sheet: Sheet,
        ranked: Mapping[str, Any],
        tables: Catalogs,
        settings: SearchSettings,
        progress: Progress | None,
        chosen: bool,
        tuning: Tuning = TUNING,
        limits: ComparisonLimits = COMPARING,
    ) -> None:
        self.chosen = chosen  # whether objectives were asked for by name
        self.started, self.tuning, self.limits = time.monotonic(), tuning, limits
        self.candidates, self.sheet, self.ranked, self.tables = candidates, sheet, ranked, tables
        self.settings, self.progress = settings, progress
        # A limit that was asked for interrupts; the budget ends a search as it ends that of one family.
        self.budget = limits.budget if settings.time_limit is None else None
        self.deadline = self.started + (self.budget or settings.time_limit or 0.0)
        self.front = CommonFront(ranked["objectives"], settings.points, ranked["weights"])
        self.faults: dict[str, InputError] = {}
        self.interrupted = ""
        self.proven, self.spent = True, False

    def run(
        self,
        finished: Callable[[str, ParetoFront], object] | None,
        announce: Callable[[Sequence[str]], object] | None = None,
        so_far: Callable[[Comparison], object] | None = None,
    ) -> Comparison:
        serving = self._serving()
        if not serving:
            raise next(iter(self.faults.values()))
        if announce is not None:
            announce([one.label for one in serving])

        def searched(label: str, front: ParetoFront) -> None:
            if finished is not None:
                finished(label, front)
            if so_far is not None:
                so_far(self._compared(UNDER_WAY))

        self._search_all(serving, searched)
        with stoppable(self.deadline) as ending:
            self._challenge_all()
        if ending.reason:
            self._stop(ending.reason)
        return self._compared()

    def _stop(self, reason: str) -> None:
        self.proven = False
        if self.budget and reason != INTERRUPTED:
            self.spent = True
        else:
            self.interrupted = self.interrupted or reason

    def _serving(self) -> list[Applicant]:
        """Families that can serve, those with the fewest combinations first; what one refuses is kept."""
        counted = []
        for one in (one for one in self.candidates if not one.misfits):
            try:
                instance = Instance(one.request(self.sheet, self.tables, **self.ranked))
            except InputError as error:
                self.faults[one.label] = error
            else:
                counted.append((instance.combinations.count, one))
        return [one for _, one in sorted(counted, key=lambda pair: pair[0])]

    # -- every family by itself ----------------------------------------------------------------

    def _search_all(self, serving: Sequence[Applicant], searched: Callable[[str, ParetoFront], object]) -> None:
        """Search every family in its share of the time, then those that are not finished in what is left."""
        members: dict[str, Competitor] = {}
        for pass_number in range(PASSES):
            open_still = [one for one in serving if one.label not in self.faults and not _done(members.get(one.label))]
            for number, one in enumerate(open_still):
                remaining = (self.deadline - time.monotonic()) / (len(open_still) - number)
                if self.interrupted or (remaining <= 0 and (pass_number or number)):
                    break
                done = (pass_number + number / len(open_still)) / PASSES
                try:
                    member = self._searched(one, remaining, done, 1 / len(open_still) / PASSES)
                except InputError as error:
                    self.faults[one.label] = error
                    continue
                except KeyboardInterrupt:
                    self._stop(INTERRUPTED)
                    break
                members[one.label] = member.with_what_it_had(members.get(one.label))
                self.front.members = [members[one.label] for one in self.candidates if one.label in members]
                searched(one.label, members[one.label].front)
                if member.front.interrupted == INTERRUPTED:
                    self._stop(INTERRUPTED)
        if len(self.faults) == sum(not one.misfits for one in self.candidates):
            raise next(iter(self.faults.values()))
        if not self.interrupted and not (len(members) == len(serving) and all(map(_done, members.values()))):
            self._stop("time limit")

    def _searched(self, one: Applicant, seconds: float, done: float, share: float) -> Competitor:
        """Search one family for some seconds; ``done`` and ``share`` are of all that is to be done."""
        limit = max(seconds, LEAST_SECONDS)
        shown, kept = self._shown(one.label, done, share), list[KeptQuestion]()

        request, rater = one.request(self.sheet, self.tables, **self.ranked), None

        def ask(block: Uncertainty | None) -> KeptQuestion:
            kept.append(KeptQuestion(pose(replace(request, robust=block), self.settings, tuning=self.tuning)))
            return kept[-1]

        if request.robust is None:
            front = ask(None).within(limit).answer(shown)
        else:
            rater = Rater(request, request.robust, self.tuning.robust)
            front = robust_front(ask, rater, shown, limit)
        state = next(k.state for k in reversed(kept) if k.state is not None)
        return Competitor(one, state, front, list(front.designs), np.zeros(len(self.front.objectives)), rater)

    def _shown(self, label: str, done: float, share: float) -> Progress | None:
        progress = self.progress
        if progress is None:
            return None

        def show(state: ProgressState) -> None:
            fraction = float(state.get("done") or 0.0)
            progress({**state, "stage": f"{label}: {state.get('stage', '')}", "done": done + share * fraction})

        return show

    # -- against each other --------------------------------------------------------------------

    def _challenge_all(self) -> None:
        """Let every family look for the design nearest to the ideal of all, then for designs that beat the others'."""
        able = [m for m in self.front.members if m.designs or m.front.status is Status.FEASIBLE]
        if len(able) < 2 or len(self.front.objectives) < 2 or not self.proven:
            return
        nearest_stand = True
        for member in able:
            nearer = nearest_among(member.state, self.front.everything(), self.front.weights, self.deadline)
            fresh, all_stand = self._standing(member, nearer)
            self.front.take(member, fresh, proven=True)
            nearest_stand = nearest_stand and all_stand
        for _ in range(self.limits.rounds):
            quiet, closed = True, nearest_stand
            for member in able:
                listed, _ = self.front.listed()
                others = [d for m, d in listed if m is not member]
                if others:
                    reply = challenge(member.state, self.front.signed(others), self.deadline)
                    member.amounts = np.maximum(member.amounts, reply.amounts)
                    fresh, all_stand = self._standing(member, reply.better)
                    self.front.take(member, fresh, reply.closed)
                    closed = closed and reply.closed and all_stand
                    quiet = quiet and not fresh
            if quiet:
                # What did not stand the range may have kept the search from what does, and beats others as well.
                self.proven = closed and not any(m.incomplete for m in self.front.members)
                return
        self.proven = False

    def _standing(self, member: Competitor, candidates: Sequence[Candidate]) -> tuple[list[Design], bool]:
        """New designs of a family that no known design beats and that stand the range; whether all found do."""
        useful = self.front.useful(further_designs(member.state, candidates)) if candidates else []
        fresh = member.standing(useful, self.deadline)
        return fresh, len(fresh) == len(useful)

    # -- the report ----------------------------------------------------------------------------

    def _compared(self, under_way: str = "") -> Comparison:
        """Comparison as it stands; ``under_way``: what is said of it while families are still searched."""
        listed, every = self.front.listed()
        stopped = self.interrupted or under_way or ("time limit" if self.spent and not listed else "")
        certificate = self._certificate(bool(listed), bool(stopped))
        proven = certificate.kind == "global"
        complete = proven and all(m.front.complete for m in self.front.members)
        order, designs = ranked([d for _, d in listed], self.front.objectives, self.front.weights, complete)
        owners = [listed[k][0].one.label for k in order]
        designs = [
            replace(d, status=d.status if proven else Status.FEASIBLE, gap=certificate.gap if proven else None)
            for d in designs
        ]
        outcomes = Outcomes(self.front, designs, owners, every, self.faults, stopped or "time limit", self.chosen)
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
            self.front.objectives,
            designs,
            owners,
            [outcomes.of(one) for one in self.candidates],
            certificate,
            settings,
            stopped,
            time.monotonic() - self.started,
        )

    def _certificate(self, any_design: bool, stopped: bool) -> Certificate:
        certificates = [m.front.certificate for m in self.front.members]
        weakest = min((KINDS.index(c.kind) for c in certificates), default=0)
        kind = KINDS[0] if stopped or self.spent else KINDS[weakest]
        if kind == "global" and not self.proven:
            kind = KINDS[0]
        gap = self.settings.gap if kind == "global" and any_design else None
        amounts = self._amounts() if gap is not None else {}
        units = {name: next(c.units[name] for c in certificates if name in c.units) for name in amounts}
        return Certificate(
            kind,
            gap,
            sum(c.combinations for c in certificates),
            sum(c.excluded_by_bound for c in certificates),
            sum(c.solved for c in certificates),
            sum(c.unresolved for c in certificates),
            self.budget if self.spent else None,
            resolution=amounts,
            units=units,
        )

    def _amounts(self) -> dict[str, float]:
        """Return in SI by how much a design must be better where that is no share of its value in every family."""
        proofs = [m.front.certificate for m in self.front.members if m.designs]
        values = np.abs(self.front.signed([d for m in self.front.members for d in m.designs]))
        result = {}
        for k, name in enumerate(self.front.objectives):
            unit = next((c.units[name] for c in proofs if name in c.resolution), None)
            if unit is not None:
                # In some families the share of a value, in others an amount: the largest of them all serves every one.
                sizes = [c.resolution.get(name, self.settings.gap * float(values[:, k].max())) for c in proofs]
                least = max(*sizes, *(float(m.amounts[k]) for m in self.front.members))
                result[name] = rounded_up(least, unit)
        return result


def _done(member: Competitor | None) -> bool:
    """True if a family has been searched to the end."""
    return member is not None and not member.front.interrupted


def _plain(value: object) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return value if isinstance(value, (str, int, float, bool)) else str(value)
