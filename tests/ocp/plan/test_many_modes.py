"""Plants of one to eight modes: rest is planned, and judged by what the plain cycloid leaves."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np
import pytest

import quietarm as qa

EXAMPLES = [(1, 0), (2, 1), (8, 0)]


@cache
def _plant(modes, seed):
    """Links side by side on one hub, of random frequency and coupling.

    W_i'' + 2 zeta_i omega_i W_i' + omega_i^2 W_i + a_i theta'' = 0, as docs/physics.md's 'A third
    plant' without the joint's speed; each link takes a share of the joint's inertia.
    """
    random = np.random.default_rng([modes, seed])
    omega = 6.0 * np.cumprod(random.uniform(1.2, 1.6, modes))
    zeta, a = random.uniform(0.001, 0.02, modes), random.uniform(0.1, 0.3, modes)
    share = random.uniform(0.1, 0.9, modes) / modes / a

    @dataclass(frozen=True)
    class Links(qa.Plant):
        name: ClassVar[str] = f"links-of-a-test-{modes}-{seed}"

        def modal_accelerations(self, joint, W, dW):
            return [
                -2 * zeta[i] * omega[i] * dW[i] - omega[i] ** 2 * W[i] - a[i] * joint.acceleration
                for i in range(modes)
            ]

        def torque(self, joint, W, dW, ddW):
            inertia = sum(share[i] * ddW[i] for i in range(modes))
            return joint.acceleration + inertia + 0.1 * joint.speed

        def tip_displacements(self, W):
            return list(W)

    Links.modes = modes
    return Links()


@pytest.mark.parametrize(("modes", "seed"), EXAMPLES)
@pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")
def test_as_many_modes_as_the_terms_can_still_come_to_rest(modes, seed):
    # Rest of the modes is two conditions for each; four more terms are left to save energy.
    task, profile = (
        qa.PointToPoint(_plant(modes, seed), 1.0, 1.2),
        qa.CycloidPolynomial(2 * modes + 4),
    )
    plain = qa.resimulate(task, profile, np.zeros(profile.size))
    plan = qa.plan_move(task, profile, starts=1)
    assert plan.residual < 1e-6 * plain.residual
