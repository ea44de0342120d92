"""How often claims of random problems are wrong, and how often fronts are proven: a table.

``python -m tests.certificates [STRUCTURE ...] [--seeds 0:40] [--verify]``; what is wrong is printed with structure and
seed, and then the exit code is 1.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter

from tests.certificates.claims import Answer, faults, run
from tests.certificates.kinks import KINKS
from tests.certificates.reference import Reference
from tests.certificates.signs import SIGNS
from tests.certificates.structures import STRUCTURES, make
from tests.certificates.sums import SUMS

VERIFYING = 20.0  # seconds
OPEN_BY_DESIGN = ("hard",)  # a structure that no search proves


def tried(structure: str, seeds: range, verify: bool) -> Counter[str]:
    """Return how many cases were tried, claimed wrongly, proven, and not proven again by ``verify``."""
    count: Counter[str] = Counter()
    for seed in seeds:
        try:
            case = make(structure, seed)
        except ValueError:
            continue  # a formula does not exist at the design that limits are drawn for
        a = Answer(case, run(case), Reference(case))
        wrong = faults(a)
        count["tried"] += 1
        count["wrong"] += bool(wrong)
        count["proven"] += a.proven
        for sentence in wrong:
            print(f"{structure}-{seed} ({a.front.certificate.kind}): {sentence}")
        if verify and a.proven:
            again = a.front.verify(time_limit=VERIFYING)
            count["verified"] += again.holds
            for finding in again.findings:
                print(f"{structure}-{seed} (verify): {finding}")
    return count


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.certificates", description=__doc__)
    every = [s for s in dict.fromkeys([*STRUCTURES, *SIGNS, *KINKS, *SUMS]) if s not in OPEN_BY_DESIGN]
    parser.add_argument("structures", nargs="*", default=every, metavar="STRUCTURE", help=", ".join(every))
    parser.add_argument("--seeds", default="0:40", help="first and one past the last (0:40)")
    parser.add_argument("--verify", action="store_true", help="prove each front again")
    given = parser.parse_args()
    seeds = range(*(int(x) for x in given.seeds.split(":")))
    print("| class | tried | wrong claims | proven |" + (" proven again |" if given.verify else ""))
    print("|---|---|---|---|" + ("---|" if given.verify else ""))
    total: Counter[str] = Counter()
    for structure in given.structures:
        count = tried(structure, seeds, given.verify)
        total += count
        print(_line(structure, count, given.verify), flush=True)
    print(_line("all", total, given.verify))
    return int(total["wrong"] > 0)


def _line(name: str, count: Counter[str], verify: bool) -> str:
    share = f"{100 * count['proven'] / max(count['tried'], 1):.0f} %"
    again = f" {count['verified']} of {count['proven']} |" if verify else ""
    return f"| `{name}` | {count['tried']} | {count['wrong']} | {share} |{again}"


if __name__ == "__main__":
    sys.exit(main())
