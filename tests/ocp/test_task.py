"""Tasks that are valid, and what is refused when a task is made."""

import dataclasses
import math

import pytest

import quietarm as qa
from quietarm.models import JointMotion, LinearAxis
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.sample import sample_plant

LIMITS = tuple(one.limit for one in QUANTITIES.values())


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, value) for name in ("duration", "residual_window") for value in (0, -0.8)),
        *((name, value) for name in LIMITS for value in (0.0, math.nan)),
        *((name, math.inf) for name in ("start", "target", "duration", "torque_limit")),
        *(("duration", 1e-7), ("duration", 1e7), ("target", 1e7), ("start", -1e9)),
    ],
)
def test_a_number_out_of_range_is_named_with_its_value(name, value):
    task = {
        "plant": qa.SingleLinkManipulator(),
        "target": math.pi / 6,
        "duration": 0.8,
        name: value,
    }
    with pytest.raises(ValueError, match=name.replace("_", ".") + " is") as error:
        qa.PointToPoint(**task)
    assert f"{value:g}" in str(error.value)


@pytest.mark.parametrize(
    "others",
    [
        {"band": 1e-3},  # which is for a range of errors
        {"band": 1e-3, "uncertainty": None},
        {"band": 1e-3, "uncertainty": qa.Uncertainty({"frequency": 0.1})},
        {"band": 1e-3, "margin": 2.0},
        {"plant": LinearAxis(), "jerk_limit": 30.0},  # and its residual window
        {"target": 0.7, "residual_window": None},
        {"torque_speed": [(99, 0), (9, 2)]},
        {"duration": 0.9, "bounds": {"torque": 0.2}},
    ],
    ids=lambda others: ", ".join(others),
)
def test_replace_does_what_the_constructor_does(others):
    move = {"plant": qa.SingleLinkManipulator(), "target": 0.5, "duration": 0.8}
    task = dataclasses.replace(qa.PointToPoint(**move), **others)
    assert task == qa.PointToPoint(**{**move, **others})
    assert (task.band is None) or task.ranges  # a band always means a range
    assert task.certain.band is None


def test_other_ranges_have_their_own_corners():
    wide = dataclasses.replace(qa.Uncertainty({"frequency": 0.1}), ranges={"frequency": 0.2})
    assert wide == qa.Uncertainty({"frequency": 0.2})
    stated = qa.Uncertainty({"frequency": 0.1}, [(0.05,)])
    assert dataclasses.replace(stated, ranges={"frequency": 0.2}).samples == ((0.05,),)


@pytest.mark.parametrize("angle", [30, -90.0, 22.5])
def test_degrees_are_warned_of_and_several_turns_are_not(angle):
    link = qa.SingleLinkManipulator()
    with pytest.warns(UserWarning, match="more than a turn; .* give quietarm.deg") as told:
        qa.PointToPoint(link, target=angle, duration=0.8)
    assert told[0].filename == __file__
    qa.PointToPoint(link, target=math.radians(720), duration=3.0)


def test_limits_of_one_direction_and_of_the_speed():
    task = qa.PointToPoint(
        qa.ArmOnFlexibleLink(), 1.0, 0.8, acceleration_limit=[-30, 40], torque_limit=(-0.3, 0.3),
        torque_speed=[(1.5, 0), (0.8, 20)],
    )  # fmt: skip
    assert (task.acceleration_limit, task.torque_limit) == ((-30.0, 40.0), 0.3)
    words = "torque 0.3 N m", "acceleration -30 to 40 rad/s^2", "torque-speed 1.5Nm@0,0.8Nm@20"
    assert tuple(map(str, task.limits)) == words
    axis = qa.PointToPoint(
        LinearAxis(), 0.3, 0.8, torque_limit=90.0, torque_speed=[(99, 0), (9, 2)]
    )
    assert tuple(map(str, axis.limits)) == ("force 90 N", "force-speed 99N@0,9N@2")
    # 1.5 N m less 0.035 N m s of the speed: half of it at 10 rad/s is 0.575 N m, in any direction
    line = task.limits[-1].quantity.values
    for torque, speed in ((0.575, 10.0), (-0.575, 10.0), (0.575, -10.0)):
        joint = JointMotion(0.0, speed, 0.0)
        still = sample_plant(task.plant, joint, [0.0], [0.0], [0.0])
        shares = line(still._replace(torques=[torque]))
        assert max(map(abs, shares)) == pytest.approx((0.575 + 0.35) / 1.5, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"acceleration_limit": (30, 40)}, "acceleration limit is 30 to 40"),
        ({"acceleration_limit": (-1, 0, 1)}, "the least and the largest"),
        ({"torque_speed": [(1.5, 0)]}, "two points or more"),
        ({"torque_speed": [(1.5, 20), (0.8, 0)]}, "rising speed"),
        ({"torque_speed": [(0.8, 0), (1.5, 20)]}, "falls ever steeper"),
        ({"torque_speed": [(2, 0), (1, 10), (0.8, 20)]}, "falls ever steeper"),
        ({"torque_speed": [(-1, 0), (-2, 20)]}, "torque of the line"),
    ],
)
def test_bounds_that_are_none_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        qa.PointToPoint(qa.ArmOnFlexibleLink(), 1.0, 0.8, **given)


def test_a_line_of_torque_by_speed_has_a_bounded_number_of_points():
    points = [(1.0 - 1e-7 * speed**2, speed) for speed in range(5000)]
    with pytest.raises(ValueError, match="torque-speed line has 5000 points; give at most 50"):
        qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8, torque_speed=points)


@pytest.mark.parametrize("target", [1e-3, 1e-6, 1e-9])
def test_a_move_of_a_nanometre_is_a_move(target):
    # A linear plant: figures are those of a move of 1 m, times the distance, the energy its square.
    def evaluated(distance):
        return qa.evaluate_coefficients(qa.PointToPoint(qa.LinearAxis(), distance, 0.2), [0.1])

    whole = evaluated(1.0)
    small = evaluated(target)
    assert small.residual == pytest.approx(target * whole.residual, rel=1e-8)
    assert small.energy == pytest.approx(target**2 * whole.energy, rel=1e-8)
    assert small.verification.energy_share < 1e-6
