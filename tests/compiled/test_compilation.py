"""The C compiler beside the program: ended with it, nothing half-written, and no word in what comes out."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from synth import deadline
from synth.compiled import compilation, compiler
from synth.compiled.compilation import compile_beside, compile_shared, meanwhile, switched_off, switched_on
from synth.deadline import Stopped
from synth.file_locks import alone
from synth.nlp import interior_point_c as native
from synth.nlp.batch import BatchNlp, Tasks
from synth.search.front_search import FrontSearch
from synth.tuning import CompilingEffort
from tests.sample_problems.strut import NEEDED, RODS, Strut, strut_form
from tests.tuned import synthesize, tuned

SOURCE = "int one(void) { return 1; }"


USUAL = CompilingEffort(undisturbed=0.0)  # other work begins at once
ALWAYS = CompilingEffort(worthwhile=0.0, undisturbed=0.0)  # however short the time limit is
NOT_WITHIN_A_YEAR = CompilingEffort(worthwhile=3e7)


def slow_compiler(folder: Path, seconds: float) -> str:
    """Return a compiler that first starts a program of its own and then takes its time."""
    path = folder / "slow_cc"
    path.write_text(
        '#!/bin/sh\nwhile [ "$1" != -o ]; do shift; done\n'
        f'sh -c "echo \\$\\$ > {folder}/child; exec sleep {seconds}"\ncp {folder}/finished "$2"\n'
    )
    path.chmod(0o755)
    (folder / "finished").write_text("compiled")
    return str(path)


def ended(pid: int) -> bool:
    """Wait until a process is gone; tell whether it is."""
    for _ in range(1000):
        if not alive(pid):
            return True
        time.sleep(0.01)
    return False


def alive(pid: int) -> bool:
    """Tell whether a process is still at work."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_what_is_compiled_is_moved_to_its_place_at_once(tmp_path):
    place = tmp_path / "cache" / "code.so"
    place.parent.mkdir()
    compile_shared(slow_compiler(tmp_path, 0.1), SOURCE, place, [], USUAL)
    assert place.read_text() == "compiled"
    assert list(place.parent.iterdir()) == [place]


def begun(tmp_path: Path) -> int:
    """Wait until the compiler has begun; return the number of the program that it has started."""
    child = tmp_path / "child"
    while not (child.exists() and child.read_text().strip()):
        time.sleep(0.01)
    return int(child.read_text())


@pytest.mark.parametrize("how", ["time limit", "interrupted"])
def test_a_compiler_is_ended_with_all_that_it_has_started(tmp_path, how):
    folder, children = tmp_path / "cache", []
    folder.mkdir()

    def work(ready):
        children.append(begun(tmp_path))
        if how == "interrupted":
            raise KeyboardInterrupt

    end = time.monotonic() + (0.5 if how == "time limit" else 60.0)
    with meanwhile(work), deadline.until(end), pytest.raises((Stopped, KeyboardInterrupt)):
        compile_shared(slow_compiler(tmp_path, 600), SOURCE, folder / "code.so", [], ALWAYS)
    assert children
    assert ended(children[0])
    assert not list(folder.iterdir())


def test_what_is_done_meanwhile_is_told_when_the_compiler_is_done(tmp_path):
    told = []

    def work(ready):
        begun(tmp_path)
        told.append(ready())
        while not ready():
            time.sleep(0.01)
        told.append(ready())

    with meanwhile(work):
        compile_shared(slow_compiler(tmp_path, 0.2), SOURCE, tmp_path / "code.so", [], USUAL)
    assert told == [False, True]


def test_what_is_compiled_soon_is_not_disturbed(tmp_path):
    worked = []
    with meanwhile(worked.append):
        compile_shared(
            slow_compiler(tmp_path, 0.2), SOURCE, tmp_path / "code.so", [], CompilingEffort(undisturbed=60.0)
        )
    assert (tmp_path / "code.so").exists()
    assert not worked


def test_what_killed_programs_have_left_is_cleared_away(tmp_path):
    old, new = tmp_path / f"{compilation.PREFIX}old", tmp_path / f"{compilation.PREFIX}new"
    old.mkdir()
    new.mkdir()
    os.utime(old, (0, 0))
    compile_shared(slow_compiler(tmp_path, 0), SOURCE, tmp_path / "code.so", [], USUAL)
    assert not old.exists()
    assert new.exists()


def test_compiled_code_can_be_switched_off_for_a_block(monkeypatch):
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    with switched_off():
        assert not switched_on()
        assert native.library("test", SOURCE, USUAL) is None
    assert switched_on()


# -- beside a search -------------------------------------------------------------------------------


def ask(problem=None, effort=USUAL, **more):
    """Return a front; everything is compiled from the first."""
    numbers = tuned(compiling={"combinations": 0, "effort": effort}, nlp={"effort": effort})
    return synthesize(numbers, problem or Strut(), NEEDED, catalogs={"rods": RODS}, points=5, **more)


