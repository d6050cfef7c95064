"""In what tasks differ, in words; what is the same within rounding."""

from dataclasses import replace
from math import pi

import pytest

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import CopperLoss, ModalState, PointToPoint, Uncertainty, task_difference

TASK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"plant": ArmOnFlexibleLink()}, "plant is arm-on-flexible-link, not single-link"),
        ({"plant": SingleLinkManipulator(zeta=0.5)}, "plant parameter zeta is 0.5, not 0.009636"),
        ({"target": 1.0}, "target is 1 rad, not 0.5235987756 rad"),
        ({"energy": CopperLoss(0.12)}, "energy is copper:0.12, not absolute"),
        ({"speed_limit": 3.0}, "speed limit is 3 rad/s, not none"),
        ({"initial": ModalState((0.005,), (0.0,))}, "initial state 1 is 0.005, not 0"),
        ({"final": ModalState((0.0,), (-0.3,))}, "final state 2 is -0.3, not 0"),
        ({"uncertainty": Uncertainty({"frequency": 0.1})}, "error of frequency is 0.1, not none"),
    ],
)
def test_a_difference_is_named(change, words):
    assert task_difference(replace(TASK, **change), TASK).startswith(words)
    assert task_difference(TASK, replace(TASK, **change))


def test_rounding_and_states_of_rest_are_no_difference():
    typed = PointToPoint(SingleLinkManipulator(), 13 / (180 / pi), 0.8)
    computed = replace(typed, target=13 * pi / 180)
    assert typed != computed
    assert task_difference(typed, computed) == ""
    assert task_difference(TASK, replace(TASK, initial=ModalState((0.0,), (0.0,)))) == ""
