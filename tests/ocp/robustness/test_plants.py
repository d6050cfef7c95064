"""Plants with errors: their frequencies and damping, and what is refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import quietarm as qa
from quietarm.models import JointMotion
from quietarm.ocp import FreeVibration, perturb_plant

PLANTS = [qa.SingleLinkManipulator(), qa.ArmOnFlexibleLink(), qa.DualLinkManipulator()]
plants = pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)


@dataclass(frozen=True)
class Mobile(qa.Plant):
    """Two modes that are coupled by stiffness and by damping, not in proportion to each other."""

    name: ClassVar[str] = "mobile"
    modes: ClassVar[int] = 2

    stiff: float = qa.parameter(90.0, "1/s^2", "made up")
    damped: float = qa.parameter(0.2, "1/s", "made up")

    def modal_accelerations(self, joint, W, dW):
        first = -self.stiff * W[0] + 20 * W[1] - self.damped * dW[0] + 0.1 * dW[1]
        second = 20 * W[0] - 60 * W[1] + 0.1 * dW[0] - 0.7 * dW[1]
        return [first - joint.acceleration, second - 0.5 * joint.acceleration]

    def torque(self, joint, W, dW, ddW):
        return joint.acceleration + ddW[0]

    def tip_displacements(self, W):
        return [W[0] + W[1]]


def outputs(plant, numbers):
    """Return all that a plant's equations give at one motion."""
    joint, state = JointMotion(*numbers[:3]), np.reshape(numbers[3:], (3, -1))[:, : plant.modes]
    W, dW, ddW = state.tolist()
    given = [*plant.modal_accelerations(joint, W, dW), plant.torque(joint, W, dW, ddW)]
    return [float(value) for value in (*given, *plant.tip_displacements(W))]


@plants
def test_an_error_of_the_frequency_is_one_of_the_parameter_of_that_meaning(plant):
    # Eqs (9) and (13), docs/physics.md 'A third plant': omega is the frequency with the joint at
    # rest, or that over the root of the mass; zeta the damping likewise.
    errors = {"frequency": 0.13, "damping": -0.4}
    by_name = {
        name: 0.13 if "omega" in name else -0.4
        for name in plant.parameters
        if "omega" in name or "zeta" in name
    }
    one, other = perturb_plant(plant, errors), perturb_plant(plant, by_name)
    for numbers in np.random.default_rng(1).uniform(-2, 2, (5, 9)):
        assert outputs(one, numbers) == pytest.approx(outputs(other, numbers), rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize("plant", [qa.ArmOnFlexibleLink(), Mobile()], ids=lambda plant: plant.name)
def test_every_frequency_of_any_plant_is_scaled_and_its_damping_stays(plant, angle):
    # W'' = -s D W' - s^2 K W has s times the eigenvalues of W'' = -D W' - K W.
    changed = perturb_plant(plant, {"frequency": -0.3})
    for (omega, zeta), now in zip(
        FreeVibration(plant, angle).modes, FreeVibration(changed, angle).modes, strict=True
    ):
        assert now == pytest.approx((0.7 * omega, zeta), rel=1e-9)


def test_the_damping_of_coupled_modes_is_scaled_to_first_order():
    assumed = FreeVibration(Mobile(), 0.0).modes
    damped = FreeVibration(perturb_plant(Mobile(), {"damping": 0.5}), 0.0).modes
    for (omega, zeta), now in zip(assumed, damped, strict=True):
        # Second-order terms: products of damping ratios, at most 0.05.
        assert now == pytest.approx((omega, 1.5 * zeta), rel=0.05**2 * 4)
