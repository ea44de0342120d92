"""``clutchsynth verify`` as a person meets it: what it prints and how it ends."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from synth.results import ParetoFront
from tests.terminal.entry import COMMAND, at_once
from tests.waiting import PATIENCE

# One ring, three plate numbers: the force is all that is left to find.
SPEC = """
family: multi_plate_clutch
options: {guide_model: cz, practice: off}
requirements: {load_torque: 600 N*m, driver_speed: 26.6 rad/s, driven_inertia: 30 kg*m2, startup_torque: 1080 N*m}
fix: {ramp_time: 2 s, d_out: 262 mm, d_in: 158 mm, inner_plate: core 4, outer_plate: core 2, pair: seed_multiplate_ref}
limits: {friction_surfaces: 10 .. 14}
"""


def ran(folder: Path, spec: str = SPEC) -> Path:
    (folder / "spec.yaml").write_text(spec)
    at_once("run", folder / "spec.yaml", "-o", folder / "out", "--quiet")
    return folder / "out"


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return ran(tmp_path_factory.mktemp("front"))


@pytest.fixture
def copy(saved: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(saved, tmp_path / "out"))


def rewritten(folder: Path, change: object) -> None:
    """Change front.json as somebody who knows the checksum would."""
    content = json.loads((folder / "front.json").read_text(encoding="utf-8"))
    del content["digest"]
    change(content)  # type: ignore[operator]
    content["digest"] = ParetoFront.digest_of(content)
    (folder / "front.json").write_text(json.dumps(content), encoding="utf-8")


@pytest.mark.slow
def test_a_front_that_was_saved_holds(saved: Path) -> None:
    done = subprocess.run(
        [*COMMAND, "verify", str(saved)], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    text = " ".join(done.stdout.split())
    assert text.startswith("holds: 3 designs are as saved, and proven again that no feasible design improves one")
    assert max(len(line) for line in done.stdout.splitlines()) <= 100


def test_front_json_may_be_named_itself(saved: Path) -> None:
    assert at_once("verify", saved / "front.json").returncode == 0


def test_an_infeasible_question_is_proven_again(tmp_path: Path) -> None:
    # Around a ring of 262 mm the drum is 280 mm wide.
    done = at_once("verify", ran(tmp_path, SPEC.replace("limits: {", "limits: {outer_diameter: <= 270 mm, ")))
    assert done.returncode == 0
    assert "no design is feasible" in done.stdout


def test_a_changed_number_ends_with_five(copy: Path) -> None:
    path = copy / "front.json"
    path.write_text(path.read_text(encoding="utf-8").replace('"startup_torque": "1080', '"startup_torque": "1090'))
    done = at_once("verify", copy)
    assert done.returncode == 5
    lines = done.stdout.splitlines()
    assert lines[0] == "- front.json was changed after it was saved: its checksum does not fit"
    assert any(line.startswith("- requirement_values_si: startup_torque") for line in lines)
    assert lines[-1].startswith("does not hold: ") or lines[-2].startswith("does not hold: ")
    assert done.stderr == ""


def test_a_design_that_is_gone_is_missed(copy: Path) -> None:
    rewritten(copy, lambda content: content["designs"].pop())
    done = at_once("verify", copy)
    assert done.returncode == 5
    text = " ".join(done.stdout.split())
    assert "checksum" not in text
    assert "the claim that the front is complete is wrong" in text
    assert "feasible and no listed design covers it" in text


def test_a_changed_table_beside_it_is_named(copy: Path) -> None:
    path = copy / "designs.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("optimal", "Optimal"))
    done = at_once("verify", copy)
    assert done.returncode == 5
    assert done.stdout.startswith("- designs.csv says something else than front.json\n")


def test_a_proof_that_is_given_up_is_another_answer_than_what_does_not_hold(saved: Path, copy: Path) -> None:
    done = at_once("verify", saved, "--time-limit", "0.000001 s")
    assert (done.returncode, done.stderr) == (6, "")
    assert "could not be proven again" in done.stdout
    assert "not proven again: 3 designs are as saved" in " ".join(done.stdout.split())
    rewritten(copy, lambda content: content.update(complete=False, settings={**content["settings"], "points": 2}))
    done = at_once("verify", copy, "--time-limit", "0.000001 s")
    assert done.returncode == 5
    assert "3 designs where at most 2 were asked for" in done.stdout


def test_a_front_that_contradicts_itself_does_not_hold(copy: Path) -> None:
    rewritten(copy, lambda content: content["designs"][0]["values"].pop("mass"))
    done = at_once("verify", copy)
    assert (done.returncode, done.stderr) == (5, "")
    assert done.stdout.startswith("- front.json contradicts itself (design 1: mass has no value)\n")


def test_a_front_with_values_of_another_type_is_refused_with_their_place(copy: Path) -> None:
    rewritten(copy, lambda content: content["designs"][0].update(score="best"))
    done = at_once("verify", copy)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Expected `float`, got `str` - at `$.designs[0].score`" in " ".join(done.stderr.split())


def test_a_fault_of_the_proof_is_one_of_the_program(saved: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*arguments: object) -> None:
        raise KeyError("a node")

    monkeypatch.setattr("synth.proof.tree.ProofTree.growth", broken)
    done = at_once("verify", saved)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("clutchsynth: internal error, KeyError: 'a node'\n")


@pytest.mark.parametrize("what", ["nowhere", "empty", "foreign", "broken"])
def test_what_is_no_front_is_refused(what: str, tmp_path: Path) -> None:
    folder = tmp_path / what
    if what != "nowhere":
        folder.mkdir()
    if what == "foreign":
        (folder / "front.json").write_text('{"format": 17}')
    if what == "broken":
        (folder / "front.json").write_text('{"format": 1, "designs"')
    done = at_once("verify", folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("clutchsynth: front")


def test_a_time_that_is_none_is_refused(saved: Path) -> None:
    done = at_once("verify", saved, "--time-limit", "soon")
    assert done.returncode == 2
    assert "--time-limit" in done.stderr
