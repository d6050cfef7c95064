"""Threads: one at a time into what casadi does, and silence for it alone."""

import subprocess
import sys
import threading
from contextlib import suppress

from quietarm.ocp.base.threads import one_at_a_time, silent_errors


def test_only_one_thread_is_inside_at_a_time():
    inside, most = [], []

    @one_at_a_time
    def outer(pause):
        return inner(pause)

    @one_at_a_time
    def inner(pause):
        inside.append(0)
        most.append(len(inside))
        pause.wait(0.01)
        inside.pop()
        return "done"

    pause = threading.Event()
    threads = [threading.Thread(target=outer, args=(pause,)) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 5
    assert outer(pause) == "done"  # the lock is free again, and inner did not wait for outer


def test_an_error_lets_the_next_one_in():
    @one_at_a_time
    def fails():
        raise ZeroDivisionError

    for _ in range(2):
        thread = threading.Thread(target=lambda: _suppressed(fails))
        thread.start()
        thread.join(10)
        assert not thread.is_alive()


def _suppressed(function):
    with suppress(ZeroDivisionError):
        function()


def test_what_other_threads_say_is_heard(capsys):
    with silent_errors():
        print("by casadi", file=sys.stderr)
        thread = threading.Thread(target=lambda: print("progress", file=sys.stderr))
        thread.start()
        thread.join()
    print("afterwards", file=sys.stderr)
    assert capsys.readouterr().err == "progress\nafterwards\n"


# A process of its own: where threads build at once, casadi ends it.
AT_ONCE = """
from concurrent.futures import ThreadPoolExecutor
from math import pi
from quietarm.metaheuristics import MoveFunction
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, epsilon_front, plan_move

def found(number):
    task = PointToPoint(SingleLinkManipulator(omega=10.0 + number), pi / 6, 0.8)
    if number % 3 == 0:
        return plan_move(task, CycloidPolynomial(2), starts=1).energy
    if number % 3 == 1:
        return MoveFunction(task, CycloidPolynomial(2), bound=0.2)([[0.1, 0.1]])[0].tolist()
    return epsilon_front(task, CycloidPolynomial(2), points=2, starts=1).energies.tolist()

with ThreadPoolExecutor(6) as pool:
    together = list(pool.map(found, range(6)))
assert together == [found(number) for number in range(6)]
"""


def test_threads_that_plan_at_once_find_what_one_finds():
    ran = subprocess.run(
        [sys.executable, "-c", AT_ONCE], capture_output=True, text=True, timeout=120, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")
