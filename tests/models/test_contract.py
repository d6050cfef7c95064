"""What a person gets wrong in a plant, and what `validate` says of it.

The words that a person may rely on are the name of the method and what it should return.
"""

import math
import random
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from sound_plant import Sound

from models import Plant, SingleLinkManipulator, known_plants, parameter

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def _accelerations(plant, joint, W, dW):
    return [-W[0] - joint.acceleration]


def _told(**changes):
    """What is said of a plant with some members of `Sound` replaced."""
    plant = type("Broken", (Sound,), {"name": "broken", **changes})()
    with pytest.raises(ValueError, match="broken") as told:
        plant.validate()
    assert "\n" not in str(told.value)
    return str(told.value)


def test_the_plant_that_is_broken_here_is_sound():
    Sound().validate()


NO_SYMBOLS = {
    "math's cosine": lambda x: math.cos(x),
    "if": lambda x: 1.0 if x > 0 else -1.0,
    "max": lambda x: max(x, 0.0),
    "float": lambda x: float(x),
}
METHODS = ("modal_accelerations", "torque", "tip_displacements")


@pytest.mark.parametrize("function", NO_SYMBOLS.values(), ids=NO_SYMBOLS)
@pytest.mark.parametrize("method", ["modal_accelerations", "torque"])
def test_what_takes_no_symbols_is_told_with_its_line_and_the_remedy(method, function):
    def equation(plant, joint, W, dW, ddW=None):
        value = function(joint.speed) * joint.acceleration
        return value if method == "torque" else [-W[0] - value]

    methods = {
        "torque": lambda p, j, W, dW, ddW: equation(p, j, W, dW, ddW),
        "modal_accelerations": lambda p, j, W, dW: equation(p, j, W, dW),
    }
    told = _told(**{method: methods[method]})
    assert f"'broken': {method} fails at line " in told
    assert "of test_contract.py" in told
    assert "casadi.cos" in told
    assert "casadi.if_else" in told


@pytest.mark.parametrize("returned", [None, "torque", True, [1.0], 1j, {}], ids=repr)
def test_a_torque_that_is_no_expression_is_told(returned):
    told = _told(torque=lambda p, j, W, dW, ddW: returned)
    assert f"torque returns {'None' if returned is None else type(returned).__name__}" in told
    assert "return one expression, the joint torque [N m]" in told


@pytest.mark.parametrize("method", ["modal_accelerations", "tip_displacements"])
@pytest.mark.parametrize("kind", ["scalar", "number", "None", "text", "list of text", "nested"])
def test_what_is_no_list_of_expressions_is_told(method, kind):
    def returned(W):
        return {
            "scalar": -W[0], "number": 0.0, "None": None, "text": "W", "list of text": ["W"],
            "nested": [[-W[0]]],
        }[kind]  # fmt: skip

    changes = {
        "modal_accelerations": lambda p, j, W, dW: returned(W),
        "tip_displacements": lambda p, W: returned(W),
    }
    told = _told(**{method: changes[method]})
    assert f"'broken': {method} returns " in told
    assert "and return a list of" in told


def test_other_arguments_are_told():
    told = _told(torque=lambda p, j, W: j.acceleration)
    assert "torque takes other arguments" in told
    assert "def torque(self, joint, W, dW, ddW)" in told


def test_an_error_of_the_equations_is_told_with_its_line():
    told = _told(torque=lambda p, j, W, dW, ddW: p.stiffness * W[0])
    assert "torque fails at line " in told
    assert "AttributeError" in told
    assert "stiffness" in told


@pytest.mark.parametrize("method", METHODS)
def test_more_modes_in_one_equation_are_told(method):
    members = {
        "modal_accelerations": lambda p, j, W, dW: [-W[1]],
        "torque": lambda p, j, W, dW, ddW: ddW[1],
        "tip_displacements": lambda p, W: [W[1]],
    }
    told = _told(**{method: members[method]})
    assert f"says modes = 1 but its {method} uses more" in told


def test_entries_that_mix_the_motions_of_a_population_are_told():
    # A sum over one entry is that entry; over a column it is that of every candidate.
    told = _told(torque=lambda p, j, W, dW, ddW: j.acceleration + ca.sum1(ddW[0]))
    assert "torque mixes motions" in told
    assert "element by element" in told


def test_values_that_change_from_call_to_call_are_told():
    told = _told(torque=lambda p, j, W, dW, ddW: j.acceleration * random.random())
    assert "torque gives other values when it is called again" in told
    assert "no random number, no clock" in told


class _Own(BaseException):
    pass


def test_an_error_of_any_kind_is_told():
    def fail(p, W):
        raise _Own("of the user's")

    assert "tip_displacements fails at line " in _told(tip_displacements=fail)


# -- at rest --


