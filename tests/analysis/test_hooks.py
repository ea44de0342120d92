"""Hooks of a family: what the engine hands to them, and what it does with what they return."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd
import pytest

import synth
from synth.analysis.hooks import OPINION
from synth.declaration import Setting


class Rod(synth.DesignProblem):
    """A rod that swings at the end."""

    name, title = "rod", "Rod"
    simulation_settings = {  # noqa: RUF012
        "damping": Setting("loss per swing", unit="N*m"),
        "shape": Setting("course", choices=("straight", "bent")),
        "plate": Setting("end plate", table="core_plates"),
    }

    def declare(self, d: Any) -> None:
        d.option("finish", ("plain", "coated"), "plain")
        force = d.requirement("force", "kN", lower=1, upper=100)
        d.requirement("room", "mm", default=20)
        d.requirement("reach", "mm", optional=True)
        diameter = d.variable("diameter", "mm", 1, 100)
        d.derive("stress", "N/mm2", force / diameter**2)
        d.derive("nothing", "J", 0 * diameter)
        d.at_most("stress", force / diameter**2, 100e6, "N/mm2")
        d.objective("diameter")

    def simulate(self, spec: Any, design: Any) -> Any:
        self.seen = (dict(spec), design, self.option("finish"))
        frame = pd.DataFrame({"time [s]": [0.0, 1.0], "angle [deg]": [0.0, 3.0]})
        stress = design.values["stress"] * 1.01
        frame.attrs = {"title": "Swing", "quantities": {"stress": stress, "nothing": 0.5, "unknown": 1.0}}
        more = pd.DataFrame({"time [s]": [0.0]})
        more.attrs = {"title": "Again", "quantities": {"stress": 0.0, "diameter": math.nan}}
        return {"motion": frame, "again": more}

    def curves(self, spec: Any, design: Any = None) -> Any:
        frame = pd.DataFrame({"force [kN]": [0.0, spec["force"] / 1e3]})
        frame.attrs = {"title": "with a design" if design else "without"}
        return {"curve": frame}


DESIGN = {"values": {"diameter": "20 mm"}, "parts": {}}


def test_a_hook_sees_requirements_options_settings_and_the_design() -> None:
    rod = Rod(finish="coated")
    settings = {"damping": "2 N*m", "shape": "bent", "plate": "core 2"}
    frames = synth.simulate(rod, {"force": "4 kN"}, DESIGN, settings=settings)
    spec, design, finish = rod.seen
    assert list(frames) == ["motion", "again"]
    assert spec["force"] == 4000
    assert spec["room"] == pytest.approx(0.02)
    assert spec["reach"] is None
    assert (spec["damping"], spec["shape"], spec["plate"]["thickness"]) == (2, "bent", pytest.approx(0.002))
    assert finish == "coated"
    assert Rod().option("finish") == "plain"
    assert design.values["diameter"] == pytest.approx(0.02)
    # What is not told is not there.
    synth.simulate(rod, {"force": "4 kN"}, DESIGN)
    assert set(rod.seen[0]) == {"force", "room", "reach"}
    # A design of a front goes the same way, and so does one of a search.
    synth.simulate(rod, {"force": "8 kN"}, design)
    assert rod.seen[1].values["stress"] == pytest.approx(20e6)


def test_the_second_opinion_stands_beside_the_closed_form() -> None:
    rod = Rod()
    design = synth.evaluate(rod, {"force": "4 kN"}, DESIGN)
    opinion = synth.second_opinion(design, synth.simulate(rod, {"force": "4 kN"}, design))
    assert list(opinion.columns) == OPINION
    rows = opinion.set_index("quantity")
    assert rows.index.tolist() == ["stress", "nothing", "diameter"]  # each once, unknown names left alone
    assert rows.loc["stress", "unit"] == "N/mm2"
    assert rows.loc["stress", ["closed_form", "simulation", "difference"]].tolist() == pytest.approx([10, 10.1, 0.1])
    assert rows.loc["stress", "relative_difference"] == pytest.approx(0.01)
    assert math.isnan(rows.loc["nothing", "relative_difference"])
    assert math.isnan(rows.loc["diameter", "simulation"])
    assert synth.second_opinion(design, synth.curves(rod, {"force": 4})).empty


def test_curves_come_with_and_without_a_design() -> None:
    assert synth.curves(Rod, {"force": 4})["curve"].attrs["title"] == "without"
    assert synth.curves(Rod, {"force": 4}, DESIGN)["curve"].attrs["title"] == "with a design"
    assert synth.curves(Rod, {"force": 4}, values={"diameter": 20})["curve"]["force [kN]"].tolist() == [0, 4]


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"dampning": 1}, "settings: got 'dampning'; expected damping"),
        ({"x": 1}, "expected damping, shape, plate"),
        ({"damping": "2 kg"}, "settings: damping: got '2 kg'"),
        ({"shape": "round"}, "settings: shape: got 'round'; expected one of straight, bent"),
        ({"plate": "core 4711"}, "core 4711"),
        ("damping", "settings: got 'damping'"),
    ],
)
def test_wrong_settings_are_refused(settings: Any, words: str) -> None:
    with pytest.raises(synth.InputError) as told:
        synth.simulate(Rod, {"force": 4}, DESIGN, settings=settings)
    assert words in str(told.value)


def test_a_family_without_hooks_says_so() -> None:
    class Plain(Rod):
        name, title = "plain", "Plain"
        simulation_settings = {}  # noqa: RUF012

        def simulate(self, spec: Any, design: Any) -> Any:
            return None

        def curves(self, spec: Any, design: Any = None) -> Any:
            return {}

    with pytest.raises(synth.InputError, match="got 'plain'; expected a family that has a simulation"):
        synth.simulate(Plain, {"force": 4}, DESIGN)
    with pytest.raises(synth.InputError, match="got 'plain'; expected a family that has curves"):
        synth.curves(Plain, {"force": 4})
    with pytest.raises(synth.InputError, match="no settings"):
        synth.simulate(Plain, {"force": 4}, DESIGN, settings={"damping": 1})
    assert synth.DesignProblem.simulate(Plain(), {}, None) is None  # type: ignore[arg-type]
    assert synth.DesignProblem.curves(Plain(), {}) is None


@pytest.mark.parametrize(
    ("key", "columns", "attrs", "words"),
    [
        ("Curve 1", ["a [m]"], {"title": "t"}, "no file name"),
        ("../curve", ["a [m]"], {"title": "t"}, "no file name"),
        ("curve", ["a [m]"], {}, "title"),
        ("curve", ["a [m]", "b"], {"title": "t"}, "column 'b' needs a unit"),
    ],
)
def test_faults_of_a_hook_are_named(key: str, columns: list[str], attrs: Any, words: str) -> None:
    class Faulty(Rod):
        name = "faulty"

        def curves(self, spec: Any, design: Any = None) -> Any:
            frame = pd.DataFrame([[1.0] * len(columns)], columns=columns)
            frame.attrs = attrs
            return {key: frame}

    with pytest.raises(ValueError, match=r"Faulty\.curves") as told:
        synth.curves(Faulty, {"force": 4})
    assert words in str(told.value)
    assert not isinstance(told.value, synth.InputError)


def test_settings_are_described_and_their_tables_may_be_replaced(tmp_path: Any) -> None:
    rows = synth.describe(Rod).query("kind == 'setting'").set_index("name")
    assert rows.index.tolist() == ["damping", "shape", "plate"]
    assert rows.loc["damping", "unit"] == "N*m"
    assert rows.loc["shape", "choices"] == "straight, bent"
    assert rows.loc["plate", "choices"] == "rows of core_plates"
    own = pd.DataFrame({"designation": ["thick"], "thickness [mm]": [9.0]})
    rod = Rod()
    synth.simulate(rod, {"force": 4}, DESIGN, catalogs={"core_plates": own}, settings={"plate": "thick"})
    assert rod.seen[0]["plate"]["thickness"] == pytest.approx(0.009)
