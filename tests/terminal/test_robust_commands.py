"""``clutchsynth rate``, and ``run`` with a robust block, as a person meets them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from synth.results.rating_tables import yield_text
from tests.terminal.entry import at_once

SPEC = """
family: multi_plate_clutch
options: {guide_model: cz, practice: off}
requirements: {load_torque: 600 N*m, driver_speed: 26.6 rad/s, driven_inertia: 30 kg*m2, startup_torque: 1080 N*m}
fix: {ramp_time: 2 s, pair: seed_multiplate_ref, inner_plate: core 3, outer_plate: core 2, d_in: 158 mm}
limits: {friction_surfaces: 10 .. 20}
points: 2
"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robust")
    (folder / "spec.yaml").write_text(SPEC)
    done = at_once("run", folder / "spec.yaml", "-o", folder / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def test_a_saved_front_is_rated(saved: Path) -> None:
    folder = saved / "rated"
    done = at_once("rate", saved / "out", "-o", folder, "--over", "friction=+-10 %", "--samples", 256)
    assert done.returncode == 3, done.stderr
    assert "none of 2 designs keeps all limits over the whole range" in done.stdout
    assert max(len(line) for line in done.stdout.splitlines() if not line.startswith("written")) <= 100
    rated = rows(folder / "rating.csv")
    assert [row["rank"] for row in rated] == ["1", "2"]
    assert {row["robust"] for row in rated} == {"no"}
    assert float(rated[0]["yield low"]) <= float(rated[0]["yield"]) <= float(rated[0]["yield high"]) < 1
    limits = rows(folder / "robust.csv")
    own = next(row for row in limits if row["rank"] == "1" and row["limit"] == rated[0]["worst limit"])
    assert own["robust"] == "no"
    assert float(own["utilisation"]) == float(rated[0]["worst utilisation"]) > 1
    told = json.loads((folder / "rating.json").read_text())
    assert told["robust"]["samples"] == 256
    assert len(told["designs"]) == 2


def test_a_given_design_is_rated_and_what_hardly_scatters_is_kept(saved: Path) -> None:
    design = saved / "out" / "design_01.yaml"
    done = at_once(
        "rate", design, "-o", saved / "one", "--over", "friction_pair.density=+-10 %", "--confidence", "99 %"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 of 1 design keeps all limits over the whole range (proven)" in done.stdout
    assert rows(saved / "one" / "rating.csv")[0]["yield low"] == "1.0"


def test_a_load_that_only_rises_is_rated(saved: Path) -> None:
    design = saved / "out" / "design_01.yaml"
    done = at_once("rate", design, "-o", saved / "risen", "--over", "load_torque=+10 %", "--samples", 256)
    assert done.returncode == 3, done.stderr
    assert "load_torque +10 %" in done.stdout
    worst = json.loads((saved / "risen" / "rating.json").read_text())["designs"][0]["worst_at"]
    assert worst == {"load_torque": pytest.approx(660)}


def test_out_of_time_ends_with_four(saved: Path) -> None:
    done = at_once(
        "rate", saved / "out", "-o", saved / "late", "--over", "friction=+-10 %", "--time-limit", "1e-9", "--quiet"
    )
    assert done.returncode == 4
    assert rows(saved / "late" / "rating.csv") == []


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], ["--over: is missing", "--over 'friction=catalogue range'", "no robust block"]),
        (["--samples", "256"], ["--over: is missing"]),
        (["--over", "friction"], ["--over", "name=value"]),
        (["--over", "friction=+-5 %", "--over", "friction=+-6 %"], ["--over", "once"]),
        (["--over", "friction=rough"], ["friction", "rough", "catalogue range"]),
        (["--over", "friction=+-5 %", "--samples", "100"], ["samples", "power of 2"]),
        (["--over", "friction=+-5 %", "--confidence", "3"], ["confidence"]),
        (["--over", "wear=new and worn"], ["wear", "lining_wear"]),
    ],
)
def test_careless_flags_are_refused_and_nothing_is_written(saved: Path, words: list[str], expected: list[str]) -> None:
    done = at_once("rate", saved / "out", "-o", saved / "never", *words)
    assert done.returncode == 2
    assert all(word in done.stderr for word in expected), done.stderr
    assert not (saved / "never").exists()


ROBUST = SPEC + 'robust: {friction: "+-10 %", load_torque: "590 .. 620 N*m", samples: 256}\n'


