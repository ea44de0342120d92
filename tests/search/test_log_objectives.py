"""Log-objectives: the scale on which objectives are compared, there and back."""

from __future__ import annotations

import numpy as np
import pytest

from synth.search.log_objectives import LogObjectives

MASS, BALANCE, DECLARED = 0, 1, 2
OBJECTIVES = LogObjectives.of([True, False, False], np.array([2.0, 4.0, 4.0]), [None, None, 1e-9])


def test_ratios_of_positive_objectives_are_differences():
    phi = OBJECTIVES.phi_of(np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]]))
    np.testing.assert_allclose(np.diff(phi[:, MASS]), np.log(2.0))


def test_values_come_back():
    values = np.array([[0.5, -3.0, 1e-3], [7.0, 0.0, -2.0]])
    phi = OBJECTIVES.phi_of(values)
    np.testing.assert_allclose(OBJECTIVES.values_of(phi), values, rtol=1e-12)
    np.testing.assert_array_equal(OBJECTIVES.values_of(phi[:, :2]), OBJECTIVES.values_of(phi)[:, :2])
    np.testing.assert_array_equal(OBJECTIVES.signed(BALANCE, phi[:, BALANCE]), OBJECTIVES.values_of(phi)[:, BALANCE])


def test_a_positive_objective_that_is_not_positive_is_good_beyond_all():
    assert OBJECTIVES.phi_of(np.array([[0.0, 0.0, 0.0]]))[0, MASS] == pytest.approx(np.log(1e-300))


def test_a_gap_is_a_share_of_positive_values_and_of_sizes_elsewhere():
    tolerance = OBJECTIVES.tolerance(0.01, np.array([9.0, 3.0, 0.0]))
    assert tolerance[MASS] == pytest.approx(-np.log(0.99))
    assert tolerance[BALANCE] == pytest.approx(0.03, rel=1e-6)
    # Never below the resolution, but for what breaking ties gives away.
    assert tolerance[DECLARED] * OBJECTIVES.scales[DECLARED] == pytest.approx(0.5e-9)
