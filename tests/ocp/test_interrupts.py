"""Ctrl-C while casadi and the solvers are at work: it is not lost."""

import contextlib
import gc
import os
import signal
import threading
import time
from dataclasses import replace

import pytest
from quietarm.ocp import Ipopt, energy_floor, epsilon_front, plan_move
from quietarm.ocp.interrupts import keep_interrupts


def _swallow_ctrl_c():
    """What casadi does: Ctrl-C comes, and is lost."""
    with contextlib.suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)  # Python runs the handler at the next opportunity, at once


def test_a_swallowed_ctrl_c_comes_after_the_block_in_place_of_errors_that_it_causes():
    def work():
        with keep_interrupts():
            _swallow_ctrl_c()
            raise AttributeError("'NoneType' object has no attribute 'T'")

    with pytest.raises(KeyboardInterrupt):
        work()


WORK = {
    "plan": lambda task: plan_move(task, starts=1000, solver=Ipopt()),
    "front": lambda task: epsilon_front(task, points=5000),
    "floor": lambda task: energy_floor(task, starts=1000),
}


@pytest.fixture
def _no_callbacks():
    """Hypothesis times the garbage collector: a signal that comes in its callback is lost."""
    kept, gc.callbacks[:] = gc.callbacks[:], []
    yield
    gc.callbacks[:] = kept


@pytest.mark.usefixtures("_no_callbacks")
@pytest.mark.parametrize("name", WORK)
def test_ctrl_c_ends_what_takes_seconds_without_an_answer(tasks, name):
    # of a thousand starts, and of as many points: they do not end before the signal
    task = replace(tasks["single link"], torque_limit=0.5)
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        WORK[name](task)
    # nothing is left behind: the next plan is whole
    assert plan_move(task).residual < 1e-8
