"""The entry point as tests run it: in a process of its own, or in this one."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

import pytest
import typer.main

from synth.terminal import batch_commands
from synth.terminal.cli import main
from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-c", "from synth.terminal.cli import main; main()"]
# A search that takes as long as one may, on machines of any speed: boxes of continuous cones never all close.
LONG_SEARCH = ["run", str(ROOT / "examples" / "cone_drive.yaml"), "--points", "500", "--gap", "1e-6", "--no-grid"]
BUILT = cache(typer.main.get_command)  # all commands, at each call anew otherwise

LACKING = """
import os, sys

class Lacking:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in os.environ["LACKING"].split():
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Lacking())
"""


def without(packages: str, *words: object) -> subprocess.CompletedProcess[str]:
    """Run it in a process of its own in which packages, told apart by blanks, cannot be imported."""
    return _run([sys.executable, "-c", f"{LACKING}{COMMAND[-1]}", *map(str, words)], ROOT, {"LACKING": packages})


def without_at_once(packages: str, *words: object) -> subprocess.CompletedProcess[str]:
    """Run it in this process, in which packages, told apart by blanks, cannot be imported meanwhile."""
    lacking = packages.split()
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in sys.modules if name.partition(".")[0] in lacking]:
            patch.delitem(sys.modules, name)
        for package in lacking:
            patch.setitem(sys.modules, package, None)
        return at_once(*words)


def clutchsynth(*words: object, folder: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run it in a process of its own, as a person does."""
    return _run([*COMMAND, *map(str, words)], folder, environment)


def _run(command: list[str], folder: Path | None, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def at_once(*words: object, folder: Path = ROOT, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run it in this process: where a search is short or none is made, imports cost most."""
    out, err = io.StringIO(), io.StringIO()
    texts = [str(word) for word in words]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.setattr(sys, "argv", ["clutchsynth", *texts])
        patch.setattr(typer.main, "get_command", BUILT)
        patch.chdir(folder)
        for name, value in environment.items():
            patch.setenv(name, value)
        with pytest.raises(SystemExit) as end:
            main()
    return subprocess.CompletedProcess(texts, int(end.value.code or 0), out.getvalue(), err.getvalue())


def in_process(*words: object, folder: Path = ROOT, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run it in this process, and the workers of a batch too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch_commands, "_processes", lambda workers: None)
        return at_once(*words, folder=folder, **environment)
