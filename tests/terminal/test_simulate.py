"""``clutchsynth simulate`` and ``clutchsynth curves`` as a user meets them."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
import yaml

from synth.results import drawings
from tests.terminal.entry import at_once, clutchsynth
from tests.terminal.test_cli import HEAVY, HOIST, LECTURE, quantity, refused
from tests.waiting import PATIENCE

SIMULATED = ["second_opinion.csv", "startup.csv", "startup.svg", "temperature.csv", "temperature.svg"]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def changed(tmp_path: Path, **changes: Any) -> Path:
    """Write the lecture's design with some of its requirements, options or values changed."""
    design = yaml.safe_load(LECTURE.read_text())
    for key, values in changes.items():
        design[key] = {name: value for name, value in {**design[key], **values}.items() if value is not None}
    path = tmp_path / "design.yaml"
    path.write_text(yaml.safe_dump(design))
    return path


@pytest.mark.slow
def test_simulating_the_lecture_draws_it_and_confirms_the_closed_forms(tmp_path: Path) -> None:
    done = clutchsynth("simulate", LECTURE, "-o", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == SIMULATED
    for line in (
        "Multi-plate clutch, start-up: lock-up after 3.218 s, friction work 39 524 J",
        "load starts 1.111 s, ramp ends 2 s, lock-up 3.218 s",
        f"written to {tmp_path / 'out'}: {', '.join(SIMULATED)}",
    ):
        assert line in " ".join(done.stdout.split())
    assert quantity(done.stdout, "slip time") == "slip time 3.218 s 3.218 s 0 s 0 %"
    assert quantity(done.stdout, "friction work") == "friction work 39 524 J 39 524 J 0 J 0 %"
    assert quantity(done.stdout, "peak slip power") == "peak slip power 21 704 W 21 704 W 0 W 0 %"
    opinion = {row["quantity"]: row for row in rows(tmp_path / "out" / "second_opinion.csv")}
    assert float(opinion["friction_work"]["simulation"]) == pytest.approx(39524.1006, abs=1e-3)
    assert abs(float(opinion["friction_work"]["relative_difference"])) < 1e-9
    # The heat comes over three seconds instead of at once; a little of it is gone before the peak.
    assert -0.02 < float(opinion["peak_temperature_rise"]["relative_difference"]) < -0.001
    course = rows(tmp_path / "out" / "startup.csv")
    assert float(course[0]["time [s]"]) == 0
    assert float(course[-1]["friction_work [J]"]) == pytest.approx(39524.1006, abs=1e-3)
    for name in ("startup", "temperature"):
        text = (tmp_path / "out" / f"{name}.svg").read_text(encoding="utf-8")
        assert ET.fromstring(text).tag == "{http://www.w3.org/2000/svg}svg"
        assert "<!-- time [" in text
    svg = (tmp_path / "out" / "startup.svg").read_text(encoding="utf-8")
    for label in ("torque [N m]", "speed [1/min]", "acceleration [rad/s²]", "power [kW]", "work [kJ]", "lock-up"):
        assert f"<!-- {label} -->" in svg
    # the same input gives the same bytes
    at_once("simulate", LECTURE, "-o", tmp_path / "again")
    for name in SIMULATED:
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "out" / name).read_bytes(), name


@pytest.mark.slow
def test_a_motor_makes_a_difference_that_is_told(tmp_path: Path) -> None:
    done = at_once("simulate", LECTURE, "-o", tmp_path, "--set", "motor=IEC4P-11kW", "--set", "ramp=smooth")
    assert done.returncode == 0
    row = next(r for r in rows(tmp_path / "second_opinion.csv") if r["quantity"] == "friction_work")
    difference = float(row["simulation"]) - float(row["closed_form"])
    assert float(row["difference"]) == pytest.approx(difference)
    assert float(row["relative_difference"]) == pytest.approx(difference / float(row["closed_form"]))
    assert -0.3 < float(row["relative_difference"]) < -0.1
    assert "driver IEC4P-11kW (Kloss)" in (tmp_path / "startup.svg").read_text(encoding="utf-8")
    weak = at_once("simulate", LECTURE, "-o", tmp_path / "weak", "--set", "motor=IEC4P-5.5kW")
    assert weak.returncode == 0
    assert "the driver stalls" in weak.stdout


def test_a_clutch_that_never_starts_is_shown_slipping(tmp_path: Path) -> None:
    path = changed(tmp_path, requirements={"startup_torque": None}, values={"F0": "5000 N"})
    done = at_once("simulate", path, "-o", tmp_path / "out", "--set", "time_limit=9 s")
    assert done.returncode == 0
    assert "no lock-up within 9 s" in done.stdout
    assert "limits violated: torque capacity, never starts" in done.stdout
    assert quantity(done.stdout, "slip time") == "slip time does not exist does not exist does not exist"
    assert not (tmp_path / "out" / "temperature.csv").exists()


@pytest.mark.slow
def test_worst_case_friction_is_simulated_from_both_sides(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        options={"friction_basis": "worst_case"},
        requirements={"startup_torque": None},
        values={"F0": "20 kN", "z": 12},
    )
    design = yaml.safe_load(path.read_text())
    design["parts"]["friction_pair"] = "paper_wet"
    path.write_text(yaml.safe_dump(design))
    done = at_once("simulate", path, "-o", tmp_path / "out")
    assert done.returncode == 0
    assert (tmp_path / "out" / "startup_high_friction.svg").exists()
    for row in rows(tmp_path / "out" / "second_opinion.csv"):
        if row["quantity"] != "peak_temperature_rise":
            assert abs(float(row["relative_difference"])) < 1e-6, row["quantity"]


