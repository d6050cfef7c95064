"""The one simulation of a plant along a joint profile, as casadi expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
from numpy.typing import ArrayLike
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.checks import whole
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy, power_of
from quietarm.ocp.interrupts import keep_interrupts, one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import NodeState, is_zero, step
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.grid import Grid, default_steps
from quietarm.ocp.simulation.objective import Motion, integrated, spent
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant


@dataclass(frozen=True)
class SymbolicRollout:
    """A simulation as expressions: one row a candidate, one column a step.

    Attributes
    ----------
    joints : list of JointMotion
        The joint at each Gauss node.
    states : list of NodeState
        The modes at each Gauss node.
    torque : list of Expression
        Joint torque at each Gauss node [N m].
    arrival : Expression
        W (m) and then W' (m/s) at arrival, one row a candidate.
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
    def energy(self) -> Expression:
        """F2 [J], one row a candidate."""
        speed = [joint.speed for joint in self.joints]
        return spent(self.definition, self.torque, speed, self.h, unbroken=self.unbroken)


@one_at_a_time
def symbolic_rollout(
    plant: Plant,
    profile: JointProfile,
    coefficients: Sequence[Expression],
    move: Sequence[Expression],
    steps: int,
    candidates: int = 1,
    jerk: bool = False,
    breaks: tuple[float, ...] = (),
    initial: Sequence[Expression] = (),
    energy: Energy = ABSOLUTE_POWER,
) -> SymbolicRollout:
    """Simulate the modes along the profile, with a fixed number of steps.

    Parameters
    ----------
    plant : Plant
        What moves.
    profile : JointProfile
        How the joint moves.
    coefficients : sequence of Expression
        The profile's coefficients; each of shape (candidates, steps), or a scalar.
    move : sequence of Expression
        start [rad], target [rad], duration [s]; scalars.
    steps : int
        Number of steps.
    candidates : int
        Number of rows.
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
        Every joint, mode and torque at the Gauss nodes, and the state at arrival.
    """
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


@lru_cache(maxsize=32)
def _compiled(
    plant: Plant,
    profile: JointProfile,
    steps: int,
    breaks: tuple[float, ...],
    energy: Energy,
    names: tuple[str, ...],
) -> ca.Function:
    """(coefficients, row, errors) -> samples at the nodes in time, arrival, energy, net work."""
    errors = ca.MX.sym("e", len(names))
    plant = perturb_plant(plant, dict(zip(names, ca.vertsplit(errors), strict=True)))
    a, row = ca.MX.sym("a", profile.size), ca.MX.sym("row", 3 + 2 * plant.modes)
    *move, initial = ca.vertsplit(row, [0, 1, 2, 3, row.numel()])
    found = symbolic_rollout(
        plant, profile, ca.vertsplit(a), move, steps, jerk=True, breaks=breaks,
        initial=ca.vertsplit(initial), energy=energy,
    )  # fmt: skip

    def in_time(*rows: Sequence[Expression]) -> Expression:
        """A column for each quantity, from its values at the nodes of every step."""
        return ca.horzcat(*(ca.vec(ca.vertcat(*at_nodes)) for at_nodes in rows))

    tips = [plant.tip_displacements(node.W) for node in found.states]
    outputs = [
        in_time(*zip(*found.joints, strict=True)),
        in_time(*zip(*tips, strict=True)),
        in_time(found.torque),
        found.arrival,
        found.energy,
        integrated(found.power, found.h),
    ]
    return ca.Function("rollout", [a, row, errors], outputs)


@dataclass(frozen=True)
class Rollout:
    """What one simulation with fixed steps gives.

    Attributes
    ----------
    motion : Motion
        Residual, energy and diagnostics; the peaks are over the nodes.
    arrival : tuple of float
        W (m) and then W' (m/s) at arrival.
    steps : int
        Number of steps.
    """

    motion: Motion
    arrival: tuple[float, ...]
    steps: int


@one_at_a_time
@keep_interrupts()  # casadi loses a Ctrl-C
def rollout(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike, steps: int | None = None
) -> Rollout:
    """Simulate a task along one profile with fixed steps.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.
    steps : int, optional
        Number of steps; `default_steps` of the task by default.

    Returns
    -------
    Rollout
        Residual, energy, diagnostics and the state at arrival.

    Raises
    ------
    ValueError
        When the coefficients or the duration do not fit the profile.
    """
    steps = default_steps(task) if steps is None else whole("steps", steps, 1)
    breaks = profile.breaks(task.duration)
    names = task.error_names
    function = _compiled(task.plant, profile, steps, breaks, task.energy, names)
    given = ca.DM(profile.checked(coefficients, task.duration)), ca.DM(task.row)
    each = [_of_scenario(task, function.call([*given, ca.DM(errors)]), k)
            for k, errors in enumerate(task.scenarios)]  # fmt: skip
    motion = Motion.worst([motion for motion, _ in each])
    return Rollout(motion, each[0][1], steps)


def _of_scenario(
    task: PointToPoint, values: Sequence[ca.DM], scenario: int
) -> tuple[Motion, tuple[float, ...]]:
    """Figures and the state at arrival, of one scenario."""
    joint, tips, torque, arrival, energy, net_work = (value.full() for value in values)
    vibration = after_arrival(task)[scenario]
    motion = Motion.from_samples(
        task,
        JointMotion(*joint.T),
        tips,
        torque.ravel(),
        residual=float(vibration.peak(task.missed(arrival.ravel()))),
        energy=energy.item(),
        net_work=net_work.item(),
    )
    return motion, tuple(arrival.ravel().tolist())
