"""What an error says and where it points: no more of the input than people read, and a place for programs."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.declaration import Declaration
from synth.errors import InputError, UnknownOptionError, at, shortened, whole_number
from synth.question.catalogs import as_catalogs
from synth.question.spec import read_spec, spec_from_mapping
from synth.studies.families.requirement_sheet import applicants, sheet_of
from synth.text.input_limits import INPUT_LIMITS
from tests.asking import instance_of, steps_of

HUGE = ("x" * 100_000, "x " * 50_000, "5 " + "N" * 100_000)
# Twice the share of a field and the value, and our own words about what is right.
ROOM = 3 * INPUT_LIMITS.message + 600


class Shelf(synth.DesignProblem):
    """A shelf with one of everything that a user can state."""

    name, title = "shelf", "Shelf"

    def declare(self, d: Declaration) -> None:
        """Declare it."""
        d.option("finish", ("raw", "painted"), default="raw", text="Finish")
        load = d.requirement("load", "N", lower=1, upper=1e6, symbol="F", text="Load")
        width = d.requirement("width", "mm", lower=10, upper=1000, default=100, text="Width")
        height = d.variable("height", "mm", 1, 100, text="Height")
        boards = d.count("boards", 1, 5, text="Boards")
        steel = d.part("steel", "metals", text="Material")
        d.refuse("heavy", load > 9e5, "less load")
        d.derive("mass", "kg", 7850 * boards * height * width, text="Mass")
        d.at_most("stress", load * 0.1 / (boards * width * height**2), steel.yield_Re, "N/mm2", source="statics")
        d.objective("mass", "min")


GOOD: dict[str, Any] = {"requirements": {"load": "1 kN"}, "parts": {"steel": ["S185"]}}


def asked(**change: Any) -> Any:
    return synth.synthesize(Shelf(**change.pop("options", {})), **{**GOOD, **change})


def told(ask: Callable[[], Any]) -> InputError:
    with pytest.raises(InputError) as fault:
        ask()
    assert isinstance(fault.value, InputError)
    return fault.value


def test_what_python_refuses_to_write_is_refused_in_words() -> None:
    deep: list[Any] = []
    for _ in range(100_000):
        deep = [deep]
    for value in (10**5000, [10**5000], deep):
        error = InputError("points", value, "a whole number")
        assert str(error) == "points: got a value too long to be shown; expected a whole number"
        assert error.told()["value"] == "a value too long to be shown"


# ---- how much is repeated -------------------------------------------------------------------------------------------

DOORS: list[Callable[[str], Any]] = [
    lambda text: asked(requirements={"load": text}),
    lambda text: asked(requirements={text: "5 N"}),
    lambda text: asked(limits={"mass": text}),
    lambda text: asked(limits={text: "<= 5 kg"}),
    lambda text: asked(limits={"mass": f"<= {text}"}),
    lambda text: asked(fix={"height": text}),
    lambda text: asked(fix={text: 1}),
    lambda text: asked(fix={"steel": text}),
    lambda text: asked(parts={"steel": [text]}),
    lambda text: asked(parts={"steel": f"yield_Re > {text}"}),
    lambda text: asked(parts={text: "S185"}),
    lambda text: asked(objectives=[text]),
    lambda text: asked(objectives={"mass": text}),
    lambda text: asked(weights={text: 1}),
    lambda text: asked(weights={"mass": text}),
    lambda text: asked(points=text),
    lambda text: asked(catalogs=text),
    lambda text: asked(catalogs={text: "a.csv"}),
    lambda text: asked(robust={text: "+-5 %"}),
    lambda text: asked(robust={"load": text}),
    lambda text: asked(robust={"tolerance": {text: "+-5 %"}}),
    lambda text: asked(options={"finish": text}),
    lambda text: asked(options={text: "raw"}),
    lambda text: synth.load(text),
    lambda text: synth.whatif(Shelf(), **GOOD, vary={"load": text}),
    lambda text: synth.whatif(Shelf(), **GOOD, vary={"load": f"1,5 {text}"}),
    lambda text: synth.whatif(Shelf(), **GOOD, vary={text: "1 kN"}),
    lambda text: synth.whatif(Shelf(), **GOOD, vary={"parts.steel": text}),
    lambda text: synth.evaluate(Shelf(), {"load": "1 kN"}, values={"height": text}, parts={"steel": "S185"}),
    lambda text: synth.batch(Shelf(), [{"load": text, "parts": "steel = S185"}]),
    lambda text: synth.batch(Shelf(), [{"load": "1 kN", "limits": text}]),
    lambda text: synth.batch(Shelf(), [{"load": "1 kN", "parts": f"steel = {text}"}]),
    lambda text: read_spec(Path(text)),
    lambda text: spec_from_mapping({text: 1, "family": "shelf"}, "a.yaml", Path()),
    lambda text: spec_from_mapping({"family": "shelf", "points": text}, "a.yaml", Path()),
    lambda text: spec_from_mapping({"family": "shelf", "options": {text: 1}}, "a.yaml", Path()),
    lambda text: spec_from_mapping({"family": "shelf", "requirements": {text: [1]}}, "a.yaml", Path()),
    lambda text: spec_from_mapping({"family": "shelf", "time_limit": text}, "a.yaml", Path()),
]


@pytest.mark.slow
@pytest.mark.parametrize("text", HUGE, ids=["word", "words", "unit"])
@pytest.mark.parametrize("door", range(len(DOORS)))
def test_a_message_repeats_little_of_the_input(door: int, text: str) -> None:
    error = told(lambda: DOORS[door](text))
    assert len(str(error)) <= ROOM, str(error)
    assert all(text[k : k + INPUT_LIMITS.message + 1] not in str(error) for k in (0, 10_000, len(text) - 200))


def test_what_fits_is_repeated_as_it_is() -> None:
    assert shortened("load_torque") == "load_torque"
    assert shortened("x" * INPUT_LIMITS.message) == "x" * INPUT_LIMITS.message
    cut = shortened("a" * 1000 + "b" * 1000)
    assert len(cut) == INPUT_LIMITS.message
    assert cut.startswith("aaa")
    assert cut.endswith("bbb")
    assert " ... " in cut


def test_a_row_keeps_no_more_of_a_cell_than_it_says(tmp_path: Path) -> None:
    rows = [{"load": "9" * 5000, "parts": "steel = S185"}, {"load": "1 kN", "parts": "steel = S185"}]
    result = synth.batch(Shelf(), rows, tmp_path / "out")
    (bad, _) = result.rows()["explanation"]
    assert len(bad) <= ROOM


# ---- where it points ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"requirements": {"load": "1,5 N"}}, ("requirements", "load")),
        ({"requirements": {"F": "5 kg"}}, ("requirements", "load")),
        ({"requirements": {"load": "2 MN"}}, ("requirements", "load")),
        ({"requirements": {"load": "950 kN"}}, ("requirements", "load")),
        ({"requirements": {}}, ("requirements", "load")),
        ({"requirements": {"lode": "5 N"}}, ("requirements", "lode")),
        ({"requirements": {"load": "5 N", "F": "5 N"}}, ("requirements", "F")),
        ({"requirements": [1]}, ("requirements",)),
        ({"limits": {"mass": "<= 5 m"}}, ("limits", "mass")),
        ({"limits": {"mass": ["<= 5 kg", "6 kg"]}}, ("limits", "mass", 1)),
        ({"limits": {"mass": ["<= 5 kg", ">= 6 kg"]}}, ("limits", "mass", 1)),
        ({"limits": {"height": [">= 2 m"]}}, ("limits", "height", 0)),
        ({"limits": {"boards": ">= 7"}}, ("limits", "boards")),
        ({"limits": {"bulk": "<= 7"}}, ("limits", "bulk")),
        ({"limits": {"mass": ["<= 5 kg"] * 201}}, ("limits",)),
        ({"fix": {"height": "2 m"}}, ("fix", "height")),
        ({"fix": {"boards": 7}}, ("fix", "boards")),
        ({"fix": {"steel": "cheese"}}, ("fix", "steel")),
        ({"parts": {"steel": "cheese"}}, ("parts", "steel")),
        ({"parts": {"steel": ["S185", "cheese"]}}, ("parts", "steel", 1)),
        ({"parts": {"steel": "colour > 3"}}, ("parts", "steel")),
        ({"parts": {"steel": "yield_Re > '9000 N/mm2'"}}, ("parts", "steel")),
        ({"parts": {"wood": "oak"}}, ("parts", "wood")),
        ({"objectives": {"boards": "small"}}, ("objectives", "boards")),
        ({"objectives": ["boards"]}, ("objectives", "boards")),
        ({"weights": {"mass": -1}}, ("weights", "mass")),
        ({"points": 0}, ("points",)),
        ({"points": 10**9}, ("points",)),
        ({"points": 501}, ("points",)),
        ({"seed": 2**70}, ("seed",)),
        ({"workers": 10**6}, ("workers",)),
        ({"gap": 2}, ("gap",)),
        ({"time_limit": -1}, ("time_limit",)),
        ({"catalogs": {"metals": 5}}, ("catalogs", "metals")),
        ({"catalogs": {"woods": "a.csv"}}, ("catalogs", "woods")),
        ({"options": {"finish": "red"}}, ("options", "finish")),
        ({"options": {"colour": "red"}}, ("options", "colour")),
        ({"robust": {"load": "5 .. 4 N"}}, ("robust", "load")),
        ({"robust": {"lode": "+-5 %"}}, ("robust", "lode")),
        ({"robust": {"load": "+-5 %", "samples": 2**30}}, ("robust", "samples")),
        ({"robust": {"tolerance": {"width": "+-1 mm"}}}, ("robust", "tolerance", "width")),
        ({"robust": {f"load{k}": "+-5 %" for k in range(9)}}, ("robust",)),
        ({"robust": {"load": "+-5 %"}, "limits": {"mass": ["<= 5 kg"] * 201}}, ("limits",)),
    ],
    ids=str,
)
def test_a_path_points_at_what_is_wrong(change: dict[str, Any], path: tuple[Any, ...]) -> None:
    assert told(lambda: asked(**change)).path == path


def test_paths_of_a_spec_and_of_one_family_of_several() -> None:
    for content, path in (
        ({"family": "shelf", "points": "many"}, ("points",)),
        ({"family": "shelf", "requirements": {"load": [1, 2]}}, ("requirements", "load")),
        ({"family": "shelf", "colour": "red"}, ("colour",)),
        ({"family": ["shelf", {"family": "rack", "limits": {"mass": 5}}]}, ("family", 1, "limits", "mass")),
        ({"requirements": {}}, ("family",)),
    ):
        assert told(lambda: spec_from_mapping(content, "a.yaml", Path())).path == path  # noqa: B023
    entries = ["multi_plate_clutch", {"family": "disc_clutch", "options": {"colour": "red"}}]
    assert told(lambda: applicants(entries, sheet_of(), as_catalogs(None))).path == ("family", 1, "options", "colour")
    many = told(lambda: applicants(["disc_clutch"] * 101, sheet_of(), as_catalogs(None)))
    assert many.path == ("family",)


def test_paths_of_given_designs_studies_and_tables(tmp_path: Path) -> None:
    given = {"values": {"height": "2 mm", "boards": "2 kg"}, "parts": {"steel": "S185"}}
    assert told(lambda: synth.evaluate(Shelf(), {"load": "1 kN"}, given)).path == ("values", "boards")
    study = told(lambda: steps_of(Shelf(), {"load": "1 kN"}, {"load": "1, 2 kg"}, None))
    assert study.path == ("vary", "load")
    (tmp_path / "metals.csv").write_text("designation,yield_Re [N/mm2]\na,100\nb,much\n", encoding="utf-8")
    table = told(lambda: asked(catalogs={"metals": str(tmp_path / "metals.csv")}))
    assert table.path == ("catalogs", "metals", 3, "yield_Re")
    rows = told(lambda: synth.batch(Shelf(), [{"load [kN]": "much", "parts": "steel = S185"}]))
    assert rows.path == ("rows", 2, "load [kN]")


def test_readers_put_their_keys_in_front_and_workers_keep_them() -> None:
    error = InputError("mass", "5", "a comparison", ("mass", 0)).under("limits")
    assert error.path == ("limits", "mass", 0)
    again = pickle.loads(pickle.dumps(error))
    assert (again.field, again.value, again.expected, again.path) == ("mass", "5", "a comparison", error.path)
    assert str(again) == str(error)
    assert InputError("mass", 5, "less").path == ()
    with pytest.raises(InputError) as fault, at("family", 2), at("limits", "mass"):
        raise InputError("mass", 5, "less")
    assert fault.value.path == ("family", 2, "limits", "mass")
    unknown = told(lambda: Shelf(colour="red").model(frozenset(), as_catalogs(None)))
    assert type(pickle.loads(pickle.dumps(unknown))) is UnknownOptionError


# ---- how many -------------------------------------------------------------------------------------------------------


def test_as_many_limits_as_are_documented_are_read() -> None:
    most = [f"<= {5 + k} kg" for k in range(INPUT_LIMITS.limits)]
    read = instance_of(Shelf(), {"load": "1 kN"}, as_catalogs(None), limits={"mass": most}).limits.judging
    assert len(read) == len(most)
    refused = told(lambda: asked(limits={"mass": most * 100}))
    assert "20000 limits" in str(refused)
    assert "at most 200" in str(refused)


@pytest.mark.parametrize("value", [0, -1, 1.0, "3", True, None, 11, 10**400])
def test_what_is_no_count(value: Any) -> None:
    assert told(lambda: whole_number(value, "points", 10)).field == "points"


def test_the_maxima_are_those_of_the_documentation() -> None:
    text = (Path(synth.__file__).parent.parent / "docs" / "specs.md").read_text(encoding="utf-8")
    table = text[text.index("## At most") :]
    for name, most in vars(INPUT_LIMITS).items():
        assert f"| `{name}` |" in table, name
        row = next(line for line in table.splitlines() if line.startswith(f"| `{name}` |"))
        assert ("2^64 - 1" if name == "seed" else f"{most:,}".replace(",", " ")) in row, row
