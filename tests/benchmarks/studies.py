"""What a what-if study costs beside one synthesis of its question."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from synth.search.synthesize import synthesize
from synth.studies.whatif.run import whatif
from synth.studies.whatif.study import Study
from tests.benchmarks import cases
from tests.benchmarks.tables import Report

SYNTHESES = 7  # of the question alone, whose median counts; half of them before the study and half after it


@dataclass(frozen=True)
class Varied:
    """A study of 50 steps."""

    name: str
    values: str
    objectives: Sequence[str] = ("mass",)
    points: int = 1
    breaks: bool = False


STUDIES = (
    Varied("load_torque", "400:645:5 N*m"),
    Varied("jerk_limit", "12:24.25:0.25 rad/s3"),
    Varied("outer_diameter_limit", "200:298:2 mm"),
    Varied("load_torque", "400:645:5 N*m", ("actuation_force",)),
    Varied("jerk_limit", "12:24.25:0.25 rad/s3", ("friction_work",)),
    Varied("load_torque", "400:645:5 N*m", breaks=True),
    Varied("load_torque", "400:645:5 N*m", ("mass", "actuation_force"), 3),
    Varied("outer_diameter_limit", "200:298:2 mm", ("mass", "actuation_force"), 3),
    Varied("jerk_limit", "12:24.25:0.25 rad/s3", ("mass", "actuation_force"), 3),
    Varied("load_torque", "400:645:5 N*m", ("mass", "friction_work"), 3),
    Varied("load_torque", "400:645:5 N*m", ("mass", "actuation_force"), 30),
)


def studies(quick: bool) -> list[Report]:
    """Measure studies of 50 steps and one synthesis each, side by side."""
    size = cases.SIZES["6k" if quick else "110k"]
    return [
        Report(
            f"studies: {size.name}, least objective or fronts, to 0.1 %",
            [measure(size, varied) for varied in (STUDIES[:1] if quick else STUDIES)],
            ["processor seconds of one thread; one synthesis: median of the question that is varied, warm"],
        )
    ]


def measure(size: cases.Size, varied: Varied) -> dict[str, Any]:
    """Return how long a study takes, and its question alone."""
    problem, asked = cases.problem(), cases.question(size)
    chosen = list(varied.objectives)

    def one() -> None:
        synthesize(problem, cases.HOIST, chosen, varied.points, **asked)

    def study(values: str, breaks: bool) -> Study:
        return whatif(problem, cases.HOIST, {varied.name: values}, chosen, varied.points, breaks=breaks, **asked)

    one()
    first, unit = varied.values.split(":")[0], varied.values.split(" ", 1)[1]
    study(f"{first}:{float(first) * 1.001:g}:{float(first) * 0.001:g} {unit}", False)  # pays for compilation
    alone = [_seconds(one) for _ in range(SYNTHESES // 2)]
    found: list[Study] = []
    whole = _seconds(lambda: found.append(study(varied.values, varied.breaks)))
    alone += [_seconds(one) for _ in range(SYNTHESES - len(alone))]
    fronts = found[0].fronts
    return {
        "varied": varied.name,
        "objectives": ", ".join(chosen),
        "steps": len(found[0].steps),
        "breaks": len(found[0].breaks) if varied.breaks else "not sought",
        "one synthesis s": statistics.median(alone),
        "study s": whole,
        "times one": whole / statistics.median(alone),
        "global": sum(f.certificate.kind == "global" for f in fronts),
        "together": sum("searched_together" in f.statistics for f in fronts),
    }


def _seconds(work: Callable[[], object]) -> float:
    begin = time.process_time()
    work()
    return time.process_time() - begin
