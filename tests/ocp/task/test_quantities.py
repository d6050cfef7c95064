"""The table of quantities, and that everything which lists them agrees with it."""

from dataclasses import fields

from quietarm.models import JointMotion
from quietarm.ocp import Motion, PointToPoint
from quietarm.ocp.task.quantities import QUANTITIES


def test_every_quantity_has_a_limit_in_a_task_and_a_peak_in_a_motion():
    limits = [entry.name for entry in fields(PointToPoint) if entry.name.endswith("_limit")]
    peaks = [entry.name for entry in fields(Motion) if entry.name.startswith("peak_")]
    assert sorted(limits) == sorted(quantity.limit for quantity in QUANTITIES.values())
    assert sorted(peaks) == sorted(quantity.peak for quantity in QUANTITIES.values())


def test_derivatives_of_the_joint_say_which_they_are():
    orders = {name: quantity.derivative for name, quantity in QUANTITIES.items()}
    assert orders == {
        "torque": None, "speed": 1, "acceleration": 2, "jerk": 3, "deflection": None,
    }  # fmt: skip
    for name, order in orders.items():
        assert order is None or JointMotion._fields[order] == name
