"""Ctrl-C in a plan and in a reproduction."""

import shlex
import signal
import subprocess
import sys

import pytest
from lines import EVERY_FILE, MOVE
from quietarm.ocp import Front
from quietarm.studies.reproduce.paper import ARM_HALF

GUARD = 120
"""Seconds after which a process that does not end has hung, on any machine."""


def interrupt(process, delay):
    """Send Ctrl-C after a while; what the process says then. Killed when it does not end."""
    try:
        try:
            process.wait(delay)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        else:
            pytest.fail("the solves were over before the interrupt")
        return process.communicate(timeout=GUARD)
    finally:
        process.kill()
        process.communicate()  # closes its pipes


# The same, which says so when the first start is solved, and waits for the signal then.
AT_THE_FIRST = """
import time
import quietarm.studies.cli
from quietarm.ocp.solvers import funnel

iterate, solved = funnel._Run.iterate, []

def announced(run):
    iterate(run)
    if not solved and funnel.End.SOLVED in run.ends:
        solved.append(run)
        print("begun", flush=True)
        time.sleep(1)

funnel._Run.iterate = announced
quietarm.studies.cli.main()
"""


@pytest.fixture
def solving():
    """Begin a plan of 400 starts, until it says so."""

    def begin(code):
        words = shlex.split(f"plan {MOVE} --starts 400 {EVERY_FILE}")
        process = subprocess.Popen(
            [sys.executable, "-c", code, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert process.stdout.readline() == "begun\n"
        return process

    return begin


def test_ctrl_c_ends_a_plan_and_writes_nothing(solving, folder):
    process = solving(AT_THE_FIRST)
    before = sorted(folder.iterdir())
    out, err = interrupt(process, 0.01)
    assert (process.returncode, out) == (1, "")
    assert err.splitlines()[-1] == "quietarm: interrupted; what was written until then is kept"
    assert sorted(folder.iterdir()) == before


def test_ctrl_c_ends_a_reproduction_and_keeps_its_fronts(folder):
    process = subprocess.Popen(
        [sys.executable, "-m", "quietarm", "reproduce", "--workers", "1", "--output", "results"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not process.stderr.readline().startswith("[1/"):
        assert process.poll() is None
    out, err = interrupt(process, 0.05)
    assert (process.returncode, out) == (1, "")
    assert err.splitlines()[-1] == "quietarm: interrupted; what was written until then is kept"
    first = min((folder / "results" / "fronts").iterdir(), key=lambda path: path.stat().st_mtime)
    assert Front.load(first).task == ARM_HALF.task
