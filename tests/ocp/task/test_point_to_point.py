"""What is asked: valid tasks, and what is refused when a task is made."""

import math

import numpy as np
import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import PointToPoint
from quietarm.ocp.task.point_to_point import LIMITS

PLANT = SingleLinkManipulator()


def _task(**changes):
    return PointToPoint(**{"plant": PLANT, "target": math.pi / 6, "duration": 0.8, **changes})


def _refused(name, value, **changes):
    """The message of the ValueError; one line that names the quantity and the value."""
    with pytest.raises(ValueError, match=name) as error:
        _task(**changes)
    message = str(error.value)
    assert "\n" not in message
    assert (f"{value:g}" if type(value) in (int, float) else str(value)) in message
    return message


def test_a_task_starts_at_zero_without_limits_and_watches_one_second():
    # Section 3.1: theta_S = 0; eq (11): one second after the positioning.
    task = _task()
    assert (task.start, task.residual_window, task.limits) == (0.0, 1.0, {})


def test_span_and_move():
    task = _task(start=-math.pi / 2, target=math.pi / 4, duration=1.0)
    assert task.span == pytest.approx(3 * math.pi / 4)
    assert task.move == (-math.pi / 2, math.pi / 4, 1.0)


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_that_is_set_is_listed_by_its_quantity(name):
    assert _task(**{name: 0.3}).limits == {name.removesuffix("_limit"): 0.3}


@pytest.mark.parametrize("kind", [int, np.float64, np.float32, np.int64])
def test_every_kind_of_number_becomes_a_float(kind):
    task = _task(start=kind(1), target=kind(2), duration=kind(3), torque_limit=kind(4))
    numbers = (task.start, task.target, task.duration, task.torque_limit)
    assert numbers == (1.0, 2.0, 3.0, 4.0)
    assert {type(number) for number in numbers} == {float}


def test_tasks_are_equal_by_value():
    assert _task() == _task()
    assert _task() != _task(duration=0.9)
    assert _task() != _task(plant=ArmOnFlexibleLink())
    assert hash(_task(duration=1)) == hash(_task(duration=1.0))


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
    _refused(name.replace("_", ".") + " is", value, **{name: value})


@pytest.mark.parametrize("span", [1e-300, -9e-7])
def test_a_move_too_short_to_be_integrated_is_named(span):
    _refused("target - start is", span, target=span)


@pytest.mark.parametrize("angle", [0.0, math.pi / 6, -1])
def test_a_target_equal_to_the_start_is_named(angle):
    _refused("target equals start", float(angle), start=angle, target=float(angle))


@pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")
def test_a_plant_that_breaks_its_contract_is_refused():
    cubic = {"name": "cubic", "modal_accelerations": lambda plant, joint, W, dW: [-(W[0] ** 3)]}
    with pytest.raises(ValueError, match=r"'cubic'.*not affine"):
        _task(plant=type("Cubic", (SingleLinkManipulator,), cubic)())


def test_a_move_through_angles_without_values_is_refused():
    # 1 + alpha1 cos(theta) divides, and is 0 at 0 rad
    plant = ArmOnFlexibleLink(alpha1=-1.0)
    assert PointToPoint(plant, 1.5, 0.8, start=0.5).plant == plant
    with pytest.raises(ValueError, match=r"modal_accelerations is \S+ with the joint at 0 rad"):
        PointToPoint(plant, 1.5, 0.8)
