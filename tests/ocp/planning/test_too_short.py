"""Durations in which not even a rigid joint gets there, refused before anything is solved."""

from dataclasses import replace

import pytest

from quietarm.models import LinearAxis
from quietarm.ocp import (
    InfeasibleTaskError,
    PointToPoint,
    epsilon_front,
    plan_move,
    weighted_front,
)
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.too_short import refuse_too_short

RIGID = 1.5 / 1.0 + 1.0 / 2.0
"""A rigid axis takes distance / speed + speed / acceleration [s]."""
AXIS = PointToPoint(LinearAxis(), 1.5, 0.9 * RIGID, speed_limit=1.0, acceleration_limit=2.0)


@pytest.mark.slow
def test_a_plan_is_refused_with_the_duration_that_will_do():
    with pytest.raises(InfeasibleTaskError, match=r"1\.8 s is too short: .* \S+ s (will|may) do$"):
        plan_move(AXIS)


def test_within_a_box_too_it_is_refused_with_a_remedy():
    with pytest.raises(InfeasibleTaskError, match=r"give a longer duration or wider limits$"):
        plan_move(AXIS, bound=0.2)


def test_a_limit_that_is_far_too_small_asks_for_its_unit():
    with pytest.raises(InfeasibleTaskError, match=r"wider limits; were other units meant\?$"):
        refuse_too_short(replace(AXIS, speed_limit=1e-9))


@pytest.mark.parametrize("find", [epsilon_front, weighted_front])
def test_fronts_are_refused_alike(find):
    with pytest.raises(InfeasibleTaskError, match="even a rigid joint takes 2 s"):
        find(AXIS)


def test_nothing_is_refused_that_is_short_by_less_than_a_plan_may_pass_its_limits():
    refuse_too_short(replace(AXIS, duration=RIGID / (1 + 0.9 * OVERRUN)))
    with pytest.raises(InfeasibleTaskError):
        refuse_too_short(replace(AXIS, duration=RIGID / (1 + 1.1 * OVERRUN)))
