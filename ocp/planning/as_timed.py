"""A robot's trajectory as it is timed: what it takes and leaves, and what makes it ring."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, GeometricPath, JointMotion, Robot
from quietarm.models.robot.on_path.full import RobotInTime
from quietarm.models.robot.path.geometric_path import USUAL_TOLERANCE
from quietarm.models.robot.path.not_driven import moves_undriven
from quietarm.models.robot.path.timed_motion import TimedMotion
from quietarm.ocp.checks import instance, positive, takes
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy
from quietarm.ocp.errors import QuietarmError
from quietarm.ocp.planning.plan import Plan, evaluate_coefficients
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import PiecewiseMotion
from quietarm.ocp.simulation.full_dynamics import FullFigures, follow_in_full, times_after

Array = NDArray[np.float64]


WINDOW = 1.0
"""How long the tip is looked at after arrival where nothing is said [s]."""


@dataclass(frozen=True, eq=False)
class TimedAnswer:
    """The effect of a trajectory on a robot as it is timed, by CVODES on the whole equations.

    Attributes
    ----------
    robot : Robot
        What moves.
    motion : TimedMotion
        The trajectory of its driven joints.
    energy, residual : float
        Energy [J] and the largest displacement of the tip after arrival [m].
    peaks : mapping of str to ndarray
        By quantity, torque, speed, acceleration and jerk: the largest size of each joint.
    swings : sequence of (float, float)
        Frequency [rad/s] of every mode after arrival, and how far the tip swings by it [m].
    stiffness, payload : float
        Multiples of the robot's.
    """

    robot: Robot
    motion: TimedMotion
    energy: float
    residual: float
    peaks: Mapping[str, Array]
    swings: Sequence[tuple[float, float]]
    stiffness: float = 1.0
    payload: float = 1.0

    @cached_property
    def path(self) -> GeometricPath:
        """The path of the trajectory without its times, within 0.0005 rad (or m) of its lines."""
        return GeometricPath.within(self.motion.points, USUAL_TOLERANCE, joints=self.motion.joints)

    @cached_property
    def cycloid(self) -> Plan:
        """The plain cycloid along the same path in the same time."""
        plant = self.robot.along(self.path)
        plant = replace(plant, stiffness=self.stiffness, payload=self.payload)
        return evaluate_coefficients(plant.task(1.0, self.motion.duration), [])

    @cached_property
    def plan(self) -> Plan:
        """A plan along the same path in the same time, within the robot's limits.

        Raises
        ------
        QuietarmError
            When there is none.
        """
        task = self.cycloid.task
        try:
            return plan_move(task, CycloidPolynomial(_TERMS))
        except QuietarmError:  # limits may take more terms than so few
            return plan_move(task)

    @property
    def largest_step(self) -> tuple[float, str, float]:
        """Largest jump of an acceleration, its joint, and its time [s]."""
        steps = np.abs(self.motion.steps)
        at, joint = np.unravel_index(steps.argmax(), steps.shape)
        return float(steps[at, joint]), self.motion.joints[joint], float(self.motion.times[at])

    @cached_property
    def diagnosis(self) -> str:
        """Words on what is left after arrival, by which mode and why, and what a plan leaves.

        Where a plan leaves no less, or less by what nobody sees, it says that alone.
        """
        first, *others = sorted(self.swings, key=lambda swing: -swing[1])
        number = 1 + list(self.swings).index(first)
        words = (
            f"{_mm(self.residual)} after arrival; of these {_mm(first[1])} by mode {number} at "
            f"{first[0] / math.tau:.3g} Hz"
        )
        if others and others[0][1] > _SEEN * first[1]:
            words += f" and {_mm(others[0][1])} by that at {others[0][0] / math.tau:.3g} Hz"
        try:
            if self._is_as_still_as_a_plan:
                return f"leaves {_mm(self.residual)}: as still as a plan; nothing to improve"
            return f"{words}; {self._cause(first[0])}; {self._remedy()}"
        except (ValueError, QuietarmError) as error:
            return f"{words}; its path cannot be planned along: {error}"

    @property
    def _is_as_still_as_a_plan(self) -> bool:
        """Return whether a plan would leave as much, or less by what nobody sees."""
        if self.residual <= _AS_STILL:
            return True
        left = self._left_by_plan
        return isinstance(left, float) and self.residual <= left + _AS_STILL

    @cached_property
    def _left_by_plan(self) -> float | QuietarmError:
        """Return what a plan leaves [m], or why there is none."""
        try:
            return _left_by(self.plan)
        except QuietarmError as error:
            return error

    def _cause(self, frequency: float) -> str:
        """Say whether steps of the acceleration or the pace of the move make it ring."""
        left = _left_by(self.cycloid)
        swings = self.motion.duration * frequency / math.tau
        if left > _SHARE * self.residual:
            return (
                f"a resonance: the plain cycloid, as smooth as can be, leaves {_mm(left)} along "
                f"the same path, since the move takes {swings:.2g} swings"
            )
        size, joint, time = self.largest_step
        jerk = self.peaks["jerk"]
        steepest = int(jerk.argmax())
        names = self.motion.joints
        what = (
            f"a step of {size:.3g} rad/s^2 (or m/s^2) of {joint} at {time:.3g} s"
            if size > _OF_PEAK * self.peaks["acceleration"].max()
            else f"up to {jerk[steepest]:.3g} rad/s^3 (or m/s^3) of {names[steepest]}"
        )
        return f"the jerk makes it ring: {what}, where the plain cycloid leaves {_mm(left)}"

    def _remedy(self) -> str:
        """Say what a plan leaves."""
        left = self._left_by_plan
        if isinstance(left, QuietarmError):
            return f"within the robot's limits no plan was found in the same time: {left}"
        return f"with the same path and time a plan leaves {_mm(left)}"


def _left_by(plan: Plan) -> float:
    """Return what a plan leaves by the whole equations [m]."""
    figures = plan.candidate.in_full
    return plan.residual if figures is None else figures.residual


_TERMS = 8
"""Of a plan of which only what it leaves is asked."""
_SEEN = 0.05
"""Share of what the largest mode leaves, from which on the next is named."""
_SHARE = 1 / 3
"""Of what is left, from which on it is no matter of jerk that the plain cycloid leaves as much."""
_OF_PEAK = 0.05
"""Share of the largest acceleration that is a step and not rounding."""
_AS_STILL = 5e-5
"""What nobody sees [m]: a plan that leaves less by no more is no better."""


@takes(energy=Energy)
def evaluate_as_timed(
    robot: Robot,
    trajectory: TimedMotion | str | Path,
    *,
    residual_window: float = WINDOW,
    energy: Energy = ABSOLUTE_POWER,
    stiffness: float = 1.0,
    payload: float = 1.0,
) -> TimedAnswer:
    """Judge a robot's trajectory as it is timed.

    Parameters
    ----------
    robot : Robot
        What moves.
    trajectory : TimedMotion, str or Path
        Or its file, as of `TimedMotion.load`.
    residual_window : float
        How long the tip is looked at after arrival [s].
    energy : Energy
        What counts as energy.
    stiffness, payload : float
        Multiples of the robot's, as of `RobotOnPath`.

    Raises
    ------
    ValueError
        When the trajectory has no times, or not all joints, or leaves the range of one.
    SolverFailedError
        When CVODES cannot follow it.
    """
    robot = instance("robot", robot, Robot)
    window = positive("residual_window", residual_window, "s")
    motion = trajectory if isinstance(trajectory, TimedMotion) else TimedMotion.load(trajectory)
    moving = moves_undriven(robot, motion.joints, motion.points)
    motion = motion.of_joints(robot.joints)
    motion = replace(motion, remarks=(*motion.remarks, *(f"warning: {words}" for words in moving)))
    robot.check_positions(motion.points)
    equations = RobotInTime(robot.finer, stiffness, payload)
    figures = _followed(equations, motion, window, energy)
    swings = equations.swings(motion.points[-1], figures.arrival)
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    orders = {"speed": 1, "acceleration": 2, "jerk": 3}
    peaks = {
        name: np.abs(motion.at(shares, order)).max(axis=(0, 1)) for name, order in orders.items()
    }
    return TimedAnswer(
        robot,
        motion,
        figures.energy,
        figures.residual,
        {"torque": figures.peak_torques, **peaks},
        swings,
        stiffness,
        payload,
    )


def _followed(
    equations: RobotInTime, motion: TimedMotion, window: float, energy: Energy
) -> FullFigures:
    """Figures by CVODES, piece by piece; long pieces in several parts of the quadrature."""
    pieces, joints, terms = motion.coefficients.shape
    arguments = np.column_stack([motion.coefficients.reshape(pieces, -1), motion.lengths]).T

    def law(
        numbers: Sequence[Expression], fraction: Expression, *, jerk: bool = False
    ) -> JointMotion:
        table = ca.reshape(ca.vertcat(*numbers[:-1]), terms, joints).T
        length = numbers[-1]
        powers = [fraction**power for power in range(terms)]
        values = list[Expression]()
        for order in range(3):
            values.append(ca.mtimes(table, ca.vertcat(*powers)))
            table = table[:, 1:] * ca.repmat(ca.DM(range(1, terms - order)).T, joints, 1) / length
            powers = powers[:-1]
        return JointMotion(*values)

    remedy = "; is a mass or a spring of the robot far out of scale?"
    moving = PiecewiseMotion(law, arguments, False, False, remedy)
    steps = max(_LEAST_STEPS, math.ceil(motion.lengths.max() / _STEP))
    fastest = float(equations.frequencies(motion.points[-1])[:_FOLLOWED].max())
    ends = (motion.points[0], motion.points[-1])
    return follow_in_full(equations, moving, ends, steps, times_after(window, fastest), energy)


_SAMPLES = 9
_LEAST_STEPS = 6
_STEP = 0.01
"""Of the quadrature of the energy [s]."""
_FOLLOWED = 4
"""Modes whose swing after arrival is seen between samples."""


def _mm(length: float) -> str:
    """Millimetres with two digits, as they are said."""
    size = 1e3 * length
    if size < _LEAST_MM:
        return f"less than {_LEAST_MM:g} mm"
    return f"{size:.2g} mm" if size < 100 else f"{size:.0f} mm"


_LEAST_MM = 0.001
