"""A finished result stands before anything is made from it, and stays where that fails."""

import json

import pytest

import synth
from synth.analysis import calculation as formulas
from synth.errors import DerivedFileWarning, derived
from synth.model.problem import DesignProblem
from synth.results import ParetoFront
from tests.terminal.entry import at_once
from tests.terminal.test_choice_commands import SEVERAL
from tests.terminal.test_cli import SMALL

pytestmark = pytest.mark.slow

FAILURES = [KeyError("u_1"), RecursionError("too deep"), MemoryError(), synth.InputError("catalogs", "x", "another")]


class Side(DesignProblem):
    """One length."""

    name, title = "side", "Side"

    def declare(self, d):
        x = d.variable("x", "mm", 1, 20)
        d.at_least("long_enough", x, d.requirement("least", "mm", 5), "mm")
        d.objective("x")


@pytest.fixture(params=FAILURES, ids=lambda e: type(e).__name__)
def failing(request, monkeypatch):
    """Let no calculation be made."""

    def fail(instance):
        raise request.param

    monkeypatch.setattr(formulas, "calculation_of", fail)
    return request.param


def test_a_front_is_kept_where_its_calculation_cannot_be_made(failing, tmp_path):
    front = synth.synthesize(Side, {})
    with pytest.warns(DerivedFileWarning) as told:
        front.save(tmp_path)
    (one,) = told
    assert str(one.message).startswith(f"calculation.json could not be made ({type(failing).__name__}: ")
    assert "the result it is made from is complete" in str(one.message)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "design_01.yaml",
        "designs.csv",
        "front.json",
        "offered.json",
    ]
    assert synth.load_front(tmp_path).verify(Side).holds


def test_a_front_is_kept_although_warnings_are_errors(failing, tmp_path):
    with pytest.raises(DerivedFileWarning):
        synth.synthesize(Side, {}).save(tmp_path)
    assert synth.load_front(tmp_path).designs


def test_nothing_is_derived_before_the_front_is_on_the_disk(monkeypatch, tmp_path):
    there = {}
    own = formulas.calculation_of

    def looked(instance):
        there.update({path.name: path.read_text() for path in tmp_path.iterdir() if path.is_file()})
        return own(instance)

    front = synth.synthesize(Side, {})
    monkeypatch.setattr(formulas, "calculation_of", looked)
    front.save(tmp_path)
    assert json.loads(there["front.json"])["designs"]
    assert there["designs.csv"] == (tmp_path / "designs.csv").read_text()
    assert "calculation.json" not in there
    assert synth.calculation(synth.load_front(tmp_path)) == synth.calculation(front)


def test_an_interrupt_while_files_are_derived_keeps_the_front(monkeypatch, tmp_path):
    def interrupted(instance):
        raise KeyboardInterrupt

    front = synth.synthesize(Side, {})
    monkeypatch.setattr(formulas, "calculation_of", interrupted)
    with pytest.raises(KeyboardInterrupt):
        front.save(tmp_path)
    assert synth.load_front(tmp_path).verify(Side).holds


def test_an_earlier_calculation_does_not_stay_beside_a_new_front(tmp_path, monkeypatch):
    synth.synthesize(Side, {}).save(tmp_path)
    assert (tmp_path / "calculation.json").exists()
    monkeypatch.setattr(formulas, "calculation_of", lambda instance: 1 / 0)
    with pytest.warns(DerivedFileWarning, match="ZeroDivisionError"):
        synth.synthesize(Side, {"least": 6}).save(tmp_path)
    assert not (tmp_path / "calculation.json").exists()
    assert synth.load_front(tmp_path).designs[0].values["x"] == pytest.approx(0.006)


def test_files_are_those_that_are_saved(tmp_path):
    front = synth.synthesize(Side, {})
    files = front.files()
    assert list(files)[:4] == ["designs.csv", "front.json", "calculation.json", "offered.json"]
    front.save(tmp_path)
    for name, text in files.items():
        assert (tmp_path / name).read_text() == text, name


def test_what_can_be_made_is_returned_without_a_word():
    assert derived("a", lambda: "text") == "text"


def test_run_keeps_the_front_and_says_in_one_sentence_what_failed(monkeypatch, tmp_path):
    def fail(*_):
        raise KeyError("u_1")

    (tmp_path / "small.yaml").write_text(SMALL)
    monkeypatch.setattr(formulas, "calculation_of", fail)
    monkeypatch.setattr(ParetoFront, "svg", fail)
    done = at_once("run", "small.yaml", "-o", "out", "--plot", folder=tmp_path)
    assert done.returncode == 0
    said = done.stderr.splitlines()
    failed = [line for line in said if "could not be made" in line]
    assert [line.split(" could")[0] for line in failed] == ["clutchsynth: calculation.json", "clutchsynth: front.svg"]
    assert "Traceback" not in done.stderr
    assert "calculation.json" not in done.stdout
    assert "design_01.yaml" in done.stdout
    assert synth.load_front(tmp_path / "out").verify().holds


def test_a_comparison_is_kept_too(monkeypatch, tmp_path):
    def fail(*_):
        raise KeyError("u_1")

    (tmp_path / "several.yaml").write_text(SEVERAL)
    monkeypatch.setattr(formulas, "calculation_of", fail)
    done = at_once("run", "several.yaml", "-o", "out", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("calculation.json could not be made (KeyError") == 1
    assert (tmp_path / "out" / "comparison.json").exists()
    assert len(list((tmp_path / "out").glob("*/front.json"))) > 1
