"""Packages that come with an extra, for those who want what needs them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from synth.errors import ExtraNeededError


def needed(module: str, option: str, extra: str) -> Any:
    """Return a module, imported on first use.

    Parameters
    ----------
    module : str
        ``typst``.
    option : str
        What was asked for: ``--pdf``.
    extra : str
        The extra that brings the module.

    Raises
    ------
    ExtraNeededError
        The module is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise ExtraNeededError(option, extra) from None
