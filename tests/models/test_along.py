"""Equations along a move: they must have values at every angle of it."""

import math

import casadi as ca
import pytest
from sound_plant import Sound

from models.contract.along import check_along

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


@pytest.mark.parametrize(
    ("method", "changed"),
    [
        ("modal_accelerations", lambda p, j, W, dW: [-W[0] - j.acceleration / ca.sin(j.angle)]),
        ("torque", lambda p, j, W, dW, ddW: j.acceleration + ca.log(0.2 - j.angle)),
    ],
)
def test_equations_need_values_all_along_a_move(method, changed):
    plant = type("Partly", (Sound,), {"name": "partly", method: changed})()
    plant.validate()  # somewhere it has values
    check_along(plant, -0.5, -0.1)
    with pytest.raises(ValueError, match=rf"'partly': {method} is \S+ with the joint at ") as told:
        check_along(plant, -0.5, 0.5)
    assert "on the way from -0.5 to 0.5 rad; move where its equations hold, or check" in str(
        told.value
    )


def test_a_right_angle_between_the_samples_is_looked_at():
    plant = type("Tangent", (Sound,), {
        "name": "tangent",
        "torque": lambda p, j, W, dW, ddW: j.acceleration / ca.if_else(
            ca.fabs(j.angle - math.pi) < 1e-9, 0.0, 1.0
        ),
    })()  # fmt: skip
    check_along(plant, 0.0, 3.0)
    with pytest.raises(ValueError, match=r"with the joint at 3\.142 rad"):
        check_along(plant, 0.0, 3.21)
