"""Folders of results: what replaces what, all files or none, one writer at a time."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import synth
from synth.folders import output_folder
from synth.folders.output_folder import (
    FRONT,
    MANIFEST,
    NEAR_EQUALS,
    NEW,
    RATING,
    READY,
    check_kind,
    claimed,
    place_for_stopped,
    replaced,
    save_files,
    save_result,
    settle,
)

OLD = {"front.json": "old\n", "designs.csv": "old\n", "design_01.yaml": "old\n", "design_02.yaml": "old\n"}
FRESH = {"front.json": "new\n", "designs.csv": "new\n", "design_01.yaml": "new\n", "robust.csv": "new\n"}
POSIX = pytest.mark.skipif(os.name != "posix", reason="locks, signals and limits of POSIX")


def texts(folder: Path) -> dict[str, str]:
    return {str(p.relative_to(folder)): p.read_text() for p in sorted(folder.rglob("*")) if p.is_file()}


# ---- what replaces what ---------------------------------------------------------------------------------------------


def test_a_finished_result_takes_the_place_of_an_earlier_one_with_all_its_files(tmp_path: Path) -> None:
    assert save_result(tmp_path / "a" / "b", OLD, FRONT, stopped=False) == tmp_path / "a" / "b"
    (tmp_path / "a" / "b" / "notes.txt").write_text("mine")
    assert save_result(tmp_path / "a" / "b", FRESH, FRONT, stopped=False) == tmp_path / "a" / "b"
    assert texts(tmp_path / "a" / "b") == {**FRESH, "notes.txt": "mine"}


def test_a_stopped_result_stands_beside_an_earlier_one_every_time(tmp_path: Path) -> None:
    save_result(tmp_path, OLD, FRONT, stopped=False)
    for name in ("stopped", "stopped_2"):
        assert save_result(tmp_path, FRESH, FRONT, stopped=True) == tmp_path / name
        assert texts(tmp_path / name) == FRESH
    assert {k: v for k, v in texts(tmp_path).items() if "/" not in k} == OLD


def test_a_stopped_result_stands_in_the_folder_where_there_is_no_other(tmp_path: Path) -> None:
    assert save_result(tmp_path, OLD, FRONT, stopped=True) == tmp_path
    assert texts(tmp_path) == OLD
    # That it was stopped as well makes the earlier one no less a result.
    assert save_result(tmp_path, FRESH, FRONT, stopped=True) == tmp_path / "stopped"
    assert save_result(tmp_path, FRESH, FRONT, stopped=True, supersedes=True) == tmp_path
    assert {k: v for k, v in texts(tmp_path).items() if "/" not in k} == FRESH


def test_a_search_that_was_stopped_before_it_found_anything_is_no_result(tmp_path: Path) -> None:
    nothing = {"front.json": json.dumps({"interrupted": "time limit", "designs": []}), "designs.csv": "rank\n"}
    save_result(tmp_path, nothing, FRONT, stopped=True)
    assert save_result(tmp_path, FRESH, FRONT, stopped=True) == tmp_path
    # That nothing is feasible is one.
    infeasible = {**nothing, "front.json": json.dumps({"interrupted": "", "designs": []})}
    save_result(tmp_path, infeasible, FRONT, stopped=False)
    assert save_result(tmp_path, FRESH, FRONT, stopped=True) == tmp_path / "stopped"


def test_families_of_an_earlier_comparison_go_with_it(tmp_path: Path) -> None:
    record = json.dumps({"families": [{"folder": "one"}, {"folder": "two"}, {"folder": None}, {"folder": "../x"}]})
    own = {f"{name}/{file}": text for name in ("one", "two") for file, text in OLD.items()}
    (tmp_path / "out").mkdir()
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "front.json").write_text("somebody else's")
    save_result(tmp_path / "out", {"comparison.json": record, "designs.csv": "old\n", **own}, FRONT, stopped=False)
    (tmp_path / "out" / "two" / "notes.txt").write_text("mine")
    save_result(tmp_path / "out", FRESH, FRONT, stopped=False)
    assert texts(tmp_path / "out") == {**FRESH, "two/notes.txt": "mine"}
    assert not (tmp_path / "out" / "one").exists()
    assert (tmp_path / "x" / "front.json").exists()


def test_results_of_commands_with_files_of_the_same_name_do_not_mix(tmp_path: Path) -> None:
    save_result(tmp_path, OLD, FRONT, stopped=False)
    for kind in (NEAR_EQUALS, RATING):
        with pytest.raises(synth.InputError, match=r"another folder: .* of clutchsynth run would be lost"):
            save_result(tmp_path, {kind.marks[0]: "x"}, kind, stopped=False)
    check_kind(tmp_path, output_folder.PRICES)
    assert texts(tmp_path) == OLD


# ---- all files or none ----------------------------------------------------------------------------------------------


def test_what_goes_wrong_while_files_are_written_changes_nothing(tmp_path: Path) -> None:
    save_files(tmp_path, OLD)

    def fail() -> None:
        with replaced(tmp_path) as new:
            new.write("front.json", "new")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert texts(tmp_path) == OLD
    (tmp_path / "robust.csv").mkdir()
    with pytest.raises(synth.InputError, match="a folder that can be written"):
        save_files(tmp_path, FRESH)
    assert texts(tmp_path) == OLD
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([*OLD, "robust.csv"])


@pytest.mark.parametrize("name", ["../outside", "/tmp/outside", "a/../../b"])
def test_nothing_is_written_outside_of_the_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"outside|b"):
        save_files(tmp_path / "out", {name: "x"})
    ready = tmp_path / READY
    ready.mkdir()
    (ready / MANIFEST).write_text(json.dumps({"files": [], "dropped": [name]}))
    with pytest.raises(synth.InputError, match="a folder of ours"):
        settle(tmp_path)


WRITER = """
import json, os, signal, sys
from pathlib import Path
from synth.folders.output_folder import FRONT, save_result

