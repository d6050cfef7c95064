"""How many terms a plan takes where nobody says it: measured in benchmarks/terms.py."""

from math import pi, radians

import pytest
from quietarm.models import DualLinkManipulator, FlexibleBeam, SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    PointToPoint,
    evaluate_coefficients,
    fastest_move,
    plan_move,
    plan_moves,
    shaped_cycloid,
)

pytestmark = pytest.mark.slow

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8)
BEAM = PointToPoint(
    FlexibleBeam(omega=6 * 2 * pi, zeta=0.015), radians(30), 0.8, acceleration_limit=60.0
)


def test_within_limits_a_plan_takes_more_terms_and_says_what_six_cost():
    plan, six = plan_move(BEAM, starts=1), plan_move(BEAM, CycloidPolynomial(6), starts=1)
    said = plan.record.settings
    assert said["chosen_terms"] == plan.profile.size > 6
    assert said["energy_of_six_terms"] == pytest.approx(six.energy, rel=1e-4)
    # 0.0162 J is what `plan --profile free` finds for this move
    assert plan.energy < 1.08 * 0.0162
    assert plan.energy < evaluate_coefficients(BEAM, [], profile=shaped_cycloid(BEAM, "zv")).energy


def test_six_stay_without_limits_and_given_terms_are_kept():
    assert plan_move(LINK, starts=1).profile == CycloidPolynomial(6)
    limited = PointToPoint(DualLinkManipulator(), pi / 2, 0.9, speed_limit=4.0)
    assert plan_move(limited, CycloidPolynomial(5), starts=1).profile.size == 5
    assert plan_move(limited, guess=[0.0] * 6, starts=1).profile.size == 6


def test_many_moves_choose_as_one_does():
    shorter = PointToPoint(BEAM.plant, BEAM.target, 0.7, acceleration_limit=60.0)
    assert plan_moves([BEAM, shorter]).profile == plan_move(BEAM, starts=1).profile


def test_more_terms_are_faster():
    limited = PointToPoint(LINK.plant, LINK.target, 0.8, torque_limit=0.2)
    found = fastest_move(limited, tolerance=1e-2)
    said = found.plan.record.settings
    assert found.duration < 0.95 * said["duration_of_six_terms"]
    assert found.plan.residual < 1e-8
    assert found.plan.motion.peak_torque <= 0.2 * (1 + 1e-6)
