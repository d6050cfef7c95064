"""Fronts of a plant that may be wrong, by searches and by the gradient: F1 is the worst sample."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import pytest
from quietarm.metaheuristics import search
from quietarm.metaheuristics.objective.claims import check_figures
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    Candidate,
    CycloidPolynomial,
    Front,
    PointToPoint,
    Uncertainty,
    epsilon_front,
    polish_front,
)


@pytest.fixture(scope="module")
def task():
    uncertainty = Uncertainty({"frequency": 0.1})
    return PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def searched(task):
    return search(task, "nsga2", bound=0.5, population=20, generations=4)


@pytest.fixture(scope="module")
def exact(task):
    return epsilon_front(task, CycloidPolynomial(4), points=2, starts=1)


@pytest.mark.parametrize("of", ["searched", "exact"])
def test_residuals_are_those_of_the_worst_sample_by_cvodes(of, task, request):
    front = request.getfixturevalue(of)
    for point in (front.smallest_residual(), front.cheapest()):
        alone = [
            Candidate.of_profile(
                replace(task, plant=part, uncertainty=None), front.profile, point.coefficients
            ).motion
            for part in front.task.perturbed_plants
        ]
        worst = max(one.residual for one in alone)
        # the gradient's is the largest between the samples as well: tests/ocp/front
        most = worst * (1.02 if of == "exact" else 1.0)
        assert worst * (1 - 1e-3) - 1e-8 <= point.residual <= most * (1 + 1e-3) + 1e-8
        assert point.energy == pytest.approx(alone[0].energy, rel=1e-3)


@pytest.mark.parametrize("of", ["searched", "exact"])
def test_fronts_save_load_and_are_believed(of, request, tmp_path):
    front = request.getfixturevalue(of)
    front.save(tmp_path / "front.json")
    loaded = Front.load(tmp_path / "front.json")
    assert loaded == front
    check_figures(loaded, "front.json")


def test_the_gradient_improves_what_a_search_found(searched):
    few = replace(searched, points=searched.points[:2])
    polished = polish_front(few)
    assert all(gain.after < gain.before for gain in polished.gains)
    assert polished.front.task == searched.task
