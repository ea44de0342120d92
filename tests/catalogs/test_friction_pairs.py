"""Friction pairs that families offer: lists of designations per family and options, which a new column must keep."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from synth.question.catalogs import as_catalogs
from tests.conformance.cases import question

OFFERED = list(csv.DictReader(Path(__file__).with_name("friction_pairs.csv").read_text().splitlines()))


@pytest.mark.parametrize("row", OFFERED, ids=lambda row: f"{row['family']}-{row['options']}")
def test_a_family_offers_the_pairs_of_its_list(row: dict[str, str]) -> None:
    options = dict(pair.split("=") for pair in row["options"].split(";") if pair)
    (slot,) = [s for s in question(row["family"], options, optional=False).selection.slots if s.slot == "friction_pair"]
    assert [slot.table.designations[k] for k in slot.rows] == row["friction_pairs"].split(";")


def test_pairs_without_a_surface_are_offered_to_no_family() -> None:
    table = as_catalogs(None).table("friction_materials")
    bare = {n for n, words in zip(table.designations, table.text("surfaces"), strict=True) if not words}
    offered = {pair for row in OFFERED for pair in row["friction_pairs"].split(";")}
    assert bare == set(table.designations) - offered
    assert len(bare) == 5
