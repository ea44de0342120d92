"""How often random tests are repeated: some times in every run, many times where a run asks for it."""

import os

SWITCH = "CLUTCHSYNTH_TESTS_THOROUGH"


def repetitions(few: int, many: int) -> int:
    """Return how often a random test is repeated: ``many`` times with ``pytest --thorough``, else a ``few``."""
    return many if os.environ.get(SWITCH) else few
