"""Problems: what they say of names that are declared with other input alone."""

from __future__ import annotations

from typing import Any

import pytest

import synth


class Sled(synth.DesignProblem):
    """A weight that slides, and what there is of it with a speed, with runners, and with nothing else."""

    name = "sled"

    def __init__(self, way: str, **options: str) -> None:
        super().__init__(**options)
        self.way = way

    def declare(self, d: Any) -> None:
        """Declare it."""
        speed = d.requirement("speed", "m/s", optional=True, symbol="v")
        d.requirement("slope", "-", optional=True)
        runners = d.option("runners", ("wood", "steel"), "wood")
        mass = d.variable("mass", "kg", 1, 2)
        d.derive("weight", "N", 9.81 * mass)
        if speed is not None:
            d.derive("energy", "J", mass * speed**2 / 2, symbol="E_kin")
        if runners == "steel":
            d.derive("wear", "-", mass / 3)
        d.objective("weight")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"limits": {"energy": "<= 3 J"}}, "energy is there where speed is given"),
        ({"objectives": ["E_kin"]}, "E_kin is there where speed is given"),
        ({"fix": {"energy": "3 J"}}, "energy is there where speed is given"),
        ({"limits": {"wear": "<= 3"}}, "wear is there with runners: steel"),
        ({"limits": {"colour": "<= 3"}}, "its description lists them"),
    ],
)
def test_a_name_that_other_input_would_declare_is_told_with_it(asked: dict[str, Any], told: str) -> None:
    with pytest.raises(synth.InputError, match=told):
        synth.synthesize(Sled("downhill"), {}, **asked)
