"""``--csv de`` of the commands that write tables, and what reads them again."""

from __future__ import annotations

from pathlib import Path

import pytest

from synth.batches.batch import BatchResult
from synth.batches.row_table import read_table
from synth.folders.csv_style import GERMAN, unstyled
from tests.terminal.entry import at_once, in_process

SPEC = """
family: cone_clutch
requirements: {load_torque: 60 N*m, driver_speed: 1500 rpm, driven_inertia: 0.5 kg*m2}
objectives: [mass, actuation_force]
points: 2
"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("csv")
    (folder / "spec.yaml").write_text(SPEC)
    for style in ("en", "de"):
        done = at_once("run", folder / "spec.yaml", "-o", folder / style, "--quiet", "--csv", style)
        assert done.returncode == 0, done.stderr
    return folder


def table(path: Path) -> str:
    return path.read_bytes().decode()


@pytest.mark.slow
def test_designs_say_the_same(saved: Path) -> None:
    german = table(saved / "de" / "designs.csv")
    assert german.startswith("\ufeffrank;score;status;gap;note;alternatives;mass [kg];")
    assert german == GERMAN.text(table(saved / "en" / "designs.csv"))
    assert unstyled(german) == table(saved / "en" / "designs.csv")
    for name in ("front.json", "design_01.yaml"):
        assert "," in table(saved / "de" / name) or ":" in table(saved / "de" / name)
        assert "\ufeff" not in table(saved / "de" / name)
    rows, same = (read_table(saved / style / "designs.csv") for style in ("de", "en"))
    assert rows.header() == same.header()
    found, right = ([cells for _, cells in each.lines()] for each in (rows, same))
    for ours, theirs in zip(found, right, strict=True):
        for a, b in zip(ours, theirs, strict=True):
            assert a == b or float(a) == float(b)


@pytest.mark.slow
def test_a_front_in_either_style_holds(saved: Path) -> None:
    for style in ("en", "de"):
        assert at_once("verify", saved / style).returncode == 0
    wrong = saved / "de" / "designs.csv"
    text = table(wrong)
    wrong.write_bytes(text.replace("0,001", "0,002", 1).encode())
    try:
        done = at_once("verify", saved / "de")
        assert done.returncode == 5
        assert "designs.csv says something else than front.json" in done.stdout
    finally:
        wrong.write_bytes(text.encode())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["check", "de/design_01.yaml"], ["check.csv"]),
        (["explain", "spec.yaml"], ["explanation.csv"]),
        (["simulate", "de/design_01.yaml"], ["second_opinion.csv"]),
        (["curves", "cone_clutch", "spec.yaml"], []),
        (["whatif", "spec.yaml", "--vary", "load_torque=60, 62 N*m"], ["whatif.csv", "breaks.csv"]),
        (["prices", "de", "--design", "1"], ["prices.csv"]),
        (["near-equals", "de"], ["near_equals.csv"]),
        (["rate", "de", "--over", "load_torque=+-5 %"], ["rating.csv", "robust.csv"]),
    ],
)
def test_every_command_that_writes_tables(saved: Path, tmp_path: Path, words: list[str], names: list[str]) -> None:
    files = [str(saved / word) if (saved / word).exists() else word for word in words]
    at_once(*files, "-o", tmp_path / "out", "--csv", "de")
    written = sorted((tmp_path / "out").glob("*.csv"))
    assert {path.name for path in written} >= set(names)
    assert written
    for path in written:
        text = table(path)
        assert text.startswith("\ufeff")
        assert ";" in text or "," not in text
        assert GERMAN.text(unstyled(text)) == text


@pytest.mark.slow
def test_a_batch_and_its_standard_sizes(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text("load_torque [N*m],driver_speed,driven_inertia,site\n60.5,1500,0.5,A\n62,1500,0.5,B\n")
    asked = ("--family", "cone_clutch", "--points", "1", "--objective", "mass", "--quiet")
    for style in ("en", "de"):
        assert in_process("batch", rows, "-o", tmp_path / style, *asked, "--csv", style).returncode == 0
    plain, german = (table(tmp_path / style / "designs.csv") for style in ("en", "de"))
    assert (german, unstyled(german)) == (GERMAN.text(plain), plain)
    results = [BatchResult(tmp_path / style, "", "", {}, None) for style in ("en", "de")]
    assert results[0].designs().equals(results[1].designs())
    assert results[0].rows().drop(columns="seconds").equals(results[1].rows().drop(columns="seconds"))
    assert in_process("batch", rows, "-o", tmp_path / "de", *asked).returncode == 0  # goes on, in the usual style
    assert table(tmp_path / "de" / "designs.csv") == plain
    sizes = tmp_path / "sizes"
    assert in_process("size-range", tmp_path / "de", "-o", sizes, "--csv", "de", "--quiet").returncode == 0
    assert all(table(path).startswith("\ufeff") for path in sizes.glob("*.csv"))


def test_other_styles_are_refused(saved: Path) -> None:
    done = at_once("run", saved / "spec.yaml", "--csv", "fr")
    assert done.returncode == 2
    assert done.stderr.startswith("clutchsynth: --csv: got 'fr'; expected en ")
