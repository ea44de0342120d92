"""``clutchsynth whatif`` as a person meets it."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from tests.terminal.entry import at_once

SPEC = """
family: multi_plate_clutch
options: {guide_model: cz, practice: off}
requirements: {load_torque: 600 N*m, driver_speed: 26.6 rad/s, driven_inertia: 30 kg*m2, startup_torque: 1080 N*m}
fix: {ramp_time: 2 s, inner_plate: core 3, outer_plate: core 2, d_in: 158 mm}
parts: {pair: [seed_multiplate_ref, cork_wet]}
limits: {friction_surfaces: 8 .. 20}
objectives: [mass]
"""


def rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("whatif")
    (made / "spec.yaml").write_text(SPEC)
    return made


@pytest.fixture(scope="module")
def saved(folder: Path) -> tuple[Path, str]:
    done = at_once("whatif", folder / "spec.yaml", "--vary", "load_torque=500:600:50 N*m", "-o", folder / "out")
    assert done.returncode == 0, done.stderr
    return folder / "out", done.stdout


@pytest.mark.slow
def test_tables_and_pictures_are_written(saved: tuple[Path, str]) -> None:
    out, shown = saved
    assert sorted(p.name for p in out.iterdir()) == ["breaks.csv", "steps", "study.json", "whatif.csv", "whatif.svg"]
    assert "load torque, 3 steps" in shown
    assert " ".join(shown.split()).endswith(f"written to {out}: breaks.csv, whatif.csv, whatif.svg, steps/")
    assert "proven: every step" in shown
    table = rows(out / "whatif.csv")
    assert [row["load_torque [N*m]"] for row in table] == ["500.0", "550.0", "600.0"]
    mass = [float(row["mass [kg]"]) for row in table]
    assert mass == sorted(mass)
    assert (out / "whatif.svg").read_text().lstrip().startswith("<?xml")
    assert (out / "breaks.csv").read_text().startswith("objective,")


@pytest.mark.slow
def test_the_same_command_keeps_what_it_has(saved: tuple[Path, str], folder: Path) -> None:
    out, shown = saved
    before = {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in sorted((out / "steps").iterdir())}
    texts = [(out / name).read_bytes() for name in ("whatif.csv", "breaks.csv")]
    done = at_once("whatif", folder / "spec.yaml", "--vary", "load_torque=500:600:50 N*m", "-o", out)
    assert done.returncode == 0, done.stderr
    assert done.stdout == shown
    assert [(out / name).read_bytes() for name in ("whatif.csv", "breaks.csv")] == texts
    assert {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in sorted((out / "steps").iterdir())} == before


@pytest.mark.slow
def test_break_points_are_where_parts_or_counts_change(folder: Path) -> None:
    out = folder / "breaks"
    done = at_once("whatif", folder / "spec.yaml", "--vary", "load_torque=300, 600 N*m", "-o", out)
    assert done.returncode == 0, done.stderr
    table, ends = rows(out / "breaks.csv"), rows(out / "whatif.csv")
    assert table
    for row in table:
        assert row["objective"] == "mass"
        assert row["proven"] == "yes"
        assert row["change"].split(",")[0].replace("friction_surfaces", "friction surfaces") in done.stdout
        low, high = float(row["from"]), float(row["to"])
        assert low <= float(row["load_torque [N*m]"]) <= high
        assert 0 < high - low <= 1.001e-3 * high
    # They lead from the parts of the first step to those of the last, one to the next.
    parts = [[row["parts before"], row["parts after"]] for row in table]
    assert [a for a, _ in parts[1:]] == [b for _, b in parts[:-1]]
    for words, row in ((parts[0][0], ends[0]), (parts[-1][1], ends[-1])):
        assert f"friction_pair {row['friction_pair']}," in words
        assert f"friction_surfaces {float(row['friction_surfaces [-]']):g}" in words


@pytest.mark.slow
def test_without_breaks_and_with_two_objectives(folder: Path) -> None:
    out = folder / "two"
    done = at_once(
        "whatif",
        folder / "spec.yaml",
        "--vary",
        "parts.pair=seed_multiplate_ref,cork_wet",
        "--vary",
        "friction_surfaces <= 14, 20",
        "--objective",
        "mass",
        "--objective",
        "actuation_force",
        "--points",
        3,
        "--no-breaks",
        "--quiet",
        "-o",
        out,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    assert {"fronts.svg", "whatif.svg", "whatif.csv", "breaks.csv"} <= {p.name for p in out.iterdir()}
    assert rows(out / "breaks.csv") == []
    table = rows(out / "whatif.csv")
    assert {(row["parts.friction_pair"], row["friction_surfaces <= [-]"]) for row in table} == {
        (pair, limit) for pair in ("seed_multiplate_ref", "cork_wet") for limit in ("14.0", "20.0")
    }
    # Fourteen surfaces of cork are too few: such a step has one row, without a design.
    none = [(row["parts.friction_pair"], row["rank"]) for row in table if row["status"] == "infeasible"]
    assert none == [("cork_wet", "")]
    found = [row for row in table if row["status"] != "infeasible"]
    for row in found:
        assert row["friction_pair"] == row["parts.friction_pair"]
        assert float(row["friction_surfaces [-]"]) <= float(row["friction_surfaces <= [-]"])
    assert max(int(row["rank"]) for row in found) == 3


@pytest.mark.slow
def test_out_of_time_ends_with_four_and_goes_on(folder: Path, saved: tuple[Path, str]) -> None:
    command = ["whatif", folder / "spec.yaml", "--vary", "load_torque=500:600:50 N*m", "-o", folder / "late"]
    done = at_once(*command, "--time-limit", "1e-9")
    assert done.returncode == 4
    assert "0 of 3 steps are kept, run again to go on" in done.stdout
    assert {row["reason"] for row in rows(folder / "late" / "whatif.csv")} == {"not reached: time limit"}
    assert " ".join(done.stdout.split()).endswith(f"written to {folder / 'late'}: breaks.csv, whatif.csv")
    assert sorted(p.name for p in (folder / "late").iterdir()) == ["breaks.csv", "whatif.csv"]
    assert at_once(*command, "--quiet").returncode == 0
    for name in ("whatif.csv", "breaks.csv", "whatif.svg"):
        assert (folder / "late" / name).read_bytes() == (saved[0] / name).read_bytes()


def test_a_study_without_any_feasible_step_ends_with_three(folder: Path) -> None:
    out = folder / "none"
    done = at_once("whatif", folder / "spec.yaml", "--vary", "mass <= 0.01, 0.02 kg", "-o", out)
    assert done.returncode == 3, done.stderr
    table = rows(out / "whatif.csv")
    assert [row["status"] for row in table] == ["infeasible", "infeasible"]
    assert all("misses" in row["reason"] or "no design" in row["reason"] for row in table)
    words = " ".join(done.stdout.split())
    assert "no design at 0.01 kg: the nearest design misses" in words
    assert rows(out / "breaks.csv") == []
    assert not (out / "whatif.svg").exists()


def test_where_a_range_ends_before_its_end_is_told(folder: Path) -> None:
    command = ["whatif", folder / "spec.yaml", "--vary", "load_torque=500:620:50 N*m", "-o", folder / "short"]
    told = "load torque: the steps end at 600 N m: 620 N m is no whole number of steps of 50 N m from 500 N m"
    assert told in " ".join(at_once(*command, "--time-limit", "1e-9").stdout.split())
    assert at_once(*command, "--time-limit", "1e-9", "--quiet").stdout == ""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("vary", "words"),
    [
        (["load_torque"], ["--vary", "NAME=VALUES"]),
        (["load_torqe=500,600 N*m"], ["load_torqe", "did you mean load_torque"]),
        (["load_torque=500:600 N*m"], ["load_torque", "from:to:step"]),
        (["load_torque=500:600:-50 N*m"], ["a step that leads", "200:300:10 mm"]),
        (["load_torque=500:600:500 N*m"], ["a step that is not larger"]),
        (["load_torque=500,5:600:20 N*m"], ["a decimal point instead of a decimal comma"]),
        (["load_torque=500,600 kg"], ["load_torque", "kg"]),
        (["load_torque=500,500 N*m"], ["each value once"]),
        (["load_torque=500 N*m", "load_torque=600 N*m"], ["--vary", "each thing once"]),
        (["load_torque=500 N*m", "mass <= 5 kg", "driver_speed=20 rad/s"], ["one or two"]),
        (["mass=5,6 kg"], ["mass <="]),
        (["weights.actuation_force=1,2"], ["actuation_force", "a chosen objective"]),
        (["parts.pair=cork_wet,felt"], ["felt", "a designation of this table"]),
        (["parts.pair=corck_wet,paper_wet"], ["parts.friction_pair = corck_wet", "perhaps cork_wet"]),
        (["parts.pair=cork_wet,mu_dynamic >"], ["condition"]),
        (["options.guide_model=cz,cx"], ["cx", "series, cz"]),
        (["load_torque=500,-600 N*m"], ["load_torque = -600 N*m"]),
        ([], ["--vary"]),
    ],
)
def test_what_cannot_be_varied_is_one_sentence_and_nothing_is_written(
    folder: Path, vary: list[str], words: list[str]
) -> None:
    flags = [word for text in vary for word in ("--vary", text)]
    done = at_once("whatif", folder / "spec.yaml", *flags, "-o", folder / "never")
    assert done.returncode == 2
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    if vary:
        assert len(done.stderr.splitlines()) == 1, done.stderr
    assert all(word in done.stderr for word in words), done.stderr
    assert not (folder / "never").exists()


def test_a_given_design_is_no_question(folder: Path) -> None:
    (folder / "design.yaml").write_text(SPEC + "values: {z: 10}\n")
    done = at_once("whatif", folder / "design.yaml", "--vary", "load_torque=500,600 N*m", "-o", folder / "never")
    assert done.returncode == 2
    assert "a question without values" in done.stderr
    assert not (folder / "never").exists()
