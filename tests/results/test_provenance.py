"""What decides answers, as hashes: alike for the same question, another for whatever changes a number."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import synth
from synth.kernels.loading import best_variant, native_code
from synth.plugins import AROUND_THE_ENGINE
from synth.question.catalogs import catalogs_for
from synth.question.instance import Instance
from synth.results import provenance as fingerprint
from synth.results.provenance import code_digest, package_folder, processor
from synth.robust.counterpart import robust_counterpart
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut


def question(needed: Any = NEEDED, rods: Any = RODS, robust: Any = None, **more: Any) -> Instance:
    limits = more.get("limits") or {}
    problem = robust_counterpart(Strut(**more.pop("options", {})), robust, limits)
    return instance_of(problem, needed, catalogs_for(problem, {"rods": rods}), **more)


def test_the_same_question_has_the_same_fingerprint() -> None:
    own = question().fingerprint()
    assert question({"F": "20000 N"}).fingerprint() == question({"load": 20}).fingerprint() == own
    assert question({"load": "20 kN", "safety": 1.5}).fingerprint() == own
    assert len(own.combined) == 64
    assert own.combined not in (own.question, own.computation)


@pytest.mark.parametrize(
    "more",
    [
        {"needed": {"load": "20.000000001 kN"}},
        {"options": {"finish": "coated"}},
        {"parts": {"plate": ["core 2"]}},
        {"limits": {"mass": "<= 20 kg"}},
        {"limits": {"width": "<= 100 mm"}},
        {"limits": {"plates": [1, 3]}},
        {"fix": {"end": "eye"}},
        {"grid": False},
        {"rods": RODS.assign(**{"density [kg/m3]": [7850.0, 7850.1, 7900.0]})},
        {"parts": {"plate": "thickness == plate.thickness"}},
        {"robust": {"load": "+-5 %"}},
    ],
    ids=lambda more: next(iter(more)),
)
def test_whatever_is_asked_otherwise_is_another_question(more: Any) -> None:
    assert question(**more).fingerprint().question != question().fingerprint().question


def test_whether_native_code_computes_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)
    if best_variant("boxes") is None:
        pytest.skip("no kernel was built")
    assert native_code() == "on"
    own = question().fingerprint()
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    assert native_code() == "off"
    switched_off = question().fingerprint()
    assert switched_off.question == own.question
    assert switched_off.computation != own.computation


@pytest.mark.parametrize("what", ["code_digest", "problem_digest", "processor"])
def test_what_computes_is_known(monkeypatch: pytest.MonkeyPatch, what: str) -> None:
    own = question().fingerprint()
    monkeypatch.setattr(synth.question.instance, what, lambda *_: "another")
    other = question().fingerprint()
    assert (other.question == own.question, other.computation == own.computation) == (True, False)


def test_another_formula_is_another_computation() -> None:
    class Heavier(Strut):
        def declare(self, d: Any) -> None:
            super().declare(d)
            d.derive("lost", "kg", 2 * d.derived["mass"].sx)

    problem = Heavier()
    other = instance_of(problem, NEEDED, catalogs_for(problem, {"rods": RODS})).fingerprint()
    assert other.question == question().fingerprint().question
    assert other.computation != question().fingerprint().computation


def test_the_code_is_that_of_the_whole_engine(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert package_folder() == Path(synth.__file__).parent
    assert processor() == processor() != ""
    places = []
    add = fingerprint._add_sources

    def noted(total: Any, place: Path, *without: Any) -> None:
        places.append(place)
        add(total, place, *without)

    monkeypatch.setattr(fingerprint, "_add_sources", noted)
    code_digest.cache_clear()
    before = code_digest()
    assert places == [package_folder()]
    own = {"a.py": True, "templates/kernel.c": True, "notes.txt": False}
    # A wheel holds families, tables and reports in the folder of the engine: they are not its code.
    inside = dict.fromkeys((f"{name.rpartition('.')[2]}/a.py" for name in AROUND_THE_ENGINE), False)
    for name, changed in {**own, **inside}.items():
        monkeypatch.setattr(fingerprint, "package_folder", lambda: tmp_path)
        code_digest.cache_clear()
        empty = code_digest()
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("something")
        code_digest.cache_clear()
        assert (code_digest() != empty) == changed
        monkeypatch.undo()
    code_digest.cache_clear()
    assert code_digest() == before