@pytest.mark.parametrize(
    ("method", "equation"),
    [
        ("torque", lambda p, j, W, dW, ddW: j.acceleration / j.speed),
        ("torque", lambda p, j, W, dW, ddW: j.acceleration + ca.sqrt(j.speed)),
        ("modal_accelerations", lambda p, j, W, dW: [-W[0] - j.acceleration / j.speed]),
        ("modal_accelerations", lambda p, j, W, dW: [-W[0] / j.speed]),
    ],
    ids=["power over speed", "root of the speed", "excitation", "stiffness"],
)
def test_a_division_by_speed_is_told_with_the_motion(method, equation):
    told = _told(**{method: equation})
    assert f"'broken': {method} is " in told
    assert "rad/s" in told
    assert "divide by nothing that can be 0" in told


def test_a_slope_that_is_not_finite_at_rest_is_told():
    # d sqrt|x| / dx has no limit at 0: IPOPT would be given it.
    told = _told(torque=lambda p, j, W, dW, ddW: j.acceleration + ca.sqrt(ca.fabs(j.speed)))
    assert "the slope of torque is " in told


def test_equations_that_are_finite_nowhere_are_told():
    assert "torque is nan" in _told(torque=lambda p, j, W, dW, ddW: math.nan * j.speed)


def test_angles_that_the_equations_are_not_made_for_are_left_out():
    # A slider and crank at its dead point: finite at every other angle.
    type("Crank", (Sound,), {
        "name": "crank",
        "modal_accelerations": lambda p, j, W, dW: [-W[0] - j.acceleration / ca.sin(j.angle)],
    })().validate()  # fmt: skip


@pytest.mark.parametrize(
    "gravity",
    [
        lambda angle: ca.sin(angle - 0.7),
        lambda angle: ca.if_else(angle > 1.0, 1.0, 0.0),
        lambda angle: ca.sin(60 * angle),
    ],
    ids=["at 0.7 rad", "below 1 rad", "at every 3 degrees"],
)
def test_rest_at_some_angles_alone_is_refused(gravity):
    told = _told(modal_accelerations=lambda p, j, W, dW: [-W[0] - 9.81 * gravity(j.angle)])
    assert "does not stay at rest: with the joint at rest at" in told
    assert "modal_accelerations gives" in told


def test_rest_that_rounding_alone_breaks_is_rest():
    type("Rounded", (Sound,), {
        "name": "rounded",
        "modal_accelerations": lambda p, j, W, dW: [
            -W[0] - j.acceleration - (1 - ca.cos(j.angle) ** 2 - ca.sin(j.angle) ** 2)
        ],
    })().validate()  # fmt: skip


@pytest.mark.parametrize(
    ("acceleration", "growth"),
    [
        # W'' = W grows as exp(t); W'' = 0.02 W' - 100 W as exp(0.01 t): the real parts of the roots
        (lambda p, j, W, dW: [W[0] - j.acceleration], "exp(1 t)"),
        (lambda p, j, W, dW: [-100 * W[0] + 0.02 * dW[0]], "exp(0.01 t)"),
        (lambda p, j, W, dW: [-100 * ca.cos(j.angle) * W[0]], "exp(10 t)"),
    ],
    ids=["stiffness", "damping", "beyond a right angle"],
)
def test_an_unstable_mode_is_refused(acceleration, growth):
    told = _told(modal_accelerations=acceleration)
    assert "'broken' has an unstable mode" in told
    assert growth in told
    assert "signs" in told


@pytest.mark.parametrize("modes", [1, 2, 3])
def test_modes_that_do_not_decay_are_accepted(modes):
    # Undamped: roots on the imaginary axis.
    type("Undamped", (Sound,), {
        "name": "undamped",
        "modes": modes,
        "modal_accelerations": lambda p, j, W, dW: [
            -(100.0 + i) * W[i] - j.acceleration for i in range(modes)
        ],
    })().validate()  # fmt: skip


@pytest.mark.parametrize("modes", [1, 2])
def test_a_mode_without_stiffness_is_refused(modes):
    # The last mode is free, with both roots at zero: what it leaves is no vibration.
    told = _told(
        modes=modes,
        modal_accelerations=lambda p, j, W, dW: [
            *[-(100.0 + i) * W[i] - j.acceleration for i in range(modes - 1)], -j.acceleration
        ],
    )  # fmt: skip
    assert "'broken' has a mode without stiffness" in told
    assert "other values than 0" in told


def test_a_parameter_that_takes_the_stiffness_away_is_refused():
    with pytest.raises(ValueError, match=r"'single-link' has a mode without stiffness.*omega"):
        SingleLinkManipulator(omega=0.0).validate()


def test_a_parameter_that_hides_the_stiffness_is_refused_for_its_damping():
    # 2 zeta omega = 2.086e10 1/s beside omega^2 = 108.8 1/s^2
    with pytest.raises(ValueError, match=r"'single-link' has a mode that creeps.*2\.09e\+10 1/s"):
        SingleLinkManipulator(zeta=1e9).validate()


def test_a_tip_that_no_mode_moves_is_refused():
    with pytest.raises(ValueError, match=r"'single-link': tip displacement 1 is 0 whatever W is"):
        SingleLinkManipulator(phi=0.0).validate()


