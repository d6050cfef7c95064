"""Ctrl-C while casadi and the solvers are at work: it is not lost."""

import contextlib
import gc
import os
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import casadi as ca
import pytest

from quietarm.models.compiled import Compiled
from quietarm.ocp import Ipopt, energy_floor, epsilon_front, plan_move
from quietarm.ocp.checks import takes

X = ca.SX.sym("x")
SQUARE = Compiled(lambda: ca.Function("square", [X], [X * X]), side_by_side=True)


def _swallow_ctrl_c():
    """What casadi does: Ctrl-C comes, and is lost."""
    with contextlib.suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)  # Python runs the handler at the next opportunity, at once


def _lose_ctrl_c_and_fail():
    """What a build or a call is that CasADi has lost a Ctrl-C in: any error follows."""
    _swallow_ctrl_c()
    raise AttributeError("'NoneType' object has no attribute 'T'")


DOORS = {
    "a build": lambda: Compiled(_lose_ctrl_c_and_fail).function,
    "a call": lambda: SQUARE.run([[3.0]], lambda _: _lose_ctrl_c_and_fail()),
    "other work": lambda: Compiled.guard(_lose_ctrl_c_and_fail),
    "without an error": lambda: Compiled.guard(_swallow_ctrl_c),
}


@pytest.mark.parametrize("name", DOORS)
def test_a_swallowed_ctrl_c_comes_after_what_casadi_does_in_place_of_errors_that_it_causes(name):
    outside = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        DOORS[name]()
    assert signal.getsignal(signal.SIGINT) is outside
    assert SQUARE([3.0])[0].item() == 9.0  # nothing is left behind


def test_an_error_of_its_own_stays_one():
    with pytest.raises(ZeroDivisionError):
        Compiled.guard(lambda: 1 / 0)


def test_a_ctrl_c_that_casadi_made_a_system_error_is_one_again():
    @takes()
    def add(x, y):  # as casadi's own sums do before 3.8
        raise SystemError("<built-in function plus> returned a result") from KeyboardInterrupt()

    with pytest.raises(KeyboardInterrupt):
        add(1, 2)


def test_calls_side_by_side_have_memory_of_their_own():
    numbers = list(range(2000))
    with ThreadPoolExecutor(4) as pool:
        squares = list(pool.map(lambda x: SQUARE([x])[0].item(), numbers))
    assert squares == [x**2 for x in numbers]


WORK = {
    "plan": lambda task: plan_move(task, starts=1000, solver=Ipopt()),
    "front": lambda task: epsilon_front(task, points=5000),
    "floor": lambda task: energy_floor(task, starts=1000),
}


@pytest.fixture
def _no_callbacks():
    """Hypothesis times the garbage collector: a signal that comes in its callback is lost."""
    callbacks = list(gc.callbacks)
    gc.callbacks.clear()
    yield
    gc.callbacks[:] = callbacks


@contextlib.contextmanager
def _ctrl_c_until_it_ends(first=1.0, again=2.0):
    """Press Ctrl-C as a user does: once more where Python has lost it in a callback of its own."""
    ended = threading.Event()

    def press():
        wait = first
        while not ended.wait(wait):
            os.kill(os.getpid(), signal.SIGINT)
            wait = again

    thread = threading.Thread(target=press)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


# Python reports a KeyboardInterrupt in the callback of a weak reference, and goes on
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.usefixtures("_no_callbacks")
@pytest.mark.parametrize("name", WORK)
def test_ctrl_c_ends_what_takes_seconds_without_an_answer(tasks, name):
    # of a thousand starts, and of as many points: they do not end before the signal
    task = replace(tasks["single link"], torque_limit=0.5)
    with pytest.raises(KeyboardInterrupt), _ctrl_c_until_it_ends():
        WORK[name](task)
    # nothing is left behind: the next plan is whole
    assert plan_move(task).residual < 1e-8
