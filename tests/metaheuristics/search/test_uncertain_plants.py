"""Fronts of a plant that may be wrong, by searches and by the gradient: F1 is the worst sample."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import pytest

from quietarm.metaheuristics import search
from quietarm.metaheuristics.evaluation.stated_figures import check_figures
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import JudgedMotion, PointToPoint, Uncertainty


@pytest.fixture(scope="module")
def task():
    uncertainty = Uncertainty({"frequency": 0.1})
    return PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def searched(task):
    return search(task, algorithm="nsga2", bound=0.5, population=20, generations=4)


@pytest.mark.slow
def test_residuals_are_those_of_the_worst_sample_by_cvodes(searched, task):
    for point in (searched.smallest_residual(), searched.cheapest()):
        alone = [
            JudgedMotion.of_profile(
                replace(task, plant=part, uncertainty=None), searched.profile, point.coefficients
            ).motion
            for part in task.perturbed_plants
        ]
        assert point.residual == pytest.approx(max(one.residual for one in alone), rel=1e-3)
        assert point.energy == pytest.approx(alone[0].energy, rel=1e-3)
    check_figures(searched, "front.json")
