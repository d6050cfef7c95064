"""Which points stay in a front."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from made_fronts import points
from quietarm.ocp import (
    non_dominated,
)

# -- which points stay --

values = st.one_of(
    st.floats(0, 1),
    st.sampled_from([0.0, -0.0, 0.25, 0.5, math.nan, math.inf, -math.inf, 5e-324, 1e308]),
)


def _by_definition(given_points):
    """Finite, no other at least as good in both and better in one, and the first of its equals."""
    finite = [p for p in given_points if math.isfinite(p.residual) and math.isfinite(p.energy)]

    def beats(one, other):
        no_worse = one.residual <= other.residual and one.energy <= other.energy
        return no_worse and (one.residual, one.energy) != (other.residual, other.energy)

    kept = []
    for i, p in enumerate(finite):
        equal_before = any((p.residual, p.energy) == (q.residual, q.energy) for q in finite[:i])
        if not equal_before and not any(beats(q, p) for q in finite):
            kept.append(p)
    return kept


@given(st.lists(st.tuples(values, values), max_size=25))
def test_the_points_that_stay_are_those_of_the_definition(figures):
    given_points = points(*figures)
    kept = non_dominated(given_points)
    expected = _by_definition(given_points)
    # by their first coefficient, which tells points of equal figures apart
    assert sorted(p.coefficients for p in kept) == sorted(p.coefficients for p in expected)
    residuals, energies = ([getattr(p, name) for p in kept] for name in ("residual", "energy"))
    assert np.all(np.diff(residuals) > 0)
    assert np.all(np.diff(energies) < 0)


def test_of_equal_points_the_first_stays():
    given_points = points((1.0, 1.0), (1.0, 1.0), (2.0, 0.5), (2.0, 0.5))
    assert non_dominated(given_points) == (given_points[0], given_points[2])
    assert non_dominated(iter(given_points)) == (given_points[0], given_points[2])
