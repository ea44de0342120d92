"""``clutchsynth near-equals``, ``prices``, and ``run`` with several families, as a person meets them."""

from __future__ import annotations

import csv
import json
import re
import shutil
from pathlib import Path

import pytest

from tests.terminal.entry import at_once

SPEC = """
family: multi_plate_clutch
options: {guide_model: cz, practice: off}
requirements: {load_torque: 600 N*m, driver_speed: 26.6 rad/s, driven_inertia: 30 kg*m2, startup_torque: 1080 N*m}
fix: {ramp_time: 2 s, d_out: 262 mm, d_in: 158 mm, pair: seed_multiplate_ref}
parts: {inner_plate: [core 4, core 3], outer_plate: [core 2, core 2.5]}
limits: {friction_surfaces: 10 .. 14}
points: 4
"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("choice")
    (folder / "spec.yaml").write_text(SPEC)
    assert at_once("run", folder / "spec.yaml", "-o", folder / "out", "--quiet").returncode == 0
    return folder


@pytest.mark.slow
def test_near_equals_are_shown_saved_and_hold(saved: Path) -> None:
    folder = saved / "near"
    done = at_once("near-equals", saved / "out", "--design", 2, "--within", "25 %", "--count", 4, "-o", folder)
    assert done.returncode == 0
    assert "near-equals of design 2" in done.stdout
    assert "no further one does (proven)" in done.stdout
    assert "design 1 of the front: " in done.stdout  # a near-equal that is listed already is said to be
    assert max(len(line) for line in done.stdout.splitlines() if not line.startswith("written")) <= 100
    with (folder / "near_equals.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["number"] for row in rows] == ["0", "1", "2", "3", "4"]
    assert float(rows[1]["change: mass [%]"]) <= 25
    for number in (1, 4):
        assert at_once("check", folder / f"design_{number:02d}.yaml").returncode == 0


def test_nothing_near_ends_with_three(saved: Path) -> None:
    done = at_once("near-equals", saved / "out", "--within", "0.01 %", "-o", saved / "none")
    assert done.returncode == 3
    assert "proven: no other combination of parts, counts and choices comes within 0.01 %" in done.stdout
    assert (saved / "none" / "near_equals.json").exists()


def test_out_of_time_ends_with_four(saved: Path) -> None:
    done = at_once("near-equals", saved / "out", "--time-limit", "1e-9", "--quiet", "-o", saved / "stopped")
    assert done.returncode == 4
    assert (saved / "stopped" / "near_equals.csv").exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--design", "77"], ["design", "77", "rank"]),
        (["--within", "2 kg"], ["within", "2 kg"]),
        (["--count", "0"], ["count"]),
    ],
)
def test_careless_flags_are_refused_and_nothing_is_written(saved: Path, words: list[str], expected: list[str]) -> None:
    done = at_once("near-equals", saved / "out", *words, "-o", saved / "never")
    assert done.returncode == 2
    assert all(word in done.stderr for word in expected)
    assert not (saved / "never").exists()


def test_the_front_is_not_written_over(saved: Path) -> None:
    done = at_once("near-equals", saved / "out", "-o", saved / "out")
    assert done.returncode == 2
    assert "another folder" in done.stderr


# ---- prices ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_prices_are_shown_and_saved_beside_the_front(saved: Path) -> None:
    folder = saved / "out"
    done = at_once("prices", folder, "--design", 2, "--design", 1, "-o", folder)
    assert done.returncode == 0, done.stderr
    assert "prices of design 2" in done.stdout
    assert "prices of design 1" not in done.stdout
    assert re.search(r"^\d+ more requirements and limits have no influence \(prices.csv\)$", done.stdout, re.M)
    assert "1 more design with --all, and in prices.csv" in done.stdout
    assert "other parts: over all 12 combinations tried" in done.stdout
    assert max(len(line) for line in done.stdout.splitlines() if not line.startswith("written")) <= 100
    with (folder / "prices.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["design"] for row in rows if row["quantity"] == "load_torque"] == ["2", "2", "1", "1"]
    assert {row["kind"] for row in rows} == {"requirement", "limit"}
    # The rings are pinned: torque is a matter of force alone, in proportion.
    force = {row["quantity"]: row for row in rows if row["design"] == "1" and row["objective"] == "actuation_force"}
    assert float(force["load_torque"]["down"]) == pytest.approx(1.0, rel=1e-4)
    assert "load_torque costs 1 % actuation_force" in force["load_torque"]["sentence"]
    assert (folder / "design_02.yaml").exists()
    again = at_once("prices", folder, "--all", "-o", folder)
    assert "prices of design 1" in again.stdout
    assert "prices of design 2" in again.stdout


def test_prices_out_of_time_end_with_four_and_go_on(saved: Path) -> None:
    folder = saved / "late"
    done = at_once("prices", saved / "out", "--time-limit", "1e-9", "-o", folder)
    assert done.returncode == 4
    assert "designs are kept, run again to go on" in done.stdout
    assert (folder / "prices.csv").read_text().startswith("design,objective,quantity,kind")
    assert at_once("prices", saved / "out", "--quiet", "-o", folder).returncode == 0
    assert len((folder / "prices.csv").read_text().splitlines()) > 20


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--design", "77"], ["design", "77", "rank"]),
        (["--step", "2 kg"], ["step", "2 kg"]),
        (["--step", "50 %"], ["step", "0.01 % to 10 %"]),
        (["--time-limit", "soon"], ["--time-limit", "soon"]),
    ],
)
def test_careless_prices_are_refused_and_nothing_is_written(saved: Path, words: list[str], expected: list[str]) -> None:
    done = at_once("prices", saved / "out", *words, "-o", saved / "never")
    assert done.returncode == 2
    assert all(word in done.stderr for word in expected)
    assert not (saved / "never").exists()


def test_prices_of_what_is_no_front_are_refused(saved: Path) -> None:
    done = at_once("prices", saved / "spec.yaml", "-o", saved / "never")
    assert done.returncode == 2
    assert "a folder that clutchsynth run has written, or its front.json" in done.stderr


# ---- several families -----------------------------------------------------------------------------------------------

SEVERAL = """
family:
  - family: disc_clutch
    options: {practice: off}
    parts: {friction_pair: [moulded_dry]}
    limits: {ring_outer_diameter: 200 mm .. 260 mm, pressure_plate_thickness: 3 mm .. 4 mm}
  - family: cone_clutch
    options: {practice: off}
    parts: {friction_pair: [millboard_dry], cone_layout: [outer_spring]}
    limits: {mean_diameter: 215 mm .. 250 mm, shell_thickness: 3 mm .. 4 mm, cone_half_angle: 22 deg .. 25 deg}
  - roller_coupling
  - family: multi_plate_clutch
    options: {practice: off}
    parts: {friction_pair: [paper_wet], inner_plate: [core 2], outer_plate: [core 2]}
    limits: {friction_surfaces: "2 .. 4", outer_diameter: "<= 60 mm"}
