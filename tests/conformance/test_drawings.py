"""Drawings of every family that has them: they show the design that is computed, and can be read.

Every structure of a family is drawn at random designs: the smallest, the largest and two others.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from synth.reports.drawing.dxf import dxf_document
from synth.reports.drawing.page import paper_sheet
from synth.reports.drawing.paper import overlap
from synth.reports.drawing.svg import drawing_svg

import synth
from synth.analysis.designs import make_design, make_frame, part_row
from synth.analysis.drawing import drawing_of, draws, shown_measure, weighed
from synth.results.design import DesignSteps
from synth.testing.properties import Properties
from tests.conformance.cases import CASES, front_of, question
from tests.repetitions import repetitions
from tests.reports.dxf_measures import drawn_measure, measured_in
from tests.reports.sheet_places import corners_of, texts_of

pytestmark = pytest.mark.slow
of_drawings = Properties()

POINTS = 60
OTHERS = repetitions(1, 30)
DRAWN = [f for f in CASES if draws(synth.load(f))]
STRUCTURES = [(f, s) for f in DRAWN for s in CASES[f].option_sets]


def random_designs(family, structure):
    """Return random designs with sensible proportions, small ones first."""
    instance = question(family, CASES[family].option_sets[structure], optional=False)
    rng = np.random.default_rng(7)
    variables = CASES[family].sound(rng, instance, POINTS)
    numbers = rng.integers(0, instance.combinations.count, POINTS)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (POINTS,)) for x in instance.data(numbers)]
    result = instance.evaluate(variables, data)
    across = np.asarray(result.values["outer_diameter"], dtype=float)
    known = [k for k in np.argsort(across) if math.isfinite(across[k]) and across[k] > 0]
    frame = make_frame(instance, {})
    steps = instance.model.steps(variables, data)
    for k in known:
        rows, _, choices = instance.combinations.describe(int(numbers[k]))
        parts = {slot: part_row(*row) for slot, row in rows.items()}
        yield (
            instance.problem,
            make_design(instance, frame, variables[k], result, k, parts, choices, steps=DesignSteps(steps[k])),
        )


def drawings_of(family, structure):
    """Return the smallest, the largest and other random designs that have bodies, with their drawings."""
    designs = list(random_designs(family, structure))
    refused = []

    def first_drawn(among):
        for problem, design in among:
            try:
                return [(design, drawing_of(problem, design))]
            except synth.InputError as error:
                refused.append(str(error))
        return []

    others = [designs[(k + 1) * len(designs) // (OTHERS + 1) :] for k in range(OTHERS)]
    found = [x for among in (designs, *others, designs[::-1]) for x in first_drawn(among)]
    assert found
    assert all("whose parts have bodies" in words for words in refused)
    return found + known_drawing(family, structure)


def known_drawing(family, structure):
    instance = question(family, CASES[family].option_sets[structure], optional=False)
    known_one = CASES[family].designs.get(structure)
    if known_one is not None:
        values = {**known_one.sizes, **known_one.counts}
        problem, stated = instance.problem, make_frame(instance, {}).requirements
        design = synth.evaluate(problem, stated, values=values, parts=known_one.parts)
        return [(design, drawing_of(problem, design))]
    return []


@pytest.fixture(scope="module", params=STRUCTURES, ids=lambda p: f"{p[0]}-{p[1]}")
def drawn(request):
    """Return designs of a structure with their drawings, on paper as well."""
    return [(*x, paper_sheet(x[1], x[0].frame.title, "clutchsynth 0.0.0")) for x in drawings_of(*request.param)]


@of_drawings
def dimensions_are_the_quantities_that_they_name(drawn):
    for design, drawing, _ in drawn:
        assert len(drawing.measured) >= 4
        for dimension in drawing.measured:
            assert dimension.measure == pytest.approx(shown_measure(dimension, design), rel=1e-9, abs=1e-9)


@of_drawings
def areas_weigh_what_the_design_weighs(drawn):
    for design, drawing, _ in drawn:
        for names, of_drawing, of_design in weighed(drawing, design):
            assert of_drawing == pytest.approx(of_design, rel=1e-6), names


@of_drawings
def every_part_that_is_drawn_is_listed_and_numbered(drawn):
    for _, drawing, _ in drawn:
        told = {b.item for v in drawing.views for b in (*v.balloons, *(b for d in v.details for b in d.balloons))}
        assert told == {item.number for item in drawing.items}
        assert all(item.count > 0 and item.name for item in drawing.items)


@of_drawings
def what_is_no_part_of_the_model_is_told(drawn):
    for _, drawing, sheet in drawn:
        assert all(len(text) > 4 for text in drawing.omitted)
        text = drawing_svg(sheet, drawing)
        assert "Not part of the model, not drawn:" in text
        ET.fromstring(text)


@of_drawings
def nothing_overlaps_and_nothing_leaves_the_frame(drawn):
    for _, _, sheet in drawn:
        assert_readable(sheet)


def test_drawings_of_an_option_set_keep_every_property(drawn):
    of_drawings.check(drawn)


def assert_readable(sheet):
    x0, y0, x1, y1 = sheet.frame
    texts = texts_of(sheet)
    boxes = [(place, text.text, text.corners) for place, text in texts]
    for k, view in enumerate(sheet.views):
        place = f"{k} {view.view.name}" + (f" {view.detail.letter}" if view.detail else "")
        boxes += [(place, "ring", ring_box(c.ring)) for c in view.callouts if c.ring]
    for place, text, corners in boxes:
        assert all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in corners), (place, text)
    for k, (place, text, corners) in enumerate(boxes):
        for other, others, more in boxes[:k]:
            if "ring" in (text, others) and place == other:
                continue  # a number stands in its ring
            assert not overlap(corners, more), (place, text, other, others)
    regions = [corners_of(view.region) for view in sheet.views] + [corners_of(box) for box in sheet.boxes]
    for k, region in enumerate(regions):
        assert all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in region)
        assert not any(overlap(region, other) for other in regions[:k])


@pytest.mark.parametrize("family", DRAWN)
def test_dxf_is_sound_and_measures_what_is_drawn(family):
    pytest.importorskip("ezdxf")
    design, drawing = drawings_of(family, next(reversed(CASES[family].option_sets)))[-1]
    document = dxf_document(paper_sheet(drawing, design.frame.title, "clutchsynth 0.0.0"), drawing)
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    assert measured_in(document) == pytest.approx(sorted(drawn_measure(d) for d in drawing.measured), rel=1e-9)


def ring_box(ring):
    (x, y), r = ring.centre, ring.radius
    return corners_of((x - r, y - r, x + r, y + r))


@pytest.mark.parametrize("family", DRAWN)
def test_designs_of_a_front_are_drawn_as_they_are_when_it_is_read_again(family, tmp_path):
    name, case = next(iter(CASES[family].feasible.items()))
    front = front_of(family, name)
    problem = synth.load(family, **case.options)
    again = synth.load_front(front.save(tmp_path))
    for found, read in zip(front.designs[:2], again.designs[:2], strict=True):
        assert drawing_of(problem, found) == drawing_of(problem, read)
        assert synth.draw(problem, case.requirements, found).items == drawing_of(problem, read).items
