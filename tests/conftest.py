"""What all tests need."""

import signal

import pytest


def pytest_configure() -> None:
    """Hear of Ctrl-C: a shell that runs the tests in the background has it ignored, in them and in what they start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run files with slow tests first: a long one at the end would keep one process at work while others wait."""
    long = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in long)
