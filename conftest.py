"""Modules of folders that are installed inside ``synth`` are collected under the names that they are imported by.

Otherwise a module with doctests would be loaded a second time, under the name of its path.
"""

import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parent
INSIDE = ("problems", "catalogs", "reports")


def pytest_collect_file(file_path: Path) -> None:
    """Import a module of these folders by its name, and let pytest find it under that of its path."""
    place = file_path.relative_to(ROOT) if file_path.is_relative_to(ROOT) else file_path
    if file_path.suffix == ".py" and place.parts[0] in INSIDE:
        steps = place.parent.parts if place.name == "__init__.py" else place.with_suffix("").parts
        sys.modules[".".join(steps)] = import_module(".".join(("synth", *steps)))
