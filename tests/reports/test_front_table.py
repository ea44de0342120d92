"""The ranked table: what it shows, how wide it is, and why each design is on the front."""

from __future__ import annotations

import io
from dataclasses import replace

import pytest
from rich.console import Console
from synth.reports.reasons import why
from synth.reports.table import print_front

from synth.order.feasibility import Status
from synth.results import Certificate, Design, Frame, ParetoFront

FRAME = Frame(
    family="sample",
    title="Sample",
    options={},
    requirements={},
    requirement_values={},
    not_asked=(),
    objectives={"mass": "min", "actuation_force": "min"},
    units={"ring_outer_diameter": "mm", "friction_surfaces": "-", "mass": "kg", "actuation_force": "N"},
    kinds={
        "ring_outer_diameter": "variable",
        "friction_surfaces": "count",
        "mass": "derived",
        "actuation_force": "derived",
    },
    limit_units={"jerk": "rad/s3", "pinned": "mm"},
    limit_senses={"jerk": "at_most", "pinned": "equal"},
)


def design(rank: int, mass: float, force: float, used: float = 0.5, note: str = "", frame: Frame = FRAME) -> Design:
    objectives = {"mass": mass, "actuation_force": force}
    return Design(
        frame=frame,
        values={"ring_outer_diameter": 0.2581, "friction_surfaces": 10.0, **objectives},
        parts={},
        choices={},
        objectives={name: objectives[name] for name in frame.objectives},
        limits={},
        residuals={},
        utilisation={"jerk": used, "pinned": 1.0},
        status=Status.OPTIMAL,
        rank=rank,
        score=0.1 * rank,
        note=note,
    )


def front(*designs: Design, frame: Frame = FRAME) -> ParetoFront:
    certificate = Certificate("global", 1e-3, 10, 8, 2)
    return ParetoFront(frame, designs, Status.OPTIMAL, True, {}, certificate, None, {})


def test_why_names_best_knee_neighbours_and_binding_limits() -> None:
    light, middle, weak = design(2, 10, 2000), design(1, 12, 1500, 0.9995, "knee"), design(3, 20, 1000)
    shown = front(middle, light, weak)
    assert why(shown, middle) == (
        "nearest to the best, the knee too; between #2 and #3: 25 % less actuation force than #2, "
        "40 % less mass than #3; at the limit of jerk"
    )
    assert why(shown, light) == (
        "smallest mass; 17 % less mass and 33 % more actuation force than #1 next to it; no limit is reached"
    )
    assert why(shown, weak).startswith("smallest actuation force; 67 % more mass and 33 % less actuation force than #1")


def test_others_with_the_same_objectives_are_counted() -> None:
    alone = design(1, 10, 1000)
    one, two = (replace(alone, alternatives=("plate B", "plate C")[:count]) for count in (1, 2))
    assert why(front(one), one).endswith("no limit is reached; 1 other with the same objectives")
    assert why(front(two), two).endswith("no limit is reached; 2 others with the same objectives")


def test_why_with_an_objective_to_be_made_large() -> None:
    frame = replace(FRAME, objectives={"mass": "max", "actuation_force": "min"})
    light, middle, heavy = (design(k, *x, frame=frame) for k, x in enumerate([(10, 1000), (12, 1500), (20, 2000)], 1))
    shown = front(light, middle, heavy, frame=frame)
    # Gained over the lighter one: mass; over the heavier one: force.
    assert "between #1 and #3: 20 % more mass than #1, 25 % less actuation force than #3" in why(shown, middle)
    assert why(shown, heavy).startswith("largest mass;")


def test_why_of_a_single_design_and_of_many_objectives() -> None:
    alone = design(1, 10, 2000)
    assert why(front(alone), alone) == "smallest mass; smallest actuation force; no limit is reached"
    frame = replace(FRAME, objectives={"mass": "min", "actuation_force": "min", "friction_surfaces": "min"})

    def triple(rank: int, mass: float, force: float, surfaces: float) -> Design:
        objectives = {"mass": mass, "actuation_force": force, "friction_surfaces": surfaces}
        return replace(design(rank, mass, force), frame=frame, objectives=objectives)

    one, two, three = triple(1, 10, 2000, 10), triple(2, 11, 1900, 10), triple(3, 30, 900, 4)
    sentence = why(front(one, two, three, frame=frame), two)
    assert "against #1 next to it 10 % more mass, 5 % less actuation force, the same friction surfaces" in sentence


