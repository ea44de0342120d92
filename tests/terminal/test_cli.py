"""The command line as a user meets it: what it prints, what it writes, how it ends."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

import synth
from synth.results import drawings
from tests.terminal.entry import COMMAND, LONG_SEARCH, ROOT, at_once, clutchsynth
from tests.waiting import PATIENCE

LECTURE = ROOT / "examples" / "lecture_design.yaml"
HOIST = ROOT / "examples" / "hoist_multi_plate.yaml"
HEAVY = (
    "casadi",
    "cvxpy",
    "pandas",
    "numpy",
    "scipy",
    "optuna",
    "matplotlib",
    "sqlalchemy",
    "alembic",
    "distributed",
    "multiprocessing",
)

# One ring, three plate numbers: the force is all that is left to find.
SMALL = """
family: multi_plate_clutch
options: {guide_model: cz, practice: off}
requirements: {load_torque: 600 N*m, driver_speed: 26.6 rad/s, driven_inertia: 30 kg*m2, startup_torque: 1080 N*m}
fix: {ramp_time: 2 s, d_out: 262 mm, d_in: 158 mm, inner_plate: core 4, outer_plate: core 2, pair: seed_multiplate_ref}
limits: {friction_surfaces: 10 .. 14}
"""


def refused(done: subprocess.CompletedProcess[str]) -> str:
    """One sentence on standard error, nothing else, exit code 2."""
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("clutchsynth: ")
    return done.stderr


def quantity(output: str, name: str) -> str:
    """Return the line of a table that begins with a name, its blanks made single."""
    lines = output.splitlines()
    return next(" ".join(line.split()) for line in lines if re.split(r" {2,}| \(", line.strip())[0] == name)


# ---- help, families, describe ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("flag", ["--help", "--version"])
def test_help_and_version_import_nothing_heavy(flag: str) -> None:
    program = (
        "import sys\n"
        f"sys.argv = ['clutchsynth', {flag!r}]\n"
        "from synth.terminal.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    code = end.code\n"
        f"print(code or 0, [m for m in {HEAVY!r} if m in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout.splitlines()[-1] == "0 []"
    assert "clutchsynth" in done.stdout


UNASKED = ["pandas", "scipy", "optuna", "cvxpy", "matplotlib", "sqlalchemy", "http.server"]
UNASKED += [
    "synth.batches",
    "synth.kinds",
    "synth.queue",
    "synth.workers",
    "synth.variants",
    "synth.studies",
    "synth.verification",
    "synth.proof",
    "synth.robust.rating",
]


@pytest.mark.slow
def test_a_run_imports_nothing_that_its_question_does_not_need(tmp_path: Path) -> None:
    asked = ["clutchsynth", "run", str(ROOT / "examples" / "automobile_disc.yaml"), "-o", str(tmp_path / "out")]
    program = (
        f"import sys\nsys.argv = {asked!r}\n"
        "from synth.terminal.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    code = end.code\n"
        f"print(code or 0, [m for m in {UNASKED!r} if m in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout.splitlines()[-1] == "0 []"
    assert (tmp_path / "out" / "front.json").exists()


def test_families_are_listed_with_their_titles() -> None:
    done = at_once("families")
    assert done.returncode == 0
    listed = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    assert set(listed) == set(synth.families())
    assert listed["multi_plate_clutch"] == "Multi-plate clutch"


def test_describe_fits_on_a_line_and_respects_options() -> None:
    done = at_once("describe", "multi_plate_clutch", "--option", "lubrication=dry")
    assert done.returncode == 0
    assert max(len(line) for line in done.stdout.splitlines()) <= 100
    assert "lubrication == 'dry'" in " ".join(done.stdout.split())
    for heading in ("Options", "Requirements", "Variables", "Counts", "Parts", "Derived", "Limits", "Objectives"):
        assert f"\n{heading}" in done.stdout
    assert quantity(done.stdout, "load_torque").startswith("load_torque (M_load) N*m needed 0 .. 1·10⁷")
    assert quantity(done.stdout, "friction_pair.p_allow").startswith("friction_pair.p_allow N/mm2 0.001 .. 500")
    assert quantity(done.stdout, "friction_pair.mu_static").startswith(
        "friction_pair.mu_static - optional 0.001 .. 1.2"
    )
    limits, objectives = done.stdout.split("\nLimits\n")[1].split("\nObjectives\n")
    for name, section, kind in (
        ("ring_ratio_min", limits, "log-convex"),
        ("sliding_speed", limits, "log-convex"),  # the lesser of two columns
        ("core_slenderness", limits, "log-affine"),
        ("outer_diameter", objectives, "log-convex"),
    ):
        assert section.split(f"\n{name} ")[1].split("class: ")[1].startswith(f"{kind} ")


def test_describe_as_csv() -> None:
    done = at_once("describe", "multi_plate_clutch", "--csv")
    rows = {(row["kind"], row["name"]): row for row in csv.DictReader(io.StringIO(done.stdout))}
    assert rows["requirement", "safety_factor"]["default"] == "1.5"
    column = rows["column", "friction_pair.mu_dynamic"]
    assert (column["unit"], column["lower"], column["upper"]) == ("-", "0.001", "1.0")
    assert rows["objective", "mass"]["sense"] == "min"
    assert rows["derived", "friction_area"]["classification"] == "log-concave"
    assert not [name for kind, name in rows if kind == "step"]


@pytest.mark.slow
def test_describe_lists_quantities_on_the_way_where_they_are_asked_for() -> None:
    shown = at_once("describe", "multi_plate_clutch", "--all").stdout
    listed = shown.split("\nQuantities on the way to others")[1].split("\nLimits\n")[0]
    assert quantity(listed, "heat_capacity").startswith("heat_capacity (")
    assert "\nQuantities on the way" not in at_once("describe", "multi_plate_clutch").stdout
    rows = csv.DictReader(io.StringIO(at_once("describe", "multi_plate_clutch", "--all", "--csv").stdout))
    assert {row["name"]: row["unit"] for row in rows if row["kind"] == "step"}["cooled_area"] == "m2"


# ---- check ----------------------------------------------------------------------------------------------------------


def test_the_lecture_design_comes_out_as_printed_in_its_source(tmp_path: Path) -> None:
    done = at_once("check", LECTURE, "-o", tmp_path / "out")
    assert done.returncode == 0
    assert done.stderr == ""
    for name, (symbol, shown, printed) in {
        "torque": ("M_k", "1412 N m", 1411.76),
        "ring_outer_diameter": ("d_out", "258.1 mm", 258.111),
        "ring_inner_diameter": ("d_in", "154.9 mm", 154.866),
        "friction_area": ("A", "3349 cm²", 3348.74),
        "friction_work": ("W", "39 524 J", 39524.1),
        "hourly_heat": ("w", "5.901 J/(mm² h)", 5.90134),
        "slip_time": ("t_D", "3.218 s", 3.21806),
        "peak_slip_power": ("P_peak", "21 704 W", 21703.7),
        "friction_surfaces": ("z", "10", 10),
    }.items():
        said = name.replace("_", " ")
        assert quantity(done.stdout, said).startswith(f"{said} {symbol} {shown} ")
        with (tmp_path / "out" / "check.csv").open() as file:
            value = next(float(row["value"]) for row in csv.DictReader(file) if row["name"] == name)
        assert value == pytest.approx(printed, rel=4e-6)
    assert quantity(done.stdout, "surface pressure").startswith("surface pressure p_s 0.4 N/mm²")
    assert "\nnot asked, so their limits are not built: power, " in done.stdout
    assert "off the grid: ring outer diameter, nearest makeable 258 mm" in done.stdout
    assert "VIOLATED" not in done.stdout
    assert "\nremark: thin plates load the spline flanks" in done.stdout
    assert "thin_plates" not in done.stdout
    assert "(Szoke" not in done.stdout
    assert max(len(line) for line in done.stdout.splitlines()) <= 100


def test_check_lists_every_violated_limit(tmp_path: Path) -> None:
    design = yaml.safe_load(LECTURE.read_text())
    design["values"]["F0"] = "9000 N"
    design["requirements"]["jerk_limit"] = "10 rad/s3"
    path = tmp_path / "weak.yaml"
    path.write_text(yaml.safe_dump(design))
    done = at_once("check", path, "-o", tmp_path / "out")
    assert done.returncode == 3
    assert "violated: torque capacity, startup torque available, jerk\n" in done.stdout
    limits = done.stdout[done.stdout.index("\nLimits") :]
    assert quantity(limits, "torque capacity") == "torque capacity 948.557 N m >= 1411.76 N m 149 % VIOLATED"
    assert quantity(limits, "jerk") == "jerk 18 rad/s³ <= 10 rad/s³ 180 % VIOLATED"
    assert quantity(limits, "slip time").endswith("ok")
    with (tmp_path / "out" / "check.csv").open() as file:
        rows = {(row["kind"], row["name"]): row for row in csv.DictReader(file)}
    assert rows["limit", "jerk"]["state"] == "VIOLATED"
    assert float(rows["limit", "jerk"]["value"]) == pytest.approx(18)
    assert float(rows["derived", "friction_work"]["value"]) == pytest.approx(39524.1, abs=0.05)
    assert rows["variable", "ring_outer_diameter"]["state"] == "off the grid"
    assert rows["part", "inner_plate"]["value"] == "core 4"


def test_check_takes_one_designation_even_as_a_list(tmp_path: Path) -> None:
    design = yaml.safe_load(LECTURE.read_text())
    design["parts"]["inner_plate"] = ["core 4"]
    path = tmp_path / "design.yaml"
    path.write_text(yaml.safe_dump(design))
    assert at_once("check", path).returncode == 0
    design["parts"]["inner_plate"] = ["core 4", "core 2"]
    path.write_text(yaml.safe_dump(design))
    assert "parts: inner_plate" in refused(at_once("check", path))


def test_own_limits_on_variables_and_counts_are_tested_as_well(tmp_path: Path) -> None:
    path = tmp_path / "design.yaml"
    own = "\nlimits: {friction_surfaces: '2 .. 4', ring_outer_diameter: '<= 1 m'}\n"
    path.write_text(LECTURE.read_text() + own)
    done = at_once("check", path)
    assert done.returncode == 3
    assert "violated: friction surfaces <= 4" in done.stdout
    path.write_text(LECTURE.read_text() + own.replace("2 .. 4", "2 .. 400"))
    done = at_once("check", path)
    assert done.returncode == 0, done.stderr
    assert "all 20 limits that apply hold" in done.stdout


# ---- bad input ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "text", "words"),
    [
        ("run", "", ["bad.yaml", "empty file"]),
        ("run", "family: multi_plate\n", ["bad.yaml: family", "'multi_plate'", "multi_plate_clutch"]),
        ("run", "family: multi_plate_clutch\nrequirments: {}\n", ["'requirments'", "requirements"]),
        ("run", "family: multi_plate_clutch\nrequirements: [1]\n", ["bad.yaml: requirements", "got a list"]),
        ("run", "family: multi_plate_clutch\n", ["requirement load_torque", "missing", "N*m"]),
        ("run", SMALL.replace("600 N*m", "'6,5 N*m'"), ["bad.yaml: requirement load_torque", "6,5 N*m"]),
        ("run", SMALL.replace("600 N*m", "600 kg"), ["load_torque", "600 kg"]),
        ("run", SMALL.replace("600 N*m", "-600 N*m"), ["load_torque", "-600 N*m"]),
        ("run", SMALL.replace("load_torque", "load_torqe"), ["load_torqe", "did you mean load_torque"]),
        ("run", SMALL.replace("cz", "cx"), ["guide_model", "'cx'", "series, cz"]),
        ("run", SMALL.replace("core 4", "core 4711"), ["core 4711"]),
        ("run", SMALL + "values: {z: 10}\n", ["values", "clutchsynth check"]),
        ("run", SMALL + "catalogs: nowhere\n", ["catalogs", "nowhere"]),
        ("run", SMALL + "gap: 0.9\n", ["gap", "1e-6 to 0.5"]),
        ("explain", "family: any\nrequirements: {load_torque: 600 N*m}\n", ["family", "one family", "clutchsynth run"]),
        ("check", SMALL, ["values", "missing", "clutchsynth run"]),
        ("check", SMALL + "values: {z: 10}\n", ["fix", "under values"]),
        ("check", "family: multi_plate_clutch\nvalues: {q: 1}\n", ["load_torque"]),
    ],
)
def test_bad_input_is_one_sentence_and_nothing_written(
    tmp_path: Path, command: str, text: str, words: list[str]
) -> None:
    (tmp_path / "bad.yaml").write_text(text)
    message = refused(at_once(command, "bad.yaml", "-o", "out", folder=tmp_path))
    assert all(word in message for word in words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.yaml"]


def test_a_folder_that_cannot_be_one_is_refused_before_the_search(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    for place in (tmp_path / "taken", tmp_path / "taken" / "below"):
        assert "is a file" in refused(at_once("run", HOIST, "-o", place))
    assert (tmp_path / "taken").read_text() == "a file"


@pytest.mark.slow
def test_flags_are_checked_like_the_spec(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "--points: got 0" in refused(at_once("run", HOIST, "-o", out, "--points", "0"))
    assert "--time-limit" in refused(at_once("run", HOIST, "-o", out, "--time-limit", "soon"))
    assert "'weight'" in refused(at_once("run", HOIST, "-o", out, "--objective", "weight"))
    assert "name=value" in refused(at_once("describe", "multi_plate_clutch", "--option", "dry"))
    assert not out.exists()


@pytest.mark.parametrize("words", [["batch"], ["run", "x.yaml", "-o", "o", "--points", "many"], ["runn"]])
def test_wrong_usage_ends_with_two(words: list[str], tmp_path: Path) -> None:
    done = at_once(*words, folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "Error:" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_fault_of_the_program_is_short_unless_debugging(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(path: Path) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("synth.question.spec.read_spec", broken)
    monkeypatch.setenv("CLUTCHSYNTH_DEBUG", "")
    done = at_once("check", "x.yaml", folder=tmp_path)
    assert done.returncode == 1
    assert "ZeroDivisionError" in done.stderr
    assert "Traceback" not in done.stderr
    assert "please report" in done.stderr
    monkeypatch.setenv("CLUTCHSYNTH_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):  # Python writes where it comes from
        at_once("check", "x.yaml", folder=tmp_path)


# ---- run ------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_run_finds_ranks_saves_and_explains(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    done = clutchsynth("run", "small.yaml", "-o", "out", folder=tmp_path)
    assert done.returncode == 0
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"designs.csv", "front.json", "design_01.yaml"} <= written
    assert "explanation.txt" not in written
    with (tmp_path / "out" / "designs.csv").open() as file:
        rows = list(csv.DictReader(file))
    # More plates need less force and weigh more: each of the three numbers is on the front.
    assert sorted(float(row["friction_surfaces [-]"]) for row in rows) == [10, 12, 14]
    assert "#1 comes nearest to the best mass and actuation force\nsized for 600 N m x 1.5 / (0.85" in done.stdout
    for word in ("smallest mass", "smallest actuation force", "torque capacity", "3 combinations", "written to out"):
        assert word in done.stdout
    assert "boxes" not in done.stdout
    verbose = at_once("run", "small.yaml", "--verbose", folder=tmp_path)
    assert "\ncombinations 3, " in verbose.stdout
    assert "boxes" in verbose.stdout
    assert max(len(line) for line in done.stdout.splitlines()) <= 100
    # A design that was saved reads back as it was.
    assert at_once("check", tmp_path / "out" / "design_01.yaml").returncode == 0


def test_run_quietly_says_nothing(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    done = at_once("run", "small.yaml", "-o", "out", "--quiet", "--objective", "mass", folder=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert json.loads((tmp_path / "out" / "front.json").read_text())["objectives"] == {"mass": "min"}


PLATE = SMALL.replace("600 N*m", "600 N-m").replace("26.6 rad/s", "254 U/min").replace("30 kg*m2", "30 kgm²")


@pytest.mark.slow
def test_units_of_name_plates_are_told_once_and_not_where_all_is_quiet(tmp_path: Path) -> None:
    (tmp_path / "plate.yaml").write_text(PLATE, encoding="utf-8")
    done = at_once("run", "plate.yaml", "--points", "1", "--objective", "mass", "-o", "out", folder=tmp_path)
    assert done.returncode == 0
    told = [line for line in done.stderr.splitlines() if line.startswith("clutchsynth: ")]
    assert told == [f"clutchsynth: read as {read}" for read in ("N*m: N-m", "rev/min: U/min", "kg*m2: kgm²")]
    done = at_once("run", "plate.yaml", "--points", "1", "--objective", "mass", "-o", "out", "-q", folder=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    for design in tmp_path.glob("out/design_*.yaml"):
        assert at_once("check", design).returncode == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("torque", "says"),
    [
        ("motor_power: 5.5", "did you mean power?"),
        ("P_N: 7.5 HP", "requirement P_N: got '7.5 HP'; expected TORQUE: T = P/omega"),
        ("load_torque: 5.5 kW", "kW measures a power (T = P/omega"),
        ("load_torque: 0.6", "0.6 N*m or 0.6 kN*m"),
        ("load_torque: '0.6'", "0.6 N*m or 0.6 kN*m"),
    ],
)
@pytest.mark.parametrize(
    ("family", "torques"), [("multi_plate_clutch", "load_torque"), ("any", "required_torque or load_torque")]
)
def test_a_power_for_a_torque_and_a_torque_without_unit_are_asked_back(
    tmp_path: Path, torque: str, says: str, family: str, torques: str
) -> None:
    needed = f"{{{torque}, driver_speed: 254 rpm, driven_inertia: 30 kg*m2}}"
    (tmp_path / "hoist.yaml").write_text(f"family: {family}\nrequirements: {needed}\n")
    assert says.replace("TORQUE", torques) in at_once("run", "hoist.yaml", folder=tmp_path).stderr


def test_the_front_is_drawn_here_and_with_a_folder_as_a_file(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    done = at_once("run", "small.yaml", "--plot", "-o", "out", folder=tmp_path)
    assert done.returncode == 0
    assert re.search("\n\nmass|\n\nactuation force", done.stdout)
    assert re.search("[\u2801-\u28ff]", done.stdout)
    assert "front.svg" in done.stdout.rpartition("written to ")[2]
    drawn = ElementTree.parse(tmp_path / "out" / "front.svg").getroot()
    said = ["".join(text.itertext()) for text in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert said[0].startswith("Multi-plate clutch: ")
    assert {"#1", "#2", "#3"} <= set(said)
    assert " ".join(said).count("proven") == 1
    # It goes with the front that it shows, whether another one is drawn or not.
    one = at_once("run", "small.yaml", "--plot", "--objective", "mass", "-o", "out", folder=tmp_path)
    assert "no plot: mass is the only objective, and a front has two or more" in one.stdout
    assert not (tmp_path / "out" / "front.svg").exists()
    assert "front.svg" not in one.stdout


@pytest.mark.slow
def test_a_terminal_of_plain_characters_gets_a_plain_plot(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    done = clutchsynth("run", "small.yaml", "--plot", folder=tmp_path, PYTHONIOENCODING="ascii")
    assert re.search("^ *[0-9. ]+ [+] *o", done.stdout, re.MULTILINE)


def test_without_reports_nothing_is_drawn_and_a_sentence_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawings, "REPORTS", "clutchsynth.reports_of_nobody")
    (tmp_path / "small.yaml").write_text(SMALL)
    done = at_once("run", "small.yaml", "--plot", "-o", "out", folder=tmp_path)
    assert done.returncode == 0
    assert "no plot: reports are not installed" in done.stdout
    assert not (tmp_path / "out" / "front.svg").exists()


def test_what_is_far_off_is_told_as_a_factor_and_without_exponents(tmp_path: Path) -> None:
    limits = "limits: {mass: <= 0.00001 kg, length: <= 1 mm, "
    (tmp_path / "too light.yaml").write_text(SMALL.replace("limits: {", limits))
    done = at_once("run", "too light.yaml", folder=tmp_path)
    assert done.returncode == 3
    assert re.search(r"(?m)^length <= .* times the limit$", done.stdout)
    assert re.search(r"(?m)^mass <= .* \d+(\.\d+)? kg$", done.stdout)
    assert not re.search(r"\d[eE][-+]?\d", done.stdout)
    assert not re.search(r"(?<![.\d])(\d{4,}|\d[\d ]* \d{3})(\.\d+)? %", done.stdout)
    assert "clutchsynth explain 'too light.yaml'" in done.stdout


@pytest.mark.slow
def test_what_a_family_refuses_names_explain_as_well(tmp_path: Path) -> None:
    (tmp_path / "room.yaml").write_text(
        "family: disc_clutch\nrequirements: {load_torque: 60 N*m, driver_speed: 1500 1/min, "
        "driven_inertia: 0.7 kg*m2, outer_diameter_limit: 60 mm}\n"
    )
    done = at_once("run", "room.yaml", folder=tmp_path)
    assert "no_room_for_ring" in refused(done)
    assert "(what would help: clutchsynth explain room.yaml)" in done.stderr
    assert at_once("explain", "room.yaml", folder=tmp_path).returncode == 3


def test_nothing_feasible_is_explained(tmp_path: Path) -> None:
    # Around a ring of 262 mm the drum is 280 mm wide.
    (tmp_path / "tight.yaml").write_text(SMALL.replace("limits: {", "limits: {outer_diameter: <= 270 mm, "))
    done = at_once("run", "tight.yaml", "-o", "out", folder=tmp_path)
    assert done.returncode == 3
    assert "outer_diameter" in done.stdout
    text = (tmp_path / "out" / "explanation.txt").read_text()
    assert text in done.stdout
    assert "outer_diameter" in text
    content = json.loads((tmp_path / "out" / "front.json").read_text())
    assert content["status"] == "infeasible"
    missed = [conflict["limit"] for conflict in content["explanation"]["conflicts"]]
    assert missed
    # Each is told once, and what tells more is named.
    assert all(len(re.findall(rf"(?m)^{re.escape(name)} ", done.stdout)) == 1 for name in missed)
    assert " where " not in done.stdout
    assert "what would help: clutchsynth explain tight.yaml\n" in done.stdout
    # The next run into the same folder that finds something takes the explanation away.
    (tmp_path / "small.yaml").write_text(SMALL)
    assert at_once("run", "small.yaml", "-o", "out", "-q", folder=tmp_path).returncode == 0
    assert not (tmp_path / "out" / "explanation.txt").exists()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_saves_what_was_found(tmp_path: Path) -> None:
    with subprocess.Popen(
        [*COMMAND, *LONG_SEARCH, "-o", "out"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        assert "designs" in process.stderr.readline()  # of the progress: the search has begun
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 4
    assert "Traceback" not in errors
    assert json.loads((tmp_path / "out" / "front.json").read_text())["interrupted"] == "interrupted"


@pytest.mark.slow
def test_the_time_limit_saves_what_was_found(tmp_path: Path) -> None:
    done = at_once(*LONG_SEARCH, "-o", tmp_path / "out", "--time-limit", "1 s")
    assert done.returncode == 4
    assert "stopped: time limit" in done.stdout
    assert json.loads((tmp_path / "out" / "front.json").read_text())["interrupted"] == "time limit"


@pytest.mark.slow
def test_the_same_question_gives_the_same_bytes_whether_code_was_compiled_before_or_not(tmp_path):
    words = ("run", HOIST, "--points", "3", "--gap", "0.02", "--quiet", "-o")
    cache = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    saved = []
    for name in ("first", "second"):
        assert clutchsynth(*words, tmp_path / name, **cache).returncode == 0
        saved.append((tmp_path / name / "designs.csv").read_bytes())
    assert saved[0] == saved[1]


def test_a_saved_front_is_gone_on_with(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    words = ("run", "small.yaml", "-o")
    assert at_once(*words, "first", "-q", folder=tmp_path).returncode == 0
    more = at_once(*words, "second", "--more", "first", folder=tmp_path)
    assert more.returncode == 0, more.stderr
    first, second = (json.loads((tmp_path / name / "front.json").read_text()) for name in ("first", "second"))
    assert second["certificate"] == first["certificate"]
    assert second["designs"] == first["designs"]
    (tmp_path / "small.yaml").write_text(SMALL.replace("26.6 rad/s", "26.7 rad/s"))
    assert "requirement driver_speed" in refused(at_once(*words, "third", "--more", "first", folder=tmp_path))
    assert not (tmp_path / "third").exists()
