"""What one system does differently; of Windows what can be tried elsewhere."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from synth.errors import InputError
from synth.folders.output_folder import FRONT, READY, _is_inside, check_not_held, save_result, settle
from synth.system import operating_system as system
from tests.waiting import until

SLEEP = "import time; time.sleep(600)"


def test_processes_are_asked_for_and_left_alone() -> None:
    process = subprocess.Popen([sys.executable, "-c", SLEEP], **system.apart())
    try:
        assert system.is_alive(process.pid)
        assert process.poll() is None
        until(lambda: system.resident(process.pid) > 1_000_000)  # little before Python has started
        assert system.beginning(process.pid) == system.beginning(process.pid) != system.beginning(os.getpid())
    finally:
        process.kill()
        process.wait()
    assert not system.is_alive(process.pid)
    assert system.resident(process.pid) == 0
    assert system.beginning(process.pid) == ""


def test_folders_of_the_user_follow_their_variables(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    assert (system.cache_home(), system.data_home()) == (tmp_path / "cache", tmp_path / "data")
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.delenv("XDG_DATA_HOME")
    assert {system.cache_home().parts[: len(Path.home().parts)], Path.home().parts} == {Path.home().parts}
    assert system.data_home().is_relative_to(Path.home())


# ---- files that others hold, as on Windows --------------------------------------------------------------------------


def test_what_others_hold_for_a_moment_is_waited_for(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "new").write_text("new", encoding="utf-8")
    tries, replace = [], Path.replace

    def held(path: Path, target: Path) -> Path:
        tries.append(path)
        if len(tries) < 4:
            raise PermissionError
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", held)
    with pytest.raises(PermissionError):  # nobody holds a file here: there is nothing to wait for
        system.put_in_place(tmp_path / "new", tmp_path / "old")
    monkeypatch.setattr(system, "OPEN_FILES_CAN_GO", False)
    system.put_in_place(tmp_path / "new", tmp_path / "old")
    assert len(tries) == 4
    assert (tmp_path / "old").read_text(encoding="utf-8") == "new"


OLD = {"front.json": "old\n", "designs.csv": "old\n", "design_01.yaml": "old\n"}
FRESH = {"front.json": "new\n", "designs.csv": "new\n"}


def texts(folder: Path) -> dict[str, str]:
    return {p.name: p.read_text(encoding="utf-8") for p in folder.iterdir() if p.is_file()}


def test_a_result_with_a_table_that_is_open_elsewhere_changes_as_a_whole_or_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    save_result(tmp_path, OLD, FRONT, stopped=False)
    monkeypatch.setattr("synth.folders.output_folder.OPEN_FILES_CAN_GO", False)
    monkeypatch.setattr("synth.folders.output_folder.is_held", lambda path: path.name == "designs.csv")
    with pytest.raises(InputError, match=r"designs\.csv.*no other program has open"):
        check_not_held(tmp_path, FRONT)  # before a search
    with pytest.raises(InputError, match=rf"designs\.csv.*complete in {READY}"):
        save_result(tmp_path, FRESH, FRONT, stopped=False)  # after it
    assert texts(tmp_path) == OLD
    monkeypatch.undo()
    settle(tmp_path)  # as whoever opens the folder next
    assert texts(tmp_path) == FRESH
    check_not_held(tmp_path, FRONT)


@pytest.mark.parametrize(
    "name", ["../a", "..\\a", "C:\\a", "C:a", "\\a", "/a", "a\\b", "\\\\host\\share\\a", "", "a\0"]
)
def test_no_name_of_any_system_leads_out_of_a_folder(name: str) -> None:
    assert not _is_inside(name)
    assert _is_inside("a/b.json")
