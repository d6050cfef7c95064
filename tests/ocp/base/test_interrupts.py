"""Ctrl-C during casadi's own loops is not lost."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from quietarm.ocp.base.interrupts import keep_interrupts

ROOT = Path(__file__).parents[3]


def _swallow_ctrl_c():
    """What casadi does: Ctrl-C comes, and is lost."""
    with contextlib.suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)  # Python runs the handler at the next opportunity, at once


def test_a_swallowed_ctrl_c_comes_after_the_block():
    reached = []

    def work():
        with keep_interrupts():
            _swallow_ctrl_c()
            reached.append("the end of the block")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert reached


def test_an_error_that_a_swallowed_ctrl_c_causes_is_not_what_one_sees():
    # casadi returns nothing where a value should be, and an AttributeError follows
    def work():
        with keep_interrupts():
            _swallow_ctrl_c()
            raise AttributeError("'NoneType' object has no attribute 'T'")

    with pytest.raises(KeyboardInterrupt):
        work()
    with pytest.raises(AttributeError), keep_interrupts():
        raise AttributeError


def test_ctrl_c_ends_a_solve():
    # A thousand starts: they do not end before the signal. Where the machine is so slow that
    # the first has not begun by then, Ctrl-C ends the call all the same.
    script = (
        "import math, ocp, models\n"
        "task = ocp.PointToPoint(models.SingleLinkManipulator(), math.pi / 6, 0.8)\n"
        "try:\n"
        "    print('begun', flush=True)\n"
        "    plan = ocp.plan_move(task, ocp.CycloidPolynomial(12), starts=1000)\n"
        "    if not plan.complete:  # the best of the starts until then\n"
        "        raise KeyboardInterrupt\n"
        "except KeyboardInterrupt:\n"
        "    print('stopped', flush=True)\n"
    )
    run = subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    try:
        assert run.stdout.readline() == "begun\n"
        time.sleep(0.7)
        run.send_signal(signal.SIGINT)
        out, _ = run.communicate(timeout=600)
    finally:
        run.kill()
        run.stdout.close()
    assert out == "stopped\n"
    assert run.returncode == 0
