"""What decides answers besides the question: code and families, as hashes."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

from synth.front_record import installed_versions


@lru_cache(maxsize=1)
def code_digest() -> str:
    """Return the SHA-256 of the sources of this package and of the versions it computes with."""
    total = hashlib.sha256(repr(sorted(installed_versions().items())).encode())
    _add_sources(total, Path(__file__).parent)
    return total.hexdigest()


def problem_digest(problems: Iterable[type[Any]]) -> str:
    """Return the SHA-256 of the sources that declare some problems: their packages, or the script of a single one."""
    total = hashlib.sha256()
    places = set[Path]()
    for problem in problems:
        module = sys.modules.get(problem.__module__)
        package = sys.modules.get(problem.__module__.split(".", 1)[0])
        file = getattr(package, "__file__", None) or getattr(module, "__file__", None)
        total.update(f"{problem.__module__}.{problem.__qualname__}\0".encode())
        if file is not None:
            path = Path(file)
            places.add(path.parent if path.name == "__init__.py" else path)
    for place in sorted(places):
        _add_sources(total, place)
    return total.hexdigest()


def _add_sources(total: Any, place: Path) -> None:
    files = [place] if place.is_file() else sorted(path for path in place.rglob("*") if path.suffix in (".py", ".c"))
    for path in files:
        name = path.name if place.is_file() else path.relative_to(place).as_posix()
        total.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
