"""Plans and fronts with a limit on the jerk, and their files."""

from dataclasses import replace

import numpy as np
import pytest
from quietarm.ocp import (
    InfeasibleTaskError,
    plan_move,
)


@pytest.fixture(scope="module", params=["single link", "arm"])
def pair(request, tasks, solved):
    """A plan without a limit, and one with half of its jerk."""
    free = solved(tasks[request.param])
    limited = replace(free.task, jerk_limit=0.5 * free.motion.peak_jerk)
    return free, solved(limited, starts=1)


def test_a_jerk_limit_is_kept_all_the_way_and_costs_energy(pair):
    free, plan = pair
    limit, times = plan.task.jerk_limit, np.linspace(0.0, plan.task.duration, 20_001)
    assert plan.motion.peak_jerk <= limit * (1 + 1e-6)
    assert np.abs(plan.path(times, 3)).max() <= limit * (1 + 1e-5)
    assert plan.motion.peak_jerk > limit * (1 - 1e-3)  # nothing of it is left unused
    assert plan.residual < 1e-8
    assert plan.energy > free.energy


def test_what_is_said_to_be_feasible_is(tasks):
    task = replace(tasks["arm"], jerk_limit=100.0)
    with pytest.raises(InfeasibleTaskError, match=r"jerk <= 100 rad/s\^3.* jerk limit") as error:
        plan_move(task, starts=1)
    least = float(str(error.value).split(" jerk limit ")[1].split()[0])
    plan = plan_move(replace(task, jerk_limit=least), starts=1)
    assert plan.motion.peak_jerk <= least * (1 + 1e-3)
    assert plan.residual < 1e-8
