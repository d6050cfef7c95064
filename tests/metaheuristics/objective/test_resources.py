"""What the population objective builds and holds, and that it loses no Ctrl-C."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from populations import CONDITIONS, PROFILE, SINGLE_LINK, pi
from quietarm.metaheuristics import PopulationObjective
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
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


def test_a_faster_mode_gets_more_steps():
    fast = SingleLinkManipulator(omega=30.0)
    assert (
        PopulationObjective(PointToPoint(SINGLE_LINK, pi / 6, 0.8), PROFILE).steps
        == CANDIDATE_STEPS
    )
    # two steps a radian of the fastest mode (ocp.simulation.rollout.default_steps)
    assert PopulationObjective(PointToPoint(fast, pi / 6, 0.8), PROFILE).steps == 2 * 30 * 0.8


# -- Ctrl-C --


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
