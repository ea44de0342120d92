"""Changes to a spec, in its own vocabulary: a mapping that replaces entries, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def patched(spec: Mapping[str, Any], patch: Mapping[str, Any]) -> dict[str, Any]:
    """Return a spec with the entries of a patch in place of its own.

    Parameters
    ----------
    spec : mapping
        Keys of a spec, such as ``requirements`` and ``limits``.
    patch : mapping
        Some of these keys, each with the entries that change; every other entry stays.

    Examples
    --------
    >>> patched({"limits": {"mass": "<= 5 kg", "length": "<= 1 m"}, "points": 3}, {"limits": {"mass": "<= 6 kg"}})
    {'limits': {'mass': '<= 6 kg', 'length': '<= 1 m'}, 'points': 3}
    """
    result = dict(spec)
    for key, entries in patch.items():
        result[key] = {**(spec.get(key) or {}), **entries} if isinstance(entries, Mapping) else entries
    return result
