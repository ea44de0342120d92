"""What all tests need."""

import signal


def pytest_configure() -> None:
    """Hear of Ctrl-C: a shell that runs the tests in the background has it ignored, in them and in what they start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
