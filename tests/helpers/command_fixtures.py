"""Shared by tests of `machine`, `views` and `studies`: answers, and ways to call the command."""

import math
import os
import shlex
import signal
import subprocess
import threading

import numpy as np
import pytest
from floors import coarse_floors
from lines import COARSELY

from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    FrontPoint,
    PointToPoint,
    Record,
    evaluate_coefficients,
    non_dominated,
    plan_move,
)
from quietarm.studies.cli import main
from quietarm.views.report import progress


@pytest.fixture(scope="module", autouse=True)
def coarse_floors_():
    with coarse_floors():
        yield


@pytest.fixture(autouse=True)
def a_machine_as_slow_as_you_like(monkeypatch):
    """No word that a command is still at work: how long it takes is the machine's."""
    monkeypatch.setattr(progress, "SILENT_SECONDS", threading.TIMEOUT_MAX)


@pytest.fixture
def call(capfd, monkeypatch):
    """Run a line in this process: its status, standard output and standard error."""

    def run_here(line):
        words = line if isinstance(line, list) else shlex.split(line)
        with pytest.raises(SystemExit) as ended:
            main(words)
        out, err = capfd.readouterr()  # what casadi's libraries write, too
        return ended.value.code, out, err

    return run_here


@pytest.fixture
def done(call):
    """Run a line that must end well and say nothing on standard error; its standard output."""

    def run_done(line):
        code, out, err = call(line)
        assert (code, err) == (0, "")
        return out

    return run_done


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of the test's own, and standing in it."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def at_a_terminal():
    """Start a line as a process with a group of its own, as a shell does; killed at the end."""
    begun = []

    def start(line):
        begun.append(
            subprocess.Popen(
                [*COARSELY, *shlex.split(line)],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=True,
            )
        )
        return begun[-1]

    yield start
    for process in begun:
        process.kill()
        process.communicate()  # closes its pipes


@pytest.fixture
def stop():
    """Send Ctrl-C to a process and to those that it started; what it says until all have ended."""

    def press(process, number=signal.SIGINT):
        os.killpg(process.pid, number)
        # both pipes end with the last of the processes; the limit is a guard against hanging
        return process.communicate(timeout=240)

    return press


@pytest.fixture(scope="session")
def task():
    """The README's move: the first row of Table 3."""
    return PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


@pytest.fixture(scope="session")
def plan(task):
    """A plan of two terms, at rest on arrival."""
    return plan_move(task, CycloidPolynomial(2))


@pytest.fixture(scope="session")
def cycloid(task):
    """The plain cycloid of the same task."""
    return evaluate_coefficients(task, [])


@pytest.fixture(scope="session")
def front_of(task):
    """Make a front of points (residual [mm], energy [J]), to work out indicators of by hand."""
    move = task

    def make(points, method="nsga2", seed=0, task=move, bound=0.2, terms=2, **rest):
        found = [FrontPoint(tuple(np.full(terms, 0.1)), 1e-3 * r, energy) for r, energy in points]
        return Front(
            task=task,
            profile=CycloidPolynomial(terms),
            points=non_dominated(found),
            record=Record(
                method,
                bound=bound,
                seed=seed,
                evaluations=rest.pop("evaluations", 100),
                seconds=rest.pop("seconds", 1.0),
            ),
            reference=rest.pop("reference", (10e-3, 1.0)),
            **rest,
        )

    return make


@pytest.fixture(scope="session")
def good(front_of):
    """A front from (0, 0.8) to (8 mm, 0.4 J): its extent is 8 mm or 0.4 J."""
    return front_of([(0, 0.8), (4, 0.5), (8, 0.4)], "epsilon", seed=None)


@pytest.fixture(scope="session")
def poor(front_of):
    """A front that `good` dominates."""
    return front_of([(2, 0.9), (6, 0.6)], "nsga2")
