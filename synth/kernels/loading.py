"""Loading of the kernels: C code that was built when the package was installed, in variants for levels of processors.

NumPy computes the same where none was built, in more time. ``CLUTCHSYNTH_NATIVE=0`` switches kernels off.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
from functools import cache

VARIABLE = "CLUTCHSYNTH_NATIVE"
LEVELS = (4, 3, 2)  # of x86-64 processors, the best first; other processors have the last one alone


def native_enabled() -> bool:
    """True unless the environment switches kernels off."""
    return os.environ.get(VARIABLE) != "0"


def native_code() -> str:
    """``on`` where kernels compute, else ``off``: the two differ in the last digits."""
    return "on" if kernel("boxes") is not None else "off"


def kernel(name: str) -> ctypes.CDLL | None:
    """Kernel of a name, in the best variant that this processor can run; None where there is none."""
    return best_variant(name) if native_enabled() else None


@cache
def best_variant(name: str) -> ctypes.CDLL | None:
    """Kernel of a name, also where kernels are switched off."""
    level = processor_level()
    return next((loaded for x in LEVELS if x <= level and (loaded := variant(name, x)) is not None), None)


@cache
def variant(name: str, level: int) -> ctypes.CDLL | None:
    """Kernel of a name for a level of processors; None where it was not built or cannot be loaded."""
    return _loaded(f"_{name}_v{level}")


@cache
def processor_level() -> int:
    """Level of this processor, of those in :data:`LEVELS`; 0 where no kernel was built."""
    library = _loaded("_processor")
    return 0 if library is None else int(library.processor_level())


def _loaded(module: str) -> ctypes.CDLL | None:
    place = importlib.util.find_spec(f"{__package__}.{module}")
    try:
        return None if place is None or place.origin is None else ctypes.CDLL(place.origin)
    except OSError:
        return None
