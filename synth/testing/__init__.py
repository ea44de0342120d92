"""Suite for families, run by pytest (``pip install clutchsynth[test]``); nothing else of the package loads it.

A family has a module ``cases`` beside its model with ``CASES``: family -> :class:`FamilyCases`. Its suite is::

    from synth.testing import FamilyTests


    class TestRod(FamilyTests):
        family = "rod"
"""

from __future__ import annotations

import pytest

# Before the checks are imported, so that failures show values.
pytest.register_assert_rewrite(*(f"{__name__}.{part}" for part in ("fronts", "names", "option_sets", "texts")))

from synth.question.instance import Instance  # noqa: E402
from synth.testing.family_tests import FamilyTests  # noqa: E402
from synth.testing.records import Case, FamilyCases, KnownDesign, cases_of  # noqa: E402

__all__ = ["Case", "FamilyCases", "FamilyTests", "Instance", "KnownDesign", "cases_of"]
