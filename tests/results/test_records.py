"""What fronts tell beside numbers: typed records that read like the mappings of their files."""

from __future__ import annotations

import copy
import json
import pickle

import msgspec
import pytest
import yaml
from msgspec.structs import replace

import synth
from synth.results import ParetoFront
from synth.results.least_infeasible import LeastInfeasible, MissedLimit
from synth.results.ratings import DesignRating, LimitRating, RatingCounts
from synth.results.record import UNSET, FileRecord
from synth.results.search_record import SettingsRecord
from tests.sample_problems.strut import NEEDED, RODS, Strut

CATALOGS = {"rods": RODS}


@pytest.fixture(scope="module")
def infeasible() -> ParetoFront:
    return synth.synthesize(Strut(), NEEDED, catalogs=CATALOGS, limits={"mass": "<= 1 g"}, points=2)


@pytest.fixture(scope="module")
def rated() -> ParetoFront:
    block = {"load": "+-5 %", "mode": "rate", "samples": 64}
    return synth.synthesize(Strut(), NEEDED, catalogs=CATALOGS, points=2, robust=block)


def through_a_file(front: ParetoFront, folder: object) -> ParetoFront:
    return synth.load_front(front.save(str(folder)))


def test_why_nothing_is_feasible_has_names_and_keys(infeasible: ParetoFront, tmp_path: object) -> None:
    for told in (infeasible.explanation, through_a_file(infeasible, tmp_path).explanation):
        assert isinstance(told, LeastInfeasible)
        assert list(told) == ["message", "conflicts", "nearest", "parts"]
        assert told.message == told["message"]
        assert told.conflicts is not UNSET
        first = told.conflicts[0]
        assert isinstance(first, MissedLimit)
        assert list(first) == ["limit", "value", "limit_value", "unit", "missed_by", "sentence"]
        assert first.limit == first["limit"]
        assert str(first.limit) in str(told.message)
    assert infeasible.explanation == told


def test_ratings_have_names_and_keys(rated: ParetoFront, tmp_path: object) -> None:
    again = through_a_file(rated, tmp_path)
    for front in (rated, again):
        told = front.designs[0].robust
        assert isinstance(told, DesignRating)
        assert list(told)[:4] == ["holds", "verdict", "proof", "yield"]
        assert told.share_good == told["yield"]
        assert told.limits is not UNSET
        assert {type(x) for x in told.limits.values()} == {LimitRating}
        counts = front.statistics.robust
        assert isinstance(counts, RatingCounts)
        assert counts.rated == counts["rated"] == len(front.designs)
        assert "taken_off" not in counts
        assert isinstance(front.settings, SettingsRecord)
        assert front.settings.robust == front.settings["robust"] == front.frame.restated["robust"]
    assert again.settings == rated.settings
    assert [d.robust for d in again.designs] == [d.robust for d in rated.designs]


def test_settings_are_told_in_the_order_of_the_file(rated: ParetoFront) -> None:
    keys = ["points", "gap", "grid", "seed", "weights", "parts", "limits", "fix", "robust"]
    assert list(rated.settings) == keys
    assert (rated.settings.points, rated.settings.gap) == (2, rated.settings["gap"])


def test_a_design_that_was_not_rated_tells_nothing(infeasible: ParetoFront) -> None:
    front = synth.synthesize(Strut(), NEEDED, catalogs=CATALOGS, points=2)
    assert not front.designs[0].robust
    assert front.designs[0].robust == {}
    assert not front.designs[0].robust.holds
    assert not front.designs[0].robust.share_good
    assert not front.settings.robust
    assert "robust" not in front.settings
    assert front.explanation is None


@pytest.mark.parametrize(
    "told",
    [
        DesignRating(holds=True, share_good=0.5, limits={"a": LimitRating(holds=True)}),
        LeastInfeasible(message="none", conflicts=[MissedLimit(limit="a", value=1.0)]),
        SettingsRecord.from_json({"points": 3, "of another version": 1}),
    ],
    ids=lambda x: type(x).__name__,
)
def test_records_go_through_files_and_processes(told: FileRecord) -> None:
    for again in (
        pickle.loads(pickle.dumps(told)),
        copy.deepcopy(told),
        type(told).from_json(json.loads(json.dumps(told.to_json()))),
    ):
        assert type(again) is type(told)
        assert again == told
        assert repr(again) == repr(told)
    assert replace(told) == told
    assert yaml.safe_load(yaml.safe_dump(told.to_json())) == told


def test_a_key_may_be_no_name() -> None:
    told = DesignRating.from_json({"yield": 0.25})
    assert (told.share_good, told["yield"]) == (0.25, 0.25)
    assert dict(replace(told, share_good=0.5)) == {"yield": 0.5}


def test_keys_of_other_versions_are_left_out() -> None:
    assert dict(SettingsRecord.from_json({"points": 3, "of another version": 1})) == {"points": 3}


@pytest.mark.parametrize(
    ("record", "content", "words"),
    [
        (SettingsRecord, 7, "Expected `object`, got `int`"),
        (SettingsRecord, {"points": "7"}, r"Expected `int.*`, got `str` - at `\$.points`"),
        (DesignRating, {"limits": [7]}, r"Expected `object.*`, got `array` - at `\$.limits`"),
        (LeastInfeasible, {"conflicts": [7]}, r"Expected `object`, got `int` - at `\$.conflicts\[0\]`"),
    ],
)
def test_what_is_no_record_is_refused_with_its_place(record: type[FileRecord], content: object, words: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=words):
        record.from_json(content)