requirements:
  load_torque: 60 N*m
  driver_speed: 700 1/min
  driven_inertia: 2 kg*m2
fix: {ramp_time: 0.3 s}
points: 6
"""


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp("several")
    (folder / "several.yaml").write_text(SEVERAL)
    done = at_once("run", folder / "several.yaml", "--plot", "-o", folder / "out")
    assert done.returncode == 0, done.stderr
    return folder / "out", done.stdout


@pytest.mark.slow
def test_several_families_make_one_front_with_a_line_each(compared: tuple[Path, str]) -> None:
    folder, shown = compared
    assert "6 designs of 1 family" in shown
    assert max(len(line) for line in shown.splitlines() if not line.startswith("written")) <= 100
    words = " ".join(shown.split())
    assert "roller_coupling not_covered it joins two shafts and never slips" in words
    assert "cone_clutch beaten everywhere, in " in words
    assert "(disc_clutch): least mass" in words
    assert "multi_plate_clutch infeasible No combination is feasible." in words
    assert "of the 3 families searched no design improves one listed here by more than 0.1 %" in words
    with (folder / "families.csv").open() as file:
        rows = {row["family"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["disc_clutch", "cone_clutch", "roller_coupling", "multi_plate_clutch"]
    with (folder / "designs.csv").open() as file:
        assert {row["family"] for row in csv.DictReader(file)} <= {"disc_clutch", "cone_clutch"}
    assert (folder / "cone_clutch" / "front.json").exists()
    assert at_once("check", folder / "design_01.yaml").returncode == 0
    assert "A: disc clutch\n" in shown
    assert "front.svg" in shown.rsplit("written to", 1)[1]
    assert "disc clutch" in (folder / "front.svg").read_text()


@pytest.mark.slow
def test_a_comparison_is_verified_over_all_its_families(compared: tuple[Path, str], tmp_path: Path) -> None:
    folder = compared[0]
    done = at_once("verify", folder)
    assert done.returncode == 0, done.stdout
    assert "proven again that no feasible design improves one of them" in " ".join(done.stdout.split())
    # A comparison that keeps silent about the best family does not hold.
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    content = json.loads((copy / "comparison.json").read_text())
    lightest = min(content["designs"], key=lambda d: d["objectives"]["mass"])
    heavier = [d for d in content["designs"] if d is not lightest]
    worse = {n: v * 1.5 for n, v in heavier[-1]["objectives"].items()}
    content["designs"][-1]["objectives"] = worse
    (copy / "comparison.json").write_text(json.dumps(content))
    done = at_once("verify", copy)
    assert done.returncode == 5
    assert "evaluated it is" in done.stdout
    assert "beats design" in done.stdout


@pytest.mark.slow
def test_no_family_with_a_design_ends_with_three_and_an_explanation(tmp_path: Path) -> None:
    (tmp_path / "tight.yaml").write_text(
        SEVERAL.replace("load_torque: 60 N*m", "load_torque: 60 N*m\n  actuation_force_limit: 300 N").replace(
            "pressure_plate_thickness: 3 mm .. 4 mm}", "pressure_plate_thickness: 3 mm .. 4 mm}"
        )
    )
    done = at_once("run", tmp_path / "tight.yaml", "-o", tmp_path / "out")
    assert done.returncode == 3, done.stdout
    text = (tmp_path / "out" / "explanation.txt").read_text()
    assert "disc_clutch (infeasible)" in text
    assert "roller_coupling (not_covered)" in text
    assert "none of the" in " ".join(done.stdout.split())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("  - roller_coupling", "  - roler_coupling", ["family", "roler_coupling", "roller_coupling"]),
        ("load_torque:", "load_torqe:", ["load_torqe", "did you mean load_torque"]),
        ("60 N*m", "60 kg", ["load_torque", "60 kg"]),
        ("  - roller_coupling", "  - {family: roller_coupling, points: 3}", ["entry 3", "points"]),
        ("  - roller_coupling", "  - {parts: {}}", ["entry 3", "family"]),
        ("  driver_speed: 700 1/min\n", "", ["a sheet that one of the families can serve", "driver_speed"]),
    ],
)
def test_a_careless_sheet_is_refused(tmp_path: Path, old: str, new: str, words: list[str]) -> None:
    assert old in SEVERAL
    (tmp_path / "bad.yaml").write_text(SEVERAL.replace(old, new))
    done = at_once("run", tmp_path / "bad.yaml", "-o", tmp_path / "out")
    assert done.returncode == 2
    assert all(word in done.stderr for word in ["bad.yaml", *words]), done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_several_families_are_no_design_to_check(compared: tuple[Path, str], tmp_path: Path) -> None:
    (tmp_path / "design.yaml").write_text(SEVERAL + "values: {ramp_time: 1 s}\n")
    done = at_once("check", tmp_path / "design.yaml")
    assert done.returncode == 2
    assert "one family" in done.stderr