place, old, fresh = Path(sys.argv[1]), json.loads(sys.argv[2]), json.loads(sys.argv[3])

def killed_at(owner, name):
    own = getattr(owner, name)
    def call(*args, **more):
        global left
        left -= 1
        if left == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return own(*args, **more)
    setattr(owner, name, call)

at, ended = 0, 9
while ended == 9:
    at += 1
    save_result(place / str(at), old, FRONT, False)
    child = os.fork()
    if child == 0:
        left = at
        for owner, name in ((os, "fsync"), *((Path, n) for n in ("rename", "replace", "unlink", "mkdir"))):
            killed_at(owner, name)
        save_result(place / str(at), fresh, FRONT, False)
        os._exit(0)
    ended = os.waitpid(child, 0)[1]
print(at, ended)
"""


@pytest.mark.slow
@POSIX
def test_a_process_that_is_killed_at_any_moment_leaves_the_old_files_or_the_new_ones(tmp_path: Path) -> None:
    command = [sys.executable, "-c", WRITER, str(tmp_path), json.dumps(OLD), json.dumps(FRESH)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, ended = map(int, done.stdout.split())
    assert ended == 0
    stands = []
    for at in range(1, count + 1):
        folder = tmp_path / str(at)
        settle(folder)
        found = {k: v for k, v in texts(folder).items() if not k.startswith(".")}
        assert found in (OLD, FRESH), at
        stands.append(found == FRESH)
        # Whoever comes next finds the folder free and in order.
        save_result(folder, OLD, FRONT, stopped=False)
        assert texts(folder) == OLD
        assert not (folder / NEW).exists()
    assert stands == sorted(stands), "once the new one is complete it stays"
    assert stands.count(False) > 5
    assert stands.count(True) > 5


def _limited(folder: str, size: int) -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    try:
        save_result(Path(folder), {**FRESH, "designs.csv": "x" * 5000}, FRONT, stopped=False)
    except synth.InputError as error:
        print(error)
        sys.exit(2)


@POSIX
def test_where_there_is_no_room_nothing_changes(tmp_path: Path) -> None:
    save_result(tmp_path, OLD, FRONT, stopped=False)
    process = multiprocessing.get_context("spawn").Process(target=_limited, args=(str(tmp_path), 4096))
    process.start()
    process.join()
    assert process.exitcode == 2
    assert texts(tmp_path) == OLD
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(OLD)


@contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Path]:
    folder.mkdir()
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)], capture_output=True, check=False
    )
    if done.returncode:
        pytest.skip("no right to mount a small disk")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.skipif(not sys.platform.startswith("linux") or os.geteuid() != 0, reason="only root can mount a disk")
def test_a_full_disk_keeps_the_earlier_result(tmp_path: Path) -> None:
    with small_disk(tmp_path / "disk", 64) as disk:
        save_result(disk / "out", OLD, FRONT, stopped=False)
        with pytest.raises(synth.InputError, match="No space left on device"):
            save_result(disk / "out", {**FRESH, "designs.csv": "x" * 100_000}, FRONT, stopped=False)
        assert texts(disk / "out") == OLD
        with pytest.raises(synth.InputError, match="No space left on device"):
            save_result(disk / "out", {**FRESH, "designs.csv": "x" * 100_000}, FRONT, stopped=True)
        assert sorted(p.name for p in (disk / "out").iterdir()) == sorted(OLD)


# ---- one writer at a time -------------------------------------------------------------------------------------------

HOLDER = """
import sys, time
from pathlib import Path
from synth.folders.output_folder import claimed
with claimed(Path(sys.argv[1]), sys.argv[2]):
    print("held", flush=True)
    time.sleep(60)
