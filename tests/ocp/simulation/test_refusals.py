"""Numbers that no simulation can take are named, with what to give instead."""

import math

import pytest

import quietarm as qa
from quietarm.ocp.simulation.mesh import default_steps

TASK = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)
PROFILE = qa.CycloidPolynomial(2)
FAST = qa.PointToPoint(qa.SingleLinkManipulator(omega=1e4), math.pi / 6, 1.0001, residual_window=1)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (
            lambda: qa.JudgedMotion.of_profile(TASK, PROFILE, [0.1]).motion,
            r"got 1 coefficients for a profile of 2",
        ),
        (
            lambda: qa.JudgedMotion.of_profile(TASK, PROFILE, [0.1, math.nan]).motion,
            r"coefficient 2 is nan",
        ),
        (lambda: default_steps(FAST), r"1e\+04 radians .* resolves up to 10000"),
    ],
)
def test_a_number_that_cannot_be_is_named(ask, said):
    with pytest.raises(ValueError, match=said):
        ask()
