"""Run the benchmarks: ``python -m tests.benchmarks --help``."""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from synth.kernels.loading import native_code
from tests.benchmarks import batch, parts, practice, sent_back, service, studies
from tests.benchmarks.families import families
from tests.benchmarks.tables import Report, write_csv

PARTS: dict[str, Callable[[parts.Settings], list[Report]]] = {
    "scale": parts.scale,
    "nlp": parts.nlp,
    "peers": parts.peers,
    "rows": parts.rows,
    "verify": parts.verify,
    "objectives": parts.objectives,
    "families": lambda settings: families(settings.repeat, settings.time_limit, settings.quick),
    "studies": lambda settings: studies.studies(settings.quick),
    "batch": lambda settings: batch.batches(settings.quick),
    "ranges": lambda settings: batch.ranges(settings.quick),
    "practice": lambda settings: practice.practice(settings.time_limit, settings.quick),
    "sent-back": lambda settings: sent_back.sent_back(settings.time_limit, settings.quick),
    "service": lambda settings: service.service(settings.quick),
}


def machine() -> str:
    """Return on what the figures were measured."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [x.split(":", 1)[1].strip() for x in cpuinfo.read_text().splitlines() if x.startswith("model name")]
        model = names[0] if names else model
    shown = []
    for name in ("clutchsynth", "numpy", "casadi", "pymoo", "optuna"):
        try:
            shown.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            shown.append(f"{name} not installed")
    return (
        f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, "
        f"kernels {native_code()}\n{', '.join(shown)}"
    )


def main() -> None:
    """Parse the command line, run the parts, print their tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description="Benchmarks of the search.")
    parser.add_argument("--only", action="append", choices=list(PARTS), help="run one part; may be given again")
    parser.add_argument("--size", action="append", choices=list(parts.SCALE_SIZES), help="of the part scale only")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs per case; the median counts (3)")
    parser.add_argument("--seeds", type=int, default=3, metavar="N", help="runs per random peer; the median counts (3)")
    parser.add_argument("--time-limit", type=float, default=120.0, metavar="S", help="seconds per search (120)")
    parser.add_argument("--points", type=int, default=100, metavar="N", help="designs of a whole front, at most (100)")
    parser.add_argument("--quick", action="store_true", help="smallest sizes, one run each: does it all work?")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write all figures to this file as well")
    given = parser.parse_args()
    if min(given.repeat, given.seeds, given.points) < 1 or given.time_limit <= 0:
        parser.error("--repeat, --seeds, --points and --time-limit must be positive")
    settings = parts.Settings(
        repeat=1 if given.quick else given.repeat,
        seeds=1 if given.quick else given.seeds,
        time_limit=min(given.time_limit, 20.0) if given.quick else given.time_limit,
        quick=given.quick,
        points=given.points,
        sizes=tuple(given.size or parts.SCALE_SIZES),
    )
    print(machine() + "\n", flush=True)
    reports = []
    for name in PARTS:
        if given.only is None or name in given.only:
            for report in PARTS[name](settings):
                print(report.text(), flush=True)
                reports.append(report)
    if given.csv is not None:
        write_csv(given.csv, reports)
        print(f"written to {given.csv}", file=sys.stderr)


if __name__ == "__main__":
    main()
