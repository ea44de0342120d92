"""The content of a study.json: what was varied, the whole front of every step, and the breaks between them."""

from __future__ import annotations

from typing import Any

from synth.results.front import front_record
from synth.results.plain import finite
from synth.studies.study_store import STUDY_FORMAT
from synth.studies.whatif.study import Study
from synth.studies.whatif.study_answers import Break, Composition, StudyStep
from synth.studies.whatif.vary import Value, Varied


def study_record(study: Study) -> dict[str, Any]:
    """Return a study as JSON holds it; ``synth.results.loading.front_of_record`` reads the fronts.

    Values are in the unit of what is varied; ``stated`` has them as a spec takes them.
    """
    fronts = study.fronts
    return {
        "format": STUDY_FORMAT,
        "family": fronts[0].frame.family if fronts else None,
        "objectives": dict(fronts[0].frame.objectives) if fronts else {},
        "units": study.objectives(),
        "varied": [_varied(x) for x in study.varied],
        "along": study.along,
        "steps": [_step(study, step) for step in study.steps],
        "breaks": [_break(x) for x in study.breaks],
        "interrupted": study.interrupted,
        "statistics": dict(study.statistics),
    }


def _varied(x: Varied) -> dict[str, Any]:
    return {
        "label": x.label,
        "kind": x.kind,
        "name": x.name,
        "sign": x.sign,
        "unit": x.unit,
        "values": [_value(value) for value in x.values],
        "remark": x.remark,
    }


def _value(value: Value) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _step(study: Study, step: StudyStep) -> dict[str, Any]:
    return {
        "number": step.number,
        "values": [_value(value) for value in step.values],
        "stated": [x.spec_value(value) for x, value in zip(study.varied, step.values, strict=True)],
        "status": step.status.value,
        "reason": step.reason,
        "front": None if step.front is None else front_record(step.front),
    }


def _break(x: Break) -> dict[str, Any]:
    return {
        "objective": x.objective,
        "others": [_value(value) for value in x.others],
        "low": x.low,
        "high": x.high,
        "value": x.value,
        "kind": x.kind,
        "change": x.change,
        "before": _composition(x.before),
        "after": _composition(x.after),
        "proven": x.proven,
        "remark": x.remark,
    }


def _composition(composition: Composition | None) -> dict[str, Any] | None:
    if composition is None:
        return None
    return {
        "parts": dict(composition.parts),
        "counts": {name: float(value) for name, value in composition.counts.items()},
        "choices": dict(composition.choices),
        "value": finite(float(composition.value)),
    }
