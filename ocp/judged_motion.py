"""A motion of a task, judged by CVODES: the one judge of every answer.

With the optimisers' fixed steps it shares the equations, the energy's quadrature and the vibration
after arrival, but no integrator.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import JointMotion, Plant
from quietarm.ocp.acting import ActingMotion
from quietarm.ocp.checks import numbers, quoted, takes
from quietarm.ocp.figures import Figures
from quietarm.ocp.limits import OF_THIRD_ORDER, RESIDUAL, Quantity
from quietarm.ocp.profiles.check_profile import check_motion, check_profile
from quietarm.ocp.profiles.free_motion import FreeMotion, PiecewiseMotion
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.sample import Sample
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS
from quietarm.ocp.simulation.cvodes import Integration, integrate, integrate_to
from quietarm.ocp.simulation.evaluator import Evaluator
from quietarm.ocp.simulation.free_vibration import FreeVibration, fastest_along, vibration_of
from quietarm.ocp.simulation.full_dynamics import FullFigures, follow_in_full, times_after
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.on_drive import DriveFigures, DriveRun, figures_of, run_on_drive
from quietarm.ocp.simulation.servo import Mode, Servo, as_held, held_mode, mode_on_servo
from quietarm.ocp.simulation.set_points import FINEST, SetPoints, invert
from quietarm.ocp.simulation.trajectory import Trajectory, extremes, outputs_of
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant


@dataclass(frozen=True, eq=False)
class JudgedMotion(ActingMotion):
    """A motion of a task, evaluated by CVODES; each quantity is computed when it is first read.

    For an uncertain task residual and deflection are the largest over the scenarios; all else is of
    the nominal plant.

    Parameters
    ----------
    task : PointToPoint
        The move.
    path : PiecewiseMotion
        How the joint moves; `of_profile` and `of_free_motion` make one.
    errors : mapping of str to float
        Relative errors of the plant's parameters, as of `perturb_plant`.
    profile : JointProfile or None
        The profile that the path follows; None of a free motion.
    coefficients : tuple of float
        The profile's coefficients.

    Raises
    ------
    ValueError, SolverFailedError
        When a quantity is read, if the residual window is too long, or CVODES fails.
    """

    example: ClassVar[str] = (
        "a motion, such as plan.candidate or JudgedMotion.of_profile(task, profile, a)"
    )

    task: PointToPoint
    path: PiecewiseMotion
    errors: Mapping[str, float] = field(default_factory=dict)
    profile: JointProfile | None = None
    coefficients: tuple[float, ...] = ()

    @classmethod
    @takes(task=PointToPoint)
    def of_profile(
        cls, task: PointToPoint, profile: JointProfile, coefficients: ArrayLike
    ) -> JudgedMotion:
        """The move along a profile; ValueError where coefficients or duration do not fit it."""
        check_profile(profile)
        path = PiecewiseMotion.of_profile(task, profile, coefficients)
        checked = tuple(path.arguments[: profile.size, 0].tolist())
        check_motion(profile, checked, *task.move)
        return cls(task, path, profile=profile, coefficients=checked)

    @classmethod
    @takes(task=PointToPoint, free=FreeMotion)
    def of_free_motion(cls, task: PointToPoint, free: FreeMotion) -> JudgedMotion:
        """The move by a free motion from the task's start."""
        return cls(task, PiecewiseMotion.of_free_motion(task, free))

    def perturbed(self, errors: Mapping[str, float]) -> JudgedMotion:
        """Return this motion on the plant with these relative errors, and on no other."""
        if not isinstance(errors, Mapping):
            raise TypeError(
                f"errors are {quoted(errors)}; give them by name, such as {{'frequency': 0.1}}"
            )
        return replace(self, task=self.task.certain, errors=dict(errors))

    def on(self, task: PointToPoint) -> JudgedMotion:
        """Return this motion for another task of its move, such as one with errors of the plant."""
        return replace(self, task=task)

    def by_steps(self, steps: int, **options: Any) -> Evaluator:
        """Fixed steps along its profile, with the `options` of `Evaluator`."""
        if self.profile is None:
            raise ValueError("a free motion has no profile to follow by fixed steps")
        return Evaluator(self.task, self.profile, steps, **options)

    @cached_property
    def scenarios(self) -> tuple[JudgedMotion, ...]:
        """The motion in every scenario of the task, itself the first."""
        named = (dict(zip(self.task.error_names, errors)) for errors in self.task.scenarios[1:])
        return (self, *map(self.perturbed, named))

    @property
    def energy(self) -> float:
        """The task's energy [J]."""
        return self._run.energy

    @cached_property
    def residual(self) -> float:
        """Residual: largest tip displacement after arrival from the wanted free vibration [m]."""
        missed = self.task.missed(self.arrival)
        pairs = zip(self.scenarios, missed)
        return max(float(motion.vibration.peak(state)) for motion, state in pairs)

    @cached_property
    def arrival(self) -> NDArray[np.float64]:
        """W (m) and then W' (m/s) on arrival, shape (scenarios, 2 * modes)."""
        return np.array([motion._run.arrival for motion in self.scenarios])

    @cached_property
    def figures(self) -> Figures:
        """All figures by name, as of `FIGURES`; peaks include those between the samples."""
        return Figures(candidate=self)

    @property
    def motion(self) -> Figures:
        """Figures of the motion, by the name that they had in 2.0."""
        return self.figures

    @property
    def net_work(self) -> float:
        """Integral of torque * speed over the move [J]: dissipated and stored energy."""
        return self._run.net_work

    @property
    def overshoot(self) -> float:
        """Largest way of the joint beyond the target [rad], 0 if it does not exceed it."""
        past_target = self._largest(self.moving.path.angle[None]) - self.task.target
        return max(0.0, float((past_target * np.sign(self.task.span)).max()))

    @property
    def moving(self) -> Sample:
        """Everything on the way, an array over the samples of the quadrature for each value."""
        return self._samples.sample

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the samples of `moving` [s]; where two pieces meet, two samples of one time."""
        lengths = self.path.arguments[-1]
        begins = np.append(0.0, np.cumsum(lengths[:-1]))
        times = (begins[:, None] + np.outer(lengths, self._mesh.samples)).ravel()
        return np.minimum(times, self.task.duration)  # beyond it by rounding

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Weights of these samples [s]: sums of weight times value are integrals over the move."""
        of_a_step = np.outer(self._mesh.lengths, GAUSS_WEIGHTS).ravel()
        of_a_piece = np.concatenate([[0.0], of_a_step, [0.0]])  # the ends are no nodes
        return np.outer(self.path.arguments[-1], of_a_piece).ravel()

    def range_of(self, quantity: Quantity) -> tuple[float, float]:
        """Least and largest value of a quantity; infinite where the motion does not have it."""
        if quantity.name == RESIDUAL:
            return -self.residual, self.residual
        if quantity not in self._known_ranges:
            has_it = quantity.derivative != OF_THIRD_ORDER or self.path.has_jerk
            self._known_ranges[quantity] = self._range(quantity) if has_it else (-inf, inf)
        return self._known_ranges[quantity]

    @cached_property
    def _known_ranges(self) -> dict[Quantity, tuple[float, float]]:
        return {}

    def values_of(self, quantity: Quantity) -> NDArray[np.float64]:
        """Return the values of a quantity over the samples of `moving`, a row each."""
        return np.array(quantity.values(self.moving))

    def peak_of_rows(self, rows: Sequence[NDArray[np.float64]]) -> float:
        """Return the largest absolute value of rows over these samples, between them as well."""
        return float(np.abs(self._largest(np.array(rows))).max())

    def peaks_of_joints(self, quantity: Quantity) -> NDArray[np.float64]:
        """Return the largest absolute value of a quantity of the joints, of each of them."""
        return np.abs(self.ranges_of_joints(quantity)).max(axis=1)

    def _range(self, quantity: Quantity) -> tuple[float, float]:
        """Least and largest value in the scenarios that count, between the samples as well."""
        counted = self.scenarios if quantity.in_scenarios else (self,)
        ranges = np.concatenate([motion.ranges_of_joints(quantity) for motion in counted])
        return float(ranges.min()), float(ranges.max())

    def ranges_of_joints(self, quantity: Quantity) -> NDArray[np.float64]:
        """Return the least and the largest of each value of a quantity on this plant, a row each.

        Of a quantity of the joints these are the values of each joint.
        """
        return self._largest(self.values_of(quantity))

    def _largest(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Least and largest value of each row of samples."""
        return extremes(self._mesh.samples, rows)

    @cached_property
    def in_full(self) -> FullFigures | None:
        """Figures by the whole equations of a plant whose own are a reduction; None of others.

        They are computed by CVODES without the tables and modes of the plant. Errors of the damping
        alone have no such equations.
        """
        equations = self.plant.in_full
        if equations is None:
            return None
        vibration = self.vibration
        return follow_in_full(
            equations,
            self.path,
            (self.task.start, self.task.target),
            self._mesh.steps,
            times_after(float(vibration.window), float(vibration.fastest)),
            self.task.energy,
        )

    @cached_property
    def on_drive(self) -> DriveFigures | None:
        """Figures on the plant's drive, judged by its servo, transmission and dry friction.

        None where no drive is stated whose loops are known, and of a free motion.
        """
        drive = self.task.plant.drive
        if drive is None or not drive.has_loops or self.profile is None:
            return None
        servo = self._servo
        run = self.run_on_drive()
        inside = np.minimum(run.time, self.task.duration)
        planned = np.array(self.nominal.sample(np.unique(inside)).motion.angle)
        planned = np.append(planned, np.full(len(run.time) - len(planned), planned[-1]))
        return figures_of(servo, run, planned, self.task.duration, self.task.target)

    @property
    def modes_on_drive(self) -> tuple[Mode, Mode]:
        """The slowest mode with the joint held, and on its servo, without friction."""
        servo = self._servo
        target = self.task.target
        return held_mode(servo.plant, target), mode_on_servo(servo.plant, target)

    def run_on_drive(self) -> DriveRun:
        """Run the plant on its drive along the set points, until the residual window is over."""
        rate = round(1 / FINEST)
        return run_on_drive(
            self._servo,
            self.set_points(rate),
            self.task.residual_window,
            fastest_along(self.task.plant, self.task.start, self.task.target),
            self.task.initial_state,
        )

    @property
    def inverts_drive(self) -> bool:
        """Return whether set points differ from the planned path, so that the load follows it.

        Not where the plant's frequencies were recorded on the moving servo: they then have it.
        """
        drive = self.task.plant.drive
        return drive is not None and drive.has_loops and drive.recorded == "held"

    def set_points(self, sample_rate: float) -> SetPoints:
        """Return what the servo has to be given, rows at a rate [Hz].

        They are the planned path, unless `inverts_drive`. Then the drive's linear model is inverted
        so that the load follows the path: rows go on until the servo has settled.
        """
        task = self.task
        drive = task.plant.drive
        if drive is None or not self.inverts_drive:
            ticks = math.ceil(task.duration * sample_rate - 1e-9)
            times = np.arange(ticks + 1) / sample_rate
            path = self.nominal.sample(times).motion
            return SetPoints(times, path.angle, path.speed, path.acceleration)
        every = max(1, math.ceil(1 / (sample_rate * FINEST) - 1e-9))
        step = 1 / (sample_rate * every)
        times = step * np.arange(math.floor(task.duration / step + 1e-9) + 1)
        sampled = self.nominal.sample(np.minimum(times, task.duration))
        path = sampled.motion
        effort = sampled.torque - np.array(drive.friction(path.speed)).ravel()
        servo = Servo(task.plant, task.start)
        return invert(servo, Servo(task.plant, task.target), path, effort, step, every)

    @property
    def nominal(self) -> JudgedMotion:
        """Copy of this motion on the plant without errors."""
        return replace(self, errors={}) if self.errors else self

    @property
    def _servo(self) -> Servo:
        """The plant with the errors, its joint held, on its drive."""
        held = as_held(self.task.plant, self.task.target)
        return Servo(perturb_plant(held, self.errors), self.task.start)

    @property
    def trajectory(self) -> Trajectory:
        """The move and the residual window; where two pieces meet, two samples of one time."""
        vibration = self.vibration
        # Phase of the fastest mode between samples after arrival: these miss 1.2e-6 of a peak at
        # most.
        radians_a_sample = 0.003
        samples = math.ceil(vibration.window * vibration.fastest / radians_a_sample) + 2
        later = np.linspace(0.0, vibration.window, samples)
        outputs = np.hstack([self._run.outputs, self._after(later)])
        times = np.append(self.times, self.task.duration + later)
        return Trajectory.from_outputs(self.plant, times, outputs)

    def sample(self, times: ArrayLike) -> Trajectory:
        """Sample a motion along a profile.

        Parameters
        ----------
        times : array_like, shape (samples,)
            Increasing times from 0 on [s]; those after the duration show the residual vibration.

        Raises
        ------
        ValueError
            When the times do not increase from 0 or later, or the motion is a free one.
        """
        at = np.atleast_1d(numbers("sample times", times, "numbers in s", infinite=True))
        duration = self.task.duration
        ordered = at.ndim == 1 and at.size and at[0] >= 0 and np.all(np.diff(at) > 0)
        if not (ordered and np.all(np.isfinite(at))):
            raise ValueError(
                f"sample times are {reprlib.repr(at.tolist())}; give finite ones that increase "
                "from 0 or later"
            )
        if self.path.arguments.shape[1] > 1:
            raise ValueError("a free motion has samples of its own; take its trajectory")
        moving = at[at <= duration]
        later = at[at > duration] - duration
        fractions, places = np.unique(np.append(moving / duration, [0.0, 1.0]), return_inverse=True)
        initial = self.task.initial_state
        outputs = integrate_to(self.task.plant, self.errors, self.path, initial, fractions)
        outputs = np.hstack([outputs[:, places[:-2]], self._after(later)])
        return Trajectory.from_outputs(self.plant, at, outputs)

    @cached_property
    def _run(self) -> Integration:
        _ = self.vibration  # refuses a window that is too long
        task = self.task
        return integrate(
            task.plant,
            self.errors,
            self.path,
            task.initial_state,
            self._mesh.steps,
            task.energy,
            task.smallness,
        )

    @cached_property
    def plant(self) -> Plant:
        """The plant with the errors."""
        return perturb_plant(self.task.plant, self.errors)

    @cached_property
    def vibration(self) -> FreeVibration:
        """The free vibration of this plant after arrival."""
        return vibration_of(self.plant, self.task.target, self.task.residual_window)

    @cached_property
    def _mesh(self) -> Mesh:
        """Steps of the quadrature on every piece."""
        # Least number of steps of the quadrature, in all and where nothing breaks: its nodes are
        # at most a thousandth of the move apart, or two. On the paper's conditions energies with
        # 250 are those with 2000 within 1e-10.
        least_steps = 500
        least_smooth_steps = 250
        least = least_smooth_steps if self.path.smooth else least_steps
        fastest = fastest_along(self.task.plant, self.task.start, self.task.target)
        # Steps for each radian of the plant's fastest mode, where this gives more.
        steps_a_radian = 10
        blocks = math.ceil(steps_a_radian * fastest * self.task.duration / least)
        of_a_piece = math.ceil(least * max(1, blocks) / self.path.arguments.shape[1])
        # Of the shortest part between two breaks: there a spline may turn its acceleration.
        steps_of_a_part = 2
        of_a_piece = max(of_a_piece, math.ceil(steps_of_a_part / self.path.shortest_part))
        # So that every piece has the seven samples that `extremes` needs.
        least_of_a_piece = 2
        return Mesh(max(of_a_piece, least_of_a_piece))

    @cached_property
    def _samples(self) -> Trajectory:
        """Everything on the way, at the samples of the quadrature."""
        outputs = self._run.outputs
        return Trajectory.from_outputs(
            self.plant,
            np.zeros(outputs.shape[1]),
            outputs,
        )

    def _after(self, later: NDArray[np.float64]) -> NDArray[np.float64]:
        """`outputs_of` the joint at rest, at times since arrival [s]."""
        states = self.vibration.states(self._run.arrival, later)
        joint = JointMotion(self.task.target, 0.0, 0.0, 0.0)
        return outputs_of(self.plant, joint, ca.DM(states.T)).full()
