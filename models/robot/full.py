"""A robot on its path by its whole equations: every spring, nonlinear, without tables and modes."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics import Dynamics


class WholeDynamics:
    """Compiled functions of a robot: of its driven joints' motion and its springs' angles."""

    def __init__(self, dynamics: Dynamics, tip: tuple[int, object], directions: Array) -> None:
        self.dynamics = dynamics
        self._tip = tip
        self._directions = directions

    @cached_property
    def accelerations(self) -> ca.Function:
        """(q, q', q'', p, p') -> p'': of the springs."""
        q, v, a, p, dp = self._symbols()
        dynamics = self.dynamics
        mechanism = dynamics.mechanism
        unknown = ca.SX.sym("ddp", dynamics.sprung)
        torques = dynamics.torques(
            ca.vertcat(q, p),
            ca.vertcat(v, dp),
            ca.vertcat(a, unknown),
        )[dynamics.driven :]
        masses = ca.jacobian(torques, unknown)
        inertial = ca.substitute(torques, unknown, ca.SX.zeros(dynamics.sprung))
        springs = ca.DM(mechanism.stiffness) * p + ca.DM(mechanism.damping) * dp
        D, LT, order = ca.ldl(masses)
        solution = -ca.ldl_solve(inertial + springs, D, LT, order)
        return ca.Function("accelerations", [q, v, a, p, dp], [solution], {"cse": True})

    def _symbols(self) -> list[ca.SX]:
        dynamics = self.dynamics
        driven = [ca.SX.sym(name, dynamics.driven) for name in ("q", "v", "a")]
        return [*driven, *(ca.SX.sym(name, dynamics.sprung) for name in ("p", "dp"))]
