"""What all tests need."""

import gc
import os
import signal
from pathlib import Path

import pytest

from tests.repetitions import SWITCH

# Files of more than half a minute of a processor, with what their servers and browsers take, the longest first.
LONGEST = (
    "docs/test_docs.py",
    "service/pages/test_stories.py",
    "certificates/test_global_claims.py",
    "service/pages/test_whatif_pages.py",
    "service/test_threats.py",
    "reports/test_workbook.py",
    "workers/test_worker.py",
    "endtoend/test_installation.py",
    "conformance/test_families.py",
    "search/test_first_by_rank.py",
    "service/api/test_job_routes.py",
)
TESTS = Path(__file__).parent


def pytest_addoption(parser: pytest.Parser) -> None:
    """Offer the many repetitions of random tests."""
    parser.addoption("--thorough", action="store_true", help="repeat random tests many times")


def pytest_configure(config: pytest.Config) -> None:
    """Hear of Ctrl-C, have no terminal's width, and look for no garbage among the tests that are being collected.

    A shell that runs the tests in the background has Ctrl-C ignored, in them and in what they start. Collecting makes
    what lives to the end: looking for garbage in it would be a third of its time.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("COLUMNS", None)  # processes that share tests set it
    if config.getoption("--thorough"):
        os.environ[SWITCH] = "1"  # read while tests are collected
    gc.disable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run long files first, then those with slow tests: one at the end would keep one process at work alone."""
    place = {TESTS / name: k for k, name in enumerate(LONGEST)}
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: place.get(item.path, len(place) + (item.path not in slow)))


def pytest_collection_finish() -> None:
    """Leave what was imported and collected out of the search for garbage, and search more rarely.

    A process that runs tests holds a gigabyte of modules, tests and declared families that live to its end. Each full
    search walks through all of it and finds nothing: a tenth of the processor time of the suite. What tests themselves
    throw away is still found.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 50)
    gc.enable()
