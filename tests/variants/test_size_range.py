"""Size ranges from batches: who serves whom, by the same evaluation as a check, and why some are not served."""

from __future__ import annotations

import csv
import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import synth
from synth.errors import InputError
from tests.sample_problems.rod import Rod

PARTS = "steel = S185, 42CrMo4"


def table() -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = [
        {
            "id": f"R{k}",
            "force [kN]": force,
            "parts": PARTS,
            "length [mm]": 100 + k,
            "diameter_limit [mm]": room,
            "limits": limits,
            "section": section,
        }
        for k, (force, room, limits, section) in enumerate(
            [
                (10, "", "", ""),
                (20, 30, "", ""),
                (45, 30, "", ""),
                (90, "", "mass <= 2 kg", ""),
                (150, 60, "", ""),
                (300, "", "rods <= 2", ""),
                (40, 12, "", ""),
                (60, "", "", "square"),
            ]
        )
    ]
    rows.append({**rows[2], "id": "again"})
    rows.append({"id": "weak", "force [kN]": 900, "parts": PARTS, "length [mm]": 100, "diameter_limit [mm]": 5})
    rows.append({"id": "bad", "force [kN]": "?", "parts": PARTS, "length [mm]": 100})
    return rows


@pytest.fixture(scope="module")
def batch(tmp_path_factory: pytest.TempPathFactory) -> synth.BatchResult:
    folder = tmp_path_factory.mktemp("range")
    return synth.batch(Rod, table(), folder, objectives=["mass", "diameter"], points=3)


@pytest.fixture(scope="module")
def pairs(batch: synth.BatchResult) -> tuple[np.ndarray, list[str]]:
    """Return the mass of every design for every feasible row, each pair checked alone; infinite where it fails."""
    designs = batch.designs()
    feasible = [row for row in table() if row["id"] in set(designs["id"])]
    variants = designs.drop_duplicates(["diameter [mm]", "rods [-]", "steel"])
    costs = np.full((len(feasible), len(variants)), np.inf)
    for i, row in enumerate(feasible):
        problem = Rod(section=row["section"] or "round")
        needs = {"force": f"{row['force [kN]']} kN"}
        if row["diameter_limit [mm]"]:
            needs["diameter_limit"] = f"{row['diameter_limit [mm]']} mm"
        for j, design in enumerate(variants.to_dict("records")):
            # The length is the row's own: every row pins it.
            values = {
                "diameter": f"{design['diameter [mm]']} mm",
                "rods": design["rods [-]"],
                "length": f"{row['length [mm]']} mm",
            }
            found = synth.evaluate(problem, needs, values=values, parts={"steel": design["steel"]})
            keeps = not found.violated
            keeps &= "rods" not in row["limits"] or design["rods [-]"] <= 2
            keeps &= "mass" not in row["limits"] or found.values["mass"] <= 2.000002
            costs[i, j] = found.values["mass"] if keeps else np.inf
    return costs, [row["id"] for row in feasible]


@pytest.mark.slow
def test_it_is_the_best_of_all_choices(batch: synth.BatchResult, pairs: tuple[np.ndarray, list[str]]) -> None:
    costs, names = pairs
    assert np.isfinite(costs).any(axis=1).all()
    excess = costs - costs.min(axis=1, keepdims=True)
    least: dict[int, float] = {}
    for number in range(1, 5):
        choices = itertools.combinations(range(costs.shape[1]), number)
        least[number] = min(float(excess[:, list(c)].min(axis=1).sum()) for c in choices)
    fewest = next(k for k in least if np.isfinite(least[k]))
    found = synth.size_range(batch, gap=1e-9)
    assert (found.fewest, found.fewest_proven, len(found.variants)) == (fewest, True, fewest)
    for number in range(fewest, 5):
        found = synth.size_range(batch, number, gap=1e-9)
        assert found.cost == pytest.approx(least[number], rel=1e-9, abs=1e-12)
        assert found.gap <= 1e-9
        rows = {row["line"] - 2: row for row in found.assignment}
        assert [table()[k]["id"] for k in rows] == names
        for i, row in enumerate(rows.values()):
            assert row["mass [kg]"] - row["excess [kg]"] == pytest.approx(costs[i].min(), rel=1e-9)
        assert sum(variant["rows"] for variant in found.variants) == len(names)
        assert {point["variants"]: point["cost"] for point in found.points}[number] == pytest.approx(least[number])
    costs_by_number = [point["cost"] for point in found.points]
    assert costs_by_number == sorted(costs_by_number, reverse=True)
    assert costs_by_number[-1] == 0.0
    assert found.taken_from_row == {"rod": ["length"]}


