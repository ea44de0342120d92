"""Designs and fronts: immutable, saved whole, read back the same."""

import csv
import dataclasses
import hashlib
import json
import math
import re
from itertools import product

import numpy as np
import pytest
import yaml

import synth
from synth.folders.files import write_atomically
from synth.results import Certificate
from synth.results.front_record import FRONT_FORMAT
from synth.tables.reading import OF_RECORD
from synth.units import from_si
from tests.sample_problems.strut import NEEDED, RODS, Strut

ASKED = {**NEEDED, "room": "90 mm"}
PARTS = {"plate": ["core 1", "core 2", "core 4"]}


def search(**more):
    return synth.synthesize(
        Strut(finish="coated"), ASKED, points=5, parts=PARTS, catalogs={"rods": RODS}, seed=3, **more
    )


@pytest.fixture(scope="module")
def front():
    return search()


@pytest.fixture(scope="module")
def folder(front, tmp_path_factory):
    return front.save(tmp_path_factory.mktemp("front"))


@pytest.fixture(scope="module")
def content(folder):
    return json.loads((folder / "front.json").read_text(encoding="utf-8"))


def test_designs_come_in_rank_order(front):
    assert [d.rank for d in front.designs] == list(range(1, len(front.designs) + 1))
    assert len(front.designs) == 5
    scores = [d.score for d in front.designs]
    assert scores == sorted(scores)
    values = np.array([list(d.objectives.values()) for d in front.designs])
    ratios = np.log(values / values.min(axis=0))
    assert scores == pytest.approx(np.sqrt(np.mean(ratios**2, axis=1)))


def test_a_design_cannot_be_changed(front):
    with pytest.raises(dataclasses.FrozenInstanceError):
        front.designs[0].rank = 7
    with pytest.raises(dataclasses.FrozenInstanceError):
        front.status = None


def test_a_part_reads_like_its_row(front):
    row = front.designs[0].parts["material"]
    assert str(row) == row["designation"]
    assert row["density"] in (7850.0, 7900.0)
    assert row["table"] == "rods"
    assert row["source"] in ("handbook", "guess")
    assert row["confidence"] == "user"
    assert len(row["hash"]) == 64
    assert set(row) >= {"designation", "stress_allow", "density", "table", "hash"}
    assert len(list(row)) == len(row)


# -- files -------------------------------------------------------------------------------------------


def test_every_design_has_its_file(front, folder):
    assert {p.name for p in folder.iterdir()} == {
        "designs.csv",
        "calculation.json",
        "front.json",
        "offered.json",
        *(f"design_{k:02d}.yaml" for k in range(1, 6)),
    }


def test_the_table_has_units_in_its_headers_and_stable_columns(folder):
    rows = list(csv.reader((folder / "designs.csv").read_text(encoding="utf-8").splitlines()))
    assert rows[0] == [
        "rank",
        "score",
        "status",
        "gap",
        "note",
        "alternatives",
        "mass [kg]",
        "flexibility [-]",
        "width [mm]",
        "length [mm]",
        "plates [-]",
        "end",
        "plate",
        "material",
        "area [mm2]",
        "utilisation: stress",
        "utilisation: reach",
        "utilisation: room",
    ]
    assert len(rows) == 6
    assert {len(r) for r in rows} == {len(rows[0])}


def test_the_table_has_full_precision_and_empty_cells_for_what_is_void(front, folder):
    rows = list(csv.DictReader((folder / "designs.csv").read_text(encoding="utf-8").splitlines()))
    for row, design in zip(rows, front.designs, strict=True):
        # A shorter number is shown where it stands for the same value to two units in the last place.
        assert float(row["mass [kg]"]) == pytest.approx(design.values["mass"], rel=5e-16)
        assert float(row["width [mm]"]) == from_si(design.values["width"], "mm")
        assert row["material"] == str(design.parts["material"])
        used = design.utilisation["stress"]
        assert row["utilisation: stress"] == ("" if used is None else repr(used))
    void = [r["utilisation: stress"] == "" for r in rows]
    assert any(void)
    assert not all(void)


def test_two_runs_write_the_same_bytes(front, tmp_path):
    again = search()
    first, second = front.save(tmp_path / "a"), again.save(tmp_path / "b")
    names = sorted(p.name for p in first.iterdir())
    assert names == sorted(p.name for p in second.iterdir())
    for name in names:
        if name != "front.json":  # has the seconds of the run
            assert (first / name).read_bytes() == (second / name).read_bytes()


def test_another_seed_gives_the_same_designs(front):
    other = synth.synthesize(
        Strut(finish="coated"), ASKED, points=5, parts=PARTS, catalogs={"rods": RODS}, seed=99, objectives=["mass"]
    )
    one = synth.synthesize(
        Strut(finish="coated"), ASKED, points=5, parts=PARTS, catalogs={"rods": RODS}, seed=3, objectives=["mass"]
    )
    assert other.designs[0].values["mass"] == pytest.approx(one.designs[0].values["mass"], rel=2e-3)


