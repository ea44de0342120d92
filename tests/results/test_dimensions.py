"""Units of formulas: products that were folded before the trace are told apart, and columns that no table has."""

from __future__ import annotations

import math

import pytest

from synth.results.calculation import NamedQuantity
from synth.results.dimensions import Fold, constant_in, dimension_of, fraction_of

MU_0 = 4e-7 * math.pi
CONSTANTS = {
    c.name: c
    for c in (
        NamedQuantity(name="mu0", kind="constant", symbol="mu_0", unit="T*m/A", value=MU_0),
        NamedQuantity(name="gravity", kind="constant", symbol="g_n", unit="m/s2", value=9.80665),
        NamedQuantity(name="step", kind="constant", symbol="s_1", unit="mm", value=0.008),
        NamedQuantity(name="hard", kind="constant", symbol="p_1", unit="N/mm2", value=25e6),
    )
}
MASS = NamedQuantity(name="mass", kind="requirement", symbol="m", unit="kg")
ABSENT = NamedQuantity(name="slot.column", kind="part", symbol="c", unit="")


@pytest.mark.parametrize(
    ("number", "fold"),
    [
        (9.80665, Fold(1, 0, 1, "gravity", 1)),
        (10 * 9.80665, Fold(10, 0, 1, "gravity", 1)),
        (math.pi * MU_0, Fold(1, 1, 1, "mu0", 1)),
        (1 / MU_0, Fold(1, 0, 1, "mu0", -1)),
        (2 / MU_0, Fold(2, 0, 1, "mu0", -1)),  # also 9/45 of a round constant over pi
        (2 / (math.pi * MU_0), Fold(2, -1, 1, "mu0", -1)),
        (-0.008, Fold(1, 0, 1, "step", 1)),
        (0.016, None),  # short: somebody wrote it
        (8 * math.pi / 180, None),  # a number of its own, although it is also 5 pi/9 of the step times 100
        (125.0, None),
        (0.0, None),
        (math.inf, None),
        (9.80665001, None),
    ],
)
def test_a_number_tells_the_constant_from_which_it_was_computed(number, fold):
    assert constant_in(number, CONSTANTS.values()) == fold
    if fold is not None:
        value = CONSTANTS[fold.constant].value ** fold.power * fold.over * math.pi**fold.pi / fold.under
        assert value == pytest.approx(abs(number), rel=1e-14)


@pytest.mark.parametrize(("number", "fold"), [(2 / 9, Fold(2, 0, 9)), (math.pi / 4, Fold(1, 1, 4)), (1.0003, None)])
def test_fractions_and_powers_of_pi_are_found(number, fold):
    assert fraction_of(number) == fold


def test_units_close_through_a_folded_constant():
    known = {**CONSTANTS, "mass": MASS}
    weight = ["*", [["n", 98.0665], ["q", "mass"]], []]
    assert dimension_of(weight, known) == (1, 1, -2, 0, 0)
    assert dimension_of(["+", [weight, ["q", "mass"]]], known) is None


def test_a_column_that_no_table_has_is_of_any_unit():
    known = {"mass": MASS, "slot.column": ABSENT}
    product = ["*", [["q", "slot.column"], ["q", "mass"]], []]
    assert dimension_of(["+", [product, ["q", "mass"]]], known) == (1, 0, 0, 0, 0)
    assert dimension_of(["+", [product, ["n", 1.0]]], known) == (0, 0, 0, 0, 0)
    assert dimension_of(["f", "exp", [product]], known) == (0, 0, 0, 0, 0)
