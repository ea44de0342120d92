"""What holds over a whole question holds for every feasible design of it."""

import numpy as np

from tests.sample_problems.strut import designs_of, strut_form


def test_every_feasible_design_lies_within_the_bounds_of_its_question():
    form = strut_form()
    question = form.bounding.question
    points, combinations, _ = designs_of(form, np.random.default_rng(5), 20_000)
    assert len(points) > 100
    assert np.all(points >= question.low[: form.n] - 1e-9)
    assert np.all(points <= question.high[: form.n] + 1e-9)
    nodes = sorted({k for k in question.sides() if np.isfinite(question.root.low[k])})
    assert nodes
    values = form.model.program.compile(nodes)([*points.T, *form.instance.data(combinations)])
    for k, value in zip(nodes, values, strict=True):
        known = np.broadcast_to(value, len(points))[~np.isnan(np.broadcast_to(value, len(points)))]
        low, high = question.range_of(k)
        assert np.all(known >= low - 1e-9 * abs(low))
        assert np.all(known <= high + 1e-9 * abs(high))
        if question.surely_positive(k):
            assert np.all(known > 0)


def test_limits_narrow_the_range_of_a_question():
    question = strut_form().bounding.question
    length = [v.name for v in question.model.variables].index("length")
    # With one plate at least, a strut reaches over 120 mm, up to what feasibility tolerates.
    assert 0.1199 < question.low[length] <= 0.12
    assert not question.root.empty


def test_values_of_rows_are_those_of_the_tables():
    question = strut_form().bounding.question
    material = [f.name for f in question.factors].index("material")
    stresses = [v for v in question.row_values[material].values() if np.isnan(v).any()]
    np.testing.assert_allclose(stresses[0], [80e6, 160e6, np.nan])
