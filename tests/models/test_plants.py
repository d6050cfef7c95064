"""The plants: the paper's equations, parameters, names."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sound_plant import Sound
from third_opinion import EQUATIONS, PHI

import quietarm as qa
from quietarm.models import JointMotion
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
