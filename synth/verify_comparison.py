"""Independent check of a saved comparison: the own front of every family, the designs listed, and the claim over all.

As for a single front no proof is shared with the search: each family proves by the tree of ``synth.prooftree`` that it
has no design that improves one of those listed, whichever family they are of.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from synth.errors import InputError
from synth.files import read_json
from synth.loading import COMPARISON, unchecked_front
from synth.output_folder import settle
from synth.results import ParetoFront
from synth.spec import read_content
from synth.verification import Verification
from synth.verify import UNREADABLE, checked

SAME = 1e-9


def is_comparison(folder: str | Path) -> bool:
    """Tell whether a folder holds a comparison of families."""
    return (Path(folder) / COMPARISON).is_file()


def verify_comparison(folder: str | Path, time_limit: float = 120.0) -> Verification:
    """Check a saved comparison without help of the search that made it.

    Parameters
    ----------
    folder : path
        What ``Comparison.save`` has written.
    time_limit : float
        Seconds for each family.

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
        families = {x["family"]: x["folder"] for x in content["families"] if x["folder"] is not None}
        listed, certificate = content["designs"], content["certificate"]
        kind, gap = str(certificate["kind"]), certificate["gap"]
    except UNREADABLE as error:
        raise InputError(
            "comparison", str(path), f"a folder that run has written for several families ({error})"
        ) from error
    findings: list[str] = []
    unproven: list[str] = []
    nodes = 0
    values = _values(path, content, findings)
    for label, name in families.items():
        front = unchecked_front(path / name)
        check = checked(front, None, None, time.monotonic() + time_limit)
        _among(front, label, listed, findings)
        provable = kind == "global" and gap is not None and bool(values) and not check.findings
        if provable and front.certificate.kind == "global" and front.designs:
            check.deadline = time.monotonic() + time_limit
            check.against(values, float(gap), certificate.get("resolution", {}))
        elif kind == "global" and front.certificate.kind != "global":
            findings.append(f"{label}: its own front is not proven, so that nothing over all families can be")
        findings += [f"{label}: {finding}" for finding in check.findings]
        unproven += [f"{label}: {claim}" for claim in check.open]
        nodes += check.nodes
    return Verification(
        findings=tuple(findings),
        open=tuple(unproven),
        certificate=kind,
        designs=len(listed),
        claimed_gap=gap,
        proven_gap=gap if kind == "global" and not findings and not unproven else None,
        nodes=nodes,
        seconds=time.monotonic() - started,
    )


def _values(path: Path, content: Mapping[str, Any], findings: list[str]) -> dict[str, np.ndarray]:
    """Return the objectives of the designs listed, evaluated again from their files."""
    from synth.analysis import evaluate
    from synth.posed import posed
    from synth.problem import load

    rows: dict[str, list[float]] = {name: [] for name in content["objectives"]}
    width = max(2, len(str(len(content["designs"]))))
    for told in content["designs"]:
        label = f"design {told['rank']}"
        try:
            spec = read_content(path / f"design_{told['rank']:0{width}d}.yaml", "design")
            problem = posed(load(spec["family"], **spec.get("options", {})), spec.get("robust"), spec.get("limits"))
            design = evaluate(
                problem, spec["requirements"], spec, catalogs=spec.get("catalogs"), limits=spec.get("limits"),
                objectives=content["objectives"],
            )  # fmt: skip
        except UNREADABLE as error:
            findings.append(f"{label}: its file cannot be evaluated ({error})")
            continue
        if design.violated:
            findings.append(f"{label}: {', '.join(design.violated)} do not hold")
        for name, own in rows.items():
            value = float(design.values[name])
            own.append(value)
            if abs(value - told["objectives"][name]) > SAME * abs(value):
                findings.append(f"{label}: {name} is {told['objectives'][name]}, evaluated it is {value}")
    return {name: np.array(own) for name, own in rows.items()} if all(rows.values()) else {}


def _among(front: ParetoFront, label: str, listed: list[Any], findings: list[str]) -> None:
    """No design of a family's own front may beat one that is listed."""
    objectives = front.frame.objectives
    for told in listed:
        own = np.array([told["objectives"][n] * (1 if s == "min" else -1) for n, s in objectives.items()])
        for design in front.designs:
            mine = np.array([design.objectives[n] * (1 if s == "min" else -1) for n, s in objectives.items()])
            room = SAME * np.abs(own)
            if np.all(mine <= own + room) and np.any(mine < own - room):
                findings.append(f"{label}: its design {design.rank} beats design {told['rank']} of the comparison")
