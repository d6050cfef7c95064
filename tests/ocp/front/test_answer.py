"""Fronts as values: selecting from them, equality, and what cannot be made."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_fronts import front, points
from quietarm.ocp import (
    non_dominated,
)

# -- selecting --


@pytest.mark.parametrize(
    ("limit", "index"), [(1e-4, 0), (1.9e-4, 0), (2e-4, 1), (7e-4, 1), (8e-4, 2), (math.inf, 2)]
)
def test_the_cheapest_within_a_residual(limit, index):
    assert front().cheapest(limit).coefficients[0] == index


@pytest.mark.parametrize("limit", [9.9e-5])
def test_a_residual_that_no_point_keeps_is_told_with_the_least_there_is(limit):
    with pytest.raises(ValueError, match=r"0\.0001"):
        front().cheapest(limit)


def _distances(one):
    """How far each point is from the line between the ends, objectives scaled to [0, 1]."""
    F = np.column_stack([one.residuals, one.energies])
    F = (F - F[-1]) / (F[0] - F[-1])  # the ends at (1, 1) and (0, 0)
    F[:, 0] = 1 - F[:, 0]  # residual rises: from (0, 1) to (1, 0)
    return (1 - F.sum(axis=1)) / math.sqrt(2)


@given(st.lists(st.tuples(st.floats(1e-6, 1e-2), st.floats(0.01, 1.0)), min_size=3, max_size=12))
def test_the_knee_is_farthest_below_the_line_between_the_ends(figures):
    one = front(non_dominated(points(*figures)))
    if len(one.points) < 3:
        assert one.knee() is one.points[0]
        return
    distance = _distances(one)
    assert distance[one.points.index(one.knee())] >= distance.max() - 1e-9


def test_the_knee_does_not_depend_on_units():
    figures = [(0.0, 1.0), (0.1, 0.6), (0.3, 0.3), (0.7, 0.05), (1.0, 0.0)]
    small = [(r * 1e-6, 5 + e * 1e3) for r, e in figures]
    assert front(points(*figures)).knee().coefficients == front(points(*small)).knee().coefficients
