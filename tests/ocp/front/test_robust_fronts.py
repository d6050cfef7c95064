"""Fronts of an uncertain task: fronts of its scenarios."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import pytest

import quietarm as qa
from quietarm.ocp import perturb_plant

RANGE, POINTS = 0.15, 4
PROFILE = qa.CycloidPolynomial(4)


@pytest.fixture(scope="module")
def task():
    uncertainty = qa.Uncertainty({"frequency": RANGE})
    return qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, uncertainty=uncertainty)


FRONTS = {
    "epsilon": lambda task: qa.epsilon_front(task, PROFILE, points=POINTS, starts=1),
    "weighted": lambda task: qa.weighted_front(task, PROFILE, weights=[(1, 1)], starts=1),
    "polished": lambda task: qa.polish_front(FRONTS["epsilon"](task)).front,
}


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", FRONTS)
def test_a_points_residual_is_the_largest_over_the_scenarios(task, name):
    front = FRONTS[name](task)
    assert front.task == task
    assert len(front.points) > 1
    for point in front.points:
        by_scenario = [
            qa.JudgedMotion.of_profile(
                replace(task.certain, plant=perturb_plant(task.plant, {"frequency": error})),
                PROFILE,
                point.coefficients,
            )
            for error in (0.0, -RANGE, RANGE)
        ]
        assert point.residual == pytest.approx(max(one.residual for one in by_scenario), rel=1e-6)
        assert point.energy == pytest.approx(by_scenario[0].energy, rel=1e-6)  # the nominal plant's


def test_its_cheap_end_is_the_nominal_tasks(task):
    robust, nominal = (FRONTS["epsilon"](one) for one in (task, task.certain))
    assert robust.energies[-1] == pytest.approx(nominal.energies[-1], rel=1e-5)
    assert robust.residuals[-1] > nominal.residuals[-1]
    # at rest only the nominal plant can arrive, whatever its errors
    assert nominal.residuals[0] < 1e-8 < robust.residuals[0]
