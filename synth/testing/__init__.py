"""Suite for families, run by pytest (``pip install clutchsynth[test]``); nothing else of the package loads it.

A family has a module ``cases`` beside its model with ``CASES``: family -> :class:`FamilyCases`. Its suite is::

    from synth.testing import FamilyTests


    class TestRod(FamilyTests):
        family = "rod"
"""

from __future__ import annotations

from synth.question.instance import Instance
from synth.testing.family_tests import FamilyTests
from synth.testing.records import Case, FamilyCases, KnownDesign, cases_of

__all__ = ["Case", "FamilyCases", "FamilyTests", "Instance", "KnownDesign", "cases_of"]