@pytest.mark.parametrize(
    "torque",
    [
        lambda p, j, W, dW, ddW: np.cos(j.angle) * j.acceleration,
        lambda p, j, W, dW, ddW: np.interp(j.angle, [0, 1], [0, 1]),
    ],
    ids=["cos", "interp"],
)
def test_functions_of_numpy_are_told_every_time(torque):
    for _ in range(2):  # casadi itself warns only once
        told = _told(torque=torque)
        assert "a function of numpy is given a symbol" in told
        assert "casadi.cos" in told


def test_a_method_that_ends_the_program_is_told():
    def torque(p, j, W, dW, ddW):
        raise SystemExit(5)

    assert "torque fails at line" in _told(torque=torque)


def test_more_modes_than_memory_holds_are_refused():
    assert "1000000000 modes; give at most 100" in _told(modes=10**9)


def test_a_parameter_that_makes_a_mode_unstable_is_refused():
    with pytest.raises(ValueError, match=r"'single-link' has an unstable mode.*parameters"):
        SingleLinkManipulator(zeta=-0.01).validate()


# -- the class --


def _equations():
    return {name: getattr(Sound, name) for name in METHODS}


def test_missing_modes_are_told():
    plant = dataclass(frozen=True)(type("NoModes", (Plant,), {"name": "x-modes", **_equations()}))
    with pytest.raises(ValueError, match=r"'x-modes' has no modes.*modes: ClassVar\[int\] = 1"):
        plant().validate()


@pytest.mark.parametrize(
    ("name", "has"),
    [
        ({}, "no name"),
        ({"name": ""}, "name ''"),
        ({"name": 3}, "name 3"),
        ({"name": "two\nlines"}, r"name 'two\nlines'"),
    ],
)
def test_a_missing_or_unreadable_name_is_told(name, has):
    plant = dataclass(frozen=True)(type("Nameless", (Plant,), {"modes": 1, **name, **_equations()}))
    with pytest.raises(ValueError, match=r"name: ClassVar\[str\]") as told:
        plant()
    assert str(told.value).startswith(f"class Nameless has {has}; ")


def test_a_name_that_is_written_as_a_parameter_is_told():
    members = {"name": "x-name", "modes": 1, "__annotations__": {"name": str}, **_equations()}
    plant = dataclass(frozen=True)(type("Field", (Plant,), members))
    with pytest.raises(ValueError, match=r"name is not a parameter.*ClassVar\[str\]"):
        plant()


def test_a_missing_dataclass_is_told():
    class Crane(Plant):
        name = "x-crane"
        modes = 1
        omega: float = parameter(3.0, "rad/s", "measured")

        def modal_accelerations(self, joint, W, dW):
            return [-(self.omega**2) * W[0] - joint.acceleration]

        def torque(self, joint, W, dW, ddW):
            return joint.acceleration

        def tip_displacements(self, W):
            return [W[0]]

    with pytest.raises(ValueError, match=r"@dataclass\(frozen=True\) above class Crane"):
        Crane().validate()


def test_a_dataclass_that_can_be_changed_is_told():
    members = {"name": "x-soft", "modes": 1, **_equations()}
    soft = dataclass(type("Soft", (Plant,), members))
    with pytest.raises(ValueError, match=r"@dataclass\(frozen=True\) above class Soft"):
        soft().validate()


@pytest.mark.parametrize("value", ["5 cm", 0.0, -0.1, True])
def test_a_small_deflection_that_is_no_length_is_told(value):
    assert "small_deflection is " in _told(small_deflection=value)


@pytest.mark.parametrize("name", ["single-link", "arm-on-flexible-link"])
def test_a_plant_of_ones_own_does_not_take_the_place_of_quietarms(name):
    before = known_plants()[name]
    with pytest.raises(ValueError, match=rf"'{name}' is that of quietarm's own .*class Mine"):
        type("Mine", (Sound,), {"name": name})
    assert known_plants()[name] is before


def test_a_class_may_be_written_again():
    # As in a notebook whose cell is run twice.
    type("Mine", (Sound,), {"name": "mine-again"})
    second = type("Mine", (Sound,), {"name": "mine-again"})
    assert known_plants()["mine-again"] is second


# -- torque --


def test_a_plant_that_takes_no_torque_is_refused():
    told = _told(torque=lambda p, j, W, dW, ddW: 0)
    assert "torque is 0 however the joint moves; write the joint's equation, and return" in told


# -- errors that have no words, and what is not awaited --


def test_an_error_without_words_is_named():
    class MuteError(Exception):
        def __str__(self):
            raise TypeError("in str")

    def fails(p, j, W, dW):
        raise MuteError

    assert "modal_accelerations fails at line" in _told(modal_accelerations=fails)


def test_a_coroutine_is_refused_and_python_does_not_warn_of_it():
    async def torque(p, j, W, dW, ddW):
        return j.acceleration

    assert "torque returns coroutine" in _told(torque=torque)
