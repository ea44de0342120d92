"""What-if studies: the same question at many values, each step helped by those before it, kept as it is finished."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from msgspec import structs

from synth.folders.output_folder import claimed
from synth.question.arguments import (
    Family,
    Limits,
    Objectives,
    PartRules,
    Pins,
    Requirements,
    Scatter,
    UserTables,
    Variations,
)
from synth.question.request import Request
from synth.question.settings import Progress, ProgressState, SearchSettings, check_progress
from synth.question.uncertainty import read_block
from synth.results import ParetoFront
from synth.results.assembly import ranked
from synth.results.front import front_record
from synth.results.loading import front_of_record
from synth.results.provenance import hash_of, joined
from synth.robust.rating import Rater
from synth.robust.robust_front import robust_front
from synth.search.joint.joint_fronts import joint_answers, joint_groups
from synth.search.question import Question
from synth.search.settings import TUNING, Tuning
from synth.studies.study_store import RECORD, STUDY_FORMAT, StudyStore
from synth.studies.whatif.break_points import find_breaks
from synth.studies.whatif.steps import Steps
from synth.studies.whatif.study import Study
from synth.studies.whatif.study_answers import Break, StudyStep
from synth.studies.whatif.weight_breaks import weight_breaks
from synth.system.deadline import Stopped, stoppable

POINTS = 3  # of every step: the best in each objective and, of two, one between


def whatif(
    p: Family,
    requirements: Requirements,
    vary: Variations,
    objectives: Objectives = None,
    points: int = POINTS,
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
    breaks: bool = True,
    folder: str | Path | None = None,
    robust: Scatter | None = None,
) -> Study:
    """Answer a question at many values of a requirement, a limit, a weight, a part, an option or a scatter.

    Parameters
    ----------
    p, requirements, objectives, catalogs, parts, limits, fix, weights, gap, grid, workers, seed : optional
        As for ``synth.synthesize``, for every step.
    points : int
        At most so many designs of every step: the best in each objective and, of two, one between unless more are
        asked for.
    vary : mapping
        One or two of: a requirement (``"load_torque"``), a limit on a quantity (``"mass <="``), ``"weights.mass"``,
        ``"parts.friction_pair"``, ``"options.lubrication"``, ``"robust.friction"``. Values are a text
        (``"200:300:10 mm"`` from:to:step, or ``"500, 600, 700 N*m"``), a list, or ends and a count (``("200 mm", "300
        mm", 11)``); of what scatters ranges such as ``"+-10 %"``, or ``"none"``. Of two the second runs through for
        each value of the first.
    progress : callable, optional
        Called with a mapping: stage, done (0..1), combinations, incumbents, message.
    time_limit : float, optional
        Seconds for the whole study; finished steps are kept.
    breaks : bool
        Whether to find the values at which the best parts or counts change.
    folder : path, optional
        Where finished steps are kept; the same study does not search them again.
    robust : mapping, optional
        What scatters, as for ``synthesize``: the designs of every step stand it, or are rated.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        For everything that is wrong with the input at any step, before the first is searched.
    """
    settings = SearchSettings(points=points, gap=gap, workers=workers, seed=seed, time_limit=time_limit)
    check_progress(progress)
    request = Request.of(
        p,
        requirements,
        catalogs,
        robust,
        objectives=objectives,
        parts=parts,
        limits=limits,
        fix=fix,
        weights=weights,
        grid=grid,
    )
    return study_of(request, settings, vary, progress, breaks, None if folder is None else Path(folder))


def study_of(
    request: Request,
    settings: SearchSettings,
    vary: Variations,
    progress: Progress | None = None,
    breaks: bool = True,
    folder: Path | None = None,
    tuning: Tuning = TUNING,
) -> Study:
    """Answer a request at many values of what is varied; the arguments are those of :func:`whatif`.

    ``tuning``: what its searches go by.

    Raises
    ------
    InputError
        For everything that is wrong at any step, before the first is searched.
    """
    steps = Steps(request, settings, vary, tuning)
    with nullcontext() if folder is None else claimed(folder):
        return _Run(steps, progress, settings.time_limit, folder).study(breaks)


class _Run:
    """One study under way."""

    def __init__(self, steps: Steps, progress: Progress | None, time_limit: float | None, folder: Path | None) -> None:
        self.steps, self.progress = steps, progress
        self.started = time.monotonic()
        self.deadline = math.inf if time_limit is None else self.started + time_limit
        self.folder = folder
        self.store = StudyStore(None)
        self.questions = steps.questions
        pairs = list(zip(self.questions, steps.raters, strict=True))
        self.single = [_fingerprint(question, rater) for question, rater in pairs]
        weighted = any(x.kind == "weight" for x in steps.varied)
        self.unweighted = [_fingerprint(q, r, weights=False) for q, r in pairs] if weighted else self.single
        self.answered: list[StudyStep] = []
        self.same_but_weights: dict[str, ParetoFront] = {}
        self.fingerprints: list[str] = []
        self.stored: list[ParetoFront | None] = []  # answers of an earlier run, by position
        self.ahead: dict[int, ParetoFront] = {}  # answers of joint searches, by position
        self.kept = 0
        self.share_of_steps = 1.0

    def study(self, breaks: bool) -> Study:
        """Answer the steps, then find the breaks; what is finished when time is over is kept."""
        bends = list[Break]()
        self.share_of_steps = 0.5 if breaks else 1.0
        with stoppable(self.deadline) as ending:
            self._search_together()
            for position in range(len(self.steps)):
                self.answered.append(self._answer(position))
            if breaks:
                self._find_breaks(bends)
        unanswered = [
            StudyStep(k + 1, values, None, stopped=ending.reason)
            for k, values in enumerate(self.steps.values)
            if k >= len(self.answered)
        ]
        statistics = {"steps": len(self.steps), "answered": len(self.answered), "kept": self.kept, "breaks": len(bends)}
        seconds = {"seconds": time.monotonic() - self.started}
        return Study(
            tuple(self.steps.varied),
            (*self.answered, *unanswered),
            tuple(bends),
            self._along(),
            ending.reason,
            {**statistics, **seconds},
            self.store,
        )

    # -- steps ---------------------------------------------------------------------------------

    def _search_together(self) -> None:
        """Answer steps that are alike jointly, where any of them is not kept; the others are searched one by one."""
        groups = joint_groups(self.questions)
        marks = dict[int, str]()
        for group in groups:
            marks |= dict.fromkeys(group, joined([self.single[k] for k in group]))
        for position, fingerprint in enumerate(self.single):
            ideas = [self.fingerprints[k] for k in self._neighbours(position)]
            group_mark = [marks[position]] if position in marks else []
            self.fingerprints.append(joined([fingerprint, *ideas, *group_mark]))
        self.store = StudyStore.of(self.folder, self.fingerprints)
        self.stored = [self.store.get(k + 1, mark) for k, mark in enumerate(self.fingerprints)]
        for group in groups:
            missing = [k for k in group if self.stored[k] is None]
            if missing:
                shown = self._shown(f"{len(group)} steps at once", 0.0, 0.0)
                answers = joint_answers([self.questions[k] for k in group], shown, self._remaining())
                fronts = dict(zip(group, answers, strict=True))
                self.ahead |= {k: front for k in missing if (front := fronts[k]) is not None}

    def _answer(self, position: int) -> StudyStep:
        number, values, question = position + 1, self.steps.values[position], self.questions[position]
        fingerprint, unweighted = self.fingerprints[position], self.unweighted[position]
        front = self.stored[position]
        if front is not None:
            self.kept += 1
        else:
            joint_front, known = self.ahead.pop(position, None), self.same_but_weights.get(unweighted)
            front = self._search(position, joint_front) if known is None else _reranked(known, question)
            record = front_record(front)
            self.store.put(number, fingerprint, record)
            # As it would be read again: a study that goes on is the same to the last digit.
            front = front_of_record(json.loads(json.dumps(record, allow_nan=False)), Path(RECORD))
        front = replace(front, question=self._answered_question(position, front).instance, record=None, folder=None)
        self.same_but_weights.setdefault(unweighted, front)
        return StudyStep(number, values, front, fingerprint)

    def _search(self, position: int, front: ParetoFront | None) -> ParetoFront:
        """Return the front of a step; ``front`` is that found together with others, not rated yet."""
        question, rater = self.questions[position], self.steps.raters[position]
        before = [self.answered[k] for k in self._neighbours(position)]
        known = [d for s in before if s.front is not None for d in s.front.designs]
        stage = f"step {position + 1} of {len(self.steps)}, {self.steps.text(self.steps.values[position])}"
        share = self.share_of_steps / len(self.steps)
        shown = self._shown(stage, position * share, share)
        if rater is not None:
            front = robust_front(
                lambda block: self.steps.question(position, block), rater, shown, self._remaining(), known, front
            )
        elif front is None:
            front = question.within(self._remaining()).answer(shown, known)
        if front.interrupted:
            raise Stopped(front.interrupted)
        return front

    def _answered_question(self, position: int, front: ParetoFront) -> Question:
        """Question that the front of a step answers, with the limits added during its search."""
        block = front.settings.get("robust") or {}
        if not block.get("scenarios"):
            return self.questions[position]
        robust = read_block(block)
        self.steps.learn(robust)
        return self.steps.question(position, robust)

    def _neighbours(self, position: int) -> list[int]:
        """Return the steps before one that differ in one place by one value: their designs are ideas for this one."""
        positions, stride = list[int](), 1
        for varied in reversed(self.steps.varied):
            if position // stride % len(varied.values):
                positions.append(position - stride)
            stride *= len(varied.values)
        return positions[::-1]

    def _remaining(self) -> float | None:
        """Remaining seconds, None where there is no limit."""
        if math.isinf(self.deadline):
            return None
        remaining = self.deadline - time.monotonic()
        if remaining <= 0:
            raise Stopped("time limit")
        return remaining

    def _shown(self, stage: str, begin: float, share: float) -> Progress | None:
        """Progress callback of one part, mapped to the study; ``begin`` and ``share`` of the whole."""
        report = self.progress
        if report is None:
            return None

        def show(state: ProgressState) -> None:
            done = begin + share * float(state.get("done") or 0.0)
            report({**state, "stage": f"{stage}: {state.get('stage', '')}", "done": min(done, 1.0)})

        return show

    # -- breaks --------------------------------------------------------------------------------

    def _along(self) -> int | None:
        """Return the position of what breaks are sought along: the first that is a number."""
        return next((k for k, x in enumerate(self.steps.varied) if x.numeric), None)

    def _find_breaks(self, bends: list[Break]) -> None:
        along = self._along()
        if along is None:
            return
        if self.steps.varied[along].kind == "weight":
            bends += weight_breaks(self.steps, along, self.answered)
            return
        find_breaks(
            self.steps,
            along,
            self.answered,
            bends,
            self.store,
            self._remaining,
            self._shown("break points", self.share_of_steps, 1.0 - self.share_of_steps),
        )


def _reranked(front: ParetoFront, question: Question) -> ParetoFront:
    """Return a front with other weights: the designs are the same, their order is not."""
    weights = list(question.weights.values())
    _, designs = ranked(front.designs, question.chosen, weights, front.complete, front.scale)
    return replace(front, designs=designs, settings=structs.replace(front.settings, **question.record()))


def _fingerprint(question: Question, rater: Rater | None, weights: bool = True) -> str:
    """Return the hash of all that decides an answer but ideas: question, settings, and what computes."""
    settings = {k: repr(v) for k, v in question.record().items() if weights or k != "weights"}
    robust = None if rater is None else rater.uncertainty.block()
    return hash_of(
        [STUDY_FORMAT, question.instance.fingerprint().combined, list(question.chosen.items()), settings, robust]
    )
