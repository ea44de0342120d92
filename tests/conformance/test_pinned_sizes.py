"""Sizes that are all pinned: rounding of point boxes must not grow into a proof that nothing is feasible."""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.question.objectives import chosen_objectives, with_ties
from synth.search.formulation import Formulation
from tests.asking import instance_of

DUTY = {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"}
CLUTCH = synth.load("multi_plate_clutch", practice="off")
PARTS = {"friction_pair": ["cork_wet"], "inner_plate": ["core 1.5"], "outer_plate": ["core 2"]}


@pytest.mark.parametrize("ratio", [0.11, 0.13, 0.16, 0.2])
@pytest.mark.parametrize("outer", [351])
@pytest.mark.parametrize("compiled", [False, True])
def test_a_pinned_ring_that_is_feasible_is_kept(outer, ratio, compiled, monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "1" if compiled else "0")
    inner = round(outer * (1 - ratio) / (1 + ratio))
    fix = {"ramp_time": "2 s", "d_out": f"{outer} mm", "d_in": f"{inner} mm", "friction_surfaces": 24}
    instance = instance_of(CLUTCH, DUTY, as_catalogs(None), PARTS, None, fix)
    form = Formulation(instance, with_ties(instance.model, chosen_objectives(instance.model, None)), 2)
    forces = np.geomspace(500, 20000, 400)
    points = np.column_stack([np.full(400, outer / 1e3), np.full(400, inner / 1e3), forces, np.full(400, 2.0)])
    result = instance.model.evaluate(points, instance.data(np.array([0])))
    kept = form.boxes.root()
    if result.feasible.any():
        assert len(kept) == 1
        for _ in range(5):
            kept = form.boxes.contract(kept, None, passes=3, every_goal=True)
        assert len(kept) == 1
        least, most = forces[result.feasible][[0, -1]]
        assert kept.low[0, 2] <= least
        assert kept.high[0, 2] >= most
