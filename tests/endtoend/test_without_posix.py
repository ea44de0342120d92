"""The six commands do on a system without POSIX what they do here: the same files, byte for byte but for times.

This is Linux with what Windows has not taken away (``no_posix.py``), no Windows: neither its file systems nor the
libraries of others on it are tried.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]
BEGIN = "from tests.endtoend.no_posix import begin\nbegin()\n"
MAIN = "from synth.terminal.cli import main; main()"
SPEC = """family: multi_plate_clutch
requirements: {load_torque: 600 N*m, driver_speed: 254 rpm, driven_inertia: 30 kg*m2, slip_time_limit: 4 s}
parts: {friction_pair: [paper_wet], inner_plate: [core 2.5], outer_plate: [core 2]}
limits: {friction_surfaces: "8 .. 12", outer_diameter: "<= 200 mm"}
fix: {ramp_time: 2 s}
points: 2
"""
SMALL = """family: cone_clutch
requirements: {load_torque: 200 N*m, driver_speed: 700 rpm, driven_inertia: 0.5 kg*m2}
options: {practice: off}
limits: {outer_diameter: "<= 60 mm"}
fix: {ramp_time: 0.3 s}
"""
ROWS = """id,load_torque [N*m],driver_speed [rpm],driven_inertia [kg*m2],guide_model,practice,ramp_time [s],parts,limits
A1,600,254,30,cz,off,2,PARTS,friction_surfaces == 10
Größe 2,450,254,30,cz,off,2,PARTS,friction_surfaces == 10
""".replace("PARTS", "friction_pair = seed_multiplate_ref; inner_plate = core 4; outer_plate = core 2")
COMMANDS = {
    "run": ("run", "spec.yaml", "-o", "my clutches"),
    "again": ("run", "spec.yaml", "-o", "my clutches"),  # a result takes the place of another
    "check": ("check", "my clutches/design_01.yaml", "-o", "checked"),
    "report": ("report", "my clutches", "-o", "handed on"),
    "whatif": ("whatif", "spec.yaml", "--vary", "load_torque=500:600:100 N*m", "-o", "varied"),
    "explain": ("explain", "small.yaml", "-o", "why"),
    "batch": ("batch", "rows.csv", "-o", "rows", "--family", "multi_plate_clutch", "--points", "1", "--workers", "2"),
}
ENDS = {"explain": 3}  # nothing is feasible
# What tells how long something took or where it stands, and the checksums of files that tell it.
VARIES = re.compile(
    rb'"(?:bounds|coarse|extremes|front|first|report|total)": \d+\.\d+|"(?:digest|rows\.csv)": "[0-9a-f]{64}"'
    rb'|"database": "[^"]*"'
    rb"|(?<=,)\d+\.\d{3}(?=,global,)"
)


def did(folder: Path, words: tuple[str, ...], **environment: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-c", MAIN, *words],
        cwd=folder,
        env={"PATH": str(folder / "nothing"), "HOME": str(folder / "home"), **environment},
        capture_output=True,
        timeout=PATIENCE,
        check=False,
    )


def prepared(folder: Path) -> Path:
    folder.mkdir()
    for name, text in {
        "spec.yaml": SPEC,
        "small.yaml": SMALL,
        "rows.csv": ROWS,
        "begin/sitecustomize.py": BEGIN,
    }.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return folder


def without_posix(folder: Path) -> dict[str, str]:
    """Return the variables of a process that begins so; what it writes to is of Windows in Western Europe."""
    return {
        "PYTHONPATH": os.pathsep.join([str(folder / "begin"), str(ROOT)]),
        "PYTHONIOENCODING": "cp1252",
        "PYTHONUTF8": "0",
        "PYTHONCOERCECLOCALE": "0",
        "LC_ALL": "C",
        "LOCALAPPDATA": str(folder / "local"),
        "CLUTCHSYNTH_WATCHED": str(folder),
    }


def files(folder: Path) -> dict[str, bytes]:
    places = [folder / words[words.index("-o") + 1] for words in COMMANDS.values()]
    found = [path for place in places for path in place.rglob("*") if path.is_file() and path.suffix != ".sqlite"]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The folder of a process as it is, and that of one without POSIX, after all commands."""
    place = tmp_path_factory.mktemp("systems")
    here, there = prepared(place / "a"), prepared(place / "b")
    for name, words in COMMANDS.items():
        for folder, variables in ((here, {"PYTHONPATH": str(ROOT)}), (there, without_posix(there))):
            if folder == here and name == "again":
                continue
            done = did(folder, words, **variables)
            assert done.returncode == ENDS.get(name, 0), f"{folder.name} {name}: {done.stdout!r} {done.stderr!r}"
    return here, there


ASKED = """
import synth.system.file_locks, synth.system.interrupts, synth.system.operating_system as system
from pathlib import Path
print(system.ENDING[-1].name, system.cache_home())
for line in ("synth.system.file_locks.os.kill(1, 0)", "system.os.fork()", "synth.system.interrupts.signal.SIGKILL"):
    try:
        eval(line)
    except AttributeError as error:
        print(error)
try:
    exec("import fcntl", {"__name__": "synth.x"})
except ImportError as error:
    print("no", error)
with open("held.txt", "w") as file:
    try:
        Path("held.txt").unlink()
    except PermissionError as error:
        print(error.strerror, system.is_held(Path("held.txt")))
print(system.is_held(Path("held.txt")))
"""


def test_the_process_without_posix_is_without(tmp_path: Path) -> None:
    folder = prepared(tmp_path / "b")
    done = subprocess.run(
        [sys.executable, "-c", ASKED],
        cwd=folder,
        env={"PATH": "", **without_posix(folder)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == [
        f"SIGUSR2 {folder / 'local'}",
        "module 'os' has no attribute 'kill'",
        "module 'os' has no attribute 'fork'",
        "module 'signal' has no attribute 'SIGKILL'",
        "no fcntl",
        "The process cannot access the file True",
        "False",
    ]


@pytest.mark.slow
def test_all_files_are_the_same(both: tuple[Path, Path]) -> None:
    here, there = map(files, both)
    assert {path.split("/")[0] for path in here} == {words[words.index("-o") + 1] for words in COMMANDS.values()}
    assert sorted(here) == sorted(there)  # also: neither a lock nor anything half done is left
    for name, content in here.items():
        assert VARIES.sub(b"", content) == VARIES.sub(b"", there[name]), name
