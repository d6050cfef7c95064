"""Points of a front by the solver that did not find them."""

from dataclasses import replace

import numpy as np
import pytest
from moves import CASES

from quietarm.ocp import (
    CycloidPolynomial,
    Ipopt,
    JudgedMotion,
    Uncertainty,
    cross_check,
    epsilon_front,
)
from quietarm.ocp.solvers.choice import SOLVERS


@pytest.fixture(scope="module", params=["sqp", "ipopt"])
def front(request):
    """Return a front of the single link's first move."""
    task, bound = CASES["single link"]
    settings = {"bound": bound, "points": 4, "starts": 2, "solver": SOLVERS[request.param]()}
    return epsilon_front(task, CycloidPolynomial(4), **settings)


@pytest.mark.slow
def test_the_other_solver_finds_no_other_energy(front):
    told = []
    both = cross_check(
        front, checked_points=3, report=lambda done, total: told.append((done, total))
    )
    assert {both.solver.name, front.record.settings["solver"]} == {"sqp", "ipopt"}
    assert told == [(1, 3), (2, 3), (3, 3)]
    residuals = [point.residual for point in both.points]
    assert (residuals[0], residuals[-1]) == (front.residuals[0], front.residuals[-1])
    if both.solver == Ipopt():
        assert both.largest < 1e-6
    assert min(point.difference for point in both.points) > -1e-6
    for end in (both.points[0], both.points[-1]):
        assert abs(end.difference) < 1e-6


@pytest.mark.slow_after(1)
def test_a_point_that_is_too_dear_is_seen(front):
    point = front.points[1]
    moved = replace(point, coefficients=tuple(0.9 * np.array(point.coefficients)))
    both = cross_check(replace(front, points=(moved,)), checked_points=2)
    assert len(both.points) == 1
    assert both.points[0].difference < -1e-3
    assert both.largest == -both.points[0].difference


@pytest.mark.slow_after(1)
def test_a_front_of_a_search_is_checked_by_ipopt(front):
    searched = replace(front, points=front.points[-1:]).restated(settings={})
    assert cross_check(searched).solver == Ipopt()


@pytest.mark.slow
def test_a_deflection_is_limited_in_every_scenario_by_both_solvers():
    """The limit binds in the scenarios, not on the nominal plant."""
    task, _ = CASES["single link"]
    task = replace(task, uncertainty=Uncertainty({"frequency": 0.1}), deflection_limit=31e-3)
    robust = epsilon_front(task, CycloidPolynomial(4), bound=0.2, points=3)
    both = cross_check(robust, checked_points=3)
    assert len(both.points) == 3
    assert both.largest < 1e-6
    for point in robust.points:
        peak, nominal = (
            JudgedMotion.of_profile(one, robust.profile, point.coefficients).motion.peak_deflection
            for one in (task, task.certain)
        )
        assert 0.999 * 31e-3 < peak <= 31e-3 * (1 + 2e-3)
        assert nominal < 0.9 * 31e-3
