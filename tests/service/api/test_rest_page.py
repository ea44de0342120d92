"""The page on the interface: its commands are run as they stand there."""

from __future__ import annotations

import doctest
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from synth.workers.engine_process import Engines
from tests.service.working import listened, working
from tests.waiting import PATIENCE

pytestmark = pytest.mark.slow
PAGE = Path(__file__).parents[3] / "docs" / "rest.md"
FENCE = re.compile(r"^```(sh|text)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MARK = "---- next ----"
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.mark.skipif(shutil.which("curl") is None, reason="NO CURL on this machine")
def test_what_the_page_shows_happens(engines: Engines, tmp_path: Path) -> None:
    blocks = FENCE.findall(PAGE.read_text(encoding="utf-8"))
    commands = [text for language, text in blocks if language == "sh"]
    shown: list[str] = []
    for language, text in blocks:
        if language == "sh":
            shown.append("")
        else:
            shown[-1] = text
    assert len(commands) >= 6
    with working(tmp_path, engines, called=False) as service, listened(service) as address:
        script = f"\necho '{MARK}'\n".join(commands).replace("http://127.0.0.1:8350", address)
        done = subprocess.run(
            ["bash", "-eu", "-c", script], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    assert done.returncode == 0, done.stderr + done.stdout
    said = done.stdout.split(f"{MARK}\n")
    assert len(said) == len(shown)
    for command, wanted, got in zip(commands, shown, said, strict=True):
        assert not wanted or doctest.OutputChecker().check_output(wanted, got, FLAGS), f"{command}\nsaid:\n{got}"