@pytest.mark.slow
def test_rows_that_no_variant_serves_are_told_with_the_reason(batch: synth.BatchResult) -> None:
    found = synth.size_range(batch)
    assert [(row["line"], row["status"]) for row in found.unserved] == [(11, "infeasible"), (12, "bad_input")]
    assert "stress" in found.unserved[0]["reason"] or "diameter" in found.unserved[0]["reason"]
    assert "expected a number" in found.unserved[1]["reason"]


def test_with_few_candidates_every_row_keeps_one_that_serves_it(batch: synth.BatchResult) -> None:
    found = synth.size_range(batch, candidates=2)
    assert {row["status"] for row in found.unserved} == {"infeasible", "bad_input"}
    assert found.statistics["candidates"] < found.statistics["designs"]


def test_another_objective_counts(batch: synth.BatchResult) -> None:
    found = synth.size_range(batch, 3, "diameter")
    assert found.objective == "diameter"
    assert found.unit == "mm"
    assert "diameter [mm]" in found.assignment[0]
    assert all(row["excess [mm]"] >= 0 for row in found.assignment)


def test_its_files_hold_everything(batch: synth.BatchResult, tmp_path: Path) -> None:
    found = synth.size_range(batch, 3)
    folder = found.save(tmp_path / "range")
    assert {path.name for path in folder.iterdir()} == set(found.files())
    with (folder / "variants.csv").open(newline="") as file:
        variants = list(csv.DictReader(file))
    assert [row["variant"] for row in variants] == ["1", "2", "3"]
    assert {"family", "rows", "total_excess [kg]", "mass [kg]", "diameter [mm]", "rods [-]", "steel"} == set(
        variants[0]
    ) - {"variant"}
    with (folder / "assignment.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == 9
    record = json.loads((folder / "size_range.json").read_text())
    assert record["total_excess"] == found.cost
    assert record["statistics"]["rows_served"] == 9
    curve = found.curve()
    assert list(curve.columns) == ["variants [-]", "total_excess [kg]", "gap [-]"]
    again = synth.size_range(batch, 3)
    assert again.files()["variants.csv"] == found.files()["variants.csv"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"variants": 1}, "variants: got 1; expected at least"),
        ({"variants": 0}, "variants: got 0"),
        ({"objective": "cost"}, "objective: got 'cost'; expected an objective of the whole batch: mass, diameter"),
        ({"per_row": ["diameter"]}, "variables that every row of rod pins"),
        ({"candidates": 0}, "candidates"),
        ({"gap": 2}, "gap"),
        ({"time_limit": -1}, "time_limit"),
    ],
)
def test_what_cannot_be_is_refused(batch: synth.BatchResult, more: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        synth.size_range(batch, **more)


def test_a_folder_needs_a_batch(tmp_path: Path, batch: synth.BatchResult) -> None:
    with pytest.raises(InputError, match="the folder of a batch"):
        synth.size_range(tmp_path)
    with pytest.raises(InputError, match="the BatchResult itself"):
        synth.size_range(batch.folder)
    nothing = synth.batch(Rod, [{"force": 1e6, "diameter_limit": 1, "parts": PARTS}], points=1)
    with pytest.raises(InputError, match="at least one feasible row"):
        synth.size_range(nothing)
