"""Work of compiled code shared among threads."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from functools import partial

import pytest

from synth.kernels.threads import SideBySide, side_by_side
from synth.system import deadline
from tests.waiting import PATIENCE


@pytest.mark.parametrize("workers", [1, 2, 3, 8])
@pytest.mark.parametrize("count", [0, 1, 2, 50])
def test_what_comes_of_parts_stands_in_their_order(workers: int, count: int) -> None:
    assert side_by_side([partial(pow, k, 2) for k in range(count)], workers) == [k * k for k in range(count)]


def test_parts_run_side_by_side() -> None:
    meeting = threading.Barrier(2, timeout=PATIENCE)
    assert len(side_by_side([meeting.wait, meeting.wait], 2)) == 2  # one alone would wait in vain


@pytest.mark.parametrize("wrong", [0, 1, 7])
def test_an_error_of_a_part_is_raised_once_nothing_is_under_way_any_more(wrong: int) -> None:
    under_way, begun = set[int](), list[int]()

    def part(k: int) -> None:
        begun.append(k)
        under_way.add(k)
        time.sleep(0.01)
        under_way.discard(k)
        if k == wrong:
            raise ValueError(f"part {k}")

    with pytest.raises(ValueError, match=f"part {wrong}"):
        side_by_side([partial(part, k) for k in range(20)], 2)
    assert not under_way
    assert len(begun) < 20


def test_parts_go_on_beside_the_caller_until_it_asks() -> None:
    begun, go_on = threading.Event(), threading.Event()

    def part() -> bool:
        begun.set()
        return go_on.wait(30.0)

    work = SideBySide([part, lambda: True], 2)
    assert begun.wait(30.0)  # nobody has asked yet
    go_on.set()
    assert work.results() == [True, True]


def test_one_thread_alone_begins_when_it_is_asked() -> None:
    begun = list[int]()
    work = SideBySide([partial(begun.append, k) for k in range(3)], 1)
    time.sleep(0.05)
    assert not begun
    work.results()
    assert begun == [0, 1, 2]


def test_what_is_stopped_begins_nothing_more_and_leaves_nothing_under_way() -> None:
    under_way, begun, first = set[int](), list[int](), threading.Event()

    def part(k: int) -> None:
        begun.append(k)
        under_way.add(k)
        first.set()
        time.sleep(0.05)
        under_way.discard(k)

    work = SideBySide([partial(part, k) for k in range(50)], 2)
    assert first.wait(30.0)
    work.stop()
    assert not under_way
    number = len(begun)
    assert 0 < number < 50
    time.sleep(0.1)
    assert len(begun) == number
    work.stop()  # again: nothing happens


def test_what_fails_is_told_to_whoever_asks_and_to_nobody_else() -> None:
    def part() -> None:
        raise ValueError("a part")

    for _ in range(20):  # whoever of the two threads takes the part
        work = SideBySide([part, part, part], 2)
        work.stop()
    with pytest.raises(ValueError, match="a part"):
        SideBySide([part, part, part], 2).results()


def test_several_callers_share_threads_without_waiting_for_each_other_for_ever() -> None:
    def inner(k: int) -> int:
        return sum(side_by_side([partial(pow, k, j) for j in range(4)], 2))

    expected = [sum(k**j for j in range(4)) for k in range(16)]
    assert side_by_side([partial(inner, k) for k in range(16)], 2) == expected
    found: dict[int, int] = {}
    callers = [threading.Thread(target=lambda k=k: found.update({k: inner(k)})) for k in range(16)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join(timeout=PATIENCE)
    assert [found[k] for k in range(16)] == expected


def test_threads_know_of_no_end_of_the_caller() -> None:
    meeting = threading.Barrier(2, timeout=PATIENCE)

    def part() -> float:
        meeting.wait()
        return deadline.current().time - time.monotonic()

    for _ in range(2):  # the second time with threads that are kept
        with deadline.until(time.monotonic() + 1000.0):
            found = sorted(side_by_side([part, part], 2))
        assert found[0] <= 1000.0
        assert found[1] == math.inf


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_process_that_was_forked_has_no_threads_and_does_it_alone() -> None:
    side_by_side([partial(pow, 2, k) for k in range(4)], 2)
    child = os.fork()
    if not child:
        os._exit(0 if side_by_side([partial(pow, 2, k) for k in range(4)], 2) == [1, 2, 4, 8] else 1)
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            assert os.waitstatus_to_exitcode(status) == 0
            return
        time.sleep(0.01)
    os.kill(child, 9)
    pytest.fail(f"a forked process waits for ever ({sys.platform})")
