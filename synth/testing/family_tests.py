"""Suite of one family."""

from __future__ import annotations

from typing import ClassVar

import pytest

from synth.analysis.calculation import calculation_of
from synth.testing.fronts import FeasibleCase, explained_by_name, of_a_front
from synth.testing.names import named, of_names, structures
from synth.testing.option_sets import of_an_option_set, traced
from synth.testing.records import cases_of, question
from synth.testing.texts import Calculated, of_a_calculation, of_texts


class FamilyTests:
    """What a family must keep; a failure names each property that does not hold.

    Attributes
    ----------
    family : str
        Name of a registered family.
    thorough : bool
        Whether all tightened requirements of the feasible cases and several sizes of units are tried, else one of each.
    """

    family: ClassVar[str]
    thorough: ClassVar[bool] = False

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Make a test of each option set, structure of names and feasible case."""
        cases = cases_of(self.family)
        for name, values in (
            ("option_set", [*cases.option_sets]),
            ("structure", structures(self.family)),
            ("example", [*cases.feasible]),
        ):
            if name in metafunc.fixturenames:
                metafunc.parametrize(name, values)

    def test_texts(self) -> None:
        """Cited works are listed, texts are words, symbols are those of the formulas."""
        of_texts.check(self.family)

    def test_names(self, structure: str) -> None:
        """Declared names are those of the table."""
        of_names.check(named(self.family, structure))

    def test_model(self, option_set: str) -> None:
        """Words, units, dimensions and gradients are sound, numbers those of CasADi."""
        of_an_option_set.check(traced(self.family, option_set, self.thorough))

    @pytest.mark.parametrize("optional", [True, False], ids=["optional", "bare"])
    def test_calculation(self, option_set: str, optional: bool) -> None:
        """Every part of a formula has a name and a unit, with and without optional requirements."""
        options = cases_of(self.family).option_sets[option_set]
        calculation = calculation_of(question(self.family, options, optional=optional))
        of_a_calculation.check(Calculated(self.family, calculation))

    def test_optional_requirements(self) -> None:
        """A limit of an optional requirement is not checked without it."""
        cases = cases_of(self.family)
        options = next(iter(cases.option_sets.values()))
        bare, full = (question(self.family, options, optional=optional) for optional in (False, True))
        assert set(bare.values.not_asked) == set(cases.optional)
        assert full.values.not_asked == ()
        fewer, more = ({x.name for x in posed.model.limits} for posed in (bare, full))
        assert fewer < more if cases.optional else fewer == more

    def test_front(self, example: str) -> None:
        """The front of a feasible case is proven, makeable, and the same from another seed."""
        of_a_front.check(FeasibleCase(self.family, example, self.thorough))

    def test_infeasible(self) -> None:
        """The infeasible case is explained by name."""
        explained_by_name(self.family)