@pytest.fixture(scope="module")
def robust(saved: Path) -> tuple[Path, str]:
    (saved / "robust.yaml").write_text(ROBUST)
    done = at_once("run", saved / "robust.yaml", "-o", saved / "robust")
    assert done.returncode == 0, done.stderr
    return saved / "robust", done.stdout


@pytest.mark.slow
def test_a_robust_front_is_shown_saved_checked_and_verified(robust: tuple[Path, str], tmp_path: Path) -> None:
    folder, shown = robust
    assert "2 of 2 designs keep all limits over the whole range (proven)" in shown
    assert "designs.csv, front.json, offered.json, robust.csv, design_01.yaml" in " ".join(shown.split())
    designs = rows(folder / "designs.csv")
    assert {row["robust"] for row in designs} == {"yes"}
    assert {float(row["yield"]) for row in designs} == {1.0}
    assert all(row["proof"] in ("proven", "bounded") for row in rows(folder / "robust.csv"))
    assert "utilisation: torque_capacity (friction low, load_torque high)" in designs[0]
    checked = at_once("check", folder / "design_01.yaml")
    assert checked.returncode == 0
    assert "torque capacity (friction low," in checked.stdout
    done = at_once("verify", folder)
    assert done.returncode == 0, done.stdout
    # The question repeats what scatters: nothing needs to be said again.
    assert at_once("rate", folder, "-o", tmp_path / "again", "--quiet").returncode == 0
    assert at_once("rate", folder / "design_02.yaml", "-o", tmp_path / "one", "--quiet").returncode == 0
    assert at_once("simulate", folder / "design_01.yaml", "-o", tmp_path / "sim").returncode == 0


@pytest.mark.slow
def test_a_folder_that_is_used_again_keeps_nothing_of_the_range(saved: Path, robust: tuple[Path, str]) -> None:
    folder = saved / "twice"
    (saved / "rate.yaml").write_text(ROBUST.replace("robust: {", "robust: {mode: rate, "))
    assert at_once("run", saved / "rate.yaml", "-o", folder, "--quiet").returncode == 0
    assert {row["robust"] for row in rows(folder / "designs.csv")} == {"no"}
    assert [row["mass [kg]"] for row in rows(folder / "designs.csv")] == [
        row["mass [kg]"] for row in rows(saved / "out" / "designs.csv")
    ]
    assert at_once("verify", folder).returncode == 0
    assert at_once("run", saved / "spec.yaml", "-o", folder, "--quiet").returncode == 0
    assert not (folder / "robust.csv").exists()
    assert "yield" not in rows(folder / "designs.csv")[0]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"+-10 %"', "rough", ["friction", "rough", "catalogue range"]),
        ('"+-10 %"', "0.1", ["friction", "0.1", "a range"]),
        ("590 .. 620", "610 .. 620", ["load_torque", "holds the nominal 600 N*m"]),
        ('load_torque: "590', 'lode_torque: "590', ["lode_torque", "did you mean load_torque"]),
        ("samples: 256", "samples: 250", ["samples", "power of 2"]),
        ("samples: 256", "mode: best", ["mode", "limits"]),
        ("robust: {", "robust: [", ["robust.yaml"]),
    ],
)
def test_a_careless_block_is_refused(saved: Path, tmp_path: Path, old: str, new: str, words: list[str]) -> None:
    assert old in ROBUST
    text = ROBUST.replace(old, new)
    text = text.replace("256}", "256]") if "robust: [" in new else text
    (tmp_path / "robust.yaml").write_text(text)
    done = at_once("run", tmp_path / "robust.yaml", "-o", tmp_path / "out")
    assert done.returncode == 2
    assert all(word in done.stderr for word in ["robust.yaml", *words]), done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_study_of_designs_that_stand_a_range(saved: Path, robust: tuple[Path, str]) -> None:
    out = saved / "study"
    done = at_once("whatif", saved / "robust.yaml", "-o", out, "--vary", "load_torque=600,610 N*m", "--no-breaks")
    assert done.returncode == 0, done.stderr
    assert "4 of 4 designs keep all limits over the whole range (proven)" in done.stdout
    table = rows(out / "whatif.csv")
    assert [row["robust"] for row in table] == ["yes"] * 4
    assert {row["yield"] for row in table} == {"1.0"}
    alone = sorted(float(row["mass [kg]"]) for row in rows(robust[0] / "designs.csv"))
    assert sorted(float(row["mass [kg]"]) for row in table[:2]) == pytest.approx(alone, rel=1e-3)


