"""Which combinations are worth solving for: none that holds a design of use is left out."""

import numpy as np
import pytest

from synth.search.archive import Archive
from synth.search.pruning import EpsilonCover, rows_of_use
from synth.search.settings import TUNING
from tests.sample_problems.strut import designs_of, strut_form


def known_by(form, columns, rng, count):
    """Return a rule that knows some random designs."""
    points, combinations, phi = designs_of(form, rng, count)
    archive = Archive(columns, form.n, len(form.goals))
    archive.add(combinations, points, phi)
    return EpsilonCover(columns, np.full(len(columns), 0.02), np.full(len(form.goals), np.inf), archive)


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("columns", [[0], [0, 1], [0, 1, 2]])
def test_no_combination_with_a_design_of_use_is_left_out(columns, grid):
    form, rng = strut_form(grid), np.random.default_rng(4)
    rule = known_by(form, columns, rng, 40)
    every = np.arange(form.instance.combinations.count)
    kept = rows_of_use(form, rule, every)
    assert 0 < len(kept) < len(every)
    _, combinations, phi = designs_of(form, rng, 60_000)
    useful = rule.possible_gain(phi) > 10 * TUNING.tolerances.tie
    assert useful.any()
    assert set(combinations[useful]) <= set(every[kept])


def test_rows_are_those_of_the_combinations_asked_about():
    form, rng = strut_form(), np.random.default_rng(4)
    rule = known_by(form, [0, 1], rng, 40)
    every = np.arange(form.instance.combinations.count)
    kept = rows_of_use(form, rule, every)
    mixed = rng.permutation(np.repeat(every, 2))
    rows = rows_of_use(form, rule, mixed)
    np.testing.assert_array_equal(np.sort(rows), np.flatnonzero(np.isin(mixed, every[kept])))
    assert len(rows_of_use(form, rule, every[:0])) == 0
