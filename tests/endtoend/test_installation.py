"""What is installed, as a wheel or from a checkout: one package, whatever else is called like its parts."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import nbformat
import pytest

from synth.plugins import AROUND_THE_ENGINE
from tests.installed_beside import BRACKET, NOT_DECLARED, NOT_IMPORTED, installed_beside
from tests.shipped import FAMILIES

ROOT = Path(__file__).parents[2]
TOPS = ("synth", *(name.rpartition(".")[2] for name in AROUND_THE_ENGINE))

SPEC = "family: wrap_spring\nrequirements: {required_torque: 30 N*m, peak_torque: 45 N*m}\n"
# What somebody may have beside his script. None of it may be imported.
SHADOWS = ("problems.py", "reports.py", "catalogs/__init__.py", "conftest.py", "mechanics.py", "tests.py")
WORK = """
import json, sys
import synth
front = synth.synthesize("wrap_spring", {"required_torque": "30 N*m", "peak_torque": "45 N*m"}, points=3)
front.save("out")
front.svg()
from synth.problems.mechanics import ring
from synth.results.provenance import code_digest, problem_digest
names = sorted(m for m in sys.modules if m.partition(".")[0] in ("problems", "reports", "catalogs"))
family = type(synth.load("wrap_spring"))
told = [synth.__file__, len(front.designs), names, code_digest(), problem_digest([family])]
open("told.json", "w").write(json.dumps(told))
"""


def run(folder: Path, environment: dict[str, str], *command: str) -> str:
    """Standard output of Python with some arguments, which must end well."""
    how = {"cwd": folder, "env": environment, "capture_output": True, "text": True, "timeout": 600, "check": False}
    done = subprocess.run([sys.executable, *command], **how)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy: building leaves folders beside what it builds."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    source.mkdir()
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    for name in TOPS:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    options = [
        "--no-deps",
        "--no-build-isolation",
        "--quiet",
        "--disable-pip-version-check",
        "--wheel-dir",
        str(folder),
    ]
    run(folder, dict(os.environ), "-m", "pip", "wheel", str(source), *options, "--wheel-dir", str(folder))
    (made,) = folder.glob("clutchsynth-*.whl")
    return made


@pytest.fixture(scope="module", params=["wheel", "editable"])
def environment(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Environment of a process that takes the package from the wheel, or from the checkout as it is installed here."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHONPATH", "PYTEST"))}
    if request.param == "editable":
        return plain
    place = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(request.getfixturevalue("wheel")) as archive:
        archive.extractall(place)
    return {**plain, "PYTHONPATH": str(place)}


@pytest.fixture
def shadows(tmp_path: Path) -> Path:
    """A working folder with files that are called like parts of the package."""
    for name in SHADOWS:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"raise RuntimeError('{name} was imported')\n")
    (tmp_path / "script.py").write_text(WORK)
    (tmp_path / "duty.yaml").write_text(
        "family: wrap_spring\nrequirements: {required_torque: 30 N*m, peak_torque: 45 N*m}\n"
    )
    return tmp_path


@pytest.mark.slow
def test_files_beside_a_script_disturb_nothing(environment: dict[str, str], shadows: Path) -> None:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(WORK)])
    nbformat.write(notebook, shadows / "work.ipynb")
    places = {name: str(shadows / "own") for name in ("HOME", "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR")}
    places |= {"JUPYTER_RUNTIME_DIR": str(shadows / "run"), "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    kernel = ("-m", "nbconvert", "--execute", "--to", "notebook", "--output", "done", "work.ipynb")
    told = []
    for command, further in ((("script.py",), {}), (("-c", WORK), {}), (kernel, places)):
        run(shadows, environment | further, *command)
        told.append(json.loads((shadows / "told.json").read_text()))
        (shadows / "told.json").unlink()
    place, designs, named, _, _ = told[0]
    assert (Path(place).parents[1] == ROOT) == ("PYTHONPATH" not in environment)
    assert designs > 0
    assert named == []
    assert told[0] == told[1] == told[2]
    assert "wrap_spring" in run(shadows, environment, "-m", "synth", "families")
    run(shadows, environment, "-m", "synth", "run", "duty.yaml", "-o", "asked")
    run(shadows, environment, "-m", "synth", "report", "asked", "--explorer", "--drawing")
    assert {"report.html", "explorer.html", "design_01_drawing.svg"} <= {
        path.name for path in (shadows / "asked").iterdir()
    }


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Environment in which somebody else's families are installed: one that is sound, and two that are not."""
    families = {"bracket": (BRACKET, "Bracket"), "gone": (NOT_IMPORTED, "Gone"), "wrong": (NOT_DECLARED, "Wrong")}
    place = installed_beside(tmp_path_factory.mktemp("beside") / "installed", families)
    return {**os.environ, "PYTHONPATH": str(place)}


