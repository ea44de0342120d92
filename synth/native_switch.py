"""Whether compiled code computes: it is wanted unless CLUTCHSYNTH_NATIVE is 0, and there must be a C compiler."""

from __future__ import annotations

import os

from synth.operating_system import find_compiler

VARIABLE = "CLUTCHSYNTH_NATIVE"


def native_wanted() -> bool:
    """Tell whether compiled code is wanted."""
    return os.environ.get(VARIABLE) != "0"


def c_compiler() -> str | None:
    """Return the path of the system's C compiler; None where there is none."""
    return find_compiler()
