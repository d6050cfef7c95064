"""Fronts of an uncertain plant: what a point claims holds between the samples as well."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import quietarm as qa

RANGE, POINTS = 0.15, 3
PROFILE = qa.CycloidPolynomial(4)


@pytest.fixture(scope="module")
def task():
    uncertainty = qa.Uncertainty({"frequency": RANGE})
    return qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def at_samples(task):
    return qa.epsilon_front(task, PROFILE, points=POINTS, starts=1, between=False)


@pytest.fixture(scope="module")
def front(task):
    return qa.epsilon_front(task, PROFILE, points=POINTS, starts=1)


def worst(front, point):
    """By CVODES on errors beside the grid that the front's own search looks at."""
    task = front.task.certain
    return max(
        qa.Candidate.of_profile(
            replace(task, plant=qa.perturb_plant(task.plant, {"frequency": error})),
            front.profile,
            point.coefficients,
        ).residual
        for error in RANGE * np.linspace(-1, 1, 14)
    )


def test_no_point_leaves_more_between_the_samples_than_it_states(front):
    assert front.excess <= 0.05
    for point in front.points:
        assert worst(front, point) <= point.residual * (1 + front.excess + 1e-4)


def test_with_the_first_samples_alone_points_leave_more(at_samples, task):
    # else the test above tests nothing
    assert at_samples.task == task
    assert at_samples.excess is None
    assert max(worst(at_samples, one) / one.residual for one in at_samples.points) > 1.05


def test_a_weighted_sum_holds_as_well(task):
    front = qa.weighted_front(task, PROFILE, weights=[(1, 1)], starts=1)
    assert front.excess <= 0.05
    for point in front.points:
        assert worst(front, point) <= point.residual * (1 + front.excess + 1e-4)


def test_a_polished_front_holds_as_well(front):
    polished = qa.polish_front(replace(front, points=front.points[1:2])).front
    for point in polished.points:
        assert worst(polished, point) <= point.residual * (1 + polished.excess + 1e-4)
