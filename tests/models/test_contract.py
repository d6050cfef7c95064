"""What a person gets wrong in a plant, and what `validate` says of it."""

import math

import casadi as ca
import numpy as np
import pytest
from quietarm.models import Plant, SingleLinkManipulator, known_plants
from quietarm.ocp import PointToPoint
from sound_plant import Sound

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def _plant(modes=1, accelerations=None, torque=None, tips=None, **members):
    """`Sound` with some members replaced."""
    given = {"modal_accelerations": accelerations, "torque": torque, "tip_displacements": tips}
    own = {name: method for name, method in given.items() if method is not None}
    return type("Broken", (Sound,), {"name": "broken", "modes": modes, **own, **members})()


def _torque(equation):
    return {"torque": lambda p, j, W, dW, ddW: equation(j, W, ddW)}


def _mode(equation):
    return {"accelerations": lambda p, j, W, dW: [equation(j, W[0], dW[0])]}


WRONG = {
    # equations that cannot be called as the program calls them
    "math": (_torque(lambda j, W, ddW: math.cos(j.speed)), r"fails at line .*casadi.cos"),
    "if": (_mode(lambda j, W, dW: -W if j.speed > 0 else -2 * W), r"fails at line .*if_else"),
    "numpy": (_torque(lambda j, W, ddW: np.cos(j.angle)), r"numpy.*casadi.cos"),
    "jerk": (_mode(lambda j, W, dW: -W - 0.4 * j.jerk), "modal_accelerations fails .*NoneType"),
    "other arguments": (
        {"torque": lambda p, j, W: j.acceleration},
        r"write def torque\(self, joint, W, dW, ddW\), and return one",
    ),
    # what they return
    "no torque": (_torque(lambda j, W, ddW: None), "torque returns NoneType"),
    "no list": ({"accelerations": lambda p, j, W, dW: -W[0]}, "returns no list; .* a list of W''"),
    "one of two modes": (_mode(lambda j, W, dW: -W) | {"modes": 2}, "modes = 2 but gives 1 modal"),
    "a mode too many": ({"tips": lambda p, W: [W[1]]}, "tip_displacements fails .*IndexError"),
    "no tip": ({"tips": lambda p, W: []}, "no tip displacement; return 1 or more"),
    # what they say
    "cubic spring": (_mode(lambda j, W, dW: -(W**3)), "not affine in W and W'; linearise"),
    "product": (_mode(lambda j, W, dW: -W - W * dW), "not affine"),
    "curved tip": ({"tips": lambda p, W: [W[0] ** 2]}, "tip displacement is not linear in W"),
    "mixed": (_torque(lambda j, W, ddW: j.acceleration + ca.sum1(ddW[0])), "element by element"),
    "over the speed": (
        _torque(lambda j, W, ddW: j.acceleration / j.speed),
        r"torque is \S+ with the joint at .* rad/s .*divide by nothing that can be 0",
    ),
    "root of the speed": (
        _torque(lambda j, W, ddW: j.acceleration + ca.sqrt(ca.fabs(j.speed))),
        "the slope of torque is",  # it has no limit at 0: a solver would be given it
    ),
    "finite nowhere": (_torque(lambda j, W, ddW: math.nan * j.speed), "torque is nan"),
    "gravity": (
        _mode(lambda j, W, dW: -W - 9.81 * ca.sin(60 * j.angle)),
        "does not stay at rest: .* modal_accelerations gives .* not 0; measure W from the static",
    ),
    "tip offset": ({"tips": lambda p, W: [W[0] + 1e-3]}, "does not stay at rest"),
    # W'' = W grows as exp(t); W'' = 0.02 W' - 100 W as exp(0.01 t): real parts of the roots
    "stiffness pushes": (
        _mode(lambda j, W, dW: W - j.acceleration),
        r"exp\(1 t\); check the signs",
    ),
    "damping drives": (_mode(lambda j, W, dW: -100 * W + 0.02 * dW), r"exp\(0.01 t\)"),
    "unstable beyond a right angle": (
        _mode(lambda j, W, dW: -100 * ca.cos(j.angle) * W),
        r"exp\(10 t\)",
    ),
    "free": (_mode(lambda j, W, dW: -j.acceleration), "mode without stiffness: .* such as omega"),
    "no torque needed": (_torque(lambda j, W, ddW: 0), "torque is 0 however the joint moves"),
    "no modes": ({"modes": 0}, r"has 0 modes; write .* modes: ClassVar\[int\] = 1"),
}


@pytest.mark.parametrize(("changes", "told"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_told_in_one_line(changes, told):
    with pytest.raises(ValueError, match=f"plant 'broken'.*{told}") as error:
        _plant(**changes).validate()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"omega": 0.0}, "mode without stiffness.*omega"),
        # 2 zeta omega = 2.086e10 1/s beside omega^2 = 108.8 1/s^2
        ({"zeta": 1e9}, r"mode without stiffness: .* damping of 2\.09e\+10 1/s"),
        ({"zeta": -0.01}, "unstable mode.*parameters"),
        ({"phi": 0.0}, "tip displacement 1 is 0 whatever W is"),
    ],
)
def test_parameters_that_no_plant_has_are_told(parameters, told):
    with pytest.raises(ValueError, match=f"'single-link'.*{told}"):
        SingleLinkManipulator(**parameters).validate()


# -- along a move --


@pytest.mark.parametrize(
    ("method", "changed"),
    [
        ("accelerations", lambda p, j, W, dW: [-W[0] - j.acceleration / ca.sin(j.angle)]),
        ("torque", lambda p, j, W, dW, ddW: j.acceleration + ca.log(0.2 - j.angle)),
    ],
)
def test_equations_need_values_all_along_a_move(method, changed):
    plant = _plant(**{method: changed})
    PointToPoint(plant, -0.1, 0.8, start=-0.5)
    with pytest.raises(ValueError, match=r"on the way from -0.5 to 0.5 rad; move where its equat"):
        PointToPoint(plant, 0.5, 0.8, start=-0.5)


def test_a_right_angle_between_the_samples_is_looked_at():
    def torque(p, j, W, dW, ddW):
        return j.acceleration / ca.if_else(ca.fabs(j.angle - math.pi) < 1e-9, 0.0, 1.0)

    PointToPoint(_plant(torque=torque), 3.0, 0.8)
    with pytest.raises(ValueError, match=r"with the joint at 3\.142 rad"):
        PointToPoint(_plant(torque=torque), 3.21, 0.8)


# -- the class --


def test_a_plant_must_give_its_equations():
    with pytest.raises(TypeError, match="abstract"):
        type("Empty", (Plant,), {"name": "empty", "modes": 1})()


@pytest.mark.parametrize("name", ["single-link", "arm-on-flexible-link"])
def test_a_plant_of_ones_own_does_not_take_the_place_of_quietarms(name):
    before = known_plants()[name]
    with pytest.raises(ValueError, match=rf"'{name}' is that of quietarm's own .*class Mine"):
        type("Mine", (Sound,), {"name": name})
    assert known_plants()[name] is before
