"""Mistakes that a person makes in a plant, and what `validate` says of them."""

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
    "other arguments": ({"torque": lambda p, j, W: j.acceleration}, "torque fails .*TypeError"),
    "two of one mode": (
        {"accelerations": lambda p, j, W, dW: [-W[0]] * 2},
        r"modal_accelerations returns \[.*modes = 1",
    ),
    "a mode too many": ({"tips": lambda p, W: [W[1]]}, "tip_displacements fails .*modes = 1"),
    "cubic spring": ({"accelerations": lambda p, j, W, dW: [-(W[0] ** 3)]}, "affine"),
    "curved tip": ({"tips": lambda p, W: [W[0] ** 2]}, "tip_displacements is not affine"),
    "deaf tip": ({"tips": lambda p, W: [0 * W[0]]}, "no W moves"),
    "mixed": ({"torque": lambda p, j, W, dW, ddW: j.acceleration + ca.sum1(ddW[0])}, "mixes"),
    "over the speed": (
        {"torque": lambda p, j, W, dW, ddW: j.acceleration / j.speed},
        r"torque is \S+ with the joint at",
    ),
    "gravity": (
        {"accelerations": lambda p, j, W, dW: [-W[0] - 9.81 * ca.sin(60 * j.angle)]},
        "rest",
    ),
    "stiffness pushes": (
        {"accelerations": lambda p, j, W, dW: [W[0] - j.acceleration]},
        r"grows or drifts.*exp\(1 t\)",
    ),
    "damping drives": (
        {"accelerations": lambda p, j, W, dW: [-100 * W[0] + 0.02 * dW[0]]},
        r"exp\(0.01 t\)",
    ),
    "free": ({"accelerations": lambda p, j, W, dW: [-j.acceleration]}, r"exp\(0 t\)"),
    "no torque needed": ({"torque": lambda p, j, W, dW, ddW: 0}, "no positive inertia"),
    "no modes": ({"modes": 0}, "has 0 modes"),
}


@pytest.mark.parametrize(("changes", "told"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_told_in_one_line(changes, told):
    with pytest.raises(ValueError, match=f"plant 'broken'.*{told}"):
        _plant(**changes).validate()


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"omega": 0.0}, r"grows or drifts.*exp\(0 t\)"),
        ({"zeta": -0.01}, "grows or drifts.*parameters"),
        ({"alpha1": 0.02}, r"no positive inertia.* -0\.00366 N m.*check its parameters"),
        ({"alpha2": -0.09}, "yields work from rest.*check its parameters"),
        ({"c": -0.03}, "yields work from rest"),
        ({"c": math.inf}, "parameter c is inf; give a finite number"),
        ({"c": "1"}, "parameter c is '1'; give a finite number"),
    ],
)
def test_parameters_that_no_plant_has_are_told(parameters, told):
    with pytest.raises(ValueError, match=f"single-link.*{told}"):
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
    with pytest.raises(ValueError, match="move where it is defined"):
        qa.PointToPoint(plant, 0.5, 0.8, start=-0.5)


def test_a_right_angle_between_the_samples_is_looked_at():
    def torque(p, j, W, dW, ddW):
        return j.acceleration / ca.if_else(ca.fabs(j.angle - math.pi) < 1e-9, 0.0, 1.0)

    qa.PointToPoint(_plant(torque=torque), 3.0, 0.8)
    with pytest.raises(ValueError, match=r"with the joint at 3\.142 rad"):
        qa.PointToPoint(_plant(torque=torque), 3.21, 0.8)


@pytest.mark.parametrize("name", ["validate", "parameters", "units", "tips"])
def test_what_the_checks_rely_on_is_not_overridden(name):
    with pytest.raises(TypeError, match=f"Unchecked has its own {name}, .*override the three"):
        type("Unchecked", (Sound,), {name: lambda self: {}})


@pytest.mark.parametrize(
    ("entry", "kinds"), [("joint", "'rotary' or 'linear'"), ("tip_unit", "'m' or 'rad'")]
)
def test_kinds_of_joints_and_units_of_tips_are_known(entry, kinds):
    with pytest.raises(ValueError, match=f"{entry} of Odd is 'deg'; give {kinds}"):
        type("Odd", (Sound,), {entry: "deg"})
