"""The code that serves all formulas gives the bits of a question's own code, and may take its place at any time."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.bounds import box_instructions as lists
from synth.bounds import compiled_boxes, interpreted_boxes
from synth.bounds.intervals import FORWARD
from synth.compiled import compiler
from synth.model.constraint import Goal
from synth.model.program import Program
from synth.tuning import CompilingEffort, CompilingLimits
from tests.bounds.test_compiled_boxes import ARITHMETIC, SMOOTH, Case, limits_at, random_case, use_of
from tests.repetitions import repetitions
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import synthesize, tuned

HERE = compiler.cache_folder() is not None and compiler._compiler() is not None
pytestmark = [pytest.mark.skipif(not HERE, reason="no C compiler"), pytest.mark.usefixtures("compiled_quickly")]

EFFORT = CompilingEffort()
MOST_VARIABLES = interpreted_boxes.MOST["N"]


def general(code):
    """Return generated code carried out from a list."""
    listed = interpreted_boxes.listed_code(code)
    assert listed is not None
    found = compiler.library("general", interpreted_boxes.source(), EFFORT, compiled_boxes.GENERAL_FLAGS)
    assert found is not None
    return compiled_boxes.BoxCode(found, listed)


def same_bits(case, capped, passes):
    """Check that both codes return the same bytes; return how many boxes are alive."""
    code = case.contractor.code(case.root, capped)
    own, own_verdicts = case.compiled(code, capped, passes)
    shared, verdicts = case.compiled(code, capped, passes, made=general)
    for name in ("cell", "low", "high", "bounds", "scores", "tag"):
        assert getattr(own, name).tobytes() == getattr(shared, name).tobytes(), name
    assert own_verdicts.alive.tobytes() == verdicts.alive.tobytes()
    assert own_verdicts.undecided.tobytes() == verdicts.undecided.tobytes()
    return len(own)


@pytest.mark.slow
@pytest.mark.parametrize("range_", [(-2.0, 2.0), pytest.param((0.2, 2.5), marks=pytest.mark.slow)])
@pytest.mark.parametrize("first", range(0, len(FORWARD) + 6, MOST_VARIABLES // 2))
def test_every_rule_gives_the_bits_of_own_code(first, range_):
    rng = np.random.default_rng(3)
    powers = [-2.0, -1.5, 0.5, 2.0, 3.0, 4.0]
    uses = [*((op, None) for op in sorted(FORWARD)), *((ca.OP_CONSTPOW, e) for e in powers)][first:][
        : MOST_VARIABLES // 2
    ]
    n = 2 * len(uses)
    symbols, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    outputs = [
        use_of(op, *symbols[2 * k : 2 * k + 2])
        if e is None
        else ca.SX.binary(op, symbols[2 * k], e) + symbols[2 * k + 1]
        for k, (op, e) in enumerate(uses)
    ]
    goals = [symbols[0] * data[0] + data[1], data[2] / data[3] - symbols[1]]
    program = Program([*symbols, *data], [*outputs, *goals])
    point = rng.uniform(*range_, n + 4)
    limits = limits_at(rng, program, program.outputs[: len(outputs)], list(point))
    case = Case(program, n, limits, [Goal(program.outputs[-2], 1), Goal(program.outputs[-1], -1)], range_, rng, 70)
    around = rng.random(case.low.shape) < 0.97
    case.low = np.where(around, np.minimum(case.low, point[:n]), case.low)
    case.high = np.where(around, np.maximum(case.high, point[:n]), case.high)
    assert same_bits(case, False, 3) > 0
    if first == 0:  # caps narrow what goals are made of, which is the same in all
        same_bits(case, True, 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_random_programs_give_the_bits_of_own_code(seed):
    for passes, capped in ((1, False), (3, True)):
        same_bits(random_case(seed, SMOOTH), capped, passes)


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans(), st.sampled_from([ARITHMETIC, SMOOTH]))
@settings(deadline=None, derandomize=True, max_examples=repetitions(8, 25))
def test_more_random_programs_give_the_bits_of_own_code(seed, passes, capped, makers):
    same_bits(random_case(seed, makers), capped, passes)


def test_a_batch_of_any_size_gives_the_bits_of_its_boxes():
    case = random_case(11, ARITHMETIC, boxes=75)
    whole, _ = case.compiled(case.contractor.code(case.root, False), False, 2, made=general)
    for count in (1, 7, 33):
        few = random_case(11, ARITHMETIC, boxes=75)
        for name in ("cell", "low", "high", "cutoffs"):
            setattr(few, name, getattr(few, name)[:count])
        few.boxes = count
        found, _ = few.compiled(few.contractor.code(few.root, False), False, 2, made=general)
        first = whole.take(whole.tag < count)
        assert found.low.tobytes() == first.low.tobytes()
        assert found.high.tobytes() == first.high.tobytes()


def test_operations_are_computed_as_they_are_said():
    """Every operation has a case of its own, and no expression needs more operands than an instruction has."""
    cases = re.findall(r"case (\d+):", lists.cases())
    assert len(cases) == len(set(cases))
    assert {int(x) for x in cases} == set(range(len(lists.BUILT_IN), len(lists.operations())))


def test_what_is_too_large_has_no_list():
    rng = np.random.default_rng(0)
    n = MOST_VARIABLES + 1
    symbols, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    program = Program([*symbols, *data], [ca.sum1(ca.vertcat(*symbols)), symbols[0] * data[0]])
    limits = limits_at(rng, program, program.outputs[:1], [1.0] * (n + 4))
    case = Case(program, n, limits, [Goal(program.outputs[1], 1)], (0.5, 2.0), rng, 10)
    code = case.contractor.code(case.root, False)
    assert interpreted_boxes.listed_code(code) is None
    assert compiled_boxes.compiled(code, 10, CompilingLimits()) is not None  # of its own, at once


# -- which of the two ----------------------------------------------------------------------------------


def front(own):
    """Return the files of a front; ``own``: boxes from which own code is compiled."""
    limits = {"combinations": 0, "own": own}
    return synthesize(tuned(compiling=limits), Strut(), NEEDED, catalogs={"rods": RODS}, points=5).files()


def kinds(folder):
    return {path.name.rpartition("_")[0] for path in folder.glob("*.so")}


@pytest.mark.slow
def test_own_code_beside_a_search_changes_no_byte(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    never, folder = front(np.inf), tmp_path / "clutchsynth"
    assert kinds(folder) == {"boxes_general", "nlp_general"}
    for _ in range(200):  # it is begun by the first search and used by a later one
        found = front(0)
        assert found["designs.csv"] == never["designs.csv"]
        if "boxes" in kinds(folder):
            break
        time.sleep(0.1)
    assert "boxes" in kinds(folder)
    assert front(0)["designs.csv"] == never["designs.csv"]


@pytest.mark.slow
def test_own_code_that_is_kept_is_used_from_the_beginning(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    never, folder = front(np.inf), tmp_path / "clutchsynth"
    while "boxes" not in kinds(folder):
        front(0)
        time.sleep(0.1)
    for path in folder.glob("boxes_general_*"):
        path.unlink()
    assert front(np.inf)["designs.csv"] == never["designs.csv"]
    assert kinds(folder) == {"boxes", "nlp_general"}


@pytest.mark.slow
def test_what_own_code_would_be_used_for_is_noted_for_programs_to_come(tmp_path):
    program = "from tests.bounds.test_interpreted_boxes import front; import numpy; front(numpy.inf)"
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    subprocess.run([sys.executable, "-c", program], check=True, env=environment, cwd=Path(__file__).parents[2])
    noted = [float(path.read_text()) for path in (tmp_path / "clutchsynth").glob("boxes_*.demand")]
    assert noted
    assert min(noted) > 0
