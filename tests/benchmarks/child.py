"""One benchmark case in a process of its own: reads the case as JSON, prints the result as JSON.

Nothing heavy is imported at the top, so that imports can be timed and memory be counted over them.
"""

from __future__ import annotations

import json
import resource
import statistics
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

MARK = "benchmark result: "
ADDRESS_SPACE = 12 << 30  # a case that runs away must not take the machine with it
TINY_TIME_LIMIT = 60.0
WORKERS = 2


def peak_bytes() -> int:
    """Return the largest resident size of this process so far."""
    status = Path("/proc/self/status")
    if status.exists():
        # Not ru_maxrss: Linux hands it on from the process that started this one.
        line = next(x for x in status.read_text(encoding="ascii").splitlines() if x.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return used if sys.platform == "darwin" else used * 1024


def import_all() -> None:
    """Import what any search imports, also what it imports late."""
    late = (
        "casadi",
        "moocore",
        "pandas",
        "scipy.optimize",
        "scipy.special",
        "synth.search.front_search",
        "tests.benchmarks.cases",
    )
    for name in late:
        import_module(name)


def _timed(work: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    result = work()
    return result, time.perf_counter() - begin


def _summary(front: Any, objectives: list[str]) -> dict[str, Any]:
    certificate, figures = front.certificate, front.statistics
    return {
        "combinations": int(certificate.combinations),
        "status": front.status.value,
        "stopped": front.interrupted,
        "certificate": certificate.kind,
        "gap": certificate.gap,
        "nodes": figures.get("nodes", figures.get("boxes")),
        "nlp_solves": figures.get("nlp_solves"),
        "designs": [[float(d.values[name]) for name in objectives] for d in front.designs],
    }


def search(case: Mapping[str, Any]) -> dict[str, Any]:
    """Ask one question ``repeat`` times, after a tiny one that pays for tracing and compilation."""
    _, imports = _timed(import_all)
    after_imports = peak_bytes()
    import synth
    from tests.benchmarks import cases

    size = cases.SIZES[case["size"]]
    question, tables = _timed(lambda: cases.question(size))
    common = {"objectives": case["objectives"], "grid": case["grid"], "catalogs": question["catalogs"]}

    def ask(**more: Any) -> Any:
        return synth.synthesize(cases.problem(), cases.HOIST, **common, workers=WORKERS, **more)

    def tiny() -> Any:
        return ask(**cases.TINY, points=2, gap=0.05, time_limit=TINY_TIME_LIMIT)

    _, cold = _timed(tiny)
    _, warm = _timed(tiny)
    seconds: list[float] = []
    front = None
    for _ in range(case["repeat"]):
        front, took = _timed(
            lambda: ask(parts=question["parts"], points=case["points"], gap=case["gap"], time_limit=case["time_limit"])
        )
        seconds.append(took)
        if front.interrupted:
            break
    assert front is not None
    result = {
        **_summary(front, case["objectives"]),
        "seconds": statistics.median(seconds),
        "all_seconds": seconds,
        "first_call": max(cold - warm, 0.0),
        "imports": imports,
        "tables": tables,
        "memory": peak_bytes() - after_imports,
    }
    if case.get("verify"):
        result["verify"] = _verify(front, case["repeat"])
    return result


def _verify(front: Any, repeat: int) -> dict[str, Any]:
    _, first = _timed(front.verify)
    timed = [_timed(front.verify) for _ in range(repeat)]
    answer = timed[0][0]
    return {
        "seconds": statistics.median(took for _, took in timed),
        "first": first,
        "nodes": answer.nodes,
        "holds": answer.holds,
        "findings": list(answer.findings),
    }


def rows(case: Mapping[str, Any]) -> dict[str, Any]:
    """Ask for the best design of many requirement rows, one after the other."""
    import_all()
    import synth
    from tests.benchmarks import cases

    question = cases.question(cases.SIZES[case["size"]])

    def ask(row: Mapping[str, Any], **more: Any) -> Any:
        settings = {"objectives": case["objectives"], "points": 1, "gap": case["gap"], "grid": case["grid"]}
        return synth.synthesize(cases.problem(), row, catalogs=question["catalogs"], **settings, **more)

    _, first = _timed(lambda: ask(cases.HOIST, **cases.TINY, time_limit=TINY_TIME_LIMIT))
    begin = time.perf_counter()
    found = []
    for row in cases.requirement_rows(case["rows"]):
        if time.perf_counter() - begin > case["time_limit"]:
            break
        traces = cases.problem().traces
        begun = time.perf_counter()
        front = ask(row, parts=question["parts"], time_limit=case["time_limit"])
        took = time.perf_counter() - begun
        figures = front.statistics
        found.append(
            {
                "seconds": took,
                "nlp_solves": figures.get("nlp_solves"),
                "nodes": figures.get("nodes", figures.get("boxes")),
                "rebuilt": cases.problem().traces > traces,
                "certificate": front.certificate.kind,
                "combinations": int(front.certificate.combinations),
            }
        )
    return {"rows": found, "first_call": first}


def peer(case: Mapping[str, Any]) -> dict[str, Any]:
    """Run another optimiser on the vectorised model."""
    import_all()
    from tests.benchmarks import peers

    return peers.run(case)


KINDS: dict[str, Callable[[Mapping[str, Any]], dict[str, Any]]] = {"search": search, "rows": rows, "peer": peer}


def main() -> None:
    """Run the case given as the first argument."""
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, resource.RLIM_INFINITY))
    case = json.loads(sys.argv[1])
    try:
        result = KINDS[case["kind"]](case)
    except Exception as error:
        traceback.print_exc()
        result = {"error": f"{type(error).__name__}: {error}"[:300]}
    sys.stdout.write("\n" + MARK + json.dumps(result) + "\n")


if __name__ == "__main__":
    main()
