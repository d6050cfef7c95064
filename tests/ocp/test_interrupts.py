"""Ctrl-C while casadi and the solvers are at work; where exactly, tests/test_interrupts.py asks."""

import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import casadi as ca
import pytest
from presses import press

from quietarm.models.compiled import Compiled
from quietarm.ocp import Ipopt, energy_floor, epsilon_front, plan_move

X = ca.SX.sym("x")
SQUARE = Compiled(lambda: ca.Function("square", [X], [X * X]), side_by_side=True)


def test_an_error_of_its_own_stays_one():
    with pytest.raises(ZeroDivisionError):
        Compiled.guard(lambda: 1 / 0)


def test_calls_side_by_side_have_memory_of_their_own():
    numbers = list(range(2000))
    with ThreadPoolExecutor(4) as pool:
        squares = list(pool.map(lambda x: SQUARE([x])[0].item(), numbers))
    assert squares == [x**2 for x in numbers]


class PressedInItsThirdIteration(ca.Callback):
    """Callback of IPOPT in each iteration on a program of one variable."""

    def __init__(self):
        super().__init__()
        self.iterations = 0
        self.construct("pressed", {})

    def get_n_in(self):
        return ca.nlpsol_n_out()

    def get_name_in(self, i):
        return ca.nlpsol_out(i)

    def get_sparsity_in(self, i):
        return ca.Sparsity.dense(1 if ca.nlpsol_out(i) in ("f", "x", "lam_x") else 0)

    def eval(self, arguments):
        self.iterations += 1
        if self.iterations == 3:
            press()
        return [0]


def test_a_solve_ends_with_the_press_and_not_with_its_last_iteration():
    pressed = PressedInItsThirdIteration()
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}}
    options |= {"iteration_callback": pressed}
    program = {"x": X, "f": (X - 3) ** 4}  # takes 16 iterations from 0
    solver = Compiled(lambda: ca.nlpsol("quartic", "ipopt", program, options))
    with pytest.raises(KeyboardInterrupt):
        solver.solve(x0=0)
    assert pressed.iterations < 10
    assert solver.solve(x0=0)[1]["success"]  # the next call is whole
    assert pressed.iterations > 10


WORK = {
    "plan": lambda task: plan_move(task, starts=1000, solver=Ipopt()),
    "front": lambda task: epsilon_front(task, points=5000),
    "floor": lambda task: energy_floor(task, starts=1000),
}


@contextmanager
def _pressed_after(seconds):
    thread = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    thread.start()
    try:
        yield
    finally:
        thread.join()


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", WORK)
def test_ctrl_c_ends_what_takes_long_without_an_answer(tasks, name):
    # of a thousand starts, and of as many points: they do not end before the signal
    task = replace(tasks["single link"], torque_limit=0.5)
    with pytest.raises(KeyboardInterrupt), _pressed_after(0.3):
        WORK[name](task)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    # nothing is left behind: the next plan is whole
    assert plan_move(task).residual < 1e-8
