"""Files that are none, far too large, damaged or made to deceive: one sentence, exit code 2, at most 20 MB read."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from synth.results import ParetoFront
from synth.text.plain_text import UNSAFE
from tests.endtoend.test_kept_results import BATCH, rows
from tests.terminal.entry import at_once
from tests.terminal.test_cli import SMALL, refused

pytestmark = pytest.mark.skipif(os.name != "posix", reason="pipes and devices of POSIX")
HUGE = 3_000_000_000  # bytes, of which none is on the disk


def folder(path: Path) -> None:
    path.mkdir()


def pipe(path: Path) -> None:
    os.mkfifo(path)


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def huge(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(HUGE)


NO_FILES = [folder, pipe, endless, huge]


@pytest.fixture(autouse=True)
def patience() -> Iterator[None]:
    """End what waits for a pipe or reads without end."""

    def stop(number: int, frame: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(60)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory
    assert grown < 400_000, "kB: more was read than a file may have"


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a front and a batch."""
    place = tmp_path_factory.mktemp("saved")
    (place / "small.yaml").write_text(SMALL)
    assert at_once("run", "small.yaml", "-o", "front", "-q", folder=place).returncode == 0
    rows(place / "rows.csv", 600)
    assert at_once(*BATCH, "-q", folder=place).returncode == 0
    return place


@pytest.fixture
def place(saved: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(saved, tmp_path / "place"))


READERS: dict[str, tuple[str, list[str]]] = {
    "spec": ("small.yaml", ["run", "small.yaml", "-o", "never"]),
    "json": ("small.json", ["run", "small.json", "-o", "never"]),
    "design": ("front/design_01.yaml", ["check", "front/design_01.yaml"]),
    "verify": ("front/front.json", ["verify", "front"]),
    "prices": ("front/front.json", ["prices", "front/front.json", "-o", "never"]),
    "near-equals": ("front/front.json", ["near-equals", "front", "-o", "never"]),
    "rate": ("front/front.json", ["rate", "front", "-o", "never", "--over", "load_torque=+-1 %"]),
    "rows": ("rows.csv", BATCH),
    "excel": ("rows.xlsx", ["batch", "rows.xlsx", "-o", "never"]),
    "mapping": ("map.yaml", [*BATCH, "--mapping", "map.yaml"]),
    "comparison": ("front/comparison.json", ["verify", "front"]),
    "size-range": ("rows.csv", ["size-range", "rows.csv", "-o", "never"]),
}


@pytest.mark.slow
@pytest.mark.parametrize("make", NO_FILES)
@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_file_of_a_sensible_size_is_refused(place: Path, reader: str, make: Callable[[Path], None]) -> None:
    name, words = READERS[reader]
    if (reader, make) in (("comparison", folder), ("comparison", pipe), ("comparison", endless)):
        pytest.skip("then the folder holds no comparison")
    if (reader, make) == ("size-range", folder):
        pytest.skip("then it is the folder of a batch")
    (place / name).unlink(missing_ok=True)
    make(place / name)
    message = refused(at_once(*words, folder=place))
    assert Path(name).name in message or "front" in message
    assert not (place / "never").exists()


@pytest.mark.slow
@pytest.mark.parametrize("make", NO_FILES)
def test_tables_that_are_no_files_are_refused(place: Path, make: Callable[[Path], None]) -> None:
    (place / "tables").mkdir()
    make(place / "tables" / "core_plates.csv")
    for catalogs in ("tables", "{core_plates: tables/core_plates.csv}", "{core_plates: [+, tables/core_plates.csv]}"):
        (place / "own.yaml").write_text(SMALL + f"catalogs: {catalogs}\n")
        assert "core_plates.csv" in refused(at_once("run", "own.yaml", "-o", "never", folder=place))
    assert not (place / "never").exists()


@pytest.mark.slow
def test_the_working_folder_as_tables_is_refused(place: Path) -> None:
    (place / "own.yaml").write_text(SMALL + "catalogs: .\n")
    assert "catalogs" in refused(at_once("run", "own.yaml", "-o", "never", folder=place))


def nested(text: str) -> str:
    return "[" * 100_000


