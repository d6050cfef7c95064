"""What a person gets wrong in a plant, and what `validate` says of it."""

import math

import casadi as ca
import pytest
from sound_plant import Sound

import quietarm as qa

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def _plant(modes=1, accelerations=None, torque=None, tips=None, **members):
    """`Sound` with some members replaced."""
    given = {"modal_accelerations": accelerations, "torque": torque, "tip_displacements": tips}
    own = {name: method for name, method in given.items() if method is not None}
    return type("Broken", (Sound,), {"name": "broken", "modes": modes, **own, **members})()


WRONG = {
    "math": (
        {"torque": lambda p, j, W, dW, ddW: math.cos(j.speed) * j.acceleration},
        r"torque fails at line \d+ of test_contract.py.*casadi.cos",
    ),
    "if": (
        {"accelerations": lambda p, j, W, dW: [-W[0] if j.speed > 0 else -2 * W[0]]},
        "casadi.if_else",
    ),
    "other arguments": ({"torque": lambda p, j, W: j.acceleration}, "torque fails .*TypeError"),
    "no torque": ({"torque": lambda p, j, W, dW, ddW: None}, "torque returns NoneType"),
    "no list": ({"accelerations": lambda p, j, W, dW: -W[0]}, "no list"),
    "two of one mode": ({"accelerations": lambda p, j, W, dW: [-W[0]] * 2}, "modes = 1 .*2"),
    "a mode too many": ({"tips": lambda p, W: [W[1]]}, "tip_displacements fails .*modes = 1"),
    "no tip": ({"tips": lambda p, W: []}, "no tip"),
    "cubic spring": ({"accelerations": lambda p, j, W, dW: [-(W[0] ** 3)]}, "affine"),
    "product": ({"accelerations": lambda p, j, W, dW: [-W[0] - W[0] * dW[0]]}, "affine"),
    "curved tip": ({"tips": lambda p, W: [W[0] ** 2]}, "linear"),
    "mixed": ({"torque": lambda p, j, W, dW, ddW: j.acceleration + ca.sum1(ddW[0])}, "mixes"),
    "over the speed": (
        {"torque": lambda p, j, W, dW, ddW: j.acceleration / j.speed},
        r"torque is \S+ with the joint at",
    ),
    "root of the speed": (
        {"torque": lambda p, j, W, dW, ddW: j.acceleration + ca.sqrt(ca.fabs(j.speed))},
        "slope of torque",  # it has no limit at 0: a solver would be given it
    ),
    "gravity": (
        {"accelerations": lambda p, j, W, dW: [-W[0] - 9.81 * ca.sin(60 * j.angle)]},
        "rest",
    ),
    "tip offset": ({"tips": lambda p, W: [W[0] + 1e-3]}, "rest"),
    # W'' = W grows as exp(t); W'' = 0.02 W' - 100 W as exp(0.01 t): real parts of the roots
    "stiffness pushes": (
        {"accelerations": lambda p, j, W, dW: [W[0] - j.acceleration]},
        r"unstable mode.*exp\(1 t\)",
    ),
    "damping drives": (
        {"accelerations": lambda p, j, W, dW: [-100 * W[0] + 0.02 * dW[0]]},
        r"exp\(0.01 t\)",
    ),
    "unstable beyond a right angle": (
        {"accelerations": lambda p, j, W, dW: [-100 * ca.cos(j.angle) * W[0]]},
        r"exp\(10 t\)",
    ),
    "free": ({"accelerations": lambda p, j, W, dW: [-j.acceleration]}, "without stiffness"),
    "no torque needed": ({"torque": lambda p, j, W, dW, ddW: 0}, "torque is 0"),
    "no modes": ({"modes": 0}, "has 0 modes"),
}


@pytest.mark.parametrize(("changes", "told"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_told_in_one_line(changes, told):
    with pytest.raises(ValueError, match=f"plant 'broken'.*{told}") as error:
        _plant(**changes).validate()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"omega": 0.0}, "without stiffness"),
        # 2 zeta omega = 2.086e10 1/s beside omega^2 = 108.8 1/s^2
        ({"zeta": 1e9}, r"2\.09e\+10"),
        ({"zeta": -0.01}, "unstable mode.*parameters"),
        ({"phi": 0.0}, "tip displacement 1 is 0"),
        # eqs (8), (9) from rest: torque per acceleration = alpha1 - alpha2 beta1
        ({"alpha1": 0.02}, r"no positive inertia.* -0\.00366 N m.*check .*alpha1"),
        ({"alpha1": 0.0, "alpha2": 0.0}, "no positive inertia"),
        # the mode's mass is alpha2 / beta1 times the square of its shape
        ({"alpha2": -0.09}, "yields work from rest.*sign of alpha2 or beta1"),
        ({"zeta": 0.0, "beta1": -0.2, "c": 0.0}, "yields work from rest"),
        ({"c": -0.03}, "yields work from rest.*sign of c"),
    ],
)
def test_parameters_that_no_plant_has_are_told(parameters, told):
    with pytest.raises(ValueError, match=f"'single-link'.*{told}"):
        qa.SingleLinkManipulator(**parameters).validate()


@pytest.mark.parametrize(
    ("method", "changed"),
    [
        ("accelerations", lambda p, j, W, dW: [-W[0] - j.speed**2 / ca.sin(j.angle)]),
        ("torque", lambda p, j, W, dW, ddW: j.acceleration + ca.log(0.2 - j.angle)),
    ],
)
def test_equations_need_values_all_along_a_move(method, changed):
    plant = _plant(**{method: changed})
    qa.PointToPoint(plant, -0.1, 0.8, start=-0.5)
    with pytest.raises(ValueError, match="on the way"):
        qa.PointToPoint(plant, 0.5, 0.8, start=-0.5)


def test_a_right_angle_between_the_samples_is_looked_at():
    def torque(p, j, W, dW, ddW):
        return j.acceleration / ca.if_else(ca.fabs(j.angle - math.pi) < 1e-9, 0.0, 1.0)

    qa.PointToPoint(_plant(torque=torque), 3.0, 0.8)
    with pytest.raises(ValueError, match=r"with the joint at 3\.142 rad"):
        qa.PointToPoint(_plant(torque=torque), 3.21, 0.8)


def test_a_plant_must_give_its_equations():
    with pytest.raises(TypeError, match="abstract"):
        type("Empty", (qa.Plant,), {"name": "empty", "modes": 1})()


@pytest.mark.parametrize("name", ["single-link", "arm-on-flexible-link"])
def test_a_plant_of_ones_own_does_not_take_the_place_of_quietarms(name):
    before = qa.known_plants()[name]
    with pytest.raises(ValueError, match="own"):
        type("Mine", (Sound,), {"name": name})
    assert qa.known_plants()[name] is before