@pytest.mark.slow
def test_a_study_of_the_range_itself(saved: Path) -> None:
    out = saved / "ranges"
    done = at_once("whatif", saved / "spec.yaml", "-o", out, "--vary", "robust.friction=none, +-5:45:20 %")
    assert done.returncode == 0, done.stderr
    table = rows(out / "whatif.csv")
    assert list(dict.fromkeys(row["robust.friction"] for row in table)) == ["none", "'+-5 %", "'+-25 %", "'+-45 %"]
    assert table[0]["robust"] == ""
    assert {row["robust"] for row in table if row["robust.friction"] != "none" and row["rank"]} == {"yes"}
    # What stands more costs more.
    least: dict[str, float] = {}
    for row in table:
        if row["rank"]:
            name, force = row["robust.friction"], float(row["actuation_force [N]"])
            least[name] = min(force, least.get(name, force))
    assert list(least.values()) == sorted(least.values())
    assert len(set(least.values())) == len(least) > 1


@pytest.mark.slow
def test_a_study_that_rates_shows_the_yield(saved: Path) -> None:
    (saved / "rated.yaml").write_text(SPEC + 'robust: {friction: "+-10 %", mode: rate, samples: 256}\n')
    out = saved / "rated_study"
    done = at_once("whatif", saved / "rated.yaml", "-o", out, "--vary", "robust.friction=+-5, +-10 %", "--no-breaks")
    assert done.returncode == 0, done.stderr
    assert "yield" in done.stdout
    assert "none of 4 designs keeps all limits over the whole range" in done.stdout
    leading = [row for row in rows(out / "whatif.csv") if row["rank"] == "1"]
    assert [row["robust.friction"] for row in leading] == ["'+-5 %", "'+-10 %"]
    for row in leading:
        assert yield_text(float(row["yield"])) in done.stdout


FAMILIES = """
family:
  - family: disc_clutch
    options: {practice: off}
    parts: {friction_pair: [sinter_bronze_dry]}
    robust: {friction: none}
  - family: multi_plate_clutch
    options: {practice: off}
    parts: {friction_pair: [paper_wet], inner_plate: [core 1], outer_plate: [core 1]}
requirements: {load_torque: 200 N*m, driver_speed: 700 1/min, driven_inertia: 2 kg*m2, outer_diameter_limit: 300 mm}
fix: {ramp_time: 0.3 s}
points: 4
robust: {friction: +-15 %}
"""


@pytest.mark.slow
def test_families_are_compared_by_what_stands_the_range(tmp_path: Path) -> None:
    (tmp_path / "both.yaml").write_text(FAMILIES)
    out = tmp_path / "out"
    done = at_once("run", tmp_path / "both.yaml", "-o", out)
    assert done.returncode == 0, done.stderr
    table = rows(out / "designs.csv")
    assert {(row["family"], row["robust"]) for row in table} == {("disc_clutch", ""), ("multi_plate_clutch", "yes")}
    unrated = sum(row["robust"] == "" for row in table)
    told = "1 design is" if unrated == 1 else f"{unrated} designs are"
    assert f"\n{told} not rated: in the family nothing scatters" in done.stdout
    assert f"{4 - unrated} of {4 - unrated} designs keep all limits" in done.stdout
    assert done.stdout.count("not rated") == unrated + 1
    assert at_once("verify", out).returncode == 0
    # The folder of all is no front: the sentence names one that is.
    done = at_once("rate", out, "-o", tmp_path / "rated")
    assert done.returncode == 2
    assert f"{out / 'disc_clutch'}" in done.stderr
    done = at_once("whatif", tmp_path / "both.yaml", "-o", tmp_path / "study", "--vary", "load_torque=200,210 N*m")
    assert done.returncode == 2
    assert "disc_clutch, multi_plate_clutch" in done.stderr
    (tmp_path / "wrong.yaml").write_text(FAMILIES.replace("{friction: none}", "{friktion: none}"))
    done = at_once("run", tmp_path / "wrong.yaml", "-o", tmp_path / "wrong")
    assert done.returncode == 2
    assert "family disc_clutch: robust" in done.stderr
    assert "friction" in done.stderr
    assert not (tmp_path / "wrong").exists()


def test_the_front_is_not_written_over(saved: Path) -> None:
    done = at_once("rate", saved / "out", "-o", saved / "out", "--over", "friction=+-5 %")
    assert done.returncode == 2
    assert "another folder" in done.stderr
