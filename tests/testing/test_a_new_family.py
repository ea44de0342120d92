"""A new family touches four places outside its package: pyproject.toml, its page, the changelog and ``make lists``."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROD = Path(__file__).parent / "tension_rod"
TOPS = ("synth", "problems", "catalogs", "reports", "docs", "examples", "tests")
FILES = ("pyproject.toml", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "conftest.py")
BY_LISTS = {"README.md", "docs/commands.md", "docs/index.md", "docs/python.md", "examples/tension_rod.yaml"}


def files(top: Path) -> dict[str, bytes]:
    """Contents of the files of a source tree by path, the package of the new family apart."""
    paths = [path for name in TOPS for path in (top / name).rglob("*") if path.is_file()]
    paths += [top / name for name in FILES]
    places = {path.relative_to(top).as_posix(): path for path in paths if "__pycache__" not in path.parts}
    return {
        name: path.read_bytes()
        for name, path in places.items()
        if not name.startswith(("problems/tension_rod/", "synth/problems", "synth/catalogs", "synth/reports"))
    }


def registered(top: Path) -> None:
    """Write what an installation writes: entry points of the tree, and the folders that are parts of ``synth``."""
    project = tomllib.loads((top / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = top / f"{project['name']}-{project['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    groups = (
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in points.items())
        for group, points in project["entry-points"].items()
    )
    (info / "entry_points.txt").write_text("\n".join(groups))
    for folder in ("problems", "catalogs", "reports"):
        (top / "synth" / folder).symlink_to(top / folder)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of the sources."""
    top = tmp_path / "copy"
    for name in TOPS:
        shutil.copytree(ROOT / name, top / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__", "*.svg"))
    for name in FILES:
        shutil.copy(ROOT / name, top / name)
    return top


def replace(path: Path, old: str, new: str) -> None:
    """Replace a text that stands in a file."""
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.mark.slow
def test_a_family_is_added_at_four_places(copy: Path) -> None:
    before = files(copy)
    package = copy / "problems" / "tension_rod"
    shutil.copytree(ROD, package, ignore=shutil.ignore_patterns("*.md", "__pycache__"))
    (package / "__init__.py").write_text('"""Tension rod."""\n')

    project = copy / "pyproject.toml"
    model = '"synth.problems.tension_rod.model:TensionRod"'
    replace(
        project, '"synth.problems.wrap_spring",', '"synth.problems.tension_rod",\n    "synth.problems.wrap_spring",'
    )
    replace(project, "\nwrap_spring = ", f"\ntension_rod = {model}\nwrap_spring = ")
    shutil.copy(ROD / "tension_rod.md", copy / "docs")
    replace(copy / "CHANGELOG.md", "### Added\n", "### Added\n\n- Family `tension_rod`.\n")
    registered(copy)

    environment = {**os.environ, "PYTHONPATH": str(copy)}

    def run(*words: str) -> str:
        done = subprocess.run(
            [sys.executable, "-m", *words], cwd=copy, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        return done.stdout

    run("tests.docs.lists")
    after = files(copy)
    touched = {name for name in before.keys() | after.keys() if before.get(name) != after.get(name)}
    assert touched == {"pyproject.toml", "docs/tension_rod.md", "CHANGELOG.md"} | BY_LISTS
    assert "| [Tension rod](docs/tension_rod.md) | a round bar under a pull |" in (copy / "README.md").read_text()
    assert "tension_rod" in run("synth", "families")
    told = run("pytest", "-q", "-p", "no:cacheprovider", "tests/conformance/test_families.py", "-k", "tension_rod")
    assert "9 passed" in told  # eight of its suite, and the referee
    checks = [
        "tests/docs/test_docs.py::test_lists_of_families_are_those_of_the_registry",
        "tests/docs/test_docs.py::test_every_family_has_a_picture_of_its_drawing",
        "tests/docs/test_docs.py::test_every_family_has_a_worked_example[tension_rod]",
        "tests/test_architecture.py::test_the_list_of_packages_is_that_of_the_folders",
        "tests/test_architecture.py::test_nothing_but_cases_imports_the_suite_and_pytest",
        "tests/terminal/test_new.py::test_the_spec_of_every_family_reads_back_and_asks_what_is_asked_without_it[tension_rod]",
    ]
    run("pytest", "-q", "-p", "no:cacheprovider", "-k", "not picture", *checks)
