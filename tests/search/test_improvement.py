"""A front improved from its own designs: never worse, and only where the question is the same."""

from __future__ import annotations

import json

import numpy as np
import pytest

import synth
from synth.question.catalogs import catalogs_for
from synth.results.loading import load_front
from synth.search.improvement import go_on
from synth.search.settings import TUNING, PartSampling, SearchEffort
from tests.asking import pose
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import synthesize, tuned

OWN = {"rods": RODS}


def ask(tuning=TUNING, **more):
    settings = {"catalogs": OWN, "points": 6, "gap": 1e-3, **more}
    return synthesize(tuning, Strut(), NEEDED, **settings)


@pytest.fixture(scope="module")
def unproven(tmp_path_factory):
    """A front of which little is proven, since its search was given up early."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        trees = ("coarse_boxes", "cover_front", "boxes", "boxes_of_many", "boxes_of_few_parts")
        given_up = {"few_combinations": 1, "further": SearchEffort(seconds=0.0), **dict.fromkeys(trees, 40)}
        front = ask(tuned(tree=given_up, heuristics={"parts": PartSampling(trials=1)}))
    assert front.certificate.kind == "heuristic"
    assert front.designs
    return front


def objectives(front):
    return np.array([list(d.objectives.values()) for d in front.designs])


def no_worse(new, old):
    """Tell whether each design of the old front has one in the new front that is as good in everything."""
    own, given = objectives(new), objectives(old)
    as_good = np.all(own[:, None, :] <= given[None, :, :] * (1 + 1e-8), axis=2)
    return bool(as_good.any(axis=0).all())


def no_larger_ends(new, old):
    """Tell whether the best in each objective is as good, and no design of the old front beats one of the new."""
    own, given = objectives(new), objectives(old)
    beaten = np.all(given[:, None, :] < own[None, :, :] * (1 - 1e-8), axis=2)
    return bool(np.all(own.min(axis=0) <= given.min(axis=0) * (1 + 1e-8))) and not beaten.any()


@pytest.mark.slow
def test_a_front_is_improved_until_it_is_proven(unproven):
    better = unproven.improve()
    assert better.certificate.kind == "global"
    assert no_larger_ends(better, unproven)
    assert len(better.designs) <= 6


@pytest.mark.parametrize("seconds", [1e-3, 0.2, 0.5])
def test_a_front_that_is_stopped_again_is_never_worse(unproven, seconds):
    again = unproven.improve(time_limit=seconds)
    # Stopped while its report is made, a front is proven as asked without being called so.
    proven = again.certificate.gap <= 1e-3
    assert proven or again.certificate.kind != "global"
    assert no_larger_ends(again, unproven) if proven else no_worse(again, unproven)
    assert again.certificate.gap <= unproven.certificate.gap * (1 + 1e-12)
    assert all(not d.violated for d in again.designs)


def test_designs_given_stay_where_there_is_room_for_them(unproven):
    question = pose(Strut(), NEEDED, points=20, catalogs=catalogs_for(Strut(), OWN))
    better = go_on(unproven, question, "front")
    assert better.certificate.kind == "global"
    assert len(better.designs) > len(unproven.designs)
    assert no_worse(better, unproven)


def test_what_is_proven_already_is_returned_as_it_is():
    front = ask()
    assert front.certificate.kind == "global"
    assert front.improve() is front


def test_a_saved_front_is_improved(unproven, tmp_path):
    unproven.save(tmp_path)
    saved = load_front(tmp_path)
    better = saved.improve(problem=Strut(), catalogs=OWN)
    assert better.certificate.kind == "global"
    assert no_larger_ends(better, unproven)


def test_a_front_whose_record_was_changed_is_refused(unproven, tmp_path):
    unproven.save(tmp_path)
    content = json.loads((tmp_path / "front.json").read_text())
    content["certificate"]["gap"] = 1e-6
    (tmp_path / "front.json").write_text(json.dumps(content))
    with pytest.raises(synth.InputError, match="changed after it was saved"):
        load_front(tmp_path).improve(problem=Strut(), catalogs=OWN)


def test_other_tables_are_another_question(unproven, tmp_path):
    unproven.save(tmp_path)
    changed = RODS.copy()
    numbers = [name for name in changed.columns if changed[name].dtype.kind == "f"]
    changed[numbers[0]] *= 1.01
    with pytest.raises(synth.InputError, match="differs in"):
        load_front(tmp_path).improve(problem=Strut(), catalogs={"rods": changed})
