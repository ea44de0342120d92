"""Ctrl-C is heard whenever it comes, also while CasADi is at work."""

import os
import signal
import threading
from contextlib import suppress

import pytest

import synth
from synth.system.interrupts import heard_again, held_back, sigterm_as_interrupt
from synth.tables.catalogs import Catalogs


def press_ctrl_c() -> None:
    os.kill(os.getpid(), signal.SIGINT)


class Impatient(synth.DesignProblem):
    """Somebody stops it while it is declared."""

    name, title = "impatient", "Impatient"
    sources = ("made up",)
    finished = 0

    def declare(self, d) -> None:
        size = d.variable("size", "mm", 1, 10)
        press_ctrl_c()
        d.objective("size")
        d.derive("area", "mm2", size * size)
        Impatient.finished += 1


class Patient(synth.DesignProblem):
    """Nobody stops it."""

    name, title = "patient", "Patient"
    sources = ("made up",)

    def declare(self, d) -> None:
        d.variable("size", "mm", 1, 10)
        d.objective("size")


def test_what_comes_while_a_problem_is_traced_is_heard_after_it():
    problem = Impatient()
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        problem.model(frozenset(), Catalogs())
    assert Impatient.finished == 1
    assert signal.getsignal(signal.SIGINT) is before


def test_what_comes_while_a_function_is_made_is_heard_after_it():
    heard, model = [], Patient().model(frozenset(), Catalogs())

    def make():
        press_ctrl_c()
        heard.append("made")
        return 1

    with pytest.raises(KeyboardInterrupt):
        model.function("own", make)
    assert heard == ["made"]
    assert model.function("own", make) == 1, "what was made is kept"


def test_an_error_is_not_lost_beside_the_wish_to_stop():
    def fail():
        with held_back():
            press_ctrl_c()
            raise ValueError("wrong")

    with pytest.raises(KeyboardInterrupt) as caught:
        fail()
    assert isinstance(caught.value.__context__, ValueError)


def test_other_threads_and_deaf_processes_are_left_alone():
    seen = []

    def work():
        with held_back():
            seen.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with held_back():
            press_ctrl_c()
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_was_lost_on_its_way_is_heard_when_asked_for_again(number):
    before = signal.getsignal(number)
    with heard_again() as check:
        check()
        with suppress(KeyboardInterrupt):  # as a library does that drops whatever is raised
            os.kill(os.getpid(), number)
        with pytest.raises(KeyboardInterrupt):
            check()
    assert signal.getsignal(number) is before


def test_who_does_not_want_to_hear_of_ctrl_c_does_not():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with heard_again() as check:
            press_ctrl_c()
            check()
    finally:
        signal.signal(signal.SIGINT, before)


def test_sigterm_is_taken_as_ctrl_c_and_one_wish_that_comes_twice_is_one():
    before = signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)
    with sigterm_as_interrupt():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGTERM)
        press_ctrl_c()  # a shell and whoever it was started by pass the same wish on
    assert (signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)) == before


def test_sigterm_is_held_back_like_ctrl_c():
    done = []

    def save():
        with held_back():
            os.kill(os.getpid(), signal.SIGTERM)
            done.append("saved")

    with sigterm_as_interrupt(), pytest.raises(KeyboardInterrupt):
        save()
    assert done == ["saved"]
