"""A notebook that is run and exported, as people hand it on: the front explores itself there."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from tests.reports.browser import chromium, needs_chromium, opened
from tests.waiting import PATIENCE

CELLS = [
    "import synth",
    "front = synth.synthesize('multi_plate_clutch', {'load_torque': '180 N*m', 'driver_speed': '1450 1/min', "
    "'driven_inertia': '0.5 kg*m2'}, points=5)",
    "front",
    "front.designs[0]",
    "front.explore()",
]


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run a notebook, and return it as HTML."""
    folder = tmp_path_factory.mktemp("notebook")
    written = folder / "front.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in CELLS]), written)
    # Everything that Jupyter keeps goes beside the notebook, and nothing of the machine is read.
    places = {name: str(folder / "own") for name in ("HOME", "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR")}
    subprocess.run(
        [sys.executable, "-m", "nbconvert", "--execute", "--to", "html", str(written)],
        env={**os.environ, **places, "JUPYTER_RUNTIME_DIR": str(folder / "run"), "PYDEVD_DISABLE_FILE_VALIDATION": "1"},
        cwd=folder,
        check=True,
        capture_output=True,
        timeout=PATIENCE,
    )
    return folder / "front.html"


@pytest.mark.slow
def test_an_exported_notebook_holds_front_and_design_as_static_html(exported: Path) -> None:
    text = exported.read_text(encoding="utf-8")
    assert "proven" in text
    assert text.count("<iframe") == 1
    assert 'sandbox="allow-scripts allow-downloads"' in text


@pytest.mark.slow
@needs_chromium
def test_the_front_is_explored_in_an_exported_notebook(exported: Path) -> None:
    with chromium() as browser, opened(browser, exported) as found:
        frame = found.page.frame_locator("iframe")
        frame.locator("table.designs tbody tr").nth(2).click()
        assert frame.locator(".panel h2").inner_text() == "Design 3"
