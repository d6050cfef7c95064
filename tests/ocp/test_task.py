"""What is asked: valid tasks, and what is refused when a task is made."""

import math

import pytest
from quietarm.ocp.task import LIMITS

import quietarm as qa


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
    assert "\n" not in str(error.value)
    assert f"{value:g}" in str(error.value)


@pytest.mark.parametrize("angle", [30, -90.0, 22.5])
def test_degrees_are_warned_of_and_several_turns_are_not(angle):
    link = qa.SingleLinkManipulator()
    with pytest.warns(UserWarning, match="more than a turn; .* give numpy.radians") as told:
        qa.PointToPoint(link, target=angle, duration=0.8)
    assert told[0].filename == __file__
    qa.PointToPoint(link, target=math.radians(720), duration=3.0)
