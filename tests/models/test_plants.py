"""The plants: the paper's equations, parameters, names."""

import sys
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sound_plant import Sound
from third_opinion import EQUATIONS, PHI

import quietarm as qa
from quietarm import models
from quietarm.models import JointMotion, known_plants
from quietarm.models.dimensions import ACCELERATION

motions = st.floats(-10.0, 10.0)
"""Angles, speeds, accelerations, amplitudes and rates: larger than any in the paper's figures."""

states = st.tuples(motions, motions)
PLANTS = {
    "single link": qa.SingleLinkManipulator(),
    "arm": qa.ArmOnFlexibleLink(),
    "two links": qa.DualLinkManipulator(),
}

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


@pytest.fixture(params=PLANTS)
def plant(request):
    return PLANTS[request.param]


def test_mode_shapes_at_the_tips():
    # docs/physics.md: 2.28 from the paper's 'about 7.7 cm' over max |W| = 0.03382 m, 0.508 from
    # beta3/(M lbar) with M = 0.450 kg, lbar = 0.105 m.
    assert qa.SingleLinkManipulator().phi == pytest.approx(0.077 / 0.03382, abs=0.005)
    assert qa.ArmOnFlexibleLink().phi == pytest.approx(2.399e-2 / (0.450 * 0.105), abs=0.0005)


@pytest.mark.parametrize("name", PLANTS)
@given(angle=motions, speed=motions, acceleration=motions, W=states, dW=states)
def test_a_plant_meets_its_equations(name, angle, speed, acceleration, W, dW):
    # eqs (8) and (9), (13) and (14), and docs/physics.md, typed afresh with their coefficients
    plant, modes = PLANTS[name], PLANTS[name].modes
    (W, dW), joint = (np.array([W, dW])[:, :modes]), JointMotion(angle, speed, acceleration)
    ddW, torque = EQUATIONS[name](angle, speed, acceleration, W, dW)
    found = [float(x) for x in plant.modal_accelerations(joint, W, dW)]
    assert found == pytest.approx(np.ravel(ddW).tolist(), rel=1e-12, abs=1e-11)
    assert float(plant.torque(joint, W, dW, found)) == pytest.approx(
        float(torque), rel=1e-12, abs=1e-11
    )
    assert plant.tip_displacements(W) == pytest.approx(PHI[name] * W)


def test_the_plants_meet_their_contract(plant):
    plant.validate()
    assert plant.tips == plant.modes  # one tip a flexible link, in all three


def test_every_parameter_has_a_unit_and_a_source(plant):
    for entry in plant.parameter_fields():
        assert entry.metadata["unit"], entry.name
        assert entry.metadata["source"], entry.name


def test_a_linear_axis_is_two_masses_and_a_spring():
    # mass M with a load m on a spring, m (x'' + W'') = -m omega^2 W - 2 m zeta omega W': the force
    # on the carriage is (M - m) x'' + m (x'' + W'') + c x'
    axis = qa.LinearAxis(omega1=20.0, zeta1=0.1, mass=5.0, load=2.0, friction=3.0)
    joint = JointMotion(0.2, 0.5, 7.0)
    (ddW,) = axis.modal_accelerations(joint, [0.01], [0.3])
    assert ddW == pytest.approx(-7.0 - 2 * 0.1 * 20.0 * 0.3 - 400.0 * 0.01)
    force = axis.torque(joint, [0.01], [0.3], [ddW])
    assert force == pytest.approx((5.0 - 2.0) * 7.0 + 2.0 * (7.0 + ddW) + 3.0 * 0.5)
    assert ACCELERATION.of(axis.joint) == "m/s^2"
    for wrong, told in (({"load": 9.0}, "load is 9 kg"), ({"share1": 1.2}, "shares of the swing")):
        with pytest.raises(ValueError, match=told):
            qa.LinearAxis(**wrong)


@dataclass(frozen=True)
class Pair(Sound):
    """Two joints that turn alike, and a tip on each."""

    name: ClassVar[str] = "pair-probe"

    def joints(self, path):
        return [path, path]

    def tip_displacements(self, W):
        return [W[0], 2 * W[0]]


def test_joints_and_tips_are_called_by_their_numbers_if_there_are_several():
    assert (Sound().joint_names, Sound().tip_names) == (("joint",), ("tip",))
    assert (Pair().joint_names, Pair().tip_names) == (("joint_1", "joint_2"), ("tip_1", "tip_2"))


def test_a_path_is_of_several_joints_or_stated():
    @dataclass(frozen=True)
    class OnPath(Sound):
        along_path = True

    assert [plant.has_path for plant in (Sound(), Pair(), OnPath())] == [False, True, True]
    assert not any(plant.has_path for plant in PLANTS.values())  # one joint, whose angle they have


def test_parameters_are_of_the_kind_that_is_stated_or_their_unit_has():
    kinds = qa.SingleLinkManipulator.parameter_kinds()
    expected = {"zeta": "damping", "omega": "frequency", "phi": "other"}
    assert {name: kinds[name] for name in expected} == expected


def test_a_torque_without_a_joint_is_not_left_out():
    @dataclass(frozen=True)
    class TorqueTooMany(Pair):
        torque = qa.Plant.torque

        def torques(self, path, W, dW, ddW):
            return [path.acceleration] * 3

    with pytest.raises(ValueError, match="argument"):
        TorqueTooMany().torque(JointMotion(0.1, 0.2, 0.3), [0.0], [0.0], [0.0])


@dataclass(frozen=True)
class Turning(Sound):
    """A tip whose displacement is seen along an axis that the joint turns."""

    name: ClassVar[str] = "turning-probe"
    tip_displacements = qa.Plant.tip_displacements

    def tips_at(self, path, W):
        return [W[0] * ca.cos(path.angle)]


def test_rates_of_tips_are_those_of_their_displacements():
    # w = W cos(q): w' = W' cos(q) - W q' sin(q), and by the product rule once more
    q, v, a, W, dW, ddW = 0.4, 1.5, -2.0, 0.03, 0.2, -5.0
    joint, sine, cosine = JointMotion(q, v, a), np.sin(q), np.cos(q)
    assert [float(w) for w in Turning().tip_displacements([W])] == [W]  # those at the angle 0
    (speed,) = Turning().tip_speeds(joint, [W], [dW])
    assert float(speed) == pytest.approx(dW * cosine - W * v * sine)
    (acceleration,) = Turning().tip_accelerations(joint, [W], [dW], [ddW])
    expected = ddW * cosine - 2 * dW * v * sine - W * (a * sine + v**2 * cosine)
    assert float(acceleration) == pytest.approx(expected)
    assert Sound().tip_speeds(joint, [W], [dW]) == [dW]  # the same everywhere: by the mode alone
    assert Sound().tip_accelerations(joint, [W], [dW], [ddW]) == [ddW]


def test_a_file_that_is_added_to_the_models_is_known_by_its_plant(tmp_path, monkeypatch):
    (tmp_path / "added_probe.py").write_text(
        "from sound_plant import Sound\nclass Added(Sound):\n    name = 'added-probe'\n"
    )
    beside = str(tmp_path / "plant.py")
    monkeypatch.setattr(models, "__path__", [*models.__path__, str(tmp_path)])
    monkeypatch.setattr(sys.modules["quietarm.models.plant"], "__file__", beside)
    monkeypatch.setattr(models, "added_probe", None, raising=False)  # taken away again
    try:
        assert known_plants()["added-probe"].__name__ == "Added"
    finally:
        sys.modules.pop("quietarm.models.added_probe", None)
