"""Values that a file or a program may hold where a question is meant: of every kind, huge, nested."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from synth.question.request_fields import FIELDS

HUGE = st.sampled_from([10**400, -(10**400), 2**64, 10**308, 1e308, float("inf"), float("nan")]) | st.just(5000).map(
    lambda n: 10**n
)
WORDS = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=8)
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | WORDS | HUGE
JUNK = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, max_size=3), max_leaves=6
)


def _within(depth: int, mapping: bool) -> Any:
    value: Any = 10**400
    for _ in range(depth):
        value = {"mass": value} if mapping else [value]
    return value


DEEP = st.builds(_within, st.sampled_from([3, 60]), st.booleans())
NAMES = st.sampled_from(
    "load_torque mass friction_pair friction_surfaces ramp_time outer_diameter practice actuation_force family "
    "friction tolerance mode samples seed confidence scenarios core_plates".split()
)
TEXTS = st.sampled_from(["<= 3 kg", "3 kg", "1e400 N*m", "nan", "6,5", "-1 N*m", "== 0", "1 .. 2", "+-5 %", "+", "x@1"])
NEARLY = st.dictionaries(NAMES, HUGE | TEXTS | st.lists(TEXTS | HUGE, max_size=2) | JUNK | DEEP, max_size=3)
# What may stand under the keys of a question: junk, or what is nearly right.
ENTRIES = st.dictionaries(st.sampled_from([*FIELDS, "dance"]), NEARLY | HUGE | JUNK | DEEP, max_size=3)
