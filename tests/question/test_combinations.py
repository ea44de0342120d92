"""Combinations and their numbers: there and back for any table, also where rows are refused."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analysis.designs import part_row
from synth.errors import InputError
from synth.question.catalogs import catalogs_for
from synth.question.combinations import Combinations, JointCombinations, MixedRadix
from synth.question.instance import Instance
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, Strut


class Picky(Strut):
    """A strut that refuses light rods, and thin plates on heavy ones."""

    name = "picky"

    def declare(self, d: Any) -> None:
        super().declare(d)
        rod, plate = d.slots["material"], d.slots["plate"]
        d.refuse("light", rod.density < 2000, "no rods lighter than 2000 kg/m3")
        d.refuse("thin", (rod.density > 8000) * (plate.thickness < 0.0015), "thicker plates on heavy rods")


def instance(densities: list[float], **more: Any) -> Instance:
    rods = pd.DataFrame(
        {
            "designation": [f"rod {k}" for k in range(len(densities))],
            "density [kg/m3]": densities,
            "source": ["test"] * len(densities),
        }
    )
    problem = Picky()
    return instance_of(problem, NEEDED, catalogs_for(problem, {"rods": rods}), **more)


def design_of(combinations: Combinations, number: int) -> Any:
    parts, counts, choices = combinations.describe(number)
    rows = {slot: part_row(table, row) for slot, (table, row) in parts.items()}
    return SimpleNamespace(parts=rows, values={**counts, "width": 0.1}, choices=choices)


DENSITIES = st.lists(st.floats(500, 9000), min_size=1, max_size=7).filter(lambda own: max(own) >= 2000)
LIMITS = st.sampled_from([{}, {"plates": ">= 2"}, {"plates": [1, 4]}])
PARTS = st.sampled_from([{}, {"plate": ["core 1.8", "core 1"]}])
ENDS = st.sampled_from([{}, {"end": "eye"}])


@pytest.mark.slow
@given(DENSITIES, LIMITS, PARTS, ENDS)
@settings(deadline=None, derandomize=True, max_examples=30)
def test_number_and_description_go_round(densities: list[float], limits: Any, parts: Any, fix: Any) -> None:
    question = instance(densities, limits=limits, parts=parts, fix=fix)
    combinations = question.combinations
    assert combinations.count == math.prod(combinations.radix)
    assert combinations.radix[combinations.names.index("material")] == sum(x >= 2000 for x in densities)
    every = np.arange(combinations.count)
    digits = combinations.digits(every)
    np.testing.assert_array_equal(combinations.composed(digits, len(every)), every)
    joint = JointCombinations([combinations] * 3)
    seen = set()
    for number in every.tolist():
        design = design_of(combinations, number)
        assert combinations.number(design) == combinations.find(design) == number
        assert joint.number(design, 2) == joint.joined(2, number)
        assert design_of(joint, joint.joined(2, number)).parts == design.parts
        seen.add((*map(str, design.parts.values()), design.values["plates"], design.choices["end"]))
    assert len(seen) == combinations.count
    chosen = np.random.default_rng(1).choice(every, min(len(every), 5), replace=False)
    for number in chosen.tolist():
        apart = sum(own != own[number] for own in digits)
        beside = combinations.neighbours(number)
        assert sorted(beside) == list(np.flatnonzero(apart == 1))
        assert sorted(joint.neighbours(joint.joined(1, number))) == sorted(joint.joined(1, beside))


def test_what_is_refused_has_no_number() -> None:
    everything, question = instance([1000, 3000, 7000], limits={"plates": "<= 2"}), instance([3000, 7000])
    assert question.combinations.count == 2 * everything.combinations.count
    design = design_of(everything.combinations, 0)
    assert str(design.parts["material"]) == "rod 1"
    for changed, words in (
        ({"parts": {**design.parts, "material": "rod 0"}}, "design: material: got 'rod 0'"),
        ({"parts": {}}, "design: plate: got 'None'"),
        ({"values": {"plates": 3.0}}, "design: plates: got '3'; expected what this question offers: 1, 2"),
        ({"values": {}}, "design: plates: got 'nan'"),
        ({"choices": {"end": "knot"}}, "design: end: got 'knot'"),
    ):
        other = SimpleNamespace(**(vars(design) | changed))
        assert everything.combinations.find(other) is None
        with pytest.raises(InputError, match=words):
            everything.combinations.number(other)


@given(st.lists(st.integers(1, 9), max_size=6), st.integers(0, 2**32))
@settings(derandomize=True)
def test_digits_compose_to_their_number(radix: list[int], seed: int) -> None:
    numbers = MixedRadix(radix)
    chosen = np.random.default_rng(seed).integers(0, numbers.count, 8)
    digits = numbers.digits(chosen)
    assert all(((d >= 0) & (d < base)).all() for d, base in zip(digits, radix, strict=True))
    np.testing.assert_array_equal(numbers.composed(digits, 8), chosen)
    beside = numbers.neighbours(chosen)
    assert beside.shape == (8, sum(base - 1 for base in radix))
    for own, others in zip(chosen, beside, strict=True):
        changed = np.array(numbers.digits(others)) != np.array(numbers.digits(own)).reshape(-1, 1)
        assert (changed.sum(axis=0) == 1).all()
        assert len(set(others.tolist())) == len(others)
