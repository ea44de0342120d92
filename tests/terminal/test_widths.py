"""Screens fit the terminal, in numbers and words of engineers: 80, 100 and 160 columns."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from tests.terminal.entry import at_once, in_process

pytestmark = pytest.mark.slow

COLUMNS = (80, 100, 160)
ANSWERS = (
    "synth.search.synthesize.find_front",
    "synth.studies.families.compare.compare",
    "synth.studies.infeasibility.explain.explanation_of",
)
EXPONENT = re.compile(r"\d[eE][+-]\d")
FOREIGN = re.compile(r"\b(None|nan|inf|nlp|True|False)\b")
SPEC = """
family: multi_plate_clutch
requirements: {load_torque: 250 N*m, driver_speed: 950 rpm, driven_inertia: 1.2 kg*m2}
fix: {ramp_time: 0.5 s}
parts: {friction_pair: [paper_wet], inner_plate: [core 2], outer_plate: [core 2]}
limits: {friction_surfaces: [6, 8]}
objectives: [mass]
points: 2
"""
TIGHT = """
family: roller_coupling
requirements: {required_torque: 300 N*m, driver_speed: 960 1/min, offset: 5 mm, outer_diameter_limit: 120 mm}
parts: {roller: [NATR 17], float_material: [100Cr6]}
"""
KINDS = """
family:
  - family: multi_plate_clutch
    parts: {friction_pair: [paper_wet], inner_plate: [core 2], outer_plate: [core 2]}
    limits: {friction_surfaces: [8]}
  - family: disc_clutch
    parts: {friction_pair: [moulded_dry]}
    fix: {discs: 1}
  - roller_coupling
requirements: {load_torque: 120 N*m, driver_speed: 950 rpm, driven_inertia: 0.6 kg*m2}
objectives: [mass]
fix: {ramp_time: 0.5 s}
points: 1
"""
ROWS = """machine,load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2],ramp_time [s],parts,friction_surfaces
A,250,950,1.2,0.5,"friction_pair = paper_wet; inner_plate = core 2; outer_plate = core 2",8
B,9000,950,1.2,0.5,"friction_pair = paper_wet; inner_plate = core 2; outer_plate = core 2",8
C,-1,950,1.2,0.5,,
"""
SCREENS = {
    "describe": ("describe", "multi_plate_clutch"),
    "run": ("run", "spec.yaml"),
    "infeasible": ("run", "tight.yaml"),
    "explain": ("explain", "tight.yaml"),
    "check": ("check", "front/design_01.yaml", "-o", "check"),
    "whatif": ("whatif", "spec.yaml", "--vary", "load_torque=250,300 N*m", "--no-breaks", "-o", "whatif"),
    "prices": ("prices", "front", "-o", "prices", "--all"),
    "near-equals": ("near-equals", "front", "--within", "10 %", "-o", "near"),
    "rate": ("rate", "front", "--over", "friction=+-10 %", "-o", "rated"),
    "compare": ("run", "kinds.yaml"),
    "batch": ("batch", "rows.csv", "--family", "multi_plate_clutch", "--points", "1", "-o", "rows"),
    "verify": ("verify", "front"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("w")
    for name, text in {"spec.yaml": SPEC, "tight.yaml": TIGHT, "kinds.yaml": KINDS, "rows.csv": ROWS}.items():
        (place / name).write_text(text, encoding="utf-8")
    assert at_once("run", "spec.yaml", "-q", "-o", "front", folder=place).returncode == 0
    return place


@pytest.fixture
def answered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What takes long is done for the first screen; the others show the same."""
    for place in ANSWERS:
        module, name = place.rsplit(".", 1)
        answer, kept = getattr(import_module(module), name), list[Any]()

        def once(*given: Any, answer: Any = answer, kept: list[Any] = kept, **more: Any) -> Any:
            kept[:] = kept or [answer(*given, **more)]
            return kept[0]

        monkeypatch.setattr(place, once)


@pytest.mark.usefixtures("answered_once")
@pytest.mark.parametrize("screen", SCREENS)
def test_a_screen_fits_and_speaks_plainly(screen: str, folder: Path) -> None:
    for columns in COLUMNS:
        done = in_process(*SCREENS[screen], folder=folder, COLUMNS=str(columns))
        assert done.returncode in (0, 3), done.stderr
        lines = done.stdout.splitlines()
        assert len(lines) > (0 if screen == "verify" else 1), columns
        assert [line for line in lines if len(line) > columns] == [], columns
        assert [line for line in lines if EXPONENT.search(line) or FOREIGN.search(line)] == [], columns


def test_names_and_words_stay_whole_on_a_narrow_screen(folder: Path) -> None:
    check = at_once("check", "front/design_01.yaml", folder=folder, COLUMNS="80").stdout
    lines = [line.rstrip() for line in check.splitlines()]
    assert any(re.match(r"plate count worthwhile +0\.\d+ +>= +0\.5 ", line) for line in lines)
    at = next(k for k, line in enumerate(lines) if line.startswith("switching factor"))
    assert lines[at + 1] == "    Engagement-count factor; by default that of engagements per hour: 1 up to"
    prices = at_once("prices", "front", "-o", "prices", folder=folder, COLUMNS="80").stdout
    told = next(line for line in prices.splitlines() if line.startswith("    ") and "of_" not in line and "sur" in line)
    assert len(told) > 40  # a sentence has the width of the screen


def test_a_check_names_the_limits_with_the_least_room(folder: Path) -> None:
    lines = at_once("check", "front/design_01.yaml", folder=folder, COLUMNS="160").stdout.splitlines()
    line = next(line for line in lines if line.startswith("nearest to their limits: "))
    shares = [float(x) for x in re.findall(r"\(([0-9.]+) % used\)", line)]
    assert len(shares) == 3
    assert shares == sorted(shares, reverse=True)
    assert shares[0] == pytest.approx(100, abs=0.2)