@pytest.mark.slow
def test_curves_of_a_design_and_of_a_requirement(tmp_path: Path) -> None:
    done = at_once("curves", "multi_plate_clutch", LECTURE, "-o", tmp_path / "design")
    assert (done.returncode, done.stderr) == (0, "")
    names = {path.name for path in (tmp_path / "design").iterdir()}
    stems = ("torque_over_plates", "force_along_pack", "startup_over_torque")
    assert names == {f"{stem}.{ending}" for stem in stems for ending in ("csv", "svg")}
    torque = rows(tmp_path / "design" / "torque_over_plates.csv")
    built = next(row for row in torque if row["friction_surfaces [-]"] == "10")
    assert float(built["no guide friction [N*m]"]) == pytest.approx(1411.76, abs=0.01)
    order = [
        float(built[f"{series} [N*m]"])
        for series in (
            "geometric series (5)",
            "Lipka's sum (5'')",
            "exact balance",
            "exponential sum (10)",
            "no guide friction",
        )
    ]
    assert order == sorted(order)
    texts = (tmp_path / "design" / "torque_over_plates.svg").read_text(encoding="utf-8")
    for mark in (r"worth while to [0-9.]+ \(1[456]\)", "built z = 10", "required torque"):
        assert re.search(f"<!-- {mark}", texts)
    forces = rows(tmp_path / "design" / "force_along_pack.csv")
    assert len(forces) == 10
    assert float(forces[0]["no guide friction_pressure [N/mm2]"]) == pytest.approx(0.4, abs=1e-4)
    # Torque is mu r times the sum of the contact forces, whatever the series.
    assert sum(float(row["exponential sum (10) [N]"]) for row in forces) / 13394.966 == pytest.approx(
        float(built["exponential sum (10) [N*m]"]) / float(built["no guide friction [N*m]"]) * 10, rel=1e-6
    )
    done = at_once("curves", "multi_plate_clutch", HOIST, "-o", tmp_path / "duty")
    assert done.returncode == 0
    assert {path.stem for path in (tmp_path / "duty").iterdir()} == {"torque_over_plates", "startup_over_torque"}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["simulate", str(HOIST)], "values: is missing"),
        (["simulate", "nowhere.yaml"], "nowhere.yaml"),
        (["simulate", str(LECTURE), "--set", "motor"], "--set: got 'motor'; expected name=value"),
        (["simulate", str(LECTURE), "--set", "mottor=x"], "settings: got 'mottor'; expected motor"),
        (["simulate", str(LECTURE), "--set", "motor=x"], "expected a designation of this table"),
        (
            ["simulate", str(LECTURE), "--set", "ramp=linear", "--set", "ramp=smooth"],
            "--set: got 'ramp'; expected each",
        ),
        (["simulate", str(LECTURE), "--set", "driver_inertia=3"], "driver_torque (or a motor) too"),
        (["simulate", str(LECTURE), "--set", "driver_torque=3"], "driver_inertia (or a motor) too"),
        (["simulate", str(LECTURE), "--set", "gear_ratio=3"], "a motor too"),
        (["simulate", str(LECTURE), "--set", "motor=IEC4P-11kW", "--set", "gear_ratio=9"], "at most 5.9"),
        (
            ["simulate", str(LECTURE), "--set", "motor=IEC4P-11kW", "--set", "driver_torque=9"],
            "either driver_torque or",
        ),
        (["simulate", str(LECTURE), "--set", "motor=SHEET-A-0.75kW"], "column pullout_torque_ratio"),
        (["simulate", str(LECTURE), "--set", "time_limit=0"], "time_limit"),
        (["curves", "cone", str(LECTURE)], "FAMILY: got 'cone'; expected multi_plate_clutch"),
        (["curves", "multi_plate_clutch", "nowhere.yaml"], "nowhere.yaml"),
    ],
)
def test_bad_input_is_one_sentence_and_nothing_written(tmp_path: Path, words: list[str], told: str) -> None:
    assert told in refused(at_once(*words, "-o", "out", folder=tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_guide_that_jams_has_no_torque_to_simulate(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        requirements={"startup_torque": None, "lug_clearance": "30 mm", "guide_friction": 0.5},
        values={"dm": "70 mm"},
    )
    done = at_once("simulate", path, "-o", tmp_path / "out")
    assert "a design whose torque exists; this one violates" in refused(done)
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_one_is_refused(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    for words in (["simulate", LECTURE], ["curves", "multi_plate_clutch", LECTURE]):
        assert "is a file" in refused(at_once(*words, "-o", tmp_path / "taken" / "below"))


def test_tables_are_written_where_no_drawing_is_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawings, "REPORTS", "clutchsynth.reports_of_nobody")
    assert at_once("curves", "multi_plate_clutch", LECTURE, "-o", tmp_path / "out").returncode == 0
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".csv"}


@pytest.mark.slow
@pytest.mark.parametrize("command", ["simulate", "curves"])
def test_help_of_a_command_imports_nothing_heavy(command: str) -> None:
    program = (
        "import sys\n"
        f"sys.argv = ['clutchsynth', {command!r}, '--help']\n"
        "from synth.terminal.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    code = end.code\n"
        f"print(code or 0, [m for m in {HEAVY!r} if m in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout.splitlines()[-1] == "0 []"
    assert "--output" in done.stdout
