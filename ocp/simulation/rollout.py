"""The one simulation of a plant along a joint profile, as casadi expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy, power_of
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NodeState, is_zero, step
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.simulation.objective import spent


@dataclass(frozen=True)
class SymbolicRollout:
    """A simulation as CasADi expressions: one row a candidate, one column a step.

    Every step has three Gauss nodes; what holds at the nodes is a list of three, each of shape
    (candidates, steps). All of it can be differentiated twice.

    Attributes
    ----------
    joints : list of JointMotion
        The joint at each Gauss node: angle [rad], speed, acceleration.
    states : list of NodeState
        The modes at each Gauss node: W [m], W', W'', by mode.
    torque : list of Expression
        Joint torque at each Gauss node [N m].
    arrival : Expression
        W (m) and then W' (m/s) at arrival, shape (candidates, 2 * modes).
    h : Expression
        Length of every step [s].
    unbroken : bool
        Whether the steps are those of a `Grid` from start to end, without breaks between them.
    definition : Energy
        What counts as the energy.
    """

    joints: list[JointMotion]
    states: list[NodeState]
    torque: list[Expression]
    arrival: Expression
    h: Expression
    unbroken: bool = True
    definition: Energy = ABSOLUTE_POWER

    @property
    def power(self) -> list[Expression]:
        """Mechanical power of the joint at each Gauss node [W]."""
        nodes = zip(self.torque, self.joints, strict=True)
        return [power_of(torque, joint.speed) for torque, joint in nodes]

    @property
    def weights(self) -> list[Expression]:
        """Quadrature weights of the nodes [s], so that sums of weight times value are integrals."""
        return [weight * self.h for weight in GAUSS_WEIGHTS]

    @property
    def energy(self) -> Expression:
        """F2 [J], one row a candidate."""
        speed = [joint.speed for joint in self.joints]
        return spent(self.definition, self.torque, speed, self.h, unbroken=self.unbroken)


@one_at_a_time
def symbolic_rollout(
    plant: Plant,
    profile: JointProfile,
    coefficients: Expression | Sequence[Expression],
    move: Sequence[Expression],
    steps: int,
    candidates: int = 1,
    jerk: bool = False,
    breaks: tuple[float, ...] = (),
    initial: Sequence[Expression] = (),
    energy: Energy = ABSOLUTE_POWER,
) -> SymbolicRollout:
    """Simulate the modes along the profile in fixed steps: joint, modes, torque, state on arrival.

    Parameters
    ----------
    plant, profile
        What moves, and how the joint does.
    coefficients : Expression or sequence of Expression
        The profile's coefficients: a column (SX, MX or DM) of the decision variables, or one
        expression each, of shape (candidates, steps) or a scalar.
    move : sequence of Expression
        start [rad], target [rad], duration [s]; scalars.
    steps, candidates : int
        Number of steps, and of rows.
    jerk : bool
        Whether the joint's jerk is computed as well, at the times of `Grid.stretch`.
    breaks : tuple of float
        Fractions of the duration at which the motion is not smooth: there a step ends.
    initial : sequence of Expression
        W [m], then W' [m/s] at the start, each of shape (candidates, 1) or a scalar; at rest by
        default.
    energy : Energy
        What counts as the energy.

    Returns
    -------
    SymbolicRollout
        The motion, as expressions of the coefficients.
    """
    if isinstance(coefficients, ca.SX | ca.MX | ca.DM):
        coefficients = ca.vertsplit(coefficients)
    grid = Grid(steps, breaks)
    times, length = grid.columns(candidates)
    joints = [profile.motion(coefficients, at, *move) for at in times]
    if jerk:
        ends = map(grid.stretch, times)
        of_jerk = [profile.motion(coefficients, at, *move, jerk=True) for at in ends]
        joints = [
            joint._replace(jerk=there.jerk) for joint, there in zip(joints, of_jerk, strict=True)
        ]
    h = move[2] * length
    every_step = step(plant, joints, h)
    W, dW, arrival = march(*every_step.transition(), h.shape, initial)
    ddW = every_step.accelerations(W, dW)
    states = every_step.nodes(W, dW, ddW)
    torque = [
        plant.torque(joint, node.W, node.dW, node.ddW)
        for joint, node in zip(joints, states, strict=True)
    ]
    return SymbolicRollout(joints, states, torque, arrival, h, not breaks, energy)


def march(
    constant: Sequence[Expression],
    columns: Sequence[Sequence[Expression]],
    shape: tuple[int, int],
    initial: Sequence[Expression] = (),
) -> tuple[list[Expression], list[Expression], Expression]:
    """States before every step (rows, steps), by mode, and the state at arrival; from rest or else.

    Only this recursion is sequential: everything else is computed for all steps at once.
    """
    rows, steps = shape
    size = len(constant)
    offsets = [_by_step(row, steps) for row in constant]
    by_row = [
        {c: _by_step(column[row], steps) for c, column in enumerate(columns)
         if not is_zero(column[row])}
        for row in range(size)
    ]  # fmt: skip
    state: list[Expression] = [ca.DM.zeros(rows, 1) + x for x in initial or [0.0] * size]
    before: list[list[Expression]] = [[] for _ in range(size)]
    for k in range(steps):
        for row in range(size):
            before[row].append(state[row])
        state = [
            offsets[row][k] + sum(gain[k] * state[column] for column, gain in by_row[row].items())
            for row in range(size)
        ]
    after = [ca.horzcat(*entry) for entry in before]
    return after[: size // 2], after[size // 2 :], ca.horzcat(*state)


def _by_step(entry: Expression, steps: int) -> list[Expression]:
    """A column for each step; what does not depend on the step is a single one."""
    columns = ca.horzsplit(ca.DM.zeros(1, 1) + entry, 1)
    return columns if len(columns) == steps else columns * steps
