"""What is asked for often is compiled for programs to come: by a process that nobody waits for, all or nothing."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from synth.file_locks import is_taken
from tests.compiled.test_compilation import alive, begun, ended, slow_compiler

PROGRAM = """
import multiprocessing, sys
from pathlib import Path
from synth.compiled.demand import demand_for
from synth.tuning import CompilingEffort
compiler, folder, *used = sys.argv[1:]

def use(name, times):
    demand = demand_for([compiler], "int one(void) { return 1; }", Path(folder, name), CompilingEffort(), 100)
    demand.here += float(times)

for each in used:
    use(*each.split("="))
"""
FORKED = """
process = multiprocessing.get_context("fork").Process(target=use, args=("of_child.so", "150"))
process.start()
process.join()
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "cache"
    made.mkdir()
    return made


def program(compiler: str, folder: Path, *used: str, more: str = "") -> None:
    """Run a program that uses libraries so often."""
    subprocess.run([sys.executable, "-c", PROGRAM + more, compiler, str(folder), *used], check=True)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def soon(holds: Callable[[], bool]) -> bool:
    """Wait until something holds; tell whether it does."""
    for _ in range(1000):
        if holds():
            return True
        time.sleep(0.01)
    return False


def test_what_adds_up_over_programs_is_compiled_when_one_ends(tmp_path, folder):
    compiler = slow_compiler(tmp_path, 0.2)
    program(compiler, folder, "code.so=40")
    program(compiler, folder, "code.so=40")
    assert names(folder) == ["code.demand"]
    program(compiler, folder, "code.so=40")
    assert soon(lambda: names(folder) == ["code.so"])
    assert (folder / "code.so").read_text() == "compiled"
    program(compiler, folder, "code.so=400")
    assert names(folder) == ["code.so"]


def test_nobody_waits_and_one_library_is_compiled_at_a_time(tmp_path, folder):
    compiler = slow_compiler(tmp_path, 600)
    program(compiler, folder, "few.so=120", "many.so=500")  # returns, while the compiler has ten minutes to go
    child = begun(tmp_path)
    assert alive(child)
    assert is_taken(folder / "many.lock")
    assert (folder / "few.demand").read_text() == "120"
    program(compiler, folder, "many.so=500")  # which is made already
    assert len([name for name in names(folder) if name.startswith("compiling_")]) == 1
    os.killpg(os.getpgid(child), 9)
    assert ended(child)
    assert not (folder / "many.so").exists()
    # What was killed keeps nobody out.
    (tmp_path / "child").unlink()
    program(slow_compiler(tmp_path, 0), folder, "many.so=500")
    assert soon(lambda: (folder / "many.so").exists())


def test_what_cannot_be_compiled_leaves_nothing(folder):
    program("/bin/false", folder, "code.so=500")
    assert soon(lambda: not names(folder))


def test_a_process_that_is_forked_off_notes_what_it_has_used_itself(tmp_path, folder):
    compiler = slow_compiler(tmp_path, 0)
    program(compiler, folder, "code.so=40", more=FORKED)
    assert soon(lambda: names(folder) == ["code.demand", "of_child.so"])
    assert (folder / "code.demand").read_text() == "40"


def test_what_is_unreadable_counts_as_nothing(folder):
    (folder / "code.demand").write_text("")
    program("/bin/false", folder, "code.so=40")
    assert (folder / "code.demand").read_text() == "40"
