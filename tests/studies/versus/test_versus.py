"""Plans against shapers and ruckig on the same move."""

import re
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from quietarm.models import FlexibleBeam
from quietarm.ocp import CycloidPolynomial, PointToPoint, Uncertainty
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.versus.rivals import rivals, ruckig_motion, shaped

BEAM = FlexibleBeam(omega=2 * pi * 3.2, zeta=0.01)
MOVE = PointToPoint(BEAM, pi / 3, 0.7, torque_limit=1.5, acceleration_limit=80.0)
ROBUST = replace(MOVE, uncertainty=Uncertainty({"frequency": 0.08}))


@pytest.fixture(scope="module")
def found():
    return {rival.name: rival for rival in rivals(ROBUST, CycloidPolynomial(6))}


def test_everything_that_is_used_is_there_or_says_why(found):
    expected = {"plan", "robust plan", "plain cycloid", "ruckig"}
    expected |= {f"{shaper}, {motion}" for shaper in SHAPERS for motion in ("cycloid", "ruckig")}
    assert set(found) == expected
    for rival in found.values():
        assert (rival.motion is None) == bool(rival.why)
        if rival.motion:
            assert rival.worst >= rival.motion.residual * (1 - 1e-6)
    # its impulses take two periods of 0.3125 s, and the rest is too short for 60 degrees
    why = found["3hump-ei, ruckig"].why
    assert re.fullmatch(
        r"within the limits it takes 0.\d+ s, more than the 0.\d+ s that it has", why
    )


def test_ruckig_is_followed_exactly_and_keeps_its_limits():
    task = replace(MOVE, speed_limit=2.5, jerk_limit=4000.0)
    free = ruckig_motion(task)
    angle, speed = free.boundaries(task.start)
    assert free.times[-1] == pytest.approx(0.7)
    assert angle[-1] == pytest.approx(pi / 3, abs=1e-9)
    assert speed[-1] == pytest.approx(0, abs=1e-9)
    assert np.abs(speed).max() <= 2.5 * (1 + 1e-9)
    assert np.abs(free.jerk).max() <= 4000 * (1 + 1e-9)
    with pytest.raises(ValueError, match="ruckig needs an acceleration limit"):
        ruckig_motion(replace(task, acceleration_limit=None))
    with pytest.raises(ValueError, match=r"within the limits it takes 0\.\d+ s"):
        ruckig_motion(replace(task, duration=0.1))


def test_a_shaped_motion_is_the_sum_of_its_delayed_shares():
    free = FreeMotion(np.array([0, 0.1, 0.25]), np.array([1.0, -2.0]), np.array([3.0, 0.5]))
    impulses = SHAPERS["zvd"](20.0, 0.05)
    both = shaped(free, impulses)
    assert both.times[-1] == pytest.approx(0.25 + impulses.times[-1])

    def angle_at(motion, time):
        """Angle by integrating twice what is constant or linear in pieces."""
        if time <= 0:
            return 0.0
        starts, speeds = motion.boundaries(0.0)
        k = min(np.searchsorted(motion.times, time, side="right") - 1, motion.steps)
        if k == motion.steps:
            return starts[-1] + speeds[-1] * (time - motion.times[-1])
        t = time - motion.times[k]
        jerk = motion.jerk[k]
        return starts[k] + t * (speeds[k] + t * (motion.acceleration[k] / 2 + t * jerk / 6))

    for time in np.linspace(0, both.times[-1], 37):
        parts = (
            share * angle_at(free, time - begin) for share, begin in zip(*impulses, strict=True)
        )
        assert angle_at(both, time) == pytest.approx(sum(parts), abs=1e-12)