@pytest.fixture
def never_done(tmp_path, monkeypatch):
    """Let everything be compiled by a compiler that is never done; its folder."""
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    path = slow_compiler(tmp_path, 600)
    monkeypatch.setattr(compiler, "_compiler", lambda: (path, "slow"))
    return tmp_path / "home" / "clutchsynth"


@pytest.mark.slow
def test_a_time_limit_that_the_compiler_outlasts_still_returns_designs(never_done):
    begin = time.monotonic()
    front = ask(effort=ALWAYS, time_limit=4.0, gap=1e-6)
    assert front.designs
    assert all(not d.violated for d in front.designs)
    assert front.certificate.gap is not None
    assert time.monotonic() - begin < 60  # generous: it would be ten minutes
    assert not list(never_done.glob("*"))


def test_what_is_proven_while_the_compiler_works_is_an_answer_where_time_is_over(never_done, monkeypatch):
    ends = []
    aside = FrontSearch.look_aside

    def over(self, ready, report):
        """Let time run out when the search beside the compiler is finished."""
        aside(self, lambda: False, report)
        ends.append(self.aside.front)
        raise Stopped("time limit")

    monkeypatch.setattr(FrontSearch, "look_aside", over)
    front = ask(time_limit=600.0)
    assert front is ends[0]
    assert front.certificate.kind == "global"
    assert not front.interrupted
    assert not list(never_done.glob("*"))


@pytest.fixture
def wanted(monkeypatch, tmp_path):
    """Let the cache be empty, and nothing be compiled; what would have been."""
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(compiler, "_compiler", lambda: ("cc", "a compiler"))
    begun = []

    def refuse(command, **_):
        begun.append(command)
        raise OSError

    monkeypatch.setattr(compilation.subprocess, "Popen", refuse)
    return begun


@pytest.mark.slow
def test_under_a_short_time_limit_nothing_is_compiled(wanted, tmp_path):
    limited = ask(effort=NOT_WITHIN_A_YEAR, time_limit=1e6)
    assert not wanted
    assert not list(tmp_path.rglob("*.so"))
    assert limited.certificate.kind == "global"
    with switched_off():
        assert limited.files()["designs.csv"] == ask(effort=NOT_WITHIN_A_YEAR).files()["designs.csv"]


@pytest.mark.slow
def test_a_short_time_limit_keeps_no_other_question_from_compiling(wanted):
    problem = Strut()
    ask(problem, NOT_WITHIN_A_YEAR, time_limit=1e6)
    assert switched_on()
    assert not wanted
    ask(problem, NOT_WITHIN_A_YEAR, time_limit=6e7)
    assert wanted


def test_pieces_that_ask_for_code_late_are_solved_without(monkeypatch):
    form, solved = strut_form(), BatchNlp.solve
    tasks = Tasks(np.ones((1, 3)), np.zeros((1, 3)), np.full((1, 3), np.inf), form.objectives.scales, 0.0)
    start, asked = form.boxes.inside(form.boxes.leaves(np.zeros(1, dtype=np.int64)), 0.5), []
    expected = form.continuous.solve_many(tasks, np.zeros(1, dtype=np.int64), start)

    def late(nlp, *args):
        asked.append(switched_on())
        if asked == [True]:
            compile_shared("cc", SOURCE, Path("code.so"), [], USUAL)
        return solved(nlp, *args)

    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    monkeypatch.setattr(BatchNlp, "solve", late)
    with deadline.until(time.monotonic() + 5.0):
        found = form.continuous.solve_many(tasks, np.zeros(1, dtype=np.int64), start)
    assert asked == [True, False]
    assert np.allclose(found.variables, expected.variables, rtol=1e-5)


def test_what_is_part_of_a_limited_question_has_its_time_limit():
    now = time.monotonic()
    with deadline.until(now + 5.0):
        whole = deadline.current()
        assert 0 < whole.given <= 5.0
        with deadline.until(now + 60.0):
            assert deadline.current() is whole
        with deadline.until(now + 1.0, lambda: False):
            assert deadline.current().given <= 1.0
    assert deadline.current().given == float("inf")


def test_ctrl_c_while_the_compiler_works_is_heard(never_done, monkeypatch):
    heard = []

    def stop(said):
        if said["incumbents"] and not heard:
            heard.append(said)
            raise KeyboardInterrupt

    front = ask(progress=stop)
    assert front.interrupted == "interrupted"
    assert front.designs
    assert not list(never_done.glob("*"))


@pytest.mark.slow
@pytest.mark.skipif(compiler._compiler() is None, reason="no C compiler")
def test_what_is_done_meanwhile_leaves_no_trace_in_a_result(tmp_path, monkeypatch):
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    looked = []
    aside = FrontSearch.look_aside

    def counted(self, ready, report):
        aside(self, ready, report)
        looked.append(len(self.aside.designs))

    monkeypatch.setattr(FrontSearch, "look_aside", counted)
    # While it is compiled, and with what has been compiled.
    first, second = (ask().files()["designs.csv"] for _ in range(2))
    assert looked
    assert first == second


