"""Every command without -o: its result is shown and nothing is written, or what is written is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import typer

from synth.terminal.cli import app
from tests.terminal.entry import at_once, in_process
from tests.terminal.test_cli import LECTURE

KEEPS = "nothing is written; -o DIR keeps the result"
GOES_ON = "without -o DIR nothing is kept: if this is stopped, the same command begins anew"
SPEC = """family: disc_clutch
requirements: {load_torque: 60 N*m, driver_speed: 1000 1/min, driven_inertia: 0.5 kg*m2}
points: 2
"""
ROWS = "load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2]\n60,1000,0.5\n80,1000,0.5\n"
FAMILY = ("--family", "disc_clutch", "--points", "1")
# What a new user types, in a folder with spec.yaml, rows.csv and front/.
SHOWN = {
    "run": ("spec.yaml",),
    "explain": ("spec.yaml",),
    "check": ("front/design_01.yaml",),
    "simulate": (LECTURE,),
    "curves": ("disc_clutch", "front/design_01.yaml"),
    "new": ("disc_clutch",),
    "near-equals": ("front", "--within", "20 %"),
    "prices": ("front", "--design", "1"),
    "rate": ("front", "--over", "friction=+10 %"),
    "whatif": ("spec.yaml", "--vary", "load_torque=60:80:20 N*m", "--no-breaks"),
}
WRITTEN = {  # and the folder for the files
    "batch": (("rows.csv", *FAMILY), "rows_batch"),
    "size-range": (("rows.csv", *FAMILY), "rows_batch"),
    "report": (("front",), "front"),
}


def options(command: Any, name: str = "") -> dict[str, dict[str, Any]]:
    """Return the options of every command by the words that name them."""
    inner = getattr(command, "commands", None)
    if inner is None:
        return {name: {word: option for option in command.params for word in option.opts}}
    return {n: found for word, x in inner.items() for n, found in options(x, f"{name} {word}".strip()).items()}


COMMANDS = options(typer.main.get_command(app))


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def front(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("front")
    (folder / "spec.yaml").write_text(SPEC)
    assert at_once("run", "spec.yaml", "-o", "front", "-q", folder=folder).returncode == 0
    return folder


@pytest.fixture
def place(front: Path, tmp_path: Path) -> Path:
    for name in files(front):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((front / name).read_bytes())
    (tmp_path / "rows.csv").write_text(ROWS)
    return tmp_path


def test_no_command_demands_a_folder_and_each_that_takes_one_is_tried_here() -> None:
    takes = {name: found["-o"] for name, found in COMMANDS.items() if "-o" in found}
    assert not [name for name, option in takes.items() if option.required]
    assert set(takes) == {*SHOWN, *WRITTEN}


@pytest.mark.slow
@pytest.mark.parametrize("command", list(SHOWN))
def test_without_a_folder_the_result_is_shown_and_nothing_written(place: Path, command: str) -> None:
    before = files(place)
    done = at_once(command, *SHOWN[command], folder=place)
    assert done.returncode == 0, done.stderr
    assert files(place) == before
    shown = " ".join(done.stdout.split())
    assert shown
    for name in ("whatif.csv", "prices.csv"):
        assert shown.count(name) == shown.count(f"{name} with -o DIR")
    if command not in ("explain", "check", "new"):  # what these have to say is on the screen
        assert done.stdout.splitlines()[-1] == KEEPS
    assert (GOES_ON in done.stderr) == (command in ("prices", "whatif"))


@pytest.mark.slow
@pytest.mark.parametrize("command", [name for name in SHOWN if "--quiet" in COMMANDS[name]])
def test_quietly_the_exit_code_alone_tells(place: Path, command: str) -> None:
    done = at_once(command, *SHOWN[command], "--quiet", folder=place)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.slow
@pytest.mark.parametrize("command", list(WRITTEN))
def test_what_is_made_of_files_has_a_folder_of_its_own_accord(place: Path, command: str) -> None:
    words, folder = WRITTEN[command]
    before = files(place)
    done = in_process(command, *words, folder=place)
    assert done.returncode == 0, done.stderr
    new = files(place) - before
    assert new
    assert all(name.startswith(f"{folder}/") for name in new)
    assert f"written to {folder}: " in " ".join(done.stdout.split())
    assert (f"the results go to {folder}; -o DIR names another folder" in done.stderr) == (command != "report")


@pytest.mark.parametrize("command", ["batch", "size-range"])
def test_a_table_that_is_wrong_leaves_no_folder(tmp_path: Path, command: str) -> None:
    (tmp_path / "rows.csv").write_text(ROWS.replace("load_torque", "lod_torque"))
    done = in_process(command, "rows.csv", *FAMILY, folder=tmp_path)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert [path.name for path in tmp_path.iterdir()] == ["rows.csv"]


@pytest.mark.slow
def test_rows_go_on_in_the_folder_that_was_chosen_for_them(place: Path) -> None:
    (place / "Tabelle 1.2.csv").write_text(ROWS)
    words = ("batch", "Tabelle 1.2.csv#encoding=utf-8", *FAMILY)
    first = in_process(*words, folder=place)
    assert (first.returncode, "written to Tabelle 1.2_batch: " in first.stdout) == (0, True)
    made = (place / "Tabelle 1.2_batch" / "designs.csv").read_bytes()
    quiet = in_process(*words, "--quiet", folder=place)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")
    assert (place / "Tabelle 1.2_batch" / "designs.csv").read_bytes() == made


@pytest.mark.slow
@pytest.mark.parametrize("command", ["whatif", "prices"])
def test_what_was_stopped_promises_no_going_on(place: Path, command: str) -> None:
    before = files(place)
    done = at_once(command, *SHOWN[command], "--time-limit", "1e-9", folder=place)
    assert done.returncode == 4, done.stderr
    assert "run again to go on" not in done.stdout
    assert "kept, " not in done.stdout
    assert files(place) == before
