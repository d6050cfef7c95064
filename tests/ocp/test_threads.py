"""Threads: one at a time into what casadi does, and silence for it alone."""

import subprocess
import sys

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
