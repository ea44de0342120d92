"""Changes to a spec, in its own vocabulary: a mapping that replaces entries, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def patched(spec: Mapping[str, object], patch: Mapping[str, object]) -> dict[str, Any]:
    """Return a spec with the entries of a patch in place of its own.

    Parameters
    ----------
    spec : mapping
        Keys of a spec, such as ``requirements`` and ``limits``.
    patch : mapping
        Some of these keys, each with the entries that change; every other entry stays. What is a mapping in one of
        both alone is replaced as a whole.

    Examples
    --------
    >>> patched({"limits": {"mass": "<= 5 kg", "length": "<= 1 m"}, "points": 3}, {"limits": {"mass": "<= 6 kg"}})
    {'limits': {'mass': '<= 6 kg', 'length': '<= 1 m'}, 'points': 3}
    >>> patched({"objectives": ["mass", "length"]}, {"objectives": {"mass": "min"}})
    {'objectives': {'mass': 'min'}}
    """
    result = dict(spec)
    for key, entries in patch.items():
        before = spec.get(key)
        result[key] = {**before, **entries} if isinstance(before, Mapping) and isinstance(entries, Mapping) else entries
    return result