def test_a_compiler_that_takes_too_long_is_given_up(tmp_path):
    with pytest.raises(subprocess.TimeoutExpired):
        compile_shared(slow_compiler(tmp_path, 600), SOURCE, tmp_path / "code.so", [], CompilingEffort(most=0.2))


# -- beside all other work -------------------------------------------------------------------------


def beside(cc: str, place: Path, effort: CompilingEffort = USUAL) -> bool:
    return compile_beside(cc, SOURCE, place, [], effort)


def test_what_is_compiled_beside_is_there_some_time(tmp_path):
    folder, cc = tmp_path / "cache", slow_compiler(tmp_path, 0.3)
    folder.mkdir()
    place = folder / "code.so"
    assert not beside(cc, place)
    assert not place.exists()
    while not beside(cc, place):
        time.sleep(0.01)
    assert place.read_text() == "compiled"
    assert list(folder.iterdir()) == [place]


def test_what_is_needed_at_once_is_waited_for_where_it_is_begun_already(tmp_path):
    folder, cc = tmp_path / "cache", slow_compiler(tmp_path, 0.3)
    folder.mkdir()
    place = folder / "code.so"
    beside(cc, place)
    child = begun(tmp_path)
    compile_shared("/bin/false", SOURCE, place, [], USUAL)  # no other compiler is begun
    assert place.read_text() == "compiled"
    assert ended(child)
    assert list(folder.iterdir()) == [place]


def test_what_two_processes_want_is_compiled_by_one(tmp_path):
    folder, cc = tmp_path / "cache", slow_compiler(tmp_path, 0.5)
    folder.mkdir()
    place = folder / "code.so"
    with alone(place.with_suffix(".lock")):
        assert not beside(cc, place)
        time.sleep(0.1)
        assert not beside(cc, place)
        assert not (tmp_path / "child").exists()
    compile_shared(cc, SOURCE, place, [], USUAL)
    assert list(folder.iterdir()) == [place]


def test_who_needs_what_another_process_makes_waits_for_it(tmp_path):
    place = tmp_path / "code.so"

    def other(ready):
        place.write_text("made elsewhere")

    with alone(place.with_suffix(".lock")), meanwhile(other):
        compile_shared("/bin/false", SOURCE, place, [], USUAL)
    assert place.read_text() == "made elsewhere"


def test_what_cannot_be_compiled_beside_is_told_once(tmp_path):
    place = tmp_path / "code.so"
    beside("/bin/false", place)
    time.sleep(0.5)
    with pytest.raises(subprocess.CalledProcessError):
        beside("/bin/false", place)
    assert not list(tmp_path.iterdir())


def test_under_a_short_time_limit_nothing_is_begun_beside(tmp_path):
    with deadline.until(time.monotonic() + 1e6):
        assert not beside(slow_compiler(tmp_path, 0), tmp_path / "code.so", NOT_WITHIN_A_YEAR)
    assert not list(tmp_path.glob("*.lock"))
    assert not list(tmp_path.glob("code.so"))


PROGRAM = """
import sys, time
from pathlib import Path
from synth.compiled.compilation import compile_beside
from synth.tuning import CompilingEffort
cc, place = sys.argv[1], Path(sys.argv[2])
compile_beside(cc, "int one(void) { return 1; }", place, [], CompilingEffort())
while not Path(sys.argv[3]).exists():
    time.sleep(0.01)
"""


@pytest.mark.parametrize("end", ["", "raise KeyboardInterrupt", "sys.exit(3)"])
def test_a_program_that_ends_leaves_no_compiler_and_nothing_of_it(tmp_path, end):
    folder = tmp_path / "cache"
    folder.mkdir()
    given = [slow_compiler(tmp_path, 600), str(folder / "code.so"), str(tmp_path / "child")]
    subprocess.run([sys.executable, "-c", PROGRAM + end, *given], check=False, stderr=subprocess.DEVNULL)
    assert ended(begun(tmp_path))
    assert not list(folder.iterdir())


def test_a_process_of_a_pool_ends_its_compiler(tmp_path):
    folder = tmp_path / "cache"
    folder.mkdir()
    process = multiprocessing.get_context("fork").Process(
        target=beside, args=(slow_compiler(tmp_path, 600), folder / "code.so")
    )
    process.start()
    process.join()
    assert not list(folder.iterdir())


def test_a_process_that_is_forked_off_leaves_the_compiler_to_its_parent(tmp_path):
    folder, cc = tmp_path / "cache", slow_compiler(tmp_path, 0.5)
    folder.mkdir()
    place = folder / "code.so"
    beside(cc, place)
    begun(tmp_path)
    process = multiprocessing.get_context("fork").Process(target=beside, args=(cc, place))
    process.start()
    process.join()
    compile_shared("/bin/false", SOURCE, place, [], USUAL)
    assert place.read_text() == "compiled"
    assert list(folder.iterdir()) == [place]
