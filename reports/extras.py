"""Packages that come with an extra, for those who want what needs them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from synth.errors import InputError


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
    InputError
        The module is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        install = f"pip install 'clutchsynth[{extra}]'"
        refusal = InputError(option, None, install, (option.lstrip("-"),))
        refusal.args = (f"{option} needs the extra {extra}: {install}",)
        raise refusal from None
