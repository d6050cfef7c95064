"""The plants: the paper's equations, parameters, names."""

import math
from dataclasses import fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

import quietarm as qa

motions = st.floats(-10.0, 10.0)
"""Angles, speeds, accelerations, amplitudes and rates: larger than any in the paper's figures."""


# Eq (10) of the paper.
SINGLE_LINK = {
    "alpha1": 2.383e-2,
    "alpha2": 9.261e-2,
    "c": 3.091e-2,
    "beta1": 2.555e-1,
    "beta2": 2.614e-1,
    "zeta": 9.636e-3,
    "omega": 10.43,
}


# Eq (15) of the paper.
ARM = {
    "alpha1": -1.055e-1,
    "alpha2": -9.949e-3,
    "alpha3": 5.256e-2,
    "alpha4": 7.634e-2,
    "zeta": 1.500e-3,
    "beta1": 5.366e-3,
    "beta2": -4.944e-3,
    "beta3": 2.399e-2,
    "omega": 7.320,
    "c": 1.965e-2,
}


pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


@pytest.fixture(params=["single link", "arm", "two links"])
def plant(request, two_links):
    plants = {
        "single link": qa.SingleLinkManipulator(),
        "arm": qa.ArmOnFlexibleLink(),
        "two links": two_links,
    }
    return plants[request.param]


def test_mode_shapes_at_the_tips():
    # docs/physics.md: 2.28 from the paper's 'about 7.7 cm' over max |W| = 0.03382 m, 0.508 from
    # beta3/(M lbar) with M = 0.450 kg, lbar = 0.105 m.
    assert qa.SingleLinkManipulator().phi == pytest.approx(0.077 / 0.03382, abs=0.005)
    assert qa.ArmOnFlexibleLink().phi == pytest.approx(2.399e-2 / (0.450 * 0.105), abs=0.0005)


@given(angle=motions, speed=motions, acceleration=motions, W=motions, dW=motions)
def test_single_link_meets_eqs_8_and_9(angle, speed, acceleration, W, dW):
    p, joint = SINGLE_LINK, qa.JointMotion(angle, speed, acceleration)
    plant = qa.SingleLinkManipulator()
    (ddW,) = plant.modal_accelerations(joint, [W], [dW])
    eq9 = (
        ddW
        + 2 * p["zeta"] * p["omega"] * dW
        + p["omega"] ** 2 * W
        + p["beta1"] * acceleration
        + p["beta2"] * speed**2 * W
    )
    assert eq9 == pytest.approx(0.0, abs=1e-11)
    eq8 = p["alpha1"] * acceleration + p["alpha2"] * ddW + p["c"] * speed
    assert plant.torque(joint, [W], [dW], [ddW]) == pytest.approx(eq8, rel=1e-13, abs=1e-13)


@given(angle=motions, speed=motions, acceleration=motions, W=motions, dW=motions)
def test_arm_meets_eqs_13_and_14(angle, speed, acceleration, W, dW):
    p, joint = ARM, qa.JointMotion(angle, speed, acceleration)
    plant = qa.ArmOnFlexibleLink()
    ddW = float(plant.modal_accelerations(joint, [W], [dW])[0])
    eq13 = (
        (1 + p["alpha1"] * math.cos(angle)) * ddW
        + 2 * p["zeta"] * p["omega"] * dW
        + p["omega"] ** 2 * W
        + (p["alpha2"] + p["alpha3"] * math.cos(angle)) * acceleration
        + (p["alpha4"] * dW * speed - p["alpha3"] * speed**2) * math.sin(angle)
    )
    assert eq13 == pytest.approx(0.0, abs=1e-11)
    eq14 = (
        p["beta1"] * acceleration
        + p["c"] * speed
        + (p["beta2"] + p["beta3"] * math.cos(angle)) * ddW
    )
    torque = float(plant.torque(joint, [W], [dW], [ddW]))
    assert torque == pytest.approx(eq14, rel=1e-13, abs=1e-13)


def test_the_plants_meet_their_contract(plant):
    plant.validate()
    assert plant.tips == plant.modes  # one tip a flexible link, in all three


def test_every_parameter_has_a_unit_and_a_source(plant):
    for entry in fields(plant):
        assert entry.metadata["unit"], entry.name
        assert entry.metadata["source"], entry.name


def test_a_linear_axis_is_two_masses_and_a_spring():
    # mass M with a load m on a spring, m (x'' + W'') = -m omega^2 W - 2 m zeta omega W': the force
    # on the carriage is (M - m) x'' + m (x'' + W'') + c x'
    axis = qa.LinearAxis(omega1=20.0, zeta1=0.1, mass=5.0, load=2.0, friction=3.0)
    joint = qa.JointMotion(0.2, 0.5, 7.0)
    (ddW,) = axis.modal_accelerations(joint, [0.01], [0.3])
    assert ddW == pytest.approx(-7.0 - 2 * 0.1 * 20.0 * 0.3 - 400.0 * 0.01)
    force = axis.torque(joint, [0.01], [0.3], [ddW])
    assert force == pytest.approx((5.0 - 2.0) * 7.0 + 2.0 * (7.0 + ddW) + 3.0 * 0.5)
    assert qa.joint_unit("rad/s^2", axis.joint) == "m/s^2"
    for wrong, told in (({"load": 9.0}, "load is 9 kg"), ({"share1": 1.2}, "shares of the swing")):
        with pytest.raises(ValueError, match=told):
            qa.LinearAxis(**wrong)
