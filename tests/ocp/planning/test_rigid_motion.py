"""The rigid joint's time-optimal motion, against closed forms."""

from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest

from quietarm.models import ArmOnFlexibleLink, LinearAxis, SingleLinkManipulator
from quietarm.ocp import PointToPoint
from quietarm.ocp.planning.rigid_motion import (
    RigidBounds,
    assumed_bounds,
    declared_bounds,
    largest_deflection,
    rigid_motion,
)


def test_a_trapezoid_of_speed():
    motion = rigid_motion(1.5, RigidBounds(1.0, 2.0, 2.0))
    assert motion.duration == pytest.approx(1.5 / 1.0 + 1.0 / 2.0)
    assert motion.switches == pytest.approx((0.0, 0.5, 1.5, 2.0))


def test_a_triangle_of_unequal_slopes():
    motion = rigid_motion(0.5, RigidBounds(inf, 0.4, 0.2))
    assert motion.duration == pytest.approx(sqrt(2 * 0.5 * (1 / 0.4 + 1 / 0.2)))


def test_jerk_alone():
    # four equal pieces: span = 2 jerk t^3 with t a quarter of the duration
    motion = rigid_motion(1e-3, RigidBounds(rising=100.0, falling=100.0))
    assert motion.duration == pytest.approx(4 * (1e-3 / (2 * 100.0)) ** (1 / 3))


def test_jerk_acceleration_and_speed():
    # the seven pieces of the usual S-curve
    motion = rigid_motion(10.0, RigidBounds(2.0, 1.0, 1.0, 4.0, 4.0))
    assert motion.duration == pytest.approx(10 / 2.0 + 2.0 / 1.0 + 1.0 / 4.0)
    assert len(motion.switches) == 8


def test_unequal_jerks_end_at_the_target():
    rising, falling = 5.0, 2.0
    motion = rigid_motion(1.0, RigidBounds(inf, inf, inf, rising, falling))
    jerks = [rising, -falling, -falling, rising]
    angle = speed = acceleration = 0.0
    # the acceleration is never held, so that two switches each are one
    times = np.unique(np.round(motion.switches, 12))
    for jerk, time in zip(jerks, np.diff(times), strict=True):
        angle += time * (speed + time * (acceleration / 2 + time * jerk / 6))
        speed += time * (acceleration + time * jerk / 2)
        acceleration += time * jerk
    assert (angle, speed, acceleration) == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)


def test_speed_alone_and_nothing():
    assert rigid_motion(3.0, RigidBounds(0.5)).duration == pytest.approx(6.0)
    with pytest.raises(ValueError, match="nothing limits the rigid joint"):
        rigid_motion(3.0, RigidBounds())


def test_bounds_are_those_of_the_moves_direction():
    task = PointToPoint(LinearAxis(), 1.0, 1.0, speed_limit=(-0.2, 0.5), jerk_limit=(-3.0, 7.0))
    there = declared_bounds(task)
    back = declared_bounds(replace(task, start=1.0, target=0.0))
    assert (there.speed, there.rising, there.falling) == (0.5, 7.0, 3.0)
    assert (back.speed, back.rising, back.falling) == (0.2, 3.0, 7.0)


def test_a_force_is_an_acceleration_of_all_that_moves():
    plant = LinearAxis(mass=8.0, friction=5.0)
    bounds = assumed_bounds(PointToPoint(plant, 1.0, 1.0, torque_limit=16.0))
    assert bounds.speeding_up == pytest.approx(2.0)  # 16 N / 8 kg
    assert bounds.speed == pytest.approx(3.2)  # at which friction takes all of it


def test_a_deflection_is_the_acceleration_that_holds_it():
    plant = SingleLinkManipulator()
    task = PointToPoint(plant, pi / 6, 0.8, deflection_limit=1e-3)
    # eq (9) at rest: W = -beta1 theta'' / omega^2; 2.28 of it at the tip
    static = plant.phi * plant.beta1 / plant.omega**2
    assert largest_deflection(task) == pytest.approx(static)
    assert assumed_bounds(task).braking == pytest.approx(1e-3 / static)


def test_a_plant_that_changes_with_its_angle_counts_where_it_bends_most():
    task = PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8, deflection_limit=1e-3)
    straight = PointToPoint(ArmOnFlexibleLink(), 1e-3, 0.8, deflection_limit=1e-3)
    assert largest_deflection(task) >= largest_deflection(straight) > 0
