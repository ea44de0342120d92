"""The independent check of a front: what is true passes, whatever is changed is found, also with a new checksum."""

import ast
import contextlib
import copy
import dataclasses
import json
import math
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synth
from synth.proof.questions import Point
from synth.proof.settings import PROOF
from synth.results import ParetoFront, PartRow
from synth.results.loading import load_front, unchecked_front
from synth.results.next_row import NextRow
from synth.results.verification import Verdict
from synth.tables.catalogs import Catalogs
from synth.verification.pareto_regions import uncovered
from synth.verification.verify import VerificationRun, checked
from tests.asking import instance_of
from tests.repetitions import repetitions
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]
ASKED = {**NEEDED, "room": "90 mm"}
STRUT = Strut(finish="coated")
FEW_PLATES = {"plate": ["core 1", "core 2", "core 4"]}


def test_nothing_is_shared_with_the_search():
    # What was asked is shared (tables and declarations read into an instance), and the tolerance of limits.
    allowed = {"proof", "verification", "model", "question", "results", "units", "special"}
    allowed |= {"errors", "folders", "text"}  # these read and write: no design is in them
    for path in (ROOT / "synth").glob("*/*.py"):
        if path.parent.name not in ("proof", "verification") or path.name == "verify_comparison.py":
            continue  # what ranks families beside each other evaluates their designs as everybody does
        tree = ast.parse(path.read_text(encoding="utf-8"))
        modules = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.module}
        modules |= {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
        # How a saved question is asked again, and the tolerance of limits.
        modules -= {"synth.analysis.restate", "synth.order.feasibility"}
        used = {m.split(".")[1] for m in modules if m.startswith("synth.")}
        assert used <= allowed, path.name
        assert "synth" not in modules


# -- fronts that are right ---------------------------------------------------------------------------


class Numbers(synth.DesignProblem):
    """Only counts and parts."""

    name = "numbers"

    def declare(self, d):
        n, m = d.count("n", 1, 8), d.count("m", 1, 8)
        rod = d.part("material", "rods")
        d.derive("weight", "-", n * m * rod.density / 1000)
        d.derive("weakness", "-", 10 / n + 3 / (m * m) + 1e8 / rod.stress_allow)
        d.at_most("sum", n + m, 12 + 0 * n, "-")
        d.objective("weight")
        d.objective("weakness")


class Smooth(synth.DesignProblem):
    """Only variables: a can of a volume, area against height."""

    name = "smooth"

    def declare(self, d):
        radius = d.variable("radius", "mm", 5, 200)
        height = d.variable("height", "mm", 5, 400)
        d.at_least("volume", math.pi * radius**2 * height, 5e-4 + 0 * radius, "m3")
        d.derive("area", "m2", 2 * math.pi * radius * (radius + height))
        d.objective("area")
        d.objective("height")


class Bound(synth.DesignProblem):
    """An equality, an objective to be large and one that may have either sign."""

    name = "bound"

    def declare(self, d):
        x, y = d.variable("x", "-", 0.5, 4), d.variable("y", "-", 0.5, 4)
        n = d.count("n", 1, 3)
        d.equal("circle", x * x + y * y, 9 + 0 * x, "-")
        d.derive("gain", "-", x * y + 0.1 * n)
        d.derive("balance", "-", x - y + 0.2 * n)
        d.objective("gain", "max")
        d.objective("balance")


class Unlike(synth.DesignProblem):
    """Parts that do not go together."""

    name = "unlike"

    def declare(self, d):
        one, two = d.part("one", "rods"), d.part("two", "rods")
        d.refuse("same", one.density + two.density < 15700.5, "two parts of which one is dense")
        d.derive("sum", "kg/m3", one.density + 2 * two.density)
        d.derive("other", "kg/m3", 3 * one.density - two.density)
        d.objective("sum")
        d.objective("other")


RODS_TABLE = {"rods": RODS}
WHOLE = pd.DataFrame(
    {
        "designation": ["soft", "hard", "odd"],
        "stress_allow [N/mm2]": [80.0, 160.0, 120.0],
        "density [kg/m3]": [7850.0, 8850.0, 7900.0],
    }
)
QUESTIONS = {
    "counts and parts": (Numbers(), {}, {"catalogs": {"rods": WHOLE}, "points": 40}),
    "counts and parts, not all": (Numbers(), {}, {"catalogs": {"rods": WHOLE}, "points": 4}),
    "variables": (Smooth(), {}, {"points": 6, "gap": 1e-3}),
    "one objective": (Smooth(), {}, {"objectives": ["area"], "gap": 1e-4}),
    "a limit of the user": (Smooth(), {}, {"points": 4, "limits": {"area": "<= 0.05 m2"}, "gap": 5e-3}),
    "equality, large, either sign": (Bound(), {}, {"points": 5, "gap": 1e-2}),
    "either sign alone": (Bound(), {}, {"objectives": ["balance"], "gap": 1e-2}),
    "refused together": (Unlike(), {}, {"catalogs": {"rods": WHOLE}}),
    "one of everything": (STRUT, ASKED, {"catalogs": RODS_TABLE, "parts": FEW_PLATES, "points": 5}),
    "makeable or not": (STRUT, ASKED, {"catalogs": RODS_TABLE, "parts": FEW_PLATES, "points": 4, "grid": False}),
    "fixed": (STRUT, ASKED, {"catalogs": RODS_TABLE, "fix": {"plate": "core 2", "end": "eye", "length": "200 mm"}}),
    "infeasible": (Smooth(), {}, {"limits": {"area": "<= 0.03 m2"}}),
    "infeasible counts": (Numbers(), {}, {"catalogs": {"rods": WHOLE}, "limits": {"weakness": "<= 1"}}),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", QUESTIONS)
def test_a_front_that_is_right_holds(name, tmp_path):
    problem, requirements, settings = QUESTIONS[name]
    front = synth.synthesize(problem, requirements, **settings)
    assert front.certificate.kind == "global"
    assert bool(front.designs) != name.startswith("infeasible")
    verification = load_front(front.save(tmp_path)).verify(problem, settings.get("catalogs"))
    assert verification.findings == ()
    assert verification.holds
    assert verification.claimed_gap == verification.proven_gap == front.certificate.gap
    words = "improves" if front.designs else "no design is feasible"
    assert words in verification.sentence()


def test_a_front_without_a_proof_is_checked_as_far_as_it_goes():
    front = synth.synthesize(Smooth(), {}, points=3)
    loose = dataclasses.replace(
        front,
        status=synth.order.feasibility.Status.FEASIBLE,
        complete=False,
        certificate=dataclasses.replace(front.certificate, kind="heuristic", gap=None),
        designs=[
            dataclasses.replace(d, status=synth.order.feasibility.Status.FEASIBLE, gap=None) for d in front.designs
        ],
    )
    verification = loose.verify(Smooth())
    assert verification.holds
    assert verification.proven_gap is None
    assert "no proof is claimed" in verification.sentence()


@pytest.mark.slow
@pytest.mark.parametrize("fix", [{"ramp_time": "2 s"}, {}])
def test_a_front_of_a_family_holds_over_its_whole_catalogue(fix):
    requirements = {
        "load_torque": "600 N*m",
        "driver_speed": "26.6 rad/s",
        "driven_inertia": "30 kg*m2",
        "engagements_per_hour": "50 1/h",
        "jerk_limit": "18 rad/s3",
    }
    front = synth.synthesize(
        synth.load("multi_plate_clutch", practice="off"), requirements, points=8, gap=5e-3, grid=False, fix=fix
    )
    verification = front.verify()
    assert verification.findings == ()
    assert verification.proven_gap == 5e-3


class Paired(synth.DesignProblem):
    """Two rows and a length; the lightest pairs are refused."""

    name = "paired"

    def declare(self, d):
        length = d.variable("length", "mm", 100, 200)
        one, two = d.part("one", "rods"), d.part("two", "rods")
        d.refuse("same", one.density * two.density < 7900.5 * 7850.5, "two parts of which one is dense")
        d.derive("mass", "kg", (one.density + two.density) * length * 1e-4)
        d.objective("mass")


def test_a_design_that_is_refused_refutes_nothing():
    front = synth.synthesize(Paired(), {}, catalogs={"rods": WHOLE})
    check = VerificationRun(front, math.inf)
    check.ask(front.question)
    assert check.listed()
    rows = dict.fromkeys(("one", "two"), 0)
    soft = Point(np.array([0.1]), [7850.0] * len(front.question.model.data_inputs), rows)
    assert not check._lies_below(soft, np.array([[math.inf]]))
    check.claim()
    assert (check.findings, check.open) == ([], [])


# -- fronts that are wrong ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def front():
    found = synth.synthesize(STRUT, ASKED, points=5, parts=FEW_PLATES, catalogs=RODS_TABLE, gap=5e-2)
    return dataclasses.replace(found, question=instance_of(STRUT, ASKED, Catalogs(RODS_TABLE), parts=FEW_PLATES))


@pytest.fixture(scope="module")
def saved(front, tmp_path_factory):
    return front.save(tmp_path_factory.mktemp("front"))


def findings(front):
    return front.verify(STRUT, RODS_TABLE).findings


def changed(front, position, **more):
    """Return the front with some fields of one design replaced."""
    designs = list(front.designs)
    designs[position] = dataclasses.replace(designs[position], **more)
    return dataclasses.replace(front, designs=designs)


def scaled(mapping, name, factor=1.001):
    return {**mapping, name: mapping[name] * factor}


def certified(front, **more):
    return dataclasses.replace(front, certificate=dataclasses.replace(front.certificate, **more))


def worse(front):
    """Return the front with a sixth design: feasible, told right, and longer than the first one."""
    first = front.designs[0]
    values = {**{n: f"{first.values[n]!r} m" for n in ("width",)}, "length": "290 mm", "plates": first.values["plates"]}
    parts = {slot: str(row) for slot, row in first.parts.items()}
    design = synth.evaluate(STRUT, ASKED, values={**values, **first.choices}, parts=parts, catalogs=RODS_TABLE)
    assert design.status is synth.order.feasibility.Status.FEASIBLE
    settings = {**front.settings, "points": 6}
    low = np.min([[d.objectives[n] for n in d.objectives] for d in front.designs], axis=0)
    own = np.array([design.objectives[n] for n in design.objectives])
    score = float(np.sqrt(np.mean(np.log(own / low) ** 2)))
    more = dataclasses.replace(design, rank=6, score=score, status=first.status, gap=first.gap)
    return dataclasses.replace(front, designs=[*front.designs, more], settings=settings)


def shifted(front):
    """Return the front with its first design replaced by a feasible one that is 20 % worse, all told right."""
    first = front.designs[0]
    values = {"width": f"{first.values['width']!r} m", "length": f"{1.2 * first.values['length']!r} m"}
    values |= {"plates": first.values["plates"], **first.choices}
    parts = {slot: str(row) for slot, row in first.parts.items()}
    design = synth.evaluate(STRUT, ASKED, values=values, parts=parts, catalogs=RODS_TABLE)
    assert design.status is synth.order.feasibility.Status.FEASIBLE
    kept = {n: getattr(first, n) for n in ("rank", "score", "note", "status", "gap", "elasticity", "alternatives")}
    return dataclasses.replace(front, designs=[dataclasses.replace(design, **kept), *front.designs[1:]])


def reframed(front, **more):
    return dataclasses.replace(front, frame=dataclasses.replace(front.frame, **more))


def row_of(front, slot, designation, **more):
    """Return the parts of the first design with another row in a slot."""
    table = front.question.catalogs.table(front.designs[0].parts[slot]["table"])
    index = table.row_index(designation)
    row = PartRow(table.name, table.hashes[index], {**table.row(index), **more})
    return {**front.designs[0].parts, slot: row}


def knee(front):
    return next(k for k, d in enumerate(front.designs) if "knee" in d.note)


def first(field, name, factor):
    """Return what scales one number of the first design."""
    return lambda f: changed(f, 0, **{field: scaled(getattr(f.designs[0], field), name, factor)})


DENSE = {"density": 7000.0}
INFEASIBLE = synth.order.feasibility.Status.INFEASIBLE
TAMPERINGS = {
    "a variable": (first("values", "length", 1.001), "evaluated it is"),
    "a derived value": (first("values", "area", 1.001), "area"),
    "an objective": (first("objectives", "mass", 0.99), "objective mass"),
    "a utilisation": (first("utilisation", "room", 0.9), "utilisation of room"),
    "a residual": (first("residuals", "room", 0.9), "residual of room"),
    "a side of a limit": (lambda f: changed(f, 0, limits={**f.designs[0].limits, "room": (0.01, 0.09)}), "sides"),
    "a count": (lambda f: changed(f, 0, values={**f.designs[0].values, "plates": 7.0}), "plates 7.0 is not a value"),
    "a label": (lambda f: changed(f, 0, choices={"end": "bolt"}), "end bolt is not a label"),
    "a size off the grid": (first("values", "width", 1 + 1e-6), "not on its grid"),
    "a size out of bounds": (first("values", "length", 10.0), "outside of its bounds"),
    "a part": (lambda f: changed(f, 0, parts=row_of(f, "plate", "core 3")), "plate core 3 is not a row"),
    "a column of a part": (
        lambda f: changed(f, 0, parts=row_of(f, "material", str(f.designs[0].parts["material"]), **DENSE)),
        "is not the row of table rods in force",
    ),
    "a row next to a size": (
        lambda f: changed(f, 0, next_rows={"pin": NextRow(1e-3, "mm", "rods", "core 3", 3e-3, 9e-3)}),
        "pin is told as core 3 (3 mm, 1 mm needed), by the tables it is none",
    ),
    "a rank": (lambda f: changed(f, 0, rank=2), "ranks are not"),
    "the order": (lambda f: dataclasses.replace(f, designs=f.designs[::-1]), "not in the order of their scores"),
    "a score": (lambda f: changed(f, 2, score=f.designs[2].score + 0.01), "score"),
    "a note": (lambda f: changed(f, knee(f), note=""), "the note 'knee'"),
    "a strange note": (lambda f: changed(f, 2, note="lightest"), "'lightest' means nothing"),
    "the gap of a design": (lambda f: changed(f, 0, gap=0.2), "gap 20 %"),
    "the status of a design": (lambda f: changed(f, 0, status=INFEASIBLE), "status infeasible"),
    "a requirement": (lambda f: reframed(f, requirements={**f.frame.requirements, "load": "21 kN"}), "load"),
    "a requirement that makes no sense": (lambda f: reframed(f, requirements={"load": "3 kg"}), "cannot be asked"),
    "a unit": (lambda f: reframed(f, units={**f.frame.units, "length": "m"}), "units"),
    "a limit less": (lambda f: reframed(f, limit_senses={"room": "at_most"}), "limit_senses"),
    "a design less": (lambda f: dataclasses.replace(f, designs=f.designs[:-1]), "some are missing"),
    "a design more": (lambda f: dataclasses.replace(worse(f), settings=f.settings), "at most 5"),
    "a dominated design": (worse, "dominates design 6"),
    "a design twice": (
        lambda f: dataclasses.replace(f, designs=[*f.designs[:4], dataclasses.replace(f.designs[3], rank=5)]),
        "design 4 equals design 5",
    ),
    "combinations": (lambda f: certified(f, combinations=73), "73 combinations"),
    "a smaller gap": (lambda f: certified(f, gap=1e-6), "gap 5 % is above what the certificate claims"),
    "complete": (lambda f: dataclasses.replace(f, complete=True), "the front is complete"),
    "a design that can be improved": (shifted, "improves design 1 by"),
    "no proof": (lambda f: certified(f, kind="heuristic"), "the certificate"),
    "no designs": (lambda f: certified(dataclasses.replace(f, designs=[], status=INFEASIBLE), gap=None), "is feasible"),
}


def test_the_front_that_is_tampered_with_is_right(front, saved):
    assert front.certificate.kind == "global"
    assert not front.complete
    assert front.verify().findings == ()
    assert findings(load_front(saved)) == ()


@pytest.mark.slow
@pytest.mark.parametrize("what", TAMPERINGS)
def test_whatever_is_changed_is_found_even_with_a_new_checksum(front, what, tmp_path):
    tamper, words = TAMPERINGS[what]
    found = findings(load_front(tamper(front).save(tmp_path)))
    assert any(words in sentence for sentence in found), found
    assert not any("checksum" in sentence for sentence in found)


@pytest.mark.parametrize("what", ["complete", "a design that can be improved", "a smaller gap"])
def test_a_front_that_is_wrong_is_refuted_by_levels_alone(front, what):
    levels = dataclasses.replace(PROOF, at_once=0, at_once_each=0, behind=0.0)
    tamper, words = TAMPERINGS[what]
    own = checked(tamper(front), STRUT, RODS_TABLE, time.monotonic() + PATIENCE, levels)
    assert any(words in sentence for sentence in own.findings)
    right = checked(front, STRUT, RODS_TABLE, time.monotonic() + PATIENCE, levels)
    assert (right.findings, right.open, right.proven) == ([], [], front.certificate.gap)


def test_the_gap_that_can_be_proven_is_told(front):
    listed = shifted(front)
    verification = certified(listed, gap=1e-6).verify(STRUT, RODS_TABLE)
    assert not verification.holds
    assert verification.claimed_gap == 1e-6
    assert 1e-6 < verification.proven_gap <= 0.5
    claim = "the claim that no design improves a listed one by more than 0.0001 %"
    assert any(claim in sentence for sentence in (*verification.findings, *verification.open))
    assert "what could be proven is a gap of" in verification.sentence()
    # What is told as provable is.
    again = certified(listed, gap=verification.proven_gap).verify(STRUT, RODS_TABLE)
    assert again.proven_gap == verification.proven_gap


def test_a_proof_without_time_is_not_taken_for_one(front):
    verification = front.verify(STRUT, RODS_TABLE, time_limit=1e-9)
    assert (verification.verdict, verification.holds) == (Verdict.NOT_PROVEN, False)
    assert verification.findings == ()
    assert "could not be proven again with 0 boxes" in verification.open[-1]
    assert "5 of 5 designs stay open" in verification.open[-1]
    assert verification.proven_gap is None
    assert verification.sentence().startswith("not proven again: 5 designs are as saved, nothing refutes the claim")


def test_one_finding_refutes_whatever_stays_open(front):
    verification = changed(front, 0, rank=2).verify(STRUT, RODS_TABLE, time_limit=1e-9)
    assert verification.verdict is Verdict.REFUTED
    assert verification.open
    assert verification.sentence().startswith("does not hold: 1 finding ")


# -- files -------------------------------------------------------------------------------------------


def copied(saved, folder):
    for path in saved.iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    return folder


def test_a_changed_front_json_is_named(saved, tmp_path):
    copied(saved, tmp_path)
    content = json.loads((tmp_path / "front.json").read_text(encoding="utf-8"))
    assert content["digest"] == ParetoFront.digest_of({k: v for k, v in content.items() if k != "digest"})
    content["statistics"]["combinations"] = 1
    (tmp_path / "front.json").write_text(json.dumps(content), encoding="utf-8")
    told = "front.json was changed after it was saved: its checksum does not fit"
    assert findings(unchecked_front(tmp_path)) == (told,)
    with pytest.raises(synth.InputError, match=told):
        load_front(tmp_path)
    del content["digest"]
    (tmp_path / "front.json").write_text(json.dumps(content), encoding="utf-8")
    assert findings(unchecked_front(tmp_path)) == ("front.json has no checksum; it was not written by this version",)
    with pytest.raises(synth.InputError, match="no checksum"):
        load_front(tmp_path)


def test_layout_and_order_of_front_json_do_not_matter(saved, tmp_path):
    copied(saved, tmp_path)
    content = json.loads((tmp_path / "front.json").read_text(encoding="utf-8"))
    (tmp_path / "front.json").write_text(json.dumps(dict(reversed(content.items()))), encoding="utf-8")
    assert findings(load_front(tmp_path)) == ()


def test_other_files_must_say_the_same(saved, tmp_path):
    copied(saved, tmp_path)
    table = (tmp_path / "designs.csv").read_text(encoding="utf-8")
    (tmp_path / "designs.csv").write_text(table.replace("knee", "best"), encoding="utf-8")
    (tmp_path / "design_01.yaml").unlink()
    (tmp_path / "design_02.yaml").write_bytes(b"\xff")
    assert findings(load_front(tmp_path)) == (
        "designs.csv says something else than front.json",
        "design_01.yaml is missing",
        "design_02.yaml is not the text that was saved",
    )


def test_a_front_that_lacks_something_is_refused(saved, tmp_path):
    content = json.loads((saved / "front.json").read_text(encoding="utf-8"))
    del content["certificate"]
    (tmp_path / "front.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(synth.InputError, match=r"front\.json: .*required field `certificate`.* that is complete"):
        unchecked_front(tmp_path)


ONLY_BY_CHECKSUM = {"digest", "title", "versions", "statistics", "explanation", "options"}


@pytest.mark.slow
def test_nonsense_is_found_or_refused_but_never_a_fault_of_the_program(saved, tmp_path):
    content = json.loads((saved / "front.json").read_text(encoding="utf-8"))
    for key in content.keys() - ONLY_BY_CHECKSUM:
        for nonsense in (7, "x", None, [1]):
            changed_content = {**content, key: nonsense}
            changed_content["digest"] = ParetoFront.digest_of(
                {k: v for k, v in changed_content.items() if k != "digest"}
            )
            (tmp_path / "front.json").write_text(json.dumps(changed_content), encoding="utf-8")
            try:
                loaded = load_front(tmp_path)
            except synth.InputError:
                continue
            if nonsense is not None or key not in ("complete", "interrupted"):  # nothing counts as no
                assert findings(loaded), (key, nonsense)


def places(content, above=()):
    """Yield the keys that lead to everything in a record; of what is alike (entries, rows, texts) to few."""
    keys = list(content) if isinstance(content, dict) else list(range(min(1, len(content))))
    if above == ("parts",):
        keys = list({content[key]["table"]: key for key in keys}.values())  # one row of each table
    elif len(above) == 1 and all(isinstance(content[key], str) for key in keys):
        keys = keys[:2]
    for key in keys:
        yield (*above, key)
        if isinstance(content[key], (dict, list)):
            yield from places(content[key], (*above, key))


EVERYWHERE = ("x",)
IN_TURNS = (
    None,
    -7,
    [1],
    {"a": [None]},
    1e30,
    True,
    "\ud800",
    0,
    {},
    10**400,
)  # inside of a record each at some places, and every place has one


@pytest.mark.slow
@pytest.mark.parametrize("nonsense", [*EVERYWHERE, *IN_TURNS], ids=repr)
def test_nonsense_anywhere_is_told_and_never_a_fault_of_the_program(nonsense, saved, tmp_path):
    original = json.loads((saved / "front.json").read_text(encoding="utf-8"))
    del original["digest"]
    offset = next((k for k, x in enumerate(IN_TURNS) if x is nonsense), None)
    for number, (*above, last) in enumerate(places(original)):
        if above and offset is not None and (number + offset) % repetitions(len(IN_TURNS), 2):
            continue
        content = copy.deepcopy(original)
        place = content
        for key in above:
            place = place[key]
        place[last] = nonsense
        content["digest"] = ParetoFront.digest_of(content)
        (tmp_path / "front.json").write_text(json.dumps(content), encoding="utf-8")
        with contextlib.suppress(synth.InputError):
            told = load_front(tmp_path).verify(STRUT, RODS_TABLE, time_limit=1e-9)
            assert told.sentence()


def test_what_contradicts_itself_is_said_in_one_sentence(saved, tmp_path):
    content = json.loads((saved / "front.json").read_text(encoding="utf-8"))
    del content["digest"], content["designs"][1]["values"]["length"]
    content["digest"] = ParetoFront.digest_of(content)
    (tmp_path / "front.json").write_text(json.dumps(content), encoding="utf-8")
    told = load_front(tmp_path).verify(STRUT, RODS_TABLE)
    assert told.findings == ("front.json contradicts itself (design 2: length has no value)",)
    assert told.verdict is Verdict.REFUTED


@pytest.mark.slow
@pytest.mark.parametrize(
    "place", ["_evaluator", "ProofLimits.agree", "uncovered", "ProofTree.growth", "ranking_faults"]
)
@pytest.mark.parametrize("fault", [KeyError, TypeError, ValueError, AttributeError, IndexError])
def test_a_fault_of_the_check_is_not_taken_for_one_of_the_front(place, fault, saved, monkeypatch):
    def broken(*arguments):
        raise fault("broken")

    monkeypatch.setattr(f"synth.verification.verify.{place}", broken)
    loaded = dataclasses.replace(load_front(saved), complete=True)  # so that all parts of the check are reached
    with pytest.raises(fault, match="broken"):
        loaded.verify(STRUT, RODS_TABLE)


def test_a_problem_of_your_own_has_to_be_handed_over(saved):
    with pytest.raises(synth.InputError, match="strut"):
        load_front(saved).verify()


def test_a_changed_catalogue_is_named(front):
    other = RODS.assign(**{"density [kg/m3]": RODS["density [kg/m3]"] * 1.01})
    found = front.verify(STRUT, {"rods": other}).findings
    assert any("is not the row of table rods in force" in sentence for sentence in found)


# -- what a front leaves uncovered -------------------------------------------------------------------


@pytest.mark.parametrize("objectives", [1, 2, 3, 4])
def test_uncovered_regions_are_all_that_no_point_covers(objectives):
    rng = np.random.default_rng(objectives)
    for _ in range(10):
        points = np.round(rng.random((6, objectives)), 1)
        ends = uncovered(points)
        probes = rng.random((400, objectives))
        covered = np.any(np.all(points[:, None] <= probes, axis=2), axis=0)
        inside = np.any(np.all(probes < ends[:, None], axis=2), axis=0)
        assert np.array_equal(inside, ~covered)
        below = np.all(ends[:, None] <= ends[None], axis=2)
        assert below.sum() == len(ends)  # no region lies in another
