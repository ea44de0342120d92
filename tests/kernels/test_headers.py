"""What both sides of the kernels must agree on."""

from __future__ import annotations

import tomllib

import pytest

from synth.kernels.loading import LEVELS, best_variant, native_code, processor_level, variant
from tests.kernels.headers import FOLDER, headers

ROOT = FOLDER.parents[2]


def test_headers_are_made_from_the_operations_of_today() -> None:
    assert headers() == {name: (FOLDER / name).read_text(encoding="utf-8") for name in headers()}, "run `make kernels`"


def test_every_source_is_known_to_the_build() -> None:
    """What is not would be left out of a source distribution, or not be compiled anew."""
    modules = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["ext-modules"]
    known = {path for module in modules for path in (*module["sources"], *module.get("depends", ()))}
    assert known == {path.relative_to(ROOT).as_posix() for path in FOLDER.iterdir()}
    assert all(module["optional"] and "-ffp-contract=off" in module["extra-compile-args"] for module in modules)


@pytest.mark.skipif(best_variant("boxes") is None, reason="no kernel was built")
@pytest.mark.parametrize("name", ["boxes", "solver", "dominance"])
def test_each_kernel_has_a_variant_for_this_processor(name: str) -> None:
    assert processor_level() in LEVELS
    assert best_variant(name) is variant(name, processor_level())


def test_the_environment_switches_kernels_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    assert native_code() == "off"
