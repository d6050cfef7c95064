"""Plans and fronts with a limit on the jerk, and their files."""

import json
from dataclasses import replace

import numpy as np
import pytest
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    Plan,
    epsilon_front,
    plan_move,
    resimulate,
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


def test_every_point_of_a_front_keeps_it(tasks):
    task = replace(tasks["arm"], jerk_limit=3000.0)
    front = epsilon_front(task, CycloidPolynomial(6), bound=0.5, points=3, starts=1)
    assert len(front.points) >= 3
    for point in front.points:
        peak = resimulate(task, front.profile, point.coefficients).peak_jerk
        assert peak <= 3000.0 * (1 + 1e-3)


def test_a_plan_with_a_jerk_limit_saves_and_loads_equal(pair, tmp_path):
    for plan in pair:
        plan.save(tmp_path / "plan.json")
        assert Plan.load(tmp_path / "plan.json") == plan
    document = json.loads((tmp_path / "plan.json").read_text())
    assert document["task"]["jerk_limit"] == plan.task.jerk_limit
    assert document["motion"]["peak_jerk"] == plan.motion.peak_jerk


@pytest.fixture
def changed(pair, tmp_path):
    """The file of a plan without limits, with another peak of the jerk or none."""
    path = tmp_path / "plan.json"
    pair[0].save(path)

    def write(**peaks):
        document = json.loads(path.read_text())
        del document["motion"]["peak_jerk"]
        document["motion"] |= peaks
        path.write_text(json.dumps(document))
        return path

    return write