def test_the_record_tells_what_was_asked(content):
    assert content["format"] == FRONT_FORMAT
    assert (content["family"], content["title"]) == ("strut", "Strut")
    assert content["options"] == {"finish": "coated"}
    assert content["requirements"] == {"load": "20 kN", "room": "90 mm"}
    assert content["requirement_values_si"] == {"load": 20000.0, "room": 0.09, "safety": 1.5}
    assert content["not_asked"] == []
    assert content["objectives"] == {"mass": "min", "flexibility": "min"}
    settings = content["settings"]
    assert (settings["points"], settings["gap"], settings["grid"], settings["seed"]) == (5, 1e-3, True, 3)
    assert settings["parts"] == PARTS
    assert content["units"]["width"] == "mm"
    assert content["kinds"]["area"] == "derived"
    assert content["limit_senses"] == {"stress": "at_most", "reach": "at_least", "room": "at_most"}


def test_the_record_names_the_packages_that_decide_the_numbers(content):
    import casadi
    import numpy

    assert set(content["versions"]) == {"clutchsynth", "casadi", "numpy", "scipy", "moocore"}
    assert content["versions"]["casadi"] == casadi.__version__
    assert content["versions"]["numpy"] == numpy.__version__


def test_the_record_has_the_rows_used_with_their_hashes(front, content):
    used = {f"{row['table']}/{row}" for d in front.designs for row in d.parts.values()}
    assert set(content["parts"]) == used
    for key, row in content["parts"].items():
        assert key == f"{row['table']}/{row['designation']}"
        cells = {k: v for k, v in row.items() if k not in OF_RECORD and v is not None}
        canonical = json.dumps(cells, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
        assert row["hash"] == hashlib.sha256(canonical.encode()).hexdigest()


def test_the_record_tells_how_far_the_front_is_proven(front, content):
    assert content["status"] == front.status.value
    assert content["complete"] is front.complete
    certificate = content["certificate"]
    assert certificate["kind"] == front.certificate.kind
    assert certificate["combinations"] == front.statistics["combinations"] == 3 * 3 * 4 * 2
    assert content["statistics"]["seconds"]["total"] > 0


def test_a_front_reads_back_the_same(front, folder):
    again = synth.load_front(folder)
    assert again.frame == front.frame
    assert (again.status, again.complete, again.certificate) == (front.status, front.complete, front.certificate)
    assert again.settings == front.settings
    for old, new in zip(front.designs, again.designs, strict=True):
        assert new.status is old.status
        assert (new.rank, new.score, new.note, new.gap) == (old.rank, old.score, old.note, old.gap)
        assert (new.alternatives, new.advice, new.not_checked, new.violated) == (
            old.alternatives,
            old.advice,
            old.not_checked,
            old.violated,
        )
        assert {k: str(v) for k, v in new.parts.items()} == {k: str(v) for k, v in old.parts.items()}
        assert new.parts["plate"]["hash"] == old.parts["plate"]["hash"]
        assert new.objectives == old.objectives
        assert new.utilisation == old.utilisation
        assert new.elasticity == old.elasticity
        for name, value in old.values.items():
            assert new.values[name] == value or (math.isnan(value) and math.isnan(new.values[name]))
    assert again.to_frame().equals(front.to_frame())


def test_saving_again_writes_the_same_bytes(folder, tmp_path):
    copy = synth.load_front(folder).save(tmp_path / "copy")
    for path in folder.iterdir():
        assert (copy / path.name).read_bytes() == path.read_bytes()


def test_designs_of_an_earlier_front_are_taken_away(front, tmp_path):
    target = front.save(tmp_path)
    (target / "design_99.yaml").write_text("stale", encoding="utf-8")
    (target / "notes.txt").write_text("mine", encoding="utf-8")
    front.save(tmp_path)
    assert not (target / "design_99.yaml").exists()
    assert (target / "notes.txt").read_text(encoding="utf-8") == "mine"


def test_a_design_file_says_the_same_design_in_few_digits(front, folder):
    for design in front.designs:
        spec = yaml.safe_load((folder / f"design_{design.rank:02d}.yaml").read_text(encoding="utf-8"))
        whole = design.to_spec()
        assert {**spec, "values": 0} == {**whole, "values": 0}
        assert list(spec["values"]) == list(whole["values"])
        assert isinstance(spec["values"]["plates"], int)
        assert all(len(str(text).split()[0]) <= 13 for text in spec["values"].values())
        assert list(spec) == ["family", "options", "requirements", "values", "parts", "rows"]
        problem = Strut(**spec["options"])
        rods = {"rods": RODS}
        again = synth.evaluate(problem, spec["requirements"], spec, catalogs=rods)
        assert again.status.value == "feasible"
        for name in front.frame.objectives:
            assert again.values[name] == pytest.approx(design.values[name], rel=1e-9)
        exact = synth.evaluate(problem, spec["requirements"], whole, catalogs=rods)
        assert exact.values == design.values
        assert exact.utilisation == design.utilisation
        assert again.off_grid == exact.off_grid == {}
        direct = synth.evaluate(problem, ASKED, design, catalogs=rods)
        assert direct.values == design.values


def test_a_file_of_an_earlier_version_stays_what_it_was(front):
    design = dataclasses.replace(front.designs[0], digits=None)
    assert yaml.safe_load(design.yaml()) == design.to_spec()


def test_the_table_as_a_frame(front):
    frame = front.to_frame()
    assert list(frame["rank"]) == [1, 2, 3, 4, 5]
    assert frame.loc[1, "mass [kg]"] == from_si(front.designs[0].values["mass"], "kg")
    assert frame.loc[1, "width [mm]"] == from_si(front.designs[0].values["width"], "mm")


def test_an_infeasible_front_is_saved_and_read_too(tmp_path):
    front = synth.synthesize(
        Strut(), NEEDED, catalogs={"rods": RODS[:2]}, limits={"width": "<= 6 mm"}, parts={"plate": ["core 1"]}
    )
    assert front.status.value == "infeasible"
    assert len(front.designs) == 0
    assert "stress" in [c["limit"] for c in front.explanation["conflicts"]]
    assert "stress" in front.explanation["message"]
    target = front.save(tmp_path)
    assert not list(target.glob("design_*.yaml"))
    again = synth.load_front(target)
    assert again.status.value == "infeasible"
    assert again.explanation == front.explanation
    assert len((target / "designs.csv").read_text(encoding="utf-8").splitlines()) == 1


# -- writing -----------------------------------------------------------------------------------------


def test_a_file_is_whole_or_the_old_one(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    write_atomically(path, "old\n")

    def broken(self, target):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(type(path), "replace", broken)
        with pytest.raises(OSError, match="No space"):
            write_atomically(path, "new\n")
    assert path.read_text(encoding="utf-8") == "old\n"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    write_atomically(path, "new\r\n")
    assert path.read_bytes() == b"new\r\n"


def test_a_place_that_cannot_be_written_is_told(front, tmp_path):
    file = tmp_path / "file"
    file.write_text("x", encoding="utf-8")
    with pytest.raises(synth.InputError, match="a folder; this is a file"):
        front.save(file)
    with pytest.raises(synth.InputError, match="a folder that can be written"):
        front.save(file / "below")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no JSON"),
        ("{", "no JSON"),
        ("[]", "this one is no JSON object"),
        ("null", "this one is no JSON object"),
        ('{"format": 0}', "format: got 0; expected format 1"),
        ("{}", "format: is missing; expected format 1"),
    ],
)
def test_a_file_that_is_no_front_is_told(tmp_path, text, words):
    (tmp_path / "front.json").write_text(text, encoding="utf-8")
    with pytest.raises(synth.InputError, match=f"front.*{words}"):
        synth.load_front(tmp_path)
    with pytest.raises(synth.InputError, match="front"):
        synth.load_front(tmp_path / "nowhere")


