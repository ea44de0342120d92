"""A spec to start from: what is written reads back, asks what is asked without it, and says what is missing."""

from __future__ import annotations

import os
import pty
import sys
import threading
from pathlib import Path

import pytest
import yaml

from synth.analysis.describe import described
from synth.analysis.spec_template import needed, spec_template
from synth.model.registry import load
from synth.question.spec import read_spec
from tests.shipped import FAMILIES
from tests.terminal.entry import COMMAND, at_once, clutchsynth

DUTY = ("load_torque=600 N*m", "driver_speed=254 rpm", "driven_inertia=30 kg*m2")


def some_value(row: dict[str, object]) -> str:
    """Return a value of a requirement that its range allows."""
    return f"{row['lower']!r} {row['unit']}" if row["unit"] not in ("", "-") else repr(row["lower"])


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_the_spec_of_every_family_reads_back_and_asks_what_is_asked_without_it(family: str, tmp_path: Path) -> None:
    problem = load(family)
    stated = {row["name"]: some_value(row) for row in needed(row for row in described(problem))}
    text = spec_template(problem, stated)
    assert all(len(line) <= 100 for line in text.splitlines())
    content = yaml.safe_load(text)
    assert content["requirements"] == stated
    assert set(content) == {"family", "requirements", "objectives", "points"}
    (tmp_path / "own.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "bare.yaml").write_text(yaml.safe_dump({"family": family, "requirements": stated}), encoding="utf-8")
    own, bare = (read_spec(tmp_path / name).request() for name in ("own.yaml", "bare.yaml"))
    assert own.requirements == bare.requirements
    assert (own.problem.options, own.limits, own.fix, own.parts) == (bare.problem.options, {}, {}, {})
    chosen = {row["name"] for row in described(problem) if row["kind"] == "objective" and row["default"] == "yes"}
    assert set(own.objectives or ()) == chosen


def test_everything_that_is_declared_stands_in_it() -> None:
    text = spec_template(load("multi_plate_clutch"), {})
    for row in described("multi_plate_clutch"):
        if row["kind"] in ("option", "requirement", "variable", "count", "slot"):
            assert f"  {row['name']}: " in text.replace("# ", "") or f"  {row['name']}:\n" in text, row["name"]


def test_a_file_is_written_once_and_what_is_left_is_told(tmp_path: Path) -> None:
    done = at_once("new", "multi_plate_clutch", DUTY[0], "-o", tmp_path / "own" / "drive.yaml")
    assert done.returncode == 0
    assert done.stdout.splitlines()[1] == "to be filled in: driver_speed, driven_inertia"
    file = tmp_path / "own" / "drive.yaml"
    assert f"clutchsynth run {file} -o out/" in file.read_text()
    again = at_once("new", "multi_plate_clutch", "-o", file)
    assert (again.returncode, again.stdout) == (2, "")
    assert "not there yet" in again.stderr
    missing = at_once("run", file)
    assert missing.returncode == 2
    assert "driver_speed: is missing" in missing.stderr


def test_a_torque_is_needed_until_a_word_for_it_is_stated() -> None:
    for family, torque in (("cone_clutch", "load_torque"), ("centrifugal_lever", "required_torque")):
        for stated, left in (({}, {torque}), ({"power": "15 kW"}, set()), ({"required_torque": "90 N*m"}, set())):
            rows = needed(described(family, stated=stated))
            assert {row["name"] for row in rows} & {"load_torque", "required_torque"} - set(stated) == left
    text = spec_template(load("roller_coupling"), {"power": "15 kW"})
    default = "  # Torque to transmit; by default safety_factor*(power/power_speed)\n  # required_torque: ... N*m\n"
    assert default in text


def test_symbols_stand_for_names_and_options_that_differ_are_stated(tmp_path: Path) -> None:
    shown = at_once("new", "multi_plate_clutch", "M_load=600 N*m", "--option", "lubrication=dry").stdout
    content = yaml.safe_load(shown)
    assert content["requirements"]["load_torque"] == "600 N*m"
    assert content["options"] == {"lubrication": "dry"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("no_such_clutch",), "family"),
        (("multi_plate_clutch", "torque=5 N*m"), "a requirement of multi_plate_clutch: power, "),
        (("multi_plate_clutch", "load_torque=5 kg"), "kg measures a mass"),
        (("multi_plate_clutch", "load_torque=-1 N*m"), "0 .. 1·10⁷ N*m"),
        (("multi_plate_clutch", "load_torque"), "name=value"),
    ],
)
def test_slips_are_told_in_one_sentence_and_nothing_is_written(
    words: tuple[str, ...], told: str, tmp_path: Path
) -> None:
    done = at_once("new", *words, "-o", tmp_path / "own.yaml")
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_terminal_asks_for_what_is_needed_until_it_is_right(tmp_path: Path) -> None:
    file = tmp_path / "drive.yaml"
    words = [*COMMAND, "new", "multi_plate_clutch", DUTY[0], "-o", str(file)]
    child, terminal = pty.fork()
    if child == 0:
        os.execv(sys.executable, words)
    answers = iter((b"254 kg\n", b"254 rpm\n", b"\n"))
    shown = b""
    timer = threading.Timer(60.0, os.kill, (child, 9))
    timer.start()
    try:
        asked = 0
        while True:
            try:
                shown += os.read(terminal, 4096)
            except OSError:  # the other end is closed
                break
            while shown.count(b"driving side:") + shown.count(b"that of the machine:") > asked:
                asked += 1
                os.write(terminal, next(answers))
    finally:
        timer.cancel()
        os.waitpid(child, 0)
    assert b"kg measures a mass" in shown
    assert yaml.safe_load(file.read_text())["requirements"]["driver_speed"] == "254 rpm"
    assert b"to be filled in: driven_inertia" in shown


@pytest.mark.slow
def test_run_without_a_folder_shows_and_writes_nothing(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(
        "family: cone_clutch\npoints: 3\n"
        "requirements: {load_torque: 60 N*m, driver_speed: 1500 1/min, driven_inertia: 0.5 kg*m2}\n"
    )
    done = at_once("run", spec, folder=tmp_path)
    assert done.returncode == 0
    assert "#1" in done.stdout
    assert done.stdout.splitlines()[-1] == "nothing is written; -o DIR keeps the result"
    assert [path.name for path in tmp_path.iterdir()] == ["spec.yaml"]
    several = tmp_path / "several.yaml"
    several.write_text(spec.read_text().replace("cone_clutch", "[cone_clutch, disc_clutch]"))
    assert at_once("run", several, folder=tmp_path).stdout.splitlines()[-1].startswith("nothing is written")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["several.yaml", "spec.yaml"]
    quiet = at_once("run", spec, "--quiet", folder=tmp_path)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")


@pytest.mark.slow
def test_shells_complete_commands_and_families() -> None:
    complete = {"_CLUTCHSYNTH_COMPLETE": "complete_bash"}
    commands = clutchsynth(**complete, COMP_WORDS="clutchsynth ne", COMP_CWORD="1").stdout.split()
    assert commands == ["near-equals", "new"] or commands == ["new", "near-equals"]
    families_begun = clutchsynth(**complete, COMP_WORDS="clutchsynth new wrap", COMP_CWORD="2").stdout.split()
    assert families_begun == ["wrap_spring", "wrap_spring_actuated"]
