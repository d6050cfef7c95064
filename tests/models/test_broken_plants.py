"""A plant that breaks its contract is refused."""

import casadi as ca
import numpy as np
import pytest
from sound_plant import Sound

from models import Plant, SingleLinkManipulator

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


# -- the contract --


def _broken(**changes):
    """A class of plants with some of `Sound`'s members replaced."""
    return type("Broken", (Sound,), {"name": "broken", **changes})()


def test_a_plant_must_give_its_equations():
    with pytest.raises(TypeError, match="abstract"):
        type("Empty", (Plant,), {"name": "empty", "modes": 1})()


@pytest.mark.parametrize(
    "acceleration",
    [
        pytest.param(lambda p, j, W, dW: [-(W[0] ** 3)], id="cubic spring"),
        pytest.param(lambda p, j, W, dW: [-W[0] - dW[0] * ca.fabs(dW[0])], id="quadratic damping"),
        pytest.param(lambda p, j, W, dW: [-W[0] - W[0] * dW[0]], id="product"),
        pytest.param(lambda p, j, W, dW: [-ca.sin(W[0]) - j.acceleration], id="sine"),
    ],
)
def test_modes_that_are_not_linear_are_refused(acceleration):
    with pytest.raises(ValueError, match=r"'broken'.*not affine in W and W'"):
        _broken(modal_accelerations=acceleration).validate()


def test_a_structure_that_only_a_moving_joint_excites_is_accepted():
    _broken(
        modal_accelerations=lambda p, j, W, dW: [
            -W[0] - ca.cos(j.angle) * j.acceleration - ca.sin(j.angle) * j.speed**2 - j.speed
        ]
    ).validate()


def test_time_varying_modes_are_linear_enough():
    _broken(
        modal_accelerations=lambda p, j, W, dW: [
            -(1 + j.speed**2) * W[0] - (1 + ca.sin(j.angle)) * dW[0] - j.acceleration
        ]
    ).validate()


@pytest.mark.parametrize(("modes", "given"), [(1, 2), (2, 1), (2, 3)])
def test_the_wrong_number_of_modes_is_refused(modes, given):
    def accelerations(p, j, W, dW):
        return [-W[0]] * given

    with pytest.raises(ValueError, match=rf"modes = {modes} but gives {given}"):
        _broken(modes=modes, modal_accelerations=accelerations).validate()


def test_equations_of_more_modes_than_the_plant_says_are_refused():
    def accelerations(p, j, W, dW):
        return [-W[0] + W[1]]

    with pytest.raises(ValueError, match=r"broken.*mode"):
        _broken(modal_accelerations=accelerations).validate()


def test_a_plant_without_modes_is_refused():
    nothing = {"modal_accelerations": lambda p, j, W, dW: [], "tip_displacements": lambda p, W: []}
    with pytest.raises(ValueError, match=r"broken.*mode"):
        _broken(modes=0, **nothing).validate()


def test_a_plant_without_a_tip_is_refused():
    with pytest.raises(ValueError, match=r"broken.*tip"):
        _broken(tip_displacements=lambda p, W: []).validate()


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"torque": property(lambda p: 1)}, "torque is a property, which cannot be called; write"),
        ({"torque": 3}, "torque is a int, which cannot be called"),
        ({"parameters": 3}, "has parameters of its own, a name that Plant needs; call it other"),
        ({"tip_displacements": lambda p, W: [W[0]] * 101}, "has 101 tip .* give at most 100"),
    ],
)
def test_members_that_are_no_methods_or_too_many_are_refused(changes, told):
    with pytest.raises(ValueError, match=f"plant 'broken':? {told}"):
        _broken(**changes).validate()


def test_a_tip_that_is_not_linear_is_refused():
    with pytest.raises(ValueError, match=r"'broken'.*tip displacement is not linear"):
        _broken(tip_displacements=lambda p, W: [W[0] ** 2]).validate()


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param(
            {"modal_accelerations": lambda p, j, W, dW: [-W[0] - 9.81 * ca.sin(j.angle)]},
            id="gravity",
        ),
        pytest.param(
            {"modal_accelerations": lambda p, j, W, dW: [-W[0] - 9.81 * ca.cos(j.angle)]},
            id="gravity across",
        ),
        pytest.param({"modal_accelerations": lambda p, j, W, dW: [1e-6 - W[0]]}, id="preload"),
        pytest.param(
            {
                "modes": 2,
                "modal_accelerations": lambda p, j, W, dW: [-W[0], -W[1] - ca.sin(j.angle)],
            },
            id="gravity on one mode of two",
        ),
        pytest.param({"tip_displacements": lambda p, W: [W[0] + 1e-3]}, id="tip offset"),
    ],
)
def test_a_structure_that_does_not_stay_at_rest_is_refused(changes):
    with pytest.raises(ValueError, match="'broken' does not stay at rest"):
        _broken(**changes).validate()


def _writing(W):
    W[0] = 2 * W[0]
    return W[0]


def _recursing(p, j, W, dW):
    return p.modal_accelerations(j, W, dW)


@pytest.mark.parametrize(
    ("method", "equation", "told"),
    [
        (
            "modal_accelerations",
            lambda p, j, W, dW: [-_writing(W) - j.acceleration],
            "modal_accelerations writes into W; leave W as it is",
        ),
        (
            "modal_accelerations",
            lambda p, j, W, dW: [-W[0] - _writing(dW) - j.acceleration],
            "modal_accelerations writes into dW; leave dW as it is",
        ),
        (
            "torque",
            lambda p, j, W, dW, ddW: j.acceleration + _writing(W),
            "torque writes into W; leave W as it is",
        ),
        (
            "modal_accelerations",
            lambda p, j, W, dW: [-W[0] - 0.4 * j.jerk],
            "write it with joint.angle, joint.speed and joint.acceleration: joint.jerk is None",
        ),
        ("modal_accelerations", _recursing, "it calls itself without end: compute it"),
        (
            "modal_accelerations",
            lambda p, j, W, dW: [-W[0] - 1j * j.acceleration],
            "write it with real numbers",
        ),
    ],
)
def test_a_fault_is_told_with_what_helps(method, equation, told):
    with pytest.raises(ValueError, match=f"'broken': {method}") as error:
        _broken(**{method: equation}).validate()
    assert told in str(error.value)


def test_a_parameter_in_single_precision_is_taken_without_a_warning():
    assert SingleLinkManipulator(omega=np.float32(9)).omega == 9.0
