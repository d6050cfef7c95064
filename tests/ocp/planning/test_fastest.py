"""The shortest duration within limits."""

from dataclasses import replace
from math import pi

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    PointToPoint,
    fastest_move,
    plan_move,
)

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8, torque_limit=0.15)
SIX = CycloidPolynomial(6)


@pytest.fixture(scope="module")
def fastest():
    return fastest_move(LINK, SIX)


def test_the_plan_keeps_its_limits_and_a_shorter_one_fails(fastest):
    plan = fastest.plan
    assert plan.residual < 1e-8
    assert plan.motion.peak_torque <= 0.15 * (1 + 1e-6)
    duration, why = fastest.failed[0]
    assert fastest.duration / (1 + 1e-3) <= duration < fastest.duration
    assert "torque limit" in why
    with pytest.raises(InfeasibleTaskError):
        plan_move(replace(LINK, duration=duration), SIX)
    # and neither do others farther below it
    assert min(shorter for shorter, _ in fastest.failed) < 0.85 * fastest.duration


def test_what_has_no_shortest_duration_is_refused():
    with pytest.raises(ValueError, match="nothing limits how fast the move may be; give a"):
        fastest_move(replace(LINK, torque_limit=None))
    with pytest.raises(ValueError, match="tolerance is 0"):
        fastest_move(LINK, tolerance=0)
    # a plate whose tip may move by a hundredth of a millimetre takes far longer than its swings
    with pytest.raises(InfeasibleTaskError, match="no duration up to"):
        fastest_move(replace(LINK, duration=10.0, deflection_limit=1e-5))