@pytest.mark.parametrize("width", [40, 60, 100])
def test_the_table_fits_the_width_and_loses_nothing(width: int) -> None:
    designs = [design(k, 10 + k, 2000.123456 / k) for k in range(1, 13)]
    stream = io.StringIO()
    print_front(front(*designs), Console(file=stream, width=width, markup=False, highlight=False))
    output = stream.getvalue()
    assert max(len(line) for line in output.splitlines()) <= width
    assert "…" not in output
    for cell in ("258.1", "2000", "[kg]", "[mm]", "#10", "2 more with --all", "no limit"):
        assert cell in output
    assert "#11" not in output.split("#1:")[0]


def test_all_designs_on_request() -> None:
    stream = io.StringIO()
    designs = [design(k, 10 + k, 2000 / k) for k in range(1, 13)]
    print_front(front(*designs), Console(file=stream, width=100, markup=False, highlight=False), every=True)
    assert "#12:" in stream.getvalue()
    assert "--all" not in stream.getvalue()


def test_what_people_decide_by_stands_beside_the_objectives() -> None:
    frame = replace(FRAME, headline=("mass", "friction_surfaces"), sized_by="torque")
    shown = [
        replace(design(k, 10 + k, 2000 / k, used, frame=frame), limits={"torque": (330.0 + k, 300.0)}, advice=(told,))
        for k, used, told in ((1, 1.0, "warm: keep it cool"), (2, 0.5, "cold: no matter"))
    ]
    stream = io.StringIO()
    print_front(front(*shown, frame=frame), Console(file=stream, width=100, markup=False, highlight=False))
    output = stream.getvalue()
    head, first = output.partition("\n")[2].split("#1", 1)
    assert {"torque", "reserve", "[%]"} <= set(head.split())
    assert first.splitlines()[0].split() == ["11", "2000", "10.3", "10", "jerk"]
    # Sizes that no column tells, and remarks, stand with the design that they concern.
    assert "    other sizes: ring outer diameter 258.1 mm\n    remark: keep it cool\n#2: " in output
    assert "no matter" not in output


def test_an_end_that_costs_much_for_little_is_told_to() -> None:
    ends = [design(1, 10, 1000), design(2, 9.99, 3000, note="smallest mass, whose last 0.5 % costs much")]
    assert why(front(*ends), ends[1]).startswith("smallest mass, whose last 0.5 % costs much; 0.1 % less mass")


def test_why_names_designs_that_have_a_line() -> None:
    designs = [design(1, 10, 2000), design(2, 10.1, 1990), design(3, 12, 1500)]
    shown = front(designs[0], replace(designs[1], group=1), designs[2])
    assert "than #3 next to it" in why(shown, shown.designs[0])
    assert "between #1 and #3" in why(shown, shown.designs[1])


def test_near_equals_stand_on_the_line_of_the_one_that_leads_them() -> None:
    designs = [design(k, 10 + k / 100, 2000) for k in range(1, 14)]
    designs = [replace(d, group=None if d.rank in (1, 5) else 1 if (d.rank or 0) < 5 else 5) for d in designs]
    shown: list[str] = []
    for every in (False, True):
        stream = io.StringIO()
        console = Console(file=stream, width=100, markup=False, highlight=False)
        print_front(front(*designs), console, every=every)
        shown.append(stream.getvalue())
    assert "#1: and 3 within 2 %: #2, #3, #4\n" in shown[0]
    assert "#5: and 8 within 2 %: #6," in shown[0]
    assert "11 more with --all" in shown[0]
    assert "#13:" in shown[1]
    assert "within 2 %" not in shown[1]
    assert [d.rank for d in front(*designs).lines] == [1, 5]
    columns, rows = front(*designs).table()
    assert columns[-1] == "group"
    assert [row[-1] for row in rows] == [1] * 4 + [5] * 9
    assert front(*designs[:1], designs[4]).table()[0][-1] != "group"
