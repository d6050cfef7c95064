"""Polishing: no point gets worse, each keeps its residual, and they land on the front."""

import math

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import FrontPoint, Record, non_dominated

TASK, BOUND, PROFILE = (
    qa.PointToPoint(qa.ArmOnFlexibleLink(), math.pi / 2, 0.8),
    0.5,
    qa.CycloidPolynomial(4),
)


@pytest.fixture(scope="module")
def rough():
    """A front of random coefficients, as a search that has hardly begun."""
    random, points = np.random.default_rng(0), []
    for coefficients in random.uniform(-BOUND, BOUND, (60, PROFILE.size)):
        motion = qa.JudgedMotion.of_profile(TASK, PROFILE, coefficients).motion
        points.append(FrontPoint(tuple(coefficients.tolist()), motion.residual, motion.energy))
    return qa.Front(
        task=TASK, profile=PROFILE, points=non_dominated(points), reference=(0.015, 0.25),
        record=Record("random", {"population": 60}, BOUND, 0, 60, seconds=1.0),
    )  # fmt: skip


@pytest.fixture(scope="module")
def polish(rough):
    return qa.polish_front(rough)


@pytest.mark.slow
def test_every_point_keeps_its_residual_and_costs_no_more(rough, polish):
    assert len(polish.gains) == len(rough.points)
    for point, gain in zip(rough.points, polish.gains, strict=True):
        assert (gain.residual, gain.before) == (point.residual, point.energy)
        assert gain.after <= gain.before
        assert gain.share == pytest.approx(1 - gain.after / gain.before)
    assert max(gain.share for gain in polish.gains) > 0.1  # these were random
    assert max(polish.front.residuals) <= max(rough.residuals) * (1 + 1e-3)


def test_the_points_land_on_the_front(polish):
    whole = qa.epsilon_front(TASK, PROFILE, bound=BOUND, points=20)
    cheapest = [
        min(p.energy for p in whole.points if p.residual <= point.residual)
        for point in polish.front.points
    ]
    # the sweep's next point of smaller residual is dearer by up to a step of its front
    step = -np.diff(whole.energies).min()
    assert np.all(polish.front.energies < np.array(cheapest) * 1.002)
    assert np.all(polish.front.energies > np.array(cheapest) - 1.01 * step)


@pytest.mark.slow
def test_a_polished_front_says_by_what_it_was_found_and_polished():
    found = qa.epsilon_front(TASK, PROFILE, bound=BOUND, points=3, solver=qa.Ipopt())
    polished = qa.polish_front(found).front
    assert (polished.record.settings["solver"], polished.record.settings["polish"]) == (
        "ipopt",
        "sqp",
    )
