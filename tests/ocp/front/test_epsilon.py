"""The front by epsilon-constraint: its ends, its spacing, and that no point could be cheaper."""

from dataclasses import replace

import numpy as np
import pytest
from moves import CASES

import quietarm as qa
from quietarm.ocp.rest import STILL

POINTS = 8


@pytest.fixture(scope="module", params=CASES)
def case(request):
    task, bound = CASES[request.param]
    return task, bound, qa.epsilon_front(task, bound=bound, points=POINTS)


@pytest.mark.slow_after(1)
def test_the_ends_are_the_plans_of_least_energy(case):
    # plan_move starts on its own, four times at either end
    task, bound, front = case
    still = qa.plan_move(task, bound=bound)
    free = qa.plan_move(task, bound=bound, residual_limit=1.0)
    assert front.smallest_residual().residual < STILL
    assert front.smallest_residual().energy == pytest.approx(still.energy, rel=1e-6)
    assert front.cheapest().energy == pytest.approx(free.energy, rel=1e-6)
    assert front.cheapest().residual == pytest.approx(free.residual, rel=1e-3)


@pytest.mark.slow_after(1)
def test_no_point_is_dearer_than_a_plan_at_its_residual(case):
    task, bound, front = case
    for point in front.points[2:-1:2]:
        plan = qa.plan_move(task, bound=bound, residual_limit=point.residual)
        assert point.energy <= plan.energy * (1 + 1e-4)  # docs/accuracy.md
        assert point.energy == pytest.approx(plan.energy, rel=2e-3)


@pytest.mark.slow_after(1)
def test_points_are_even_in_both_objectives(case):
    _, _, front = case
    assert len(front.points) == POINTS
    steps = np.hypot(
        np.diff(front.residuals) / np.ptp(front.residuals),
        np.diff(front.energies) / np.ptp(front.energies),
    )
    assert steps.max() < 1.5 * steps.mean()
    assert steps.min() > 0.5 * steps.mean()


@pytest.mark.slow_after(1)
def test_every_point_has_the_figures_of_the_independent_integrator(case):
    task, bound, front = case
    for point in front.points:
        motion = qa.JudgedMotion.of_profile(task, front.profile, point.coefficients).motion
        # of all points but the ends by steps that CVODES confirms to this share at every tenth
        assert point.energy == pytest.approx(motion.energy, rel=1e-6)
        assert point.residual == pytest.approx(motion.residual, rel=1e-6, abs=STILL)
        assert np.abs(point.coefficients).max() <= bound


@pytest.mark.slow
def test_where_rest_is_out_of_reach_the_front_begins_at_the_least_residual():
    # One term has nothing left to arrive at rest with: two conditions, one coefficient.
    task, profile = CASES["arm"][0], qa.CycloidPolynomial(1)
    front = qa.epsilon_front(task, profile, points=5)
    scan = [
        qa.JudgedMotion.of_profile(task, profile, [a]).residual for a in np.linspace(-0.4, 0.4, 81)
    ]
    smallest = front.smallest_residual()
    assert 0.9 * min(scan) < smallest.residual < 1.001 * min(scan)
    assert len(front.points) > 2


@pytest.mark.slow
def test_there_is_a_point_at_every_residual_that_is_asked_for():
    task, bound = CASES["arm"]
    at, told = (1e-4, 1e-3 / 3, 5e-3, 1.0), []  # at 1 m there is no front
    front = qa.epsilon_front(
        task, qa.CycloidPolynomial(3), bound=bound, points=2, at=at,
        report=lambda done, total: told.append((done, total)),
    )  # fmt: skip
    assert len(front.points) == 5
    assert told[-1] == (5, 5)
    assert {total for _, total in told} == {5}
    for residual in at[:3]:
        assert residual * (1 - 3e-4) < front.cheapest(residual).residual <= residual
    assert tuple(map(float, front.record.settings["at"].split(", "))) == at  # to the last digit


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "limits", "bound"),
    [("arm", {"acceleration_limit": 12.5}, 0.5), ("arm", {"speed_limit": 2.6}, None)],
)
def test_every_point_keeps_the_limits_that_no_motion_at_rest_keeps(tasks, name, limits, bound):
    task, six = replace(tasks[name], **limits), qa.CycloidPolynomial(6)
    front = qa.epsilon_front(task, six, bound=bound, points=4, starts=2)
    fine = qa.epsilon_front(task, six, bound=bound, points=2, starts=1, steps=384)
    assert not front.failures
    for point in front.points:
        motion = qa.JudgedMotion.of_profile(task, front.profile, point.coefficients).motion
        assert not motion.exceeded(task.limits, 1e-6)
    # and is hardly less still for it
    assert front.residuals[0] == pytest.approx(fine.residuals[0], rel=2e-3)
