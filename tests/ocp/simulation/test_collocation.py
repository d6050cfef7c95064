"""One step of the modes: nodes and weights, the collocation conditions, order, closed forms."""

import math

import numpy as np
import pytest
from quietarm.ocp.simulation.collocation import (
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    NODES,
    mesh,
)

# -- the quadrature --


@pytest.mark.parametrize("power", range(2 * NODES))
def test_the_weights_integrate_up_to_degree_five_exactly(power):
    integral = sum(w * x**power for w, x in zip(GAUSS_WEIGHTS, GAUSS_NODES, strict=True))
    assert integral == pytest.approx(1 / (power + 1), abs=1e-15)


# -- the steps --


def test_the_steps_are_finer_at_the_ends_and_the_same_from_both():
    lengths = np.array([float(mesh(k, 100)[1]) for k in range(100)])
    assert lengths == pytest.approx(lengths[::-1], rel=1e-9)
    assert np.all(np.diff(lengths[:50]) > 0)
    # Half even, half Chebyshev: 1/2 + pi/4 times the even length in the middle, 1/2 at the ends.
    assert lengths[50] == pytest.approx((1 / 2 + math.pi / 4) / 100, rel=1e-3)
    assert lengths[0] == pytest.approx(1 / 2 / 100, rel=0.05)
