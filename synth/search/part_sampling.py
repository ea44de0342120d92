"""Optuna chooses the parts where neither bounds nor plain enumeration reach; the dimensions are solved exactly.

Only discrete unknowns are drawn: flat samplers over continuous dimensions as well end several per cent off.
A trial is one combination (and a direction, where objectives are traded off), its value the optimum of the
continuous problem. The study is kept in a journal file, so that a search that was stopped goes on where it was; who
asks the same meanwhile has a study of its own in memory.
"""

from __future__ import annotations

import logging
import os
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from synth.bounds.boxes import Boxes
from synth.nlp.batch import Tasks
from synth.question.instance import Instance
from synth.results.provenance import hash_of
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import roundings
from synth.search.pruning import PruningRule
from synth.search.settings import TUNING, Tuning
from synth.system.file_locks import exclusive_access
from synth.system.operating_system import cache_home

BEGUN_ANEW = "the trials of an interrupted run are not used: its code, or the processor, was another"


def sample_parts(
    form: Formulation, unresolved: Boxes, rule: PruningRule, clock: Clock, journal: Path | None, seed: int, trials: int
) -> int:
    """Look for designs among the combinations of some boxes.

    Parameters
    ----------
    form : Formulation
        Its archive is filled.
    unresolved : Boxes
        Unresolved boxes.
    rule : PruningRule
        Takes the designs as well.
    clock : Clock
    journal : Path, optional
        Where the study is kept until it is finished; None keeps it in memory. So it is kept as well while another
        process is at work on the file.
    seed : int
    trials : int
        Combinations to try, those of an earlier run that was stopped included.

    Returns
    -------
    int
        Trials of this run.
    """
    if journal is None:
        return _searched(form, unresolved, rule, clock, None, seed, trials)
    with exclusive_access(journal.with_suffix(".lock")) as exclusive:
        done = _searched(form, unresolved, rule, clock, journal if exclusive else None, seed, trials)
        if exclusive:
            journal.unlink(missing_ok=True)
    return done


def _searched(
    form: Formulation, unresolved: Boxes, rule: PruningRule, clock: Clock, journal: Path | None, seed: int, trials: int
) -> int:
    """Look for designs as :func:`sample_parts` does, with a study that nobody else is at work on."""
    import optuna  # costly to import; few questions need it
    from optuna.storages import JournalStorage
    from optuna.storages.journal import JournalFileBackend, JournalFileOpenLock

    optuna.logging.set_verbosity(logging.ERROR)
    rows, limits = _offered(form, unresolved), form.tuning.heuristics.parts
    columns = rule.columns
    storage = None
    if journal is not None:
        storage = JournalStorage(JournalFileBackend(str(journal), lock_obj=JournalFileOpenLock(str(journal))))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # samplers warn of what is experimental in themselves
        sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, constant_liar=True)
        study = optuna.create_study(
            storage=storage,
            sampler=sampler,
            study_name="parts",
            directions=["minimize"] * len(columns),
            load_if_exists=True,
        )
        before = len(study.get_trials(deepcopy=False))
        done = before
        while done < trials:
            clock.check([unresolved])
            batch = [study.ask() for _ in range(min(limits.batch, trials - done))]
            places = [[t.suggest_int(f"factor_{f}", 0, len(r) - 1) for f, r in enumerate(rows)] for t in batch]
            towards = [t.suggest_int("direction", 0, limits.directions - 1) if len(columns) > 1 else 0 for t in batch]
            digits = [rows[f][np.array([p[f] for p in places])] for f in range(len(rows))]
            combinations = form.instance.combinations.composed(digits, len(batch))
            values, missed = _inner(form, rule, combinations, np.array(towards))
            for trial, phi, violation in zip(batch, values, missed, strict=True):
                trial.set_constraint("limits", float(violation))
                study.tell(trial, [float(x) for x in phi])
            done += len(batch)
    return done - before


def study_file(instance: Instance, objectives: Mapping[str, str], seed: int, tuning: Tuning = TUNING) -> Path | None:
    """Place of the study of a question, or None where no folder can be written.

    What computes the answers belongs to its name: another version or processor must not go on with trials that it
    would value differently.
    """
    key = instance.fingerprint()
    question, computed = hash_of([key.question, [*objectives.items()], seed]), hash_of([key.computation, repr(tuning)])
    folder = cache_home() / "clutchsynth" / "studies"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder / f"{question[:24]}_{computed[:16]}.journal" if os.access(folder, os.W_OK) else None


def passed_over(journal: Path | None) -> bool:
    """True if the study of a question begins anew although one is kept, which was computed in another way."""
    if journal is None or journal.exists():
        return False
    return any(journal.parent.glob(f"{journal.stem.split('_')[0]}_*{journal.suffix}"))


def _offered(form: Formulation, unresolved: Boxes) -> list[np.ndarray]:
    """Rows per factor that unresolved boxes hold, neighbours in the cluster tree side by side."""
    result = []
    for f, tree in enumerate(form.boxes.cells.trees):
        held = np.zeros(len(tree.order), dtype=bool)
        for cluster in np.unique(unresolved.cell[:, f]):
            held[tree.start[cluster] : tree.stop[cluster]] = True
        result.append(tree.order[held])
    return result


def _inner(
    form: Formulation, rule: PruningRule, combinations: np.ndarray, towards: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solve the continuous problem of each combination; return phi, and by how much limits are missed."""
    columns, goals, count = rule.columns, len(form.goals), len(combinations)
    limits = form.tuning.heuristics.parts
    share = towards / max(limits.directions - 1, 1)
    weights = np.zeros((count, goals))
    for position, k in enumerate(columns):
        even = (share + position / len(columns)) % 1.0
        weights[:, k] = 1.0 if len(columns) == 1 else 0.02 + even
    tasks = Tasks(
        weights, np.zeros((count, goals)), np.tile(rule.fixed_cutoffs, (count, 1)), form.objectives.scales, 0.0
    )
    start = np.tile(form.boxes.inside(form.boxes.leaves(combinations[:1]), 0.5), (count, 1))
    answer = form.continuous.solve_batch(tasks, combinations, start)
    points, owner = _makeable(form, combinations, answer.variables)
    rows, phi = form.points.feasible_rows(points, combinations[owner])
    values = np.full((count, len(columns)), limits.worst)
    missed = np.maximum(np.nan_to_num(answer.violation, nan=1.0), 1e-6)
    for k in rows:
        point = phi[k, columns]
        if np.dot(point, weights[owner[k], columns]) < np.dot(values[owner[k]], weights[owner[k], columns]):
            values[owner[k]], missed[owner[k]] = point, 0.0
    rule.take(combinations[owner][rows], points[rows], phi[rows])
    form.archive.add(combinations[owner][rows], points[rows], phi[rows])
    return values, missed


def _makeable(form: Formulation, combinations: np.ndarray, variables: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points to evaluate for continuous optima, and the combination (by position) of each."""
    if not form.gridded.any():
        return variables, np.arange(len(variables))
    low, high, owner = roundings(form, variables)
    around = form.boxes.leaves(combinations[owner], low, high)
    boxes = form.boxes.contract(replace(around, tag=owner), None)
    shares = (form.tuning.heuristics.primal.inside, 0.5)
    points = np.concatenate([form.makeable.nearest(form.boxes.inside(boxes, share)) for share in shares])
    return points, np.tile(boxes.tag, 2)