def test_certificates_in_words():
    proven = Certificate("global", 0.001, 1234567, 1234000, 567)
    assert "1 234 567 combinations" in proven.sentence()
    assert "more than 0.1 % in every objective" in proven.sentence()
    assert "10 are excluded" in Certificate("exhaustive", None, 12, 10, 2, 3).sentence()
    assert "not proven" in Certificate("heuristic", None, 12, 10, 2, 3).sentence()


WRONG_NUMBER = re.compile(
    r"\b(?:only combination(?: of parts and counts)? (?:were|are)|(?<!\d)(?<!\d )1 (?:were|are|boxes|combinations)"
    r"|(?:[02-9]|\d[\d ]*\d) (?:was|is|box|combination)\b|of the only combination|all [01] combinations)"
)


@pytest.mark.parametrize("kind", ["global", "exhaustive", "heuristic"])
@pytest.mark.parametrize("combinations", [1, 2, 12000])
def test_certificates_agree_in_number(kind, combinations):
    for excluded, solved, unresolved in product({0, 1, combinations - 1}, {0, 1, combinations}, (0, 1, 2)):
        for gap in (None, 0.01):
            made = Certificate(kind, gap, combinations, excluded, solved, unresolved)
            for sentence in (made.sentence(), made.of_no_design()):
                assert not WRONG_NUMBER.search(sentence), sentence
