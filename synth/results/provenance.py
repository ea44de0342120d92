"""What decides answers, as hashes: the question, and what computes them."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import platform
import sys
from collections.abc import Container, Iterable
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from synth.kernels.loading import native_code
from synth.plugins import AROUND_THE_ENGINE, SHIPPED_FAMILIES

PACKAGE = "synth"
SOURCES = (".py", ".c", ".h")
RECORDED_PACKAGES = ("clutchsynth", "casadi", "numpy", "scipy", "moocore")


@dataclass(frozen=True, kw_only=True)
class Fingerprint:
    """What decides the numbers of an answer, search settings apart.

    Parameters
    ----------
    question : str
        Hash of what is asked: requirements, restrictions, and the tables in force.
    computation : str
        Hash of what computes: formulas, code, native code on or off, processor. The same question computed in another
        way may differ in the last digits, or in more where the code is another.
    """

    question: str
    computation: str

    @property
    def combined(self) -> str:
        """The hash of both."""
        return hash_of([self.question, self.computation])


def hash_of(content: object) -> str:
    """Return the SHA-256 of what JSON can hold, without regard to the order of keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def joined(hashes: Iterable[str]) -> str:
    """Return one hash of several."""
    return hashlib.sha256(" ".join(hashes).encode()).hexdigest()


@lru_cache(maxsize=1)
def code_digest() -> str:
    """Return the SHA-256 of the sources of the engine and of the versions it computes with."""
    total = hashlib.sha256(repr(sorted(installed_versions().items())).encode())
    _add_sources(total, package_folder(), {name.rpartition(".")[2] for name in AROUND_THE_ENGINE})
    return total.hexdigest()


def package_folder() -> Path:
    """Return the folder of the engine's package, wherever in it this module stands."""
    spec = importlib.util.find_spec(PACKAGE)
    assert spec is not None
    return Path(str(spec.origin)).parent


def problem_digest(problems: Iterable[type[Any]]) -> str:
    """Return the SHA-256 of the sources that declare some problems: their packages, or the script of a single one."""
    total = hashlib.sha256()
    places = set[Path]()
    for problem in problems:
        module = sys.modules.get(problem.__module__)
        shipped = problem.__module__.startswith(f"{SHIPPED_FAMILIES}.")
        package = sys.modules.get(SHIPPED_FAMILIES if shipped else problem.__module__.split(".", 1)[0])
        file = getattr(package, "__file__", None) or getattr(module, "__file__", None)
        total.update(f"{problem.__module__}.{problem.__qualname__}\0".encode())
        if file is not None:
            path = Path(file)
            places.add(path.parent if path.name == "__init__.py" else path)
    for place in sorted(places):
        _add_sources(total, place)
    return total.hexdigest()


def computing_digest() -> str:
    """Return one hash of everything on this machine that decides the digits of an answer, apart from families.

    Pieces of one result may only come from machines that have the same.
    """
    return hash_of([code_digest(), native_code(), processor()])


@cache
def processor() -> str:
    """Return the kind of processor, and the extensions that NumPy uses of it: they decide how sums are rounded."""
    import numpy as np  # costly to import

    extensions = np.show_config(mode="dicts")["SIMD Extensions"]
    return " ".join([platform.system(), platform.machine(), *extensions["baseline"], *extensions["found"]])


def _add_sources(total: hashlib._Hash, place: Path, without: Container[str] = ()) -> None:
    """Add names and contents of the sources in a folder, but those in some of its folders."""
    for path in [place] if place.is_file() else sorted(p for p in place.rglob("*") if p.suffix in SOURCES):
        name = path.name if place.is_file() else path.relative_to(place).as_posix()
        if name.split("/", 1)[0] in without:
            continue
        total.update(name.encode() + b"\0" + path.read_bytes() + b"\0")


def installed_versions() -> dict[str, str]:
    """Return the versions of the packages that decide the numbers."""
    return {name: _installed(name) for name in RECORDED_PACKAGES}


@cache
def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
