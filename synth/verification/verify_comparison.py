"""Independent check of a saved comparison: the own front of every family, the designs listed, and the claim over all.

As for a single front no proof is shared with the search: each family proves by the tree of ``synth.proof.tree`` that it
has no design that improves one of those listed, whichever family they are of. The designs listed are evaluated from
their files as ``check`` does. What ``synth.verification.verify`` shares with the search is shared here too.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from synth.analysis.evaluate import evaluate
from synth.errors import InputError
from synth.folders.files import read_json
from synth.folders.output_folder import settle
from synth.model.registry import load
from synth.proof.settings import PROOF
from synth.question.arguments import UserTables
from synth.question.spec import read_spec
from synth.results import ParetoFront
from synth.results.loading import COMPARISON, unchecked_front
from synth.results.verification import Verification
from synth.robust.counterpart import robust_counterpart
from synth.verification.verify import checked


@dataclass(frozen=True)
class _Listed:
    """A design that a comparison lists, as its record tells it."""

    rank: int
    objectives: Mapping[str, float]


@dataclass(frozen=True)
class _ComparisonRecord:
    """What a comparison claims, read from its record.

    ``folders``: that of each family with a front, by label; ``senses`` of the objectives.
    """

    folders: Mapping[str, str]
    senses: Mapping[str, str]
    designs: Sequence[_Listed]
    kind: str
    gap: float | None
    resolution: Mapping[str, float]


def _read_record(content: Mapping[str, Any]) -> _ComparisonRecord:
    """Read the record of a comparison.

    Raises
    ------
    KeyError, TypeError, ValueError, AttributeError
        When it is none.
    """
    certificate, senses = content["certificate"], {str(n): str(s) for n, s in content["objectives"].items()}
    return _ComparisonRecord(
        folders={str(x["family"]): str(x["folder"]) for x in content["families"] if x["folder"] is not None},
        senses=senses,
        designs=[_Listed(int(x["rank"]), {n: float(x["objectives"][n]) for n in senses}) for x in content["designs"]],
        kind=str(certificate["kind"]),
        gap=None if certificate["gap"] is None else float(certificate["gap"]),
        resolution={str(n): float(x) for n, x in certificate.get("resolution", {}).items()},
    )


def is_comparison(folder: str | Path) -> bool:
    """True if a folder holds a comparison of families."""
    return (Path(folder) / COMPARISON).is_file()


def verify_comparison(folder: str | Path, time_limit: float = 120.0, catalogs: UserTables = None) -> Verification:
    """Check a saved comparison without help of the search that made it.

    Parameters
    ----------
    folder : path
        What ``Comparison.save`` has written.
    time_limit : float
        Seconds for each family.
    catalogs : folder or mapping, optional
        Own tables that were in memory; those that were files are read again.

    Returns
    -------
    Verification

    Raises
    ------
    InputError
        When there is no comparison, or a family cannot be had.
    """
    started = time.monotonic()
    path = Path(folder)
    settle(path)
    content = read_json(path / COMPARISON, "comparison", "a folder that run has written for several families")
    try:
        record = _read_record(content)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            "comparison", str(path), f"a folder that run has written for several families ({error})"
        ) from error
    findings: list[str] = []
    unproven: list[str] = []
    nodes = 0
    values = _values(path, record, findings, catalogs)
    for label, name in record.folders.items():
        front = unchecked_front(path / name)
        check = checked(front, None, catalogs, time.monotonic() + time_limit)
        alike = check.readable and dict(front.frame.objectives) == dict(record.senses)
        if alike:
            _among(front, label, record.designs, findings)
        elif check.readable:
            findings.append(f"{label}: its objectives are not those of the comparison")
        provable = alike and record.kind == "global" and bool(values) and not check.findings
        if provable and record.gap is not None and front.certificate.kind == "global" and front.designs:
            check.deadline = time.monotonic() + time_limit
            check.against(values, record.gap, record.resolution)
        elif record.kind == "global" and front.certificate.kind != "global":
            findings.append(f"{label}: its own front is not proven, so that nothing over all families can be")
        findings += [f"{label}: {finding}" for finding in check.findings]
        unproven += [f"{label}: {claim}" for claim in check.open]
        nodes += check.nodes
    return Verification(
        findings=tuple(findings),
        open=tuple(unproven),
        certificate=record.kind,
        designs=len(record.designs),
        claimed_gap=record.gap,
        proven_gap=record.gap if record.kind == "global" and not findings and not unproven else None,
        nodes=nodes,
        seconds=time.monotonic() - started,
    )


def _values(path: Path, record: _ComparisonRecord, findings: list[str], catalogs: UserTables) -> dict[str, np.ndarray]:
    """Objectives of the listed designs, evaluated again from their files."""
    rows: dict[str, list[float]] = {name: [] for name in record.senses}
    width = max(2, len(str(len(record.designs))))
    for listed in record.designs:
        label = f"design {listed.rank}"
        try:
            spec = read_spec(path / f"design_{listed.rank:0{width}d}.yaml")
            problem = robust_counterpart(load(spec.family, **spec.options), spec.robust or None, spec.limits)
            content = {"values": spec.values, "parts": spec.parts}
            tables = spec.catalogs if catalogs is None else catalogs
            design = evaluate(
                problem, spec.requirements, content, catalogs=tables, limits=spec.limits, objectives=record.senses
            )
        except InputError as error:
            findings.append(f"{label}: its file cannot be evaluated ({error})")
            continue
        if design.violated:
            findings.append(f"{label}: {', '.join(design.violated)} do not hold")
        for name, column in rows.items():
            value = float(design.values[name])
            column.append(value)
            if abs(value - listed.objectives[name]) > PROOF.same * abs(value):
                findings.append(f"{label}: {name} is {listed.objectives[name]}, evaluated it is {value}")
    return {name: np.array(column) for name, column in rows.items()} if all(rows.values()) else {}


def _among(front: ParetoFront, label: str, designs: Sequence[_Listed], findings: list[str]) -> None:
    """Note listed designs that a design of a family's own front dominates."""
    objectives = front.frame.objectives
    for listed in designs:
        reference = np.array([listed.objectives[n] * (1 if s == "min" else -1) for n, s in objectives.items()])
        for design in front.designs:
            mine = np.array([design.objectives[n] * (1 if s == "min" else -1) for n, s in objectives.items()])
            tolerance = PROOF.same * np.abs(reference)
            if np.all(mine <= reference + tolerance) and np.any(mine < reference - tolerance):
                findings.append(f"{label}: its design {design.rank} beats design {listed.rank} of the comparison")
