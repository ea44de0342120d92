"""Specs are read strictly: every slip is one sentence that names file and key."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import InputError
from synth.question.request_fields import FIELDS
from synth.question.settings import SearchSettings
from synth.question.spec import read_spec, spec_from_mapping
from tests.question.hostile_values import ENTRIES, JUNK
from tests.repetitions import repetitions

SMALL = "family: multi_plate_clutch\nrequirements:\n  load_torque: 600 N*m\n"
HOIST = {
    "family": "multi_plate_clutch",
    "requirements": {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"},
}


def write(folder: Path, text: str | bytes, name: str = "hoist.yaml") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def refusal(path: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        read_spec(path)
    assert "\n" not in str(caught.value)
    return caught.value


def test_a_small_spec_is_read(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, SMALL + "points: 7\ngap: 1e-2\ngrid: no\ntime_limit: 2 min\n"))
    assert spec.family == "multi_plate_clutch"
    assert spec.requirements == {"load_torque": "600 N*m"}
    assert spec.folder == tmp_path
    assert (spec.points, spec.gap, spec.grid, spec.time_limit, spec.values) == (7, 0.01, False, 120.0, None)
    assert spec.settings(seed=3) == SearchSettings(points=7, gap=0.01, seed=3, time_limit=120.0)
    assert not spec.request().grid


def test_json_says_the_same_as_yaml(tmp_path: Path) -> None:
    content = {
        "family": "f",
        "requirements": {"a": 1.5, "b": "2 mm"},
        "objectives": {"mass": "min"},
        "parts": {"p": ["x"]},
    }
    as_yaml = read_spec(write(tmp_path, yaml.safe_dump(content)))
    as_json = read_spec(write(tmp_path, json.dumps(content), "hoist.json"))
    for key in FIELDS:
        assert getattr(as_json, key) == getattr(as_yaml, key)


def test_a_key_with_nothing_under_it_counts_as_not_written(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, SMALL + "limits:\nfix:\nobjectives:\npoints:\n"))
    assert spec.settings() == SearchSettings()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["empty file", "family: multi_plate_clutch"]),
        ("# nothing\n", ["empty file"]),
        ("- family\n- x\n", ["got a list", "family:"]),
        ("just words\n", ["just words"]),
        ("requirements: {a: 1}\n", ["family", "is missing", "the name of a family"]),
        ("family: [1]\n", ["family", "entry 1", "got 1", "a name"]),
        ("family: f\nrequirements: [1, 2]\n", ["hoist.yaml: requirements", "got a list", "a mapping"]),
        ("family: f\nrequirements: {a: [1]}\n", ["requirements: a", "got a list", "one value"]),
        ("family: f\nrequirement: {a: 1}\n", ["key", "'requirement'", "requirements"]),
        ("family: f\nfoo: 1\n", ["'foo'", "one of family, options"]),
        ("family: f\nrequirements: {a: 1}\nrequirements: {a: 2}\n", ["line 3", "requirements a second time"]),
        ("family: f\nrequirements:\n  a: 1\n  a: 2\n", ["line 4", "the key a a second time"]),
        ("family: f\nrequirements:\n\ta: 1\n", ["line 3", "spaces instead of tabs"]),
        ("family: f\nlimits:\n  d: >= 200 mm\n", ["line 3", "quotes"]),
        ("family: f\nfix: {a: *b}\n", ["line 2", "alias"]),
        ("family: &a f\nfix: *a\n", ["line 2", "alias"]),
        ("family: f\n---\nfamily: g\n", ["line 2", "second document"]),
        ("family: f\nrequirements: {1: 2}\n", ["requirements", "names on the left"]),
        ("family: f\nrequirements: !!python/name:os.system {}\n", ["line 2"]),
        ("family: 'f\n", ["line 1", "a quote that is not closed"]),
        (
            "family: f\nobjectives: [a, b\nfix: {}\n",
            ["line 2: got a list whose bracket [ is not closed", "commas between"],
        ),
        ("family: f\nfix: {a: 1\n", ["line 2: got a bracket { that is not closed"]),
        ("family: f: g\n", ["line 1: got a colon where no value can begin", "one 'name: value' on a line"]),
        ("family: f\nfix\n", ["line 2: got a name without a colon"]),
        ("family: - f\n", ["line 1: got a dash where no list can begin"]),
        ("family: ]\n", ["line 1: got a sign where a value should begin"]),
        ("fix:\n    a: 1\n  b: 1\n", ["line 3: got an entry that does not go on"]),
        ('family: "\\q"\n', ["line 1: got unknown escape character 'q'"]),
        ("family: f\npoints: 0\n", ["points", "got 0", "1 or more"]),
        ("family: f\npoints: 2.5\n", ["points", "got 2.5", "whole number"]),
        ("family: f\npoints: 501\n", ["points", "got 501", "at most 500"]),
        ("family: f\npoints: yes\n", ["points", "got true", "whole number"]),
        ("family: f\ngap: 2\n", ["gap", "1e-6 to 0.5"]),
        ("family: f\ngrid: maybe\n", ["grid", "'maybe'", "true"]),
        ("family: f\nseed: -1\n", ["seed", "0 or more"]),
        ("family: f\ntime_limit: 2 mm\n", ["time_limit", "2 mm"]),
        ("family: f\ntime_limit: -2\n", ["time_limit", "above zero"]),
        ("family: f\nweights: {mass: -1}\n", ["weights: mass", "zero or more"]),
        ("family: f\nobjectives: 3\n", ["objectives", "[mass, actuation_force]"]),
        ("family: f\nlimits: {d: 260}\n", ["limits: d", "got 260", "'<= 260 mm'"]),
        ("family: f\nparts: {p: {a: b}}\n", ["parts: p", "got a mapping"]),
        ("family: f\noptions: {a: 3}\n", ["options: a", "got 3"]),
        ("family: f\ncatalogs: 3\n", ["catalogs", "a folder, or a mapping"]),
        ("family: f\nrequirements: " + "[" * 3000, ["hoist.yaml"]),
    ],
)
def test_slips_are_told_in_one_sentence(tmp_path: Path, text: str, words: list[str]) -> None:
    message = str(refusal(write(tmp_path, text)))
    for word in words:
        assert word in message
    assert "hoist.yaml" in message


@pytest.mark.parametrize(
    ("raw", "word"),
    [(b"\x89PNG\r\n\x1a\n\x00\x00", "binary"), (b"family: f\xff\n", "UTF-8"), ("family: f".encode("utf-16"), "UTF-8")],
)
def test_what_is_not_text_is_refused(tmp_path: Path, raw: bytes, word: str) -> None:
    assert word in str(refusal(write(tmp_path, raw)))


def test_a_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    assert read_spec(write(tmp_path, b"\xef\xbb\xbf" + SMALL.encode())).family == "multi_plate_clutch"


def test_files_that_are_not_there(tmp_path: Path) -> None:
    assert "No such file" in str(refusal(tmp_path / "none.yaml"))
    assert "this is a folder" in str(refusal(tmp_path))
    assert "at most 1000 kB" in str(refusal(write(tmp_path, b"#" * 1_000_001)))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"family": "f", "family": "g"}', ["'family'", "twice"]),
        ('{"family": "f", "gap": NaN}', ["NaN", "finite"]),
        ('{"family": }', ["line 1", "JSON"]),
        ("", ["empty file"]),
        ("[" * 100_000, ["hoist.json"]),
    ],
)
def test_slips_in_json(tmp_path: Path, text: str, words: list[str]) -> None:
    message = str(refusal(write(tmp_path, text, "hoist.json")))
    assert all(word in message for word in words)


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("010", 10),  # not eight
        ("1:30", "1:30"),  # not ninety
        ("1_000", "1_000"),  # refused later, as a number that is not one
        ("0x1F", "0x1F"),
        ("2026-01-02", "2026-01-02"),
        ("1e3", 1000.0),
        ("-.5", -0.5),
        (".inf", ".inf"),
        ("6,5", "6,5"),
        ("~", None),
    ],
)
def test_yaml_without_its_surprises(tmp_path: Path, written: str, read: object) -> None:
    value = read_spec(write(tmp_path, f"family: f\nrequirements:\n  a: {written}\n")).requirements["a"]
    assert value == read
    assert type(value) is type(read)


def test_yes_and_no_are_words_where_an_option_is_meant(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, "family: f\noptions: {allow_obsolete: yes, other: off}\n"))
    assert spec.options == {"allow_obsolete": "yes", "other": "no"}


def test_flags_override_and_are_checked_like_the_file(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, SMALL + "points: 7\nseed: 3\n"))
    merged = spec.merged(points=2, seed=None, objectives=["mass"], time_limit="90")
    assert (merged.points, merged.seed, merged.objectives, merged.time_limit) == (2, 3, ("mass",), 90.0)
    assert spec.points == 7
    with pytest.raises(InputError, match="--points: got 0"):
        spec.merged(points=0)
    with pytest.raises(InputError, match="--time-limit"):
        spec.merged(time_limit="soon")
    with pytest.raises(InputError, match="point"):
        spec.merged(point=3)


def test_a_spec_cannot_be_changed(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, SMALL))
    with pytest.raises(TypeError):
        spec.requirements["load_torque"] = 1  # type: ignore[index]


@pytest.mark.slow
@settings(deadline=None, derandomize=True)
@given(st.dictionaries(st.sampled_from([*FIELDS, "other"]), JUNK, max_size=6))
def test_any_mapping_is_read_or_refused(content: dict[str, object]) -> None:
    try:
        spec = spec_from_mapping(content, "spec.yaml", Path())
    except InputError as error:
        assert str(error).startswith("spec.yaml")  # noqa: PT017  (either outcome is right, a third is not)
    else:
        assert spec.family == content["family"]


def written_out(content: Any, ending: str) -> str:
    """Text of a YAML or JSON file, however long its numbers are."""
    before = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)
    try:
        return json.dumps(content) if ending == "json" else yaml.safe_dump(content)
    finally:
        sys.set_int_max_str_digits(before)


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["yaml", "json"])
@settings(deadline=None, derandomize=True, max_examples=repetitions(200, 5000))
@given(content=ENTRIES)
def test_whatever_stands_in_a_spec_is_asked_or_refused(
    tmp_path_factory: pytest.TempPathFactory, ending: str, content: dict[str, Any]
) -> None:
    path = tmp_path_factory.getbasetemp() / f"spec.{ending}"
    path.write_text(written_out(HOIST | content, ending), encoding="utf-8")
    try:
        spec = read_spec(path)
        spec.settings()
        if not spec.compares:
            spec.request()
    except InputError as error:
        assert len(str(error)) < 2000  # noqa: PT017


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["yaml", "json"])
@pytest.mark.parametrize("digits", [400, 5000])
@pytest.mark.parametrize("key", FIELDS)
def test_numbers_without_end_are_refused_under_every_key(tmp_path: Path, key: str, digits: int, ending: str) -> None:
    for value in (10**digits, [10**digits], {"mass": 10**digits}, {"mass": [10**digits]}):
        path = write(tmp_path, written_out(HOIST | {key: value}, ending), f"hoist.{ending}")
        try:
            read = read_spec(path).stated([key])
        except InputError as error:
            assert "hoist" in str(error)  # noqa: PT017
        else:
            assert key in ("requirements", "fix", "values", "robust")
            assert digits == 400
            assert read == {key: value}  # one number there is refused by whoever knows its unit


def test_tolerances_that_are_no_mapping_are_refused(tmp_path: Path) -> None:
    spec = read_spec(write(tmp_path, written_out(HOIST | {"robust": {"tolerance": "+-1 mm"}}, "yaml")))
    with pytest.raises(InputError, match="robust: tolerance: got '\\+-1 mm'"):
        spec.request()


@pytest.mark.parametrize("tag", ["!!bool x", "!!timestamp x", "!!binary x", "!!int x", "!!set {a}", "!own x", "! x"])
def test_tags_of_yaml_are_refused(tmp_path: Path, tag: str) -> None:
    assert "line 4: got a tag" in str(refusal(write(tmp_path, SMALL + f"points: {tag}\n")))


@settings(deadline=None, derandomize=True)
@given(st.binary(max_size=60))
def test_any_bytes_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, raw: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "bytes.yaml"
    path.write_bytes(b"family: f\n" + raw)
    try:
        spec = read_spec(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017
    else:
        assert spec.family == "f"
