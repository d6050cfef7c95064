"""Searches over other profiles than the polynomial: each in its own box, on a plant each."""

import math

import numpy as np
import pytest
from fixed_steps import rollout

from quietarm.metaheuristics import search
from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
from quietarm.ocp import CycloidGaussians, CycloidNetwork, CycloidSpline, PointToPoint

TASKS = {
    "single link": PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8),
    "arm": PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8),
    "two links": PointToPoint(DualLinkManipulator(), math.pi / 2, 0.9),
}
PROFILES = {
    "gaussians": CycloidGaussians(3),
    "network": CycloidNetwork(3),
    "spline": CycloidSpline(5),
}


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("method", ["vepso", "nsga2"])
@pytest.mark.parametrize(("kind", "name"), [*zip(PROFILES, TASKS, strict=True)])
def test_a_search_stays_in_the_profiles_box_and_finds_what_it_says(kind, method, name):
    task, profile = TASKS[name], PROFILES[kind]
    found = search(task, profile, algorithm=method, population=20, generations=10, seed=1)
    assert found.profile == profile
    assert found.record.bound == profile.default_bound
    lower, upper = profile.box(profile.default_bound)
    assert found.points
    for point in found.points:
        assert np.all((lower <= point.coefficients) & (point.coefficients <= upper))
    point = found.cheapest()
    motion = rollout(task, profile, point.coefficients, 1000).motion  # by other integration
    assert point.energy == pytest.approx(motion.energy, rel=1e-6)
    assert point.residual == pytest.approx(motion.residual, rel=1e-4)