LEFT_OUT = (
    "left out: family: got 'gone'; expected a family that can be imported (gone_family of other-families fails with"
)


@pytest.mark.slow
def test_a_family_that_is_broken_disturbs_no_other(beside: dict[str, str], tmp_path: Path) -> None:
    def clutchsynth(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "synth", *words]
        return subprocess.run(command, cwd=tmp_path, env=beside, capture_output=True, text=True, check=False)

    listed = clutchsynth("families")
    assert {*FAMILIES, "bracket", "wrong"} == {line.split()[0] for line in listed.stdout.splitlines()}
    assert LEFT_OUT in listed.stderr
    common = clutchsynth("families", "--common")
    assert common.returncode == 0, common.stderr
    assert "load_torque" in common.stdout
    assert LEFT_OUT in common.stderr
    assert "left out: wrong: size > 1" in common.stderr
    for name, code, words in (("gone", 2, "needs what is not installed"), ("wrong", 1, "size > 1")):
        refused = clutchsynth("describe", name)
        assert refused.returncode == code, refused.stderr
        assert words in refused.stderr
        assert "Traceback" not in refused.stderr


@pytest.mark.slow
def test_families_of_somebody_else_change_no_test(beside: dict[str, str]) -> None:
    tests = [
        "tests/analysis/test_describe.py",
        "tests/catalogs/test_friction_pairs.py",
        "tests/docs/test_docs.py::test_every_family_has_a_picture_of_its_drawing",
        "tests/kinds/test_small.py",
        "tests/terminal/test_new.py",
        "tests/test_architecture.py::test_the_engine_names_no_family",
    ]
    run(ROOT, beside, "-m", "pytest", "-q", "-m", "not slow", "-p", "no:cacheprovider", *tests)


@pytest.mark.slow
def test_a_wheel_computes_with_the_same_digests(wheel: Path, tmp_path: Path) -> None:
    ask = "from synth.results.provenance import *; import synth; "
    ask += "print(code_digest(), problem_digest([type(synth.load('cone_clutch'))]))"
    plain = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "unpacked")
    unpacked = run(tmp_path, {**plain, "PYTHONPATH": str(tmp_path / "unpacked")}, "-c", ask)
    assert unpacked == run(tmp_path, plain, "-c", ask)


@pytest.mark.slow
def test_a_wheel_contains_all_tables_schemas_templates_and_the_type_marker(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        packed = set(archive.namelist())
        metadata = next(archive.read(name).decode() for name in packed if name.endswith("/entry_points.txt"))
    kinds = {
        "modules": [path for top in TOPS for path in (ROOT / top).rglob("*.py")],
        "tables": [path for path in (ROOT / "catalogs").iterdir() if path.suffix in (".csv", ".md")],
        "templates": [*(ROOT / "synth").rglob("*.c")],
        "examples": [*(ROOT / "problems").rglob("*.yaml")],
        "names": [*(ROOT / "problems").rglob("names*.csv")],
        "assets": [path for path in (ROOT / "reports").rglob("*") if path.suffix in (".css", ".js")],
        "marker": [ROOT / "synth/py.typed"],
    }
    for kind, paths in kinds.items():
        assert paths, kind
        names = {path.relative_to(ROOT).as_posix() for path in paths}
        assert {name if name.startswith("synth/") else f"synth/{name}" for name in names} <= packed, kind
    assert {name.split("/")[0] for name in packed if ".dist-info/" not in name} == {"synth"}
    assert not {name for name in packed if name.endswith(".d.ts") or "node_modules" in name}
    assert "clutchsynth = synth.terminal.cli:main" in metadata
    named = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    for group, points in named.items():
        for value in points.values():
            assert re.match(r"synth\.", value), (group, value)
