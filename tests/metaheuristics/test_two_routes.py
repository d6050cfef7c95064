"""The two routes to a front held against each other, on both plants, with the paper's settings.

Expected values are each route's own: what the derivative-free search finds must not beat the
gradient, and started from there the gradient must end on its own front.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from metaheuristics import search
from models import ArmOnFlexibleLink, SingleLinkManipulator
from ocp import (
    CycloidPolynomial,
    PointToPoint,
    epsilon_front,
    polish_front,
    resimulate,
    weighted_front,
)
from ocp.provenance import SolveSettings
from ocp.sweep import Sweep

CASES = {  # the first rows of Tables 6 and 3, in the paper's boxes
    "arm": (PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), 0.5),
    "single link": (PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}
TOLERANCE = 1e-4  # README, 'How exact'
POLISHED = 2e-3


@pytest.fixture(scope="module", params=CASES)
def case(request):
    task, bound = CASES[request.param]
    return task, bound, epsilon_front(task, bound=bound)


@pytest.fixture(scope="module")
def found(case):
    """Fronts of both metaheuristics."""
    task, bound, _ = case
    return [search(task, method, bound=bound) for method in ("nsga2", "vepso")]


def _least_energies(front, points):
    """Least energy at the residual of each point, from the point of the front beside it."""
    sweep = Sweep(front.task, front.profile, SolveSettings(bound=front.settings["bound"]))
    least = []
    for point in points:
        beside = int(np.argmin(np.abs(front.residuals - point.residual)))
        guess = np.array(front.points[beside].coefficients)
        checked = sweep.checked(sweep.solve(guess, point.residual), {})
        least.append(checked.energy)
    return np.array(least)


def test_no_metaheuristic_dominates_the_gradient(case, found):
    _, _, front = case
    for other in found:
        assert len(other.points) > 20
        for point in other.points:
            no_stiller = front.residuals >= point.residual
            assert np.all(point.energy >= front.energies[no_stiller] * (1 - TOLERANCE))


def test_at_their_own_residuals_the_gradient_is_as_cheap_or_cheaper(case, found):
    # between the front's points, too: a solve from its nearest one
    _, _, front = case
    for other in found:
        thinned = _thinned(other, 15)
        least = _least_energies(front, thinned.points)
        assert np.all(least <= thinned.energies * (1 + TOLERANCE))


def test_weighted_points_lie_on_the_front(case):
    task, bound, front = case
    weighted = weighted_front(task, bound=bound, points=12)
    least = _least_energies(front, weighted.points[1:])  # the first is at rest
    assert weighted.energies[1:] == pytest.approx(least, rel=TOLERANCE)
    assert weighted.energies[0] == pytest.approx(front.energies[0], rel=TOLERANCE)


def test_polishing_a_metaheuristic_lands_on_the_front(case, found):
    _, _, front = case
    for other in found:
        thinned = _thinned(other, 15)
        polish = polish_front(thinned)
        least = _least_energies(front, polish.front.points)
        assert polish.front.energies == pytest.approx(least, rel=POLISHED)
        assert polish.front.failures == ()
        assert min(gain.share for gain in polish.gains) >= 0.0
        assert max(gain.share for gain in polish.gains) > 1e-3


def _thinned(front, count):
    chosen = np.unique(np.linspace(0, len(front.points) - 1, count).round().astype(int))
    return replace(front, points=tuple(front.points[i] for i in chosen))


def test_all_figures_agree_with_the_independent_integrator(case, found):
    task, _, front = case
    for one in (front, *found):
        for point in one.points[:: max(len(one.points) // 10, 1)]:
            motion = resimulate(task, CycloidPolynomial(6), point.coefficients)
            assert point.energy == pytest.approx(motion.energy, rel=TOLERANCE)
            assert point.residual == pytest.approx(motion.residual, rel=1e-3, abs=1e-6)
