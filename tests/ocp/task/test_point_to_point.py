"""What is asked: valid tasks, and what is refused when a task is made."""

import math

import pytest
from quietarm.models import SingleLinkManipulator
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
