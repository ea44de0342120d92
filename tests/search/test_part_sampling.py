"""Optuna over parts: what it does where bounds do not close and enumeration does not reach."""

import shutil
import subprocess
import sys

import numpy as np
import pytest

import synth.question.instance
from synth.question.catalogs import catalogs_for
from synth.search import part_sampling as outer
from synth.search.archive import Archive
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.part_sampling import BEGUN_ANEW, passed_over, sample_parts, study_file
from synth.search.pruning import EpsilonCover
from synth.search.settings import PartSampling, SearchEffort
from synth.system.deadline import Stopped
from synth.system.file_locks import exclusive_access
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import synthesize, tuned

TRIALS = 16
BATCH = 4
# Bounds and enumeration give up at once.
SMALL = {
    "tree": {"boxes": 1, "coarse_boxes": 1, "few_combinations": 1, "further": SearchEffort(seconds=0.0)},
    "heuristics": {"parts": PartSampling(trials=TRIALS, batch=BATCH)},
}


@pytest.fixture(scope="module")
def cache_home(tmp_path_factory):
    """A folder for what is kept; code that one test compiled serves the others."""
    return tmp_path_factory.mktemp("home")


@pytest.fixture(autouse=True)
def home(monkeypatch, cache_home):
    """The folder, without studies of other tests."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_home))
    yield cache_home
    shutil.rmtree(cache_home / "clutchsynth" / "studies", ignore_errors=True)


def ask(objectives=None, tuning=SMALL, **more):
    own = {"catalogs": {"rods": RODS}, "points": 5, **more}
    return synthesize(tuned(**tuning), Strut(), NEEDED, objectives, **own)


def journals(home):
    return sorted((home / "clutchsynth" / "studies").glob("*.journal"))


def limits_hold(front):
    """Tell whether there are designs and all of them keep all limits (those without a value are void)."""
    residuals = [r for d in front.designs for r in d.residuals.values()]
    return len(residuals) > 0 and all(not d.violated for d in front.designs) and not np.any(np.array(residuals) > 1e-6)


class Breaks:
    """Lets the time run out after some batches of trials."""

    def __init__(self, monkeypatch, batches):
        self.batches, self.done = batches, 0
        inner, check = outer._inner, Clock.check

        def counted(*args):
            self.done += 1
            return inner(*args)

        def stopping(clock, *boxes):
            if self.done >= self.batches:
                raise Stopped("time limit")
            check(clock, *boxes)

        monkeypatch.setattr(outer, "_inner", counted)
        monkeypatch.setattr(Clock, "check", stopping)


def test_optuna_takes_over_and_says_so(home):
    front = ask()
    assert front.certificate.kind == "heuristic"
    assert front.status == "feasible"
    assert front.statistics["outer_trials"] == TRIALS
    assert not front.complete
    assert limits_hold(front)
    assert journals(home) == []


def test_what_enumeration_reaches_is_not_left_to_optuna(home):
    front = ask(tuning={**SMALL, "tree": {**SMALL["tree"], "few_combinations": 240}})
    assert front.certificate.kind in ("global", "exhaustive")
    assert front.statistics["outer_trials"] == 0
    assert limits_hold(front)
    assert journals(home) == []


def test_a_search_that_was_stopped_goes_on_where_it_was(monkeypatch, home):
    with monkeypatch.context() as patch:
        Breaks(patch, 2)
        stopped = ask()
    assert stopped.interrupted == "time limit"
    assert stopped.certificate.kind == "heuristic"
    assert limits_hold(stopped)
    assert len(journals(home)) == 1
    resumed = ask()
    assert not resumed.interrupted
    assert resumed.statistics["outer_trials"] == TRIALS - 2 * BATCH
    assert resumed.certificate.kind == "heuristic"
    assert limits_hold(resumed)
    assert journals(home) == []


@pytest.mark.slow
def test_the_same_question_at_the_same_time_has_a_study_of_its_own(monkeypatch, home):
    inner, others = outer._inner, []

    def beside(*args):
        if not others:  # while the first study is under way another one begins and ends
            others.append(None)
            others.append(ask())
        return inner(*args)

    monkeypatch.setattr(outer, "_inner", beside)
    front = ask()
    assert front.statistics["outer_trials"] == TRIALS
    assert others[1].statistics["outer_trials"] == TRIALS
    assert others[1].files()["designs.csv"] == front.files()["designs.csv"]
    assert not list((home / "clutchsynth" / "studies").iterdir())


PROCESS = """
import sys
from pathlib import Path
from synth.system.file_locks import exclusive_access
with exclusive_access(Path(sys.argv[1])) as own:
    print(own, flush=True)
    sys.stdin.read()
