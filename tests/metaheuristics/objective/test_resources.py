"""What the population objective builds and holds, and that it loses no Ctrl-C."""

import dataclasses
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from populations import ARM, CONDITIONS, PROFILE, SINGLE_LINK, candidates, pi
from quietarm.metaheuristics import PopulationObjective
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
    rollout,
)
from quietarm.ocp.program.batch import batch

# -- builds --


def _builds(first, others):
    """How often a function is built for other tasks."""
    candidates = np.zeros((1, PROFILE.size))
    PopulationObjective(first, PROFILE)(candidates)
    before = batch.cache_info().misses
    for task in others:
        PopulationObjective(task, PROFILE)(candidates)
    return batch.cache_info().misses - before


# plants that no other test uses: nothing of them is in the cache
@pytest.mark.parametrize(
    "plant",
    [SingleLinkManipulator(omega=10.4), ArmOnFlexibleLink(omega=7.3)],
    ids=["single link", "arm"],
)
def test_the_papers_other_conditions_cost_no_rebuild(plant):
    first, *others = [
        PointToPoint(plant, target, duration, start)
        for of, start, target, duration, _ in CONDITIONS
        if type(of) is type(plant)
    ]
    assert _builds(first, others) == 0


def test_other_limits_windows_and_angles_cost_no_rebuild():
    task = PointToPoint(ArmOnFlexibleLink(omega=7.2), pi / 2, 0.8, torque_limit=0.3)
    changes = [
        {"start": 0.3},
        {"target": -1.0},
        {"duration": 0.7},
        {"torque_limit": 0.2},
        {"residual_window": 0.9},
    ]
    others = [dataclasses.replace(task, **change) for change in changes]
    assert _builds(task, others) == 0


def test_the_shared_function_mixes_no_tasks_up():
    X = candidates(5, 0.5)
    some = [PointToPoint(ARM, target, T) for target, T in ((pi / 2, 0.8), (1.0, 0.7), (-1, 0.9))]
    objectives = [PopulationObjective(task, PROFILE) for task in some]
    for task, objective in zip(some, objectives, strict=True):
        energies = [rollout(task, PROFILE, x, objective.steps).motion.energy for x in X]
        assert objective(X).energy == pytest.approx(energies, rel=1e-12, abs=0)


def test_a_faster_mode_gets_more_steps():
    fast = SingleLinkManipulator(omega=30.0)
    assert (
        PopulationObjective(PointToPoint(SINGLE_LINK, pi / 6, 0.8), PROFILE).steps
        == CANDIDATE_STEPS
    )
    # two steps a radian of the fastest mode (ocp.simulation.rollout.default_steps)
    assert PopulationObjective(PointToPoint(fast, pi / 6, 0.8), PROFILE).steps == 2 * 30 * 0.8


# -- Ctrl-C --

SENDER = """
import os, signal, sys, time
for line in sys.stdin:
    time.sleep(float(line))
    os.kill(int(sys.argv[1]), signal.SIGINT)
    print("sent", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent as a signal, from another process")
def test_ctrl_c_at_any_moment_of_an_evaluation_is_raised(tasks):
    # casadi's conversions of numpy's arrays swallow it, or turn it into another error, about once
    # in fifty times.
    objective, X = PopulationObjective(tasks["arm"][0], PROFILE), candidates(200, 0.5)
    objective(X)
    rng, lost = np.random.default_rng(), []
    command = [sys.executable, "-S", "-E", "-c", SENDER, str(os.getpid())]
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as sender:
        try:
            for _ in range(300):
                try:
                    sender.stdin.write(b"%f\n" % rng.uniform(0, 3e-3))
                    sender.stdin.flush()
                    while not select.select([sender.stdout], [], [], 0)[0]:
                        objective(X)
                    time.sleep(0.05)  # for the signal, should it still be under way
                    lost.append("nothing was raised")
                except KeyboardInterrupt:
                    pass
                except Exception as error:
                    lost.append(repr(error)[:60])
                assert sender.stdout.readline() == b"sent\n"
        finally:
            signal.signal(signal.SIGINT, before)
            sender.kill()
    assert lost == []


# -- memory --

MEMORY = """
import json, math
import numpy as np
from quietarm.metaheuristics import PopulationObjective
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import CycloidPolynomial, PointToPoint

def peak():
    # Not ru_maxrss: over fork and exec it starts from the peak of the parent, here pytest's.
    lines = open("/proc/self/status").read().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM"))


task = PointToPoint(
    ArmOnFlexibleLink(), math.pi / 2, 0.8,
    torque_limit=1.0, speed_limit=1.0, acceleration_limit=1.0, deflection_limit=1.0,
)
before = peak()
objective = PopulationObjective(task, CycloidPolynomial(6), threads=2)
values = objective(np.random.default_rng(0).uniform(-0.5, 0.5, (10_000, 6)))
print(json.dumps([before, peak(), int(np.isfinite(values.energy).sum())]))
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="peaks are read from /proc")
def test_ten_thousand_candidates_take_less_than_a_gigabyte():
    # the build included, in a process of its own
    done = subprocess.run(
        [sys.executable, "-c", MEMORY], capture_output=True, text=True, timeout=600, check=True
    )
    before, peak, finite = json.loads(done.stdout)
    assert finite == 10_000
    assert 0 < peak - before < 1e9
