"""The parts of the benchmarks; each case runs in a process of its own."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks import hypervolume
from tests.benchmarks.child import MARK
from tests.benchmarks.tables import Report

ROOT = Path(__file__).parents[2]
SCALE_SIZES = ("6k", "110k", "1M", "1G")
TWO = ["mass", "actuation_force"]
FRONT_GAP, SINGLE_GAP = 5e-3, 1e-3
COVERED_3 = 5  # three objectives need many times the points of two; more than 500 are not answered
USER_POINTS = 30
CHECKPOINTS = (1.0, 2.0, 5.0, 10.0, 20.0, 35.0)
PEERS = ("pymoo NSGA-II", "pymoo NSGA-III", "Optuna NSGA-II", "Optuna TPE")
SAMPLE = 100
ROWS = 300
ENUMERATED = ("6k", "110k")  # the stored reference is all there is; others are joined with what is found
GRACE = 180.0  # seconds a process may take beyond its searches before it is ended


@dataclass(frozen=True)
class Settings:
    """What the command line asked for."""

    repeat: int
    seeds: int
    time_limit: float
    quick: bool
    points: int
    sizes: tuple[str, ...]


def run(case: Mapping[str, Any], most: float) -> dict[str, Any]:
    """Run a case in a process of its own; what goes wrong is in ``error``."""
    label = " ".join(str(case[k]) for k in ("kind", "peer", "size", "objectives", "gap") if k in case)
    print(f"... {label} grid={case.get('grid')}", file=sys.stderr, flush=True)
    command = [sys.executable, "-m", "tests.benchmarks.child", json.dumps(case)]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=most, check=False)
    except subprocess.TimeoutExpired:
        return {"error": f"ended after {most:.0f} s"}
    lines = [line for line in done.stdout.splitlines() if line.startswith(MARK)]
    if not lines:
        return {"error": (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]}
    result: dict[str, Any] = json.loads(lines[-1].removeprefix(MARK))
    return result


def search_case(
    settings: Settings, size: str, objectives: Sequence[str], grid: bool, gap: float, points: int, **more: Any
) -> dict[str, Any]:
    """Run one search case."""
    case = {
        "kind": "search",
        "size": size,
        "objectives": list(objectives),
        "grid": grid,
        "gap": gap,
        "points": points,
        "repeat": settings.repeat,
        "time_limit": settings.time_limit,
        **more,
    }
    return run(case, case["repeat"] * case["time_limit"] + GRACE)


def _row(result: Mapping[str, Any], size: str, objectives: Sequence[str], grid: bool) -> dict[str, Any]:
    """Return a line of a table of searches."""
    row: dict[str, Any] = {
        "combinations": result.get("combinations", size),
        "grid": grid,
        "objectives": ", ".join(objectives),
    }
    if "error" in result:
        return {**row, "seconds": "stopped", "certificate": result["error"]}
    gap = result["gap"]
    return {
        **row,
        "seconds": result["seconds"],
        "first call +s": result["first_call"],
        "certificate": ("stopped, " if result["stopped"] else "") + result["certificate"],
        "gap %": None if gap is None else 100 * gap,
        "designs": len(result["designs"]),
        "nodes": result["nodes"],
        "NLPs": result["nlp_solves"],
        "MiB": result["memory"] / 2**20,
    }


def scale(settings: Settings) -> list[Report]:
    """Time, work and memory against the number of combinations."""
    sizes = settings.sizes[:1] if settings.quick else settings.sizes
    table, timed = [], dict[tuple[str, bool], list[tuple[float, float]]]()
    for size in sizes:
        results = {}
        for objectives, gap, points in ((TWO, FRONT_GAP, settings.points), (["mass"], SINGLE_GAP, 1)):
            for grid in (False, True):
                result = search_case(settings, size, objectives, grid, gap, points)
                results[len(objectives), grid] = result
                if "error" not in result and not result["stopped"]:
                    key = (", ".join(objectives), grid)
                    timed.setdefault(key, []).append((result["combinations"], result["seconds"]))
        for (m, grid), result in results.items():
            row = _row(result, size, TWO[:m], grid)
            designs = result.get("designs", [])
            if m == len(TWO):
                made = [r["designs"] for (k, g), r in results.items() if k == m and g >= grid and r.get("designs")]
                reference = _reference(size, grid, made)
                row["hypervolume"] = None if reference is None else f"{reference.ratio(designs):.5f}"
            elif designs:
                row["mass kg"] = designs[0][0]
            table.append(row)
    remarks = [
        f"two objectives to a gap of {100 * FRONT_GAP:g} %, the whole front; mass alone to {100 * SINGLE_GAP:g} %",
        "first call: what tracing and compilation add to the first question of a process; not in seconds",
        "MiB: peak over imports, everything included",
        "hypervolume: ratio to the reference front, see docs/benchmarks.md",
    ]
    slopes = [
        {"objectives": name, "grid": grid, "sizes": len(pairs), "slope": _slope(pairs)}
        for (name, grid), pairs in timed.items()
        if len(pairs) > 1
    ]
    reports = [Report("scale", table, remarks)]
    if slopes:
        reports.append(Report("scale: slope of log(seconds) against log(combinations)", slopes))
    return reports


def _slope(pairs: Sequence[tuple[float, float]]) -> float:
    x, y = np.log(np.array(pairs)).T
    return float(np.polyfit(x, y, 1)[0])


def _reference(size: str, grid: bool, fronts: Iterable[Sequence[Sequence[float]]]) -> hypervolume.Reference | None:
    """Return what fronts of a size are measured by; None where no design is known at all."""
    points = hypervolume.stored(size, grid)
    if not len(points) or size not in ENUMERATED:
        points = np.concatenate([points, *(np.array(f) for f in fronts if len(f))])
    return hypervolume.Reference(points) if len(points) else None


def nlp(settings: Settings) -> list[Report]:
    """How many small NLPs are solved per second."""
    from tests.benchmarks import nlp_rate  # brings all of the engine, which only this part needs here

    more = {"count": 2000, "referee": 10, "repeats": 1} if settings.quick else {"repeats": settings.repeat}
    found = nlp_rate.measure(**more)
    ways = {"over arrays": "numpy", "by the kernel": "kernel", "IPOPT one by one": "ipopt"}
    table = [{"solver": label, "NLPs per second and core": found[name]} for label, name in ways.items()]
    return [Report("nlp", table, [f"a feasible optimum found for {100 * found['solved']:.2f} % of the problems"])]


def peers(settings: Settings) -> list[Report]:
    """Hypervolume against time, side by side with other optimisers."""
    size = "6k" if settings.quick else "110k"
    checkpoints = CHECKPOINTS[:2] if settings.quick else CHECKPOINTS
    full = search_case(settings, size, TWO, False, FRONT_GAP, settings.points)
    ours: dict[float, list[list[float]]] = {}
    for checkpoint in checkpoints:
        if "error" not in full and full["seconds"] <= checkpoint:
            ours[checkpoint] = full["designs"]
        else:
            part = search_case(settings, size, TWO, False, FRONT_GAP, settings.points, repeat=1, time_limit=checkpoint)
            ours[checkpoint] = part.get("designs", [])
    fronts: dict[str, list[dict[float, list[list[float]]]]] = {"clutchsynth": [ours]}
    remarks = []
    if "error" not in full and not full["stopped"]:
        proven = "" if full["gap"] is None else f" to {100 * full['gap']:g} %"
        remarks.append(f"clutchsynth ends after {full['seconds']:.3g} s, certificate {full['certificate']}{proven}")
    for name in PEERS:
        if find_spec(name.split()[0].lower()) is None:
            remarks.append(f"{name}: not installed (pip install '.[bench]')")
            continue
        fronts[name] = []
        for seed in range(settings.seeds):
            case = {
                "kind": "peer",
                "peer": name,
                "size": size,
                "grid": False,
                "objectives": TWO,
                "checkpoints": checkpoints,
                "seed": seed,
            }
            result = run(case, checkpoints[-1] + GRACE)
            if "error" in result:
                remarks.append(f"{name}: {result['error']}")
                continue
            fronts[name].append(dict(zip(checkpoints, result["fronts"], strict=True)))
            if seed == 0:
                remarks.append(f"{name}: {shown_rate(result['evaluations'], checkpoints[-1])}")
    reference = _reference(size, False, (f for runs in fronts.values() for r in runs for f in r.values()))
    if reference is None:
        return [Report("peers", [], [*remarks, "nobody found a feasible design"])]
    table = []
    for name, runs in fronts.items():
        row: dict[str, Any] = {"optimiser": name, "runs": len(runs)}
        for c in checkpoints:
            ratios = [reference.ratio(r[c]) for r in runs]
            row[f"{c:g} s"] = f"{statistics.median(ratios):.4f}" if ratios else None
        table.append(row)
    caps = [float(x) for x in (reference.points[:, 1].min(), reference.points[:, 1].max())]
    title = f"peers: hypervolume ratio against time, {full.get('combinations', size)} combinations"
    return [Report(title, table, remarks), _ipopt(settings, caps)]


def shown_rate(evaluations: int, seconds: float) -> str:
    """Return how many designs a peer evaluated."""
    return f"{evaluations} designs evaluated in {seconds:g} s"


def _ipopt(settings: Settings, caps: Sequence[float]) -> Report:
    """One IPOPT problem per combination and point, extrapolated from a sample."""
    table = []
    for size in ("6k",) if settings.quick else ("110k", "1M"):
        case = {
            "kind": "peer",
            "peer": "ipopt",
            "size": size,
            "grid": False,
            "objectives": TWO,
            "sample": 20 if settings.quick else SAMPLE,
            "caps": list(caps),
            "seed": 0,
        }
        result = run(case, GRACE)
        own = search_case(settings, size, TWO, False, FRONT_GAP, USER_POINTS)
        row: dict[str, Any] = {"combinations": own.get("combinations", size), "points": USER_POINTS}
        table.append(row)
        if "error" in result:
            row["note"] = result["error"]
            continue
        row["sample"], row["converged"] = result["sample"], result["solved"]
        row["ms per problem"], row["median ms"] = 1e3 * result["seconds"], 1e3 * result["median"]
        hours = result["combinations"] * USER_POINTS * result["seconds"] / 3600
        row["hours, extrapolated"] = hours
        usable = "error" not in own and not own["stopped"]
        row["clutchsynth s"] = own["seconds"] if usable else "stopped"
        row["times faster"] = 3600 * hours / own["seconds"] if usable else None
    remark = "extrapolated: mean of the sample x combinations x points; the sample is drawn from all combinations"
    return Report("peers: one parametric IPOPT problem per combination and point", table, [remark])


def rows(settings: Settings) -> list[Report]:
    """One best design for each of many requirement rows."""
    size, count = ("6k", 3) if settings.quick else ("240k", ROWS)
    # The limit of a single search, for all rows together: a hundredth of a second per row would be wanted.
    most = max(settings.time_limit, 0.5 * count)
    case = {
        "kind": "rows",
        "size": size,
        "rows": count,
        "objectives": ["mass"],
        "gap": SINGLE_GAP,
        "grid": False,
        "time_limit": most,
    }
    result = run(case, 2 * most + GRACE)
    if "error" in result:
        return [Report("rows", [{"combinations": size, "rows": "stopped", "note": result["error"]}])]
    done = result["rows"]
    table = {
        "combinations": done[0]["combinations"],
        "rows": len(done),
        "asked": count,
        "NLPs, median": _median(done, "nlp_solves"),
        "seconds, median": _median(done, "seconds"),
        "seconds, most": max(r["seconds"] for r in done),
        "nodes, median": _median(done, "nodes"),
        "traced anew": sum(bool(r["rebuilt"]) for r in done),
        "global": sum(r["certificate"] == "global" for r in done),
        "first call s": result["first_call"],
    }
    remarks = [f"mass alone to {100 * SINGLE_GAP:g} % for requirements scattered around the hoist"]
    if len(done) < count:
        remarks.append(f"stopped after {most:g} s")
    return [Report("rows", [table], remarks)]


def _median(found: Sequence[Mapping[str, Any]], name: str) -> float | None:
    values = [r[name] for r in found if r[name] is not None]
    return float(statistics.median(values)) if values else None


def verify(settings: Settings) -> list[Report]:
    """Seconds that ``front.verify()`` needs."""
    size = "6k" if settings.quick else "1M"
    result = search_case(settings, size, TWO, False, FRONT_GAP, settings.points, verify=True)
    row = _row(result, size, TWO, False)
    checked = result.get("verify", {})
    row["verify s"], row["first verify s"] = checked.get("seconds"), checked.get("first")
    row["verify nodes"], row["holds"] = checked.get("nodes"), checked.get("holds")
    return [Report("verify", [row], checked.get("findings", []))]


def objectives(settings: Settings) -> list[Report]:
    """Other objectives, and three at a time."""
    size = "6k" if settings.quick else "110k"
    table = []
    for names, points in (
        (["mass", "friction_work"], settings.points),
        (["mass", "outer_diameter", "actuation_force"], COVERED_3 * settings.points),
    ):
        result = search_case(settings, size, names, False, FRONT_GAP, points)
        table.append(_row(result, size, names, False))
    return [Report("objectives", table, [f"the whole front to a gap of {100 * FRONT_GAP:g} %"])]
