"""Figures of the sources get no worse; each fall is written to ``figures.csv``."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.figures import FIGURES, bounds


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.__name__)
def test_a_figure_is_no_worse_than_it_was(figure: Callable[[], int]) -> None:
    assert figure() <= bounds()[figure.__name__].most, figure.__doc__


def test_every_figure_has_its_bounds_between_begin_and_goal() -> None:
    held = bounds()
    assert list(held) == [figure.__name__ for figure in FIGURES]
    assert all(bound.goal <= bound.most for bound in held.values())
