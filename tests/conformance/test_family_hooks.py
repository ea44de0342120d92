"""The hooks of every registered family: frames that keep to the convention, drawings that can be read."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from synth.reports.figure import figure_svg

import synth
from synth.units import parse_unit, split_header, to_si
from tests.conformance.cases import CASES, front_of

pytestmark = pytest.mark.slow


def overrides(family, hook):
    return getattr(type(synth.load(family)), hook) is not getattr(synth.DesignProblem, hook)


def small_front(family):
    name, case = next(iter(CASES[family].feasible.items()))
    front = front_of(family, name)
    return synth.load(family, **case.options), case.requirements, replace(front, designs=front.designs[:2])


@pytest.fixture(scope="module", params=[f for f in CASES if overrides(f, "simulate") or overrides(f, "curves")])
def answered(request):
    return request.param, *small_front(request.param)


@pytest.fixture(scope="module")
def curves(answered):
    """Return the curves without a design and those of every design of the front; nothing of a family without any."""
    family, problem, requirements, front = answered
    if not overrides(family, "curves"):
        return None
    return synth.curves(problem, requirements), [synth.curves(problem, requirements, d) for d in front.designs]


def assert_sound(frames, drawn=True):
    for frame in frames.values():
        assert len(frame) > 1
        for column in frame.columns:
            name, unit = split_header(column)
            parse_unit(unit)
            assert name
        assert np.isfinite(frame.to_numpy(dtype=float)).any(axis=0).all()
        if drawn:
            ET.fromstring(figure_svg(frame))


def test_designs_are_simulated_and_the_second_opinion_agrees(answered):
    family, problem, requirements, front = answered
    if not overrides(family, "simulate"):
        return
    for number, design in enumerate(front.designs):
        frames = synth.simulate(problem, requirements, design)
        assert_sound(frames, drawn=number == 0)
        opinion = synth.second_opinion(design, frames).set_index("quantity")
        for name in ("slip_time", "friction_work", "peak_slip_power"):
            if name in design.values:
                assert opinion.loc[name, "relative_difference"] == pytest.approx(0, abs=1e-6), name


def test_what_hooks_read_stands_in_designs_however_they_are_had(answered, tmp_path):
    _, problem, requirements, front = answered
    loaded = synth.load_front(front.save(tmp_path)).designs
    for found, saved in zip(front.designs, loaded, strict=True):
        evaluated = synth.evaluate(problem, requirements, found)
        assert set(found.steps) == set(saved.steps) == set(evaluated.steps)
        for name, value in evaluated.steps.items():
            assert found.steps[name] == pytest.approx(value, rel=1e-12, nan_ok=True), name
            assert saved.steps[name] == pytest.approx(found.steps[name], rel=0, nan_ok=True), name
    with pytest.raises(synth.InputError, match=r"design: colour: is missing; expected a design of synth\.evaluate"):
        loaded[0].steps["colour"]


def test_curves_with_and_without_a_design(curves):
    if curves is None:
        return
    without, of_designs = curves
    assert_sound(without)
    for number, frames in enumerate(of_designs):
        assert_sound(frames, drawn=number == 0)


# Roots that only numbers have, so that no formula of symbols can be traced; a test of the family checks them.
ROOTS = (" (14)", " (16)")


def marked(frame):
    """Return what a frame marks: label and number in SI of every mark and line."""
    header = frame.attrs.get("x", frame.columns[0])
    found = [(mark["label"], mark["x"], header) for mark in frame.attrs.get("marks", ())]
    panels = frame.attrs.get("panels", ())
    found += [(line["label"], line["y"], panels[line["panel"]]["label"]) for line in frame.attrs.get("lines", ())]
    return {(label, float(to_si(number, parse_unit(split_header(head)[1])))) for label, number, head in found}


def test_every_number_that_a_curve_marks_for_a_design_was_traced(answered, curves):
    _, problem, requirements, front = answered
    if curves is None:
        return
    without, of_designs = curves
    asked = set().union(*(marked(frame) for frame in without.values()))
    for found, frames in zip(front.designs, of_designs, strict=True):
        design = synth.evaluate(problem, requirements, found)
        traced = [0.0, *design.values.values(), *design.steps.values(), *design.frame.requirement_values.values()]
        traced += [side for sides in design.limits.values() for side in sides]
        traced += [x for row in design.parts.values() for x in row.values() if isinstance(x, float)]
        traced = np.array(traced)
        for key, frame in frames.items():
            for label, number in marked(frame) - asked:
                if label.endswith(ROOTS):
                    continue
                assert np.isclose(traced, number, rtol=1e-9, atol=0).any(), (key, label, number)