"""


@contextmanager
def held(folder: Path, job: str = "") -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(folder), job], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        try:
            yield process
        finally:
            process.kill()


@POSIX
def test_a_second_job_is_refused_until_the_first_has_ended_however_it_ends(tmp_path: Path) -> None:
    with held(tmp_path) as process:
        for attempt in (lambda: claimed(tmp_path).__enter__(), lambda: save_result(tmp_path, OLD, FRONT, False)):
            with pytest.raises(synth.InputError, match=f"nobody writes into .*process {process.pid} "):
                attempt()
        assert texts(tmp_path).keys() == {output_folder.LOCK}
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert (tmp_path / output_folder.LOCK).exists(), "killed at once, nobody took it away"
    save_result(tmp_path, OLD, FRONT, stopped=False)
    assert texts(tmp_path) == OLD


@POSIX
def test_processes_of_one_job_share_its_folder_and_no_others(tmp_path: Path) -> None:
    with held(tmp_path, "job 1"):
        with claimed(tmp_path, "job 1"):
            save_files(tmp_path, {"designs.csv": "new\n"})
        for job in ("job 2", ""):
            with pytest.raises(synth.InputError, match="nobody writes into"), claimed(tmp_path, job):
                pass
    with claimed(tmp_path, "job 2"):
        pass
    assert texts(tmp_path) == {"designs.csv": "new\n"}


def test_a_claim_may_be_taken_again_by_who_has_it_and_leaves_no_empty_folders(tmp_path: Path) -> None:
    with claimed(tmp_path / "a" / "b"), claimed(tmp_path / "a" / "b"):
        assert (tmp_path / "a" / "b").is_dir()
    assert list(tmp_path.iterdir()) == []
    assert place_for_stopped(tmp_path, FRONT) == tmp_path


@POSIX
def test_ctrl_c_waits_until_all_is_saved(tmp_path: Path) -> None:
    def impatient(press: Callable[[], None]) -> None:
        with replaced(tmp_path) as new:
            new.write("a.txt", "1")
            press()
            new.write("b.txt", "2")

    with pytest.raises(KeyboardInterrupt):
        impatient(lambda: os.kill(os.getpid(), signal.SIGINT))
    assert texts(tmp_path) == {"a.txt": "1", "b.txt": "2"}


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root can be somebody else")
def test_what_somebody_else_has_left_is_in_nobodys_way() -> None:
    program = (
        "import json, os, sys\nfrom pathlib import Path\nfrom synth.folders.output_folder import FRONT, save_result\n"
        "os.setuid(65534)\nsave_result(Path(sys.argv[1]), json.loads(sys.argv[2]), FRONT, False)"
    )
    with tempfile.TemporaryDirectory() as name:  # pytest's own folders are for one user
        folder = Path(name)
        folder.chmod(0o777)
        (folder / output_folder.LOCK).touch(mode=0o644)
        subprocess.run([sys.executable, "-c", program, name, json.dumps(OLD)], check=True)
        assert texts(folder) == OLD
