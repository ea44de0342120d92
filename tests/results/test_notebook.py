"""Results show themselves in notebooks: static, escaped, their state first."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

import synth
from synth.results.notebook import MOST_ROWS, notebook_html
from tests.analysis.test_calculation import Beam

ASKED = {"mass_carried": "100 kg"}


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Beam, ASKED)


def parsed(text):
    return ElementTree.fromstring(text.replace("&#160;", " "))


def test_a_front_shows_its_proof_and_designs(front):
    text = front._repr_html_()
    parsed(text)
    assert "proven" in text
    assert "area [mm2]" in text
    assert "<script" not in text


def test_a_design_says_first_whether_it_is_feasible(front):
    text = front.designs[0]._repr_html_()
    parsed(text)
    assert text.index("feasible") < text.index("<table>")
    weak = synth.evaluate(Beam, ASKED, values={"width": "10 mm", "height": "12 mm"})
    assert "NOT FEASIBLE: stress violated" in weak._repr_html_()


def test_a_study_and_an_explanation_show_themselves():
    study = synth.whatif(Beam, ASKED, vary={"length": [400, 500]}, objectives=["area"])
    assert "What-if study" in study._repr_html_()
    nothing = synth.explain(Beam, ASKED, limits={"area": "<= 100 mm2"})
    text = nothing._repr_html_()
    parsed(text)
    assert "cannot hold together" in text or "No design keeps" in text


def test_texts_are_escaped_and_long_tables_cut():
    rows = [[k, "<b>", 1 / 3, None] for k in range(MOST_ROWS + 3)]
    text = notebook_html("<i>", ["<u>"], ["a", "b", "c", "d"], rows)
    parsed(text)
    assert "<u>" not in text
    assert text.count("&lt;b&gt;") == MOST_ROWS
    assert "3 more rows" in text
    assert "0.3333" in text
