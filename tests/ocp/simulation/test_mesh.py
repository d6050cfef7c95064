"""Number of steps that a move takes."""

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import pytest
from fixed_steps import rollout

import quietarm as qa
from quietarm.ocp.simulation.mesh import default_steps, mesh_of

PLAIN = qa.CycloidPolynomial(0)


@dataclass(frozen=True)
class StiffMidway(qa.Plant):
    """A mode of 10 rad/s at 0 and at pi that is forty times as fast between them."""

    name: ClassVar[str] = "stiff-midway"
    modes: ClassVar[int] = 1

    def modal_accelerations(self, joint, W, dW):
        frequency = 10.0 * (1 + 39 * ca.sin(joint.angle) ** 2)
        return [-(frequency**2) * W[0] - 0.2 * dW[0] - joint.acceleration]

    def torque(self, joint, W, dW, ddW):
        return 2 * joint.acceleration + ddW[0]

    def tip_displacements(self, W):
        return [W[0]]


def test_steps_resolve_the_fastest_mode_on_the_way():
    # 400 rad/s halfway, where both ends say 10: two steps a radian.
    task = qa.PointToPoint(StiffMidway(), math.pi, 2.0)
    assert default_steps(task) == pytest.approx(2 * 400 * 2.0, rel=1e-2)
    fixed, exact = (
        rollout(task, PLAIN, []).motion,
        qa.JudgedMotion.of_profile(task, PLAIN, []).motion,
    )
    assert fixed.residual == pytest.approx(exact.residual, rel=1e-3)
    assert fixed.energy == pytest.approx(exact.energy, rel=1e-5)


def test_short_pieces_of_a_spline_get_finer_with_the_move():
    """Else a limit that is passed within one stays passed, however many steps the move takes."""
    spline = qa.JointSpline((0.001, 0.3, 0.302))
    shortest = [mesh_of(spline, steps, spline.knots).lengths.min() for steps in (80, 160, 320)]
    assert shortest[0] > 1.5 * shortest[1] > 2.5 * shortest[2]
