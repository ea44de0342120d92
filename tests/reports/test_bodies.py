"""Round parts of drawings as bodies: as large and as heavy as they are drawn, in STEP and in glTF."""

from __future__ import annotations

import json
import math
import struct

import pytest
from synth.reports.drawing.bodies import assembly, glb_of, not_bodies, plain, round_areas, step_of

import synth
from synth.analysis.drawing import drawing_of, quantity_of, weighed
from synth.analysis.reporting import report
from synth.drawing import Area, Drawing, Item, Line, LineKind, View, disc, rectangle
from synth.errors import InputError
from synth.results.report_request import About, ReportOptions

pytestmark = pytest.mark.slow

MULTI_PLATE = ("load_torque", "600 N*m"), ("driver_speed", "254 rpm"), ("driven_inertia", "30 kg*m2")


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(
        "multi_plate_clutch",
        dict(MULTI_PLATE),
        parts={"friction_pair": ["paper_wet"], "inner_plate": ["core 2.5"], "outer_plate": ["core 1.8"]},
        fix={"ramp_time": "2 s"},
        points=1,
    )


def everything() -> Drawing:
    """Return a drawing with round parts of every kind, and parts that are none."""
    rounded = ((0.0, 50.0), (10.0, 50.0), (10.0, 60.0, math.tan(math.pi / 8)), (5.0, 65.0), (0.0, 65.0), (0.0, 65.0))
    section = View(
        "Section",
        (
            Area(rectangle(-8, 30, 0, 12), 1, cut=False),
            Area(rectangle(0, 20, 15, 40), 2, holes=(disc((10, 28), 5),)),
            *(Area(rectangle(3 * k, 3 * k + 2, 40, 43), 3, half=True) for k in range(4)),
            *(Area(rectangle(3 * k + 1.5, 3 * k + 3.5, -43, -40), 3, half=True) for k in range(4)),
            Area(rounded, 4),
            Area(disc((25, 30), 4), 5, cut=False),
            Line((-8, 0), (-8, 70), LineKind.PHANTOM),
        ),
        revolved=True,
    )
    front = View("Front view", (Area(disc((0, 0), 20), 6, depth=4.0),))
    names = ("Shaft", "Ring", "Spring", "Külső gyűrű", "Ball", "Plate")
    return Drawing("all", (section, front), tuple(Item(k, name) for k, name in enumerate(names, 1)), ("the rest",))


def test_only_what_is_round_about_the_axis_is_a_body():
    drawing = everything()
    assert {item: len(areas) for item, areas in round_areas(drawing).items()} == {1: 1, 2: 1, 3: 8, 4: 1}
    assert [item.name for item in not_bodies(drawing)] == ["Ball", "Plate"]
    assert plain("Külső <gyűrű>") == "Kulso <gyuru>"
    assert plain("歯車") == "part"


def test_the_extra_is_named_where_it_is_missing(front, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "build123d", None)
    for word in ("step", "glb"):
        with pytest.raises(InputError, match=r"^--step needs the extra step: pip install 'clutchsynth\[step\]'$"):
            report(front, tmp_path, ReportOptions.read([word]))
    assert list(tmp_path.iterdir()) == []


def test_a_drawing_without_round_parts_has_no_bodies_and_it_is_told(front, tmp_path, monkeypatch):
    def flat(self, spec, design):
        area = Area(disc((0, 0), 20), 1, depth=4.0)
        return Drawing("front view", (View("Front view", (area,)),), (Item(1, "Plate"),), ("the rest",))

    monkeypatch.setattr(type(synth.load("multi_plate_clutch")), "drawing", flat)
    written = report(front, tmp_path, ReportOptions.read(["svg", "step", "glb"]))
    assert [name for name in written.files if "drawing" in name] == ["design_01_drawing.svg"]
    assert written.lacking == ()  # nothing is missed where there is nothing to make
    assert written.notes == [
        "STEP and glTF are without all parts (Plate): only parts that are round about the axis are bodies"
    ]


def test_bodies_are_as_large_and_as_heavy_as_they_are_drawn(front, tmp_path):
    cad = pytest.importorskip("build123d")
    design = front.designs[0]
    for drawing in (everything(), drawing_of(synth.load("multi_plate_clutch"), design)):
        file = tmp_path / "bodies.step"
        file.write_bytes(step_of(drawing, "Clutch", "program"))
        read = cad.import_step(file)
        there = round_areas(drawing)
        named = [item for item in drawing.items if item.number in there]
        assert [child.label.replace("_", " ") for child in read.children] == [plain(item.name) for item in named]
        for item, child in zip(named, read.children, strict=True):
            solids = child.solids()
            assert len(solids) == len(there[item.number])
            assert all(solid.is_valid for solid in solids)
            assert child.volume == pytest.approx(sum(area.volume for area in there[item.number]), rel=1e-6)
        corners = [v for areas in there.values() for area in areas for v in area.outline]
        box, across = read.bounding_box(optimal=True), max(abs(v[1]) for v in corners)
        assert (box.min.X, box.max.X) == pytest.approx((min(v[0] for v in corners), max(v[0] for v in corners)))
        assert (box.min.Y, box.max.Y, box.min.Z, box.max.Z) == pytest.approx((-across, across, -across, across))
    volumes = {item.number: child.volume * 1e-9 for item, child in zip(named, read.children, strict=True)}
    assert drawing.weights
    for weight, (names, _, mass) in zip(drawing.weights, weighed(drawing, design), strict=True):
        density = quantity_of(design, weight.density)
        assert density * sum(volumes[k] for k in weight.items if k in volumes) == pytest.approx(mass, rel=1e-6), names


def test_the_model_for_the_screen_has_the_same_parts_and_size():
    pytest.importorskip("build123d")
    drawing = everything()
    content = glb_of(drawing, "Clutch", "program")
    assert content[:4] == b"glTF"
    (length,) = struct.unpack("<I", content[12:16])
    told = json.loads(content[20 : 20 + length])
    assert {"Clutch", "Shaft", "Ring", "Spring", "Spring 8", "Kulso gyuru"} <= {node["name"] for node in told["nodes"]}
    places = [told["accessors"][p["attributes"]["POSITION"]] for m in told["meshes"] for p in m["primitives"]]
    assert max(place["max"][0] for place in places) == pytest.approx(0.030)
    assert max(place["max"][1] for place in places) == pytest.approx(0.065, rel=2e-3)


def test_the_same_drawing_gives_the_same_files():
    pytest.importorskip("build123d")
    drawing = everything()
    assert step_of(drawing, "Clutch", "program") == step_of(drawing, "Clutch", "program")
    assert glb_of(drawing, "Clutch", "program") == glb_of(drawing, "Clutch", "program")
    assert b"'2026-03-01T00:00:00'" in step_of(drawing, "Clutch", "program", About(date="2026-03-01"))


def test_files_of_a_report_are_written(front, tmp_path):
    pytest.importorskip("build123d")
    written = report(front, tmp_path, ReportOptions.read(["step", "glb"]))
    assert {"design_01_drawing.step", "design_01_drawing.glb"} <= set(written.files)
    assert written.notes == []


def test_halves_of_coils_stand_on_the_side_where_they_are_drawn():
    pytest.importorskip("build123d")
    coils = assembly(everything(), "Clutch").children[2].solids()
    assert [coil.center().Y > 0 for coil in coils] == [True] * 4 + [False] * 4
    assert [coil.bounding_box().min.Y >= -1e-3 for coil in coils] == [True] * 4 + [False] * 4
