"""Kills batches at random moments: a process that has everything imported, and forks a batch for each kill.

    python -m tests.batches.stages FOLDER DATABASE KILLS SEED

Prints how far the batch was at each kill. Forking is safe here: nothing has started a thread yet.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from pathlib import Path

import synth
from tests.sample_problems.rod import Rod


def rows() -> list[dict[str, object]]:
    """Return rows of two structures, one of them bad, two of them the same."""
    table: list[dict[str, object]] = [
        {
            "id": f"R{k}",
            "force [kN]": 10 + k % 13,
            "parts": "steel = S185, 42CrMo4",
            "length [mm]": 100,
            "diameter_limit [mm]": 30 if k % 2 else "",
        }
        for k in range(14)
    ]
    return [*table, {"id": "bad", "force [kN]": "much", "parts": "", "length [mm]": "", "diameter_limit [mm]": ""}]


def run(folder: str, database: str) -> None:
    """Do the batch."""
    synth.batch(Rod, rows(), folder, objectives=["mass"], points=1, database=database or None)


def main() -> None:
    """Start, kill, start again, and let the last one finish."""
    folder, database, kills, seed = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    chance = random.Random(seed)
    run(str(Path(folder) / "first"), "")  # whole, for comparison, and to have everything imported
    for _ in range(kills):
        process = os.fork()
        if process == 0:
            run(str(Path(folder) / "killed"), database)
            os._exit(0)
        time.sleep(chance.uniform(0.0, 0.5))
        os.kill(process, signal.SIGKILL)
        _, status = os.waitpid(process, 0)
        print("killed" if os.WIFSIGNALED(status) else f"ended {os.waitstatus_to_exitcode(status)}", flush=True)
    run(str(Path(folder) / "killed"), database)


if __name__ == "__main__":
    main()
