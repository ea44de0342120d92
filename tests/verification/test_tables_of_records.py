"""Records of designs from tables of the user's own: where tables lie, are away, or have changed."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from typer.testing import CliRunner

import synth
from synth.analysis.design_spec import design_of_spec
from synth.declaration.records import RowRange
from synth.question.spec import read_spec
from synth.results.verification import Verdict
from synth.terminal.cli import app

UNITS = "designation,torque [N*m],mass [kg],diameter [mm],kind\nA,10,,80,x\nB,8,4,85,\nC,20,6,120,y\n"
CHANGED = "table units: row B has changed since the designs were saved"


class Unit(synth.DesignProblem):
    """A part that stands a load."""

    name = "unit"

    def declare(self, d):
        """Declare it."""
        load, unit = d.requirement("load", "N*m", lower=0.1, upper=100), d.part("unit", "units")
        d.derive("mass", "kg", unit.optional("mass"))
        d.derive("outer_diameter", "mm", unit.diameter)
        d.at_least("torque", unit.torque, load, "N*m")
        d.objective("outer_diameter")
        d.objective("mass")


@pytest.fixture
def place(tmp_path, monkeypatch):
    """Folder with a table, and in ``out`` a front that was found with it."""
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "units.csv").write_text(UNITS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    front = synth.synthesize(Unit(), {"load": "5 N*m"}, catalogs={"units": "tables/units.csv"})
    front.save("out")
    front.report("out")
    return tmp_path


def verified(folder: Path):
    """Return what checking the front in a folder shows."""
    return synth.load_front(folder).verify(problem=Unit)


def test_no_file_names_the_folders_of_this_machine(place):
    for path in (place / "out").iterdir():
        assert str(place) not in path.read_text(encoding="utf-8"), path.name
    assert "units: ../tables/units.csv" in (place / "out" / "design_01.yaml").read_text(encoding="utf-8")
    assert verified(place / "out").holds


def test_what_moves_together_is_found_again(place, tmp_path_factory):
    there = tmp_path_factory.mktemp("elsewhere") / "all"
    shutil.move(place, there)
    assert verified(there / "out").verdict is Verdict.HOLDS
    synth.load_front(there / "out").save(there / "deeper" / "again")
    content = json.loads((there / "deeper" / "again" / "front.json").read_text(encoding="utf-8"))
    assert content["restated"]["catalogs"] == {"units": "../../tables/units.csv"}
    assert verified(there / "deeper" / "again").holds


def test_rows_kept_stand_in_for_a_table_that_is_away(place, tmp_path_factory):
    there = tmp_path_factory.mktemp("elsewhere") / "out"
    shutil.copytree(place / "out", there)
    found = verified(there)
    assert (found.verdict, found.findings) == (Verdict.NOT_PROVEN, ())
    assert len(found.open) == 1
    assert "units.csv is not there; the rows kept with the designs are taken" in found.open[0]
    front = synth.load_front(there)
    front.report(there, problem=Unit)
    assert synth.calculation(front, problem=Unit).values(front.designs[0])["mass"] == 4.0
    with pytest.raises(synth.InputError, match="units"):
        front.improve(problem=Unit)  # a search among the rows kept would prove what is not so
    content = json.loads((there / "front.json").read_text(encoding="utf-8"))
    content["parts"]["units/B"]["mass"] = 5.0
    content["digest"] = synth.ParetoFront.digest_of({k: v for k, v in content.items() if k != "digest"})
    (there / "front.json").write_text(json.dumps(content), encoding="utf-8")
    assert verified(there).verdict is Verdict.REFUTED


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (
            UNITS.replace("B,8,4", "B,8,5"),
            "table units: row B has changed since the designs were saved: mass 4 kg, now 5 kg",
        ),
        (UNITS.replace("B,8,4", "Z,8,4"), "table units: row B is gone since the designs were saved"),
        (UNITS + "D,9,3,70,\n", "table units: it is not the one that the front was found with"),
    ],
)
def test_a_table_that_has_changed_is_named(place, table, told):
    (place / "tables" / "units.csv").write_text(table, encoding="utf-8")
    found = verified(place / "out")
    assert found.findings[0] == told
    assert found.verdict is Verdict.REFUTED


def test_the_checksum_of_the_result_comes_again(place):
    first, second = (
        synth.synthesize(Unit(), {"load": load}, catalogs={"units": file})
        for load, file in (("5 N*m", "tables/units.csv"), ("5 N*m", str(place / "tables" / "units.csv")))
    )
    assert first.result_digest == second.result_digest == synth.load_front("out").result_digest
    assert first.result_digest in (place / "out" / "report.html").read_text(encoding="utf-8")
    other = synth.synthesize(Unit(), {"load": "6 N*m"}, catalogs={"units": "tables/units.csv"})
    assert other.result_digest != first.result_digest


class Mounted(Unit):
    """A part of a table on a plate that an option fixes, with the screw that comes next, and the tool for it."""

    name = "mounted"
    screws = "designation,size [mm]\nM5,5\nM6,6\nM8,8\n"
    tools = "designation,over [mm],up_to [mm]\nsmall,0,5.5\nlarge,5.5,7\n"
    plates = "designation,width [mm],grade\nthin,3,a\nthick,5,b\n"

    def declare(self, d):
        """Declare it."""
        super().declare(d)
        plate = d.row("plates", d.option("plate", ("thin", "thick"), "thick"))
        wide = d.derive("width", "mm", plate.width + d.requirement("extra", "mm", 0.5, lower=0, upper=10))
        d.next_row("screw", wide, "screws", "size", beside=RowRange("tools", "over", "up_to"))


TABLES = ("units", "plates", "screws", "tools")


@pytest.fixture(params=["files", "memory"])
def mounted(request, tmp_path, monkeypatch):
    """Return what saves a front of tables that are files or in memory, and gives one of its design files alone."""
    families = [SimpleNamespace(name="mounted", load=lambda: Mounted)]
    monkeypatch.setattr("synth.model.registry.installed", lambda group: families)
    texts = {"units": UNITS, "plates": Mounted.plates, "screws": Mounted.screws, "tools": Mounted.tools}
    (tmp_path / "tables").mkdir()
    for name, text in texts.items():
        (tmp_path / "tables" / f"{name}.csv").write_text(text, encoding="utf-8")
    paths = {name: str(tmp_path / "tables" / f"{name}.csv") for name in texts}
    frames = {name: pd.read_csv(path) for name, path in paths.items()}

    def saved(extra="0.5 mm"):
        catalogs = paths if request.param == "files" else frames
        front = synth.synthesize(Mounted(), {"load": "5 N*m", "extra": extra}, catalogs=catalogs)
        front.save(tmp_path / "out")
        alone = tmp_path / "mail" / "deep" / "design_01.yaml"
        alone.parent.mkdir(parents=True)
        shutil.copy(tmp_path / "out" / "design_01.yaml", alone)
        return front, alone

    return saved


@pytest.mark.parametrize("extra", ["0.5 mm", "2.5 mm", "9 mm"])  # with a tool, without one, without a screw
def test_a_design_file_alone_brings_the_rows_it_uses(mounted, extra):
    front, alone = mounted(extra)
    asked = read_spec(alone)
    assert sorted(asked.rows) == sorted({row.key for row in (*front.designs[0].parts.values(), *front.designs[0].rows)})
    assert {key.partition("/")[0] for key in asked.rows} == set(TABLES)
    _, tables, design = design_of_spec(asked)
    first = front.designs[0]
    assert (design.objectives, design.limits, design.values) == (first.objectives, first.limits, first.values)
    assert {n: str(x) for n, x in design.next_rows.items()} == {n: str(x) for n, x in first.next_rows.items()}
    assert set(tables.away()) == set(TABLES)
    assert len(tables.differences()) == len(TABLES)
    found = CliRunner().invoke(app, ["check", str(alone)])
    assert found.exit_code == 0, found.output
    assert "the rows kept with the designs are taken" in found.output
    assert str(design.next_rows["screw"]).split(" (")[0] in found.output


def test_a_row_that_was_changed_in_a_design_file_is_refused(mounted):
    _, alone = mounted()
    text = alone.read_text(encoding="utf-8")
    for old, new in (("torque: 8.0", "torque: 9.0"), ("grade: b", "grade: c"), ("size: 0.006", "size: 0.0060001")):
        assert old in text
        alone.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(synth.InputError, match="a row that was changed; expected a row of a table as"):
            design_of_spec(read_spec(alone))
        found = CliRunner().invoke(app, ["check", str(alone)])
        assert isinstance(found.exception, synth.InputError)
    alone.write_text(text.replace("unit: B", "unit: C"), encoding="utf-8")
    with pytest.raises(synth.InputError, match=r"table units: got 'C'; .* one of B, the rows kept; .* is not there"):
        design_of_spec(read_spec(alone))


def test_a_front_alone_keeps_all_rows_that_its_designs_read(mounted, tmp_path):
    mounted()
    shutil.move(tmp_path / "tables", tmp_path / "gone")
    found = synth.load_front(tmp_path / "out").verify(problem=Mounted)
    assert (found.verdict, found.findings) == (Verdict.NOT_PROVEN, ())
    assert {sentence.split(":")[0] for sentence in found.open} == {f"table {name}" for name in TABLES}


@pytest.mark.parametrize(
    ("table", "old", "new", "told"),
    [
        ("plates", "thick,5", "thick,4", "row thick has changed since the designs were saved: width 5 mm, now 4 mm"),
        ("plates", "thick,5", "stout,5", "row thick is gone since the designs were saved"),
        ("screws", "M6,6", "M6,6.5", "row M6 has changed since the designs were saved: size 6 mm, now 6.5 mm"),
        (
            "tools",
            "large,5.5,7",
            "large,5.2,7",
            "row large has changed since the designs were saved: over 5.5 mm, now 5.2 mm",
        ),
    ],
)
def test_changes_of_every_row_that_is_read_are_named(tmp_path, monkeypatch, table, old, new, told):
    texts = {"units": UNITS, "plates": Mounted.plates, "screws": Mounted.screws, "tools": Mounted.tools}
    for name, text in texts.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    front = synth.synthesize(Mounted(), {"load": "5 N*m"}, catalogs={n: str(tmp_path / f"{n}.csv") for n in texts})
    front.save(tmp_path / "out")
    (tmp_path / f"{table}.csv").write_text(texts[table].replace(old, new), encoding="utf-8")
    if new.startswith("stout"):
        (tmp_path / f"{table}.csv").write_text(texts[table].replace(old, new) + "other,5,b\n", encoding="utf-8")
        with pytest.raises(synth.InputError, match="thick"):
            synth.load_front(tmp_path / "out").verify(problem=Mounted)
        return
    found = synth.load_front(tmp_path / "out").verify(problem=Mounted)
    assert f"table {table}: {told}" in found.findings
    assert found.verdict is Verdict.REFUTED


def test_near_equals_name_tables_from_their_folder(place):
    front = synth.load_front(place / "out")
    synth.near_equals(front, 1, "50 %", problem=Unit, catalogs={"units": str(place / "tables" / "units.csv")}).save(
        place / "deep" / "near"
    )
    for path in (place / "deep" / "near").iterdir():
        assert str(place) not in path.read_text(encoding="utf-8"), path.name
    text = (place / "deep" / "near" / "design_00.yaml").read_text(encoding="utf-8")
    assert "units: ../../tables/units.csv" in text
    assert "units/B" in text