"""


def test_a_lock_keeps_other_processes_out_until_its_own_is_gone(tmp_path):
    path = tmp_path / "study.lock"

    def begun():
        process = subprocess.Popen(
            [sys.executable, "-c", PROCESS, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        return process, process.stdout.readline().strip()

    first, own = begun()
    assert own == "True"
    second, own = begun()
    assert own == "False"
    second.communicate()
    with exclusive_access(path) as own:
        assert not own
    first.kill()  # what is killed locks nothing any more, although the file stays
    first.communicate()
    with exclusive_access(path) as own:
        assert own
    assert not path.exists()


def test_another_question_does_not_take_up_the_study(monkeypatch, home):
    with monkeypatch.context() as patch:
        Breaks(patch, 1)
        ask()
    assert ask(seed=1).statistics["outer_trials"] == TRIALS
    assert len(journals(home)) == 1


@pytest.mark.parametrize(("columns", "kept"), [([0], False), ([0, 1], True)])
def test_trials_find_feasible_designs_of_the_open_boxes_only(tmp_path, columns, kept):
    problem = Strut()
    instance = instance_of(problem, NEEDED, catalogs_for(problem, {"rods": RODS}))
    form = Formulation(instance, {"mass": "min", "flexibility": "min"}, 2, tuning=tuned(**SMALL))
    root = form.boxes.root()
    left = form.boxes.split(root)[0].take(slice(0, 1))  # half of everything
    archive = Archive(columns, form.n, 2)
    rule = EpsilonCover(columns, np.full(len(columns), 1e-3), np.full(2, np.inf), archive)
    journal = tmp_path / "study.journal" if kept else None
    assert sample_parts(form, left, rule, Clock(), journal, 0, TRIALS) == TRIALS
    assert journal is None or not journal.exists()
    assert len(archive)
    rows, phi = form.points.feasible_rows(archive.variables, archive.combination)
    assert len(rows) == len(archive)
    np.testing.assert_array_equal(phi, archive.phi)
    for f, tree in enumerate(form.boxes.cells.trees):
        assert np.isin(instance.combinations.digits(archive.combination)[f], tree.rows(int(left.cell[0, f]))).all()
    assert len(form.archive)


def test_studies_are_told_apart_by_all_that_makes_a_question(home):
    def file(objectives=("mass",), seed=0, needed=NEEDED, **more):
        problem = Strut(**more)
        instance = instance_of(problem, needed, catalogs_for(problem, {"rods": RODS}))
        return study_file(instance, dict.fromkeys(objectives, "min"), seed)

    files = [
        file(),
        file(seed=1),
        file(("flexibility",)),
        file(("mass", "flexibility")),
        file(needed={"load": "21 kN"}),
        file(finish="coated"),
    ]
    assert len(set(files)) == len(files)
    assert file() == files[0]
    assert files[0].parent == home / "clutchsynth" / "studies"


@pytest.mark.parametrize("what", ["code_digest", "problem_digest", "native_code", "processor"])
def test_what_would_value_trials_differently_does_not_go_on_with_a_study(monkeypatch, home, what):
    def file():
        instance = instance_of(Strut(), NEEDED, catalogs_for(Strut(), {"rods": RODS}))
        return study_file(instance, {"mass": "min"}, 0)

    before = file()
    assert file() == before
    assert not passed_over(before)
    before.touch()
    assert not passed_over(before)
    monkeypatch.setattr(synth.question.instance, what, lambda *_: "another")
    assert file() != before
    assert passed_over(file())
    file().touch()
    assert not passed_over(file())
    assert not passed_over(None)


def test_a_study_that_begins_anew_is_told(monkeypatch, home):
    told = []
    with monkeypatch.context() as patch:
        Breaks(patch, 2)
        ask(progress=lambda state: told.append(state["message"]))
    assert BEGUN_ANEW not in told
    assert len(journals(home)) == 1
    monkeypatch.setattr(synth.question.instance, "processor", lambda: "another")
    assert ask(progress=lambda state: told.append(state["message"])).statistics["outer_trials"] == TRIALS
    assert BEGUN_ANEW in told
