"""The plants: the paper's equations, parameters, names."""

import math
from dataclasses import fields

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.models import (
    ArmOnFlexibleLink,
    JointMotion,
    SingleLinkManipulator,
)

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
        "single link": SingleLinkManipulator(),
        "arm": ArmOnFlexibleLink(),
        "two links": two_links,
    }
    return plants[request.param]


# -- the paper's equations and numbers --


def test_mode_shapes_at_the_tips():
    # docs/physics.md: 2.28 from the paper's 'about 7.7 cm' over max |W| = 0.03382 m, 0.508 from
    # beta3/(M lbar) with M = 0.450 kg, lbar = 0.105 m.
    assert SingleLinkManipulator().phi == pytest.approx(0.077 / 0.03382, abs=0.005)
    assert ArmOnFlexibleLink().phi == pytest.approx(2.399e-2 / (0.450 * 0.105), abs=0.0005)


@given(angle=motions, speed=motions, acceleration=motions, W=motions, dW=motions)
def test_single_link_meets_eqs_8_and_9(angle, speed, acceleration, W, dW):
    p, joint = SINGLE_LINK, JointMotion(angle, speed, acceleration)
    plant = SingleLinkManipulator()
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
    p, joint = ARM, JointMotion(angle, speed, acceleration)
    plant = ArmOnFlexibleLink()
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


# -- one set of lines for symbols, matrices and numbers --


def _flat(plant, joint, W, dW):
    """Every output of a plant: accelerations, torque, tips."""
    ddW = plant.modal_accelerations(joint, W, dW)
    return [*ddW, plant.torque(joint, W, dW, ddW), *plant.tip_displacements(W)]


def test_numbers_symbols_and_matrices_give_the_same(plant):
    rows, columns, entries = 3, 4, 3 + 2 * plant.modes
    values = np.random.default_rng(7).uniform(-3, 3, (entries, rows, columns))

    def outputs(arguments):
        m = plant.modes
        return _flat(
            plant, JointMotion(*arguments[:3]), arguments[3 : 3 + m], arguments[3 + m : 3 + 2 * m]
        )

    scalars = [ca.SX.sym(f"x{i}") for i in range(entries)]
    of_scalars = ca.Function("scalars", scalars, [ca.vertcat(*outputs(scalars))])
    matrices = [ca.MX.sym(f"X{i}", rows, columns) for i in range(entries)]
    of_matrices = ca.Function("matrices", matrices, outputs(matrices))
    by_matrix = [value.full() for value in of_matrices.call([ca.DM(v) for v in values])]

    for row in range(rows):
        for column in range(columns):
            one = values[:, row, column].tolist()
            by_number = np.array([float(value) for value in outputs(one)])
            assert of_scalars(*one).full().ravel() == pytest.approx(by_number, rel=1e-13)
            here = np.array([matrix[row, column] for matrix in by_matrix])
            assert here == pytest.approx(by_number, rel=1e-13)


# -- the contract --


def test_the_plants_meet_their_contract(plant):
    plant.validate()
    assert plant.tips == plant.modes  # one tip a flexible link, in all three


# -- parameters --


def test_every_parameter_has_a_unit_and_a_source(plant):
    for entry in fields(plant):
        assert entry.metadata["unit"], entry.name
        assert entry.metadata["source"], entry.name