DAMAGES: dict[str, Callable[[str], str]] = {
    "nested": nested,
    "nested inside": lambda text: text.replace('"format": 1', '"format": 1, "x": ' + "[" * 50_000 + "]" * 50_000),
    "nan": lambda text: text.replace('"gap": 0.001', '"gap": NaN'),
    "infinite": lambda text: text.replace('"gap": 0.001', '"gap": 1e999'),
    "truncated": lambda text: text[: len(text) // 2],
    "empty": lambda text: "",
    "no text": lambda text: "\ufeff\x00",
    "long number": lambda text: text.replace('"gap": 0.001', '"gap": ' + "9" * 100_000),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("reader", ["verify", "prices", "near-equals", "rate"])
def test_a_damaged_front_is_refused(place: Path, reader: str, damage: str) -> None:
    path = place / "front" / "front.json"
    text = path.read_text()
    path.write_text(DAMAGES[damage](text))
    assert path.read_text() != text
    done = at_once(*READERS[reader][1], folder=place)
    if (reader, damage) == ("verify", "infinite") or (reader == "verify" and damage == "nested inside"):
        assert done.returncode in (2, 5)  # read, and found to be changed
        assert len(done.stderr.splitlines()) <= 1
        return
    assert "front" in refused(done)


@pytest.mark.parametrize("damage", ["nested", "truncated", "empty"])
def test_a_damaged_comparison_is_refused(place: Path, damage: str) -> None:
    (place / "front" / "comparison.json").write_text(DAMAGES[damage]('{"families": []}'))
    assert "comparison" in refused(at_once("verify", "front", folder=place))


def test_a_falsified_mass_is_told_by_every_command(place: Path) -> None:
    path = place / "front" / "front.json"
    content = json.loads(path.read_text())
    content["designs"][0]["values"]["mass"] *= 0.9
    content["designs"][0]["objectives"]["mass"] *= 0.9
    path.write_text(json.dumps(content))
    for reader in ("prices", "near-equals", "rate"):
        assert "its checksum does not fit" in refused(at_once(*READERS[reader][1], folder=place))
    done = at_once("verify", "front", folder=place)
    assert done.returncode == 5
    assert "its checksum does not fit" in done.stdout
    with pytest.raises(ValueError, match="its checksum does not fit"):
        __import__("synth").load_front(place / "front")
    del content["digest"]
    content["digest"] = ParetoFront.digest_of(content)
    path.write_text(json.dumps(content))
    assert at_once("verify", "front", folder=place).returncode == 5


# ---- the database ---------------------------------------------------------------------------------------------------


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def without_tables(path: Path) -> None:
    with sqlite3.connect(path) as connection:
        connection.execute("DROP TABLE job_row")


def garbage(path: Path) -> None:
    path.write_bytes(b"no database" * 1000)


def damaged(path: Path) -> None:
    raw = bytearray(path.read_bytes())
    raw[4096:] = b"\xff" * (len(raw) - 4096)
    path.write_bytes(raw)


def cells_cut(path: Path) -> None:
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE job SET content = '{'")


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage", [emptied, without_tables, garbage, damaged, cells_cut, *(make for make in NO_FILES if make is not huge)]
)
@pytest.mark.parametrize("words", [["jobs", "show", "out"], ["size-range", "out"], ["jobs", "resume", "out"]], ids=str)
def test_a_damaged_database_is_told_in_one_sentence(
    place: Path, damage: Callable[[Path], None], words: list[str]
) -> None:
    path = place / "out" / "jobs.sqlite"
    for more in path.parent.glob("jobs.sqlite-*"):
        more.unlink()
    if damage in NO_FILES:
        path.unlink()
    damage(path)
    before = (place / "out" / "designs.csv").read_bytes()
    message = refused(at_once(*words, folder=place))
    assert "internal" not in message
    assert (place / "out" / "designs.csv").read_bytes() == before


# ---- text that acts -------------------------------------------------------------------------------------------------

ESCAPES = "\x1b[2J\x1b]0 owned\x07\u202eevil"


@pytest.mark.slow
def test_escapes_from_the_input_reach_neither_terminal_nor_files(place: Path) -> None:
    shipped = Path(__import__("catalogs").__file__).parent / "core_plates.csv"
    table = shipped.read_text()
    (place / "plates.csv").write_text(table.replace("core 4,", f"core {ESCAPES},", 1))
    spec = SMALL.replace("inner_plate: core 4", 'inner_plate: "core \\e[2J\\e]0 owned\\a\\u202Eevil"')
    (place / "own.yaml").write_text(spec + "catalogs: {core_plates: plates.csv}\n")
    done = at_once("run", "own.yaml", "-o", "own", folder=place)
    assert done.returncode == 0, done.stderr
    for text in (done.stdout, done.stderr, *(p.read_text() for p in (place / "own").iterdir())):
        assert not UNSAFE.search(text)
    assert "core \\x1b[2J" in done.stdout
    checked = at_once("check", "own/design_01.yaml", "-o", "checked", folder=place)
    assert checked.returncode == 0, checked.stderr
    for text in (checked.stdout, (place / "checked" / "check.csv").read_text()):
        assert not UNSAFE.search(text)
    bad = SMALL.replace("load_torque", '"load\\e[31m"')
    (place / "bad.yaml").write_text(bad)
    assert not UNSAFE.search(refused(at_once("run", "bad.yaml", "-o", "never", folder=place)).rstrip("\n"))
    wrong = at_once("run", f"no{ESCAPES}.yaml", "-o", "never", folder=place)
    assert not UNSAFE.search(refused(wrong).rstrip("\n"))
    usage = at_once(f"runn{ESCAPES}", folder=place)
    assert not UNSAFE.search(usage.stderr)
