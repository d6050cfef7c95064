"""The front by weighted sums: its points are on the front, its gaps where the front bends away."""

from functools import cache

import numpy as np
import pytest
from moves import CASES

import quietarm as qa
from quietarm.ocp.front import tradeoff

POINTS = 10


@cache
def _front_of(name):
    """The front of a case, found once."""
    task, bound = CASES[name]
    return qa.weighted_front(task, bound=bound, points=POINTS, starts=1)


@pytest.fixture(params=CASES)
def case(request):
    return *CASES[request.param], _front_of(request.param)


def _scaled(front, others):
    """Residual and energy of other points, scaled to the ends of a front."""
    return np.column_stack([
        (others.residuals - front.residuals[0]) / np.ptp(front.residuals),
        (others.energies - front.energies[-1]) / np.ptp(front.energies),
    ])  # fmt: skip


@pytest.mark.slow
def test_gaps_are_where_the_front_is_above_its_chord():
    # In a gap, the points by residual limit lie above the straight line between its ends.
    task, bound = CASES["single link"]
    weighted = _front_of("single link")
    (begin, end), *others = weighted.gaps
    assert not others
    whole = qa.epsilon_front(task, bound=bound, points=20, starts=1)
    inside = (whole.residuals > begin + 1e-3) & (whole.residuals < end - 1e-3)
    assert inside.sum() > 5
    chord = np.interp(whole.residuals, weighted.residuals, weighted.energies)
    assert np.all(whole.energies[inside] > chord[inside])


@pytest.mark.slow
def test_given_weights_are_used():
    task, bound = CASES["arm"]
    front = qa.weighted_front(task, bound=bound, weights=[(1, 1), (1, 3), (0, 1), (2, 0)], starts=1)
    r, e = _scaled(front, front).T
    assert front.record.settings["weights"] == "1:1, 1:3, 0:1, 2:0"
    assert len(front.points) == 4  # the ends, and one for each pair without a 0
    middle = slice(1, -1)
    for of_residual, of_energy in ((1, 1), (1, 3)):
        values = of_residual * r + of_energy * e
        assert values[middle].min() == pytest.approx(values.min(), abs=1e-6)


def test_what_is_not_certified_has_the_place_of_its_minimum(monkeypatch):
    task, bound = CASES["arm"]
    within = qa.weighted_front(task, bound=bound, weights=[(1, 1)], starts=1).points[1]
    certify = tradeoff.certify

    def refuse(problems, solved, solver, limits, **tolerances):
        if tolerances["agreement"] == tradeoff.OF_A_PLAN:  # an end
            return certify(problems, solved, solver, limits, **tolerances)
        return ["refused"] * len(solved)

    monkeypatch.setattr(tradeoff, "certify", refuse)
    front = qa.weighted_front(task, bound=bound, weights=[(1, 1)], starts=1)
    (failure,) = front.failures
    assert failure.reason == "refused"
    assert failure.asked == {"residual_limit": pytest.approx(within.residual, rel=1e-3)}


@pytest.mark.slow_after(1)
def test_the_figures_are_those_of_the_independent_integrator(case):
    task, bound, front = case
    for point in front.points:
        motion = qa.JudgedMotion.of_profile(task, front.profile, point.coefficients).motion
        assert (point.residual, point.energy) == (motion.residual, motion.energy)
        assert np.abs(point.coefficients).max() <= bound
