"""The smooth floor with a limit on the jerk."""

from dataclasses import replace

import numpy as np
import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import InfeasibleTaskError, PointToPoint, energy_floor, plan_move

# A joint beside a link that nothing excites.
RIGID = SingleLinkManipulator(alpha1=0.02, alpha2=0.0, beta1=0.0, c=0.03)
LIMIT = 1500.0
SETTINGS = {"smooth": True, "starts": 1, "tolerance": 0.02}


@pytest.fixture(scope="module")
def limited(tasks):
    """A move with less than the jerk of a plan of least energy."""
    return replace(tasks["single link"], jerk_limit=LIMIT)


@pytest.fixture(scope="module")
def floor(limited, coarse_of):
    return coarse_of(limited, **SETTINGS)


def test_the_limit_is_kept_and_no_plan_needs_less(floor, limited):
    assert floor.motion.peak_jerk == pytest.approx(LIMIT, rel=1e-3)
    assert floor.motion.peak_jerk <= LIMIT * (1 + 1e-6)
    assert floor.motion.peak_jerk == np.abs(floor.free.jerk).max()
    plan = plan_move(limited, starts=1)
    assert plan.motion.peak_jerk <= LIMIT * (1 + 1e-6)
    assert floor.energy < plan.energy


def test_the_least_jerk_of_a_rigid_joint_is_its_closed_form():
    # From rest to rest with a continuous acceleration, at rest too: +J, -J, +J for T/4, T/2, T/4
    # goes J T^3/32. Less than that is not feasible; on a grid, only a little more is.
    least = 32 * 1.5 / 1.0**3
    with pytest.raises(InfeasibleTaskError, match="jerk limit") as error:
        energy_floor(PointToPoint(RIGID, 1.5, 1.0, jerk_limit=0.9 * least), **SETTINGS)
    said = float(str(error.value).split("jerk limit ")[1].split()[0])
    assert least < said < 1.005 * least  # said with a room of 0.001
    enough = PointToPoint(RIGID, 1.5, 1.0, jerk_limit=1.05 * least)
    assert energy_floor(enough, **SETTINGS).motion.peak_jerk <= 1.05 * least * (1 + 1e-6)


def test_a_floor_whose_acceleration_jumps_refuses_a_jerk_limit(limited):
    with pytest.raises(ValueError, match="smooth"):
        energy_floor(limited)
