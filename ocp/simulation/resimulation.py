"""The independent integrator: CVODES along any joint motion, and the figures of what it finds.

Every figure that a plan or a floor reports comes from here, not from the optimiser's own fixed
steps. A motion is smooth pieces one after another: a profile is one, a free motion has one for
every interval. CVODES starts anew at every piece, since the acceleration (or the jerk) jumps there,
and gives the modes at the nodes of a fine quadrature, which finds the power's sign changes. It is
built once for a plant and a kind of piece: what differs between moves is a parameter, and time is
the fraction of the piece.
"""

from __future__ import annotations

import math
import reprlib
from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Plant
from quietarm.ocp.energy import Energy, power_of
from quietarm.ocp.interrupts import keep_interrupts, one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.buffered import BufferedFunction
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.cvodes import (
    Errors,
    Trajectory,
    cvodes_for,
    options_for,
    outputs_at_rest,
    outputs_of,
    rates_of,
    rest_of,
)
from quietarm.ocp.simulation.extremes import extremes
from quietarm.ocp.simulation.free_vibration import FreeVibration, after_arrival, fastest_along
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.simulation.objective import Motion, WithPeaks, integrated, spent
from quietarm.ocp.simulation.piecewise import Law, PiecewiseMotion
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

_STEPS, _SMOOTH_STEPS = 500, 250
"""Least number of steps of the quadrature, in all and where nothing breaks: its nodes are at most a
thousandth of the move apart, or two. On the paper's conditions energies with 250 are those with
2000 within 1e-10."""
_STEPS_A_RADIAN = 10
"""Steps for each radian of the plant's fastest mode, where this gives more."""
_LEAST_STEPS_OF_A_PIECE = 2
"""So that every piece has the seven samples that `extremes` needs."""


@one_at_a_time
@keep_interrupts()  # casadi loses a Ctrl-C
def sample_trajectory(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike, times: ArrayLike
) -> Trajectory:
    """Simulate a motion with CVODES and sample it.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.
    times : array_like, shape (samples,)
        Increasing times from 0 on [s]; those after the duration show the residual vibration.

    Returns
    -------
    Trajectory
        The samples.

    Raises
    ------
    ValueError
        When the times do not increase from 0 or later, or coefficients or duration do not
        fit the profile.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    grid = np.atleast_1d(np.asarray(times, dtype=float))
    ordered = grid.ndim == 1 and grid.size and grid[0] >= 0 and np.all(np.diff(grid) > 0)
    if not (ordered and np.all(np.isfinite(grid))):
        raise ValueError(
            f"sample times are {reprlib.repr(grid.tolist())}; give finite ones that increase from "
            "0 or later"
        )
    joint = PiecewiseMotion.of_profile(task, profile, coefficients)
    moving, later = grid[grid <= task.duration], grid[grid > task.duration] - task.duration
    fractions, at = np.unique(np.append(moving / task.duration, [0.0, 1.0]), return_inverse=True)
    with cvodes_for(joint.remedy):
        states, outputs = _along(task.plant, joint.law, joint.given.shape, fractions)(
            joint.given, ca.DM(0, 1), task.initial_state
        )
        rows = outputs.full()[:, at[:-2]]
    if later.size:
        resting = after_arrival(task)[0].states(states[:, -1].full().ravel(), later)
        rows = np.hstack([rows, outputs_at_rest(task, resting)])
    return Trajectory.from_outputs(task.plant, grid, rows)


def resimulate(task: PointToPoint, profile: JointProfile, coefficients: ArrayLike) -> Motion:
    """Residual, energy and diagnostics of a motion by CVODES.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.

    Returns
    -------
    Motion
        The figures.

    Raises
    ------
    ValueError
        When the coefficients or the duration do not fit the profile.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    joint = PiecewiseMotion.of_profile(task, profile, coefficients)
    return Motion.worst([one.motion for one in in_scenarios(task, joint)])


def in_scenarios(task: PointToPoint, joint: PiecewiseMotion) -> list[Resimulation]:
    """A joint motion in every scenario of a task."""
    names = task.error_names
    named = [tuple(zip(names, errors, strict=True)) for errors in task.scenarios[1:]]
    return [resimulated(task, joint, errors) for errors in ((), *named)]


@dataclass(frozen=True, eq=False)
class Resimulation(WithPeaks):
    """What CVODES makes of a joint motion; figures as of `Motion`.

    Attributes
    ----------
    arrival : ndarray, shape (2 * modes,)
        W (m) and then W' (m/s) on arrival.
    outputs : ndarray, shape (rows of `outputs_of`, pieces * samples)
        Samples of every piece: at its ends, and at the nodes of the quadrature.
    """

    task: PointToPoint
    joint: PiecewiseMotion
    residual: float
    energy: float
    net_work: float
    arrival: NDArray[np.float64]
    outputs: NDArray[np.float64]

    @cached_property
    def motion(self) -> Motion:
        """Residual, energy and diagnostics; peaks are those between the samples.

        They take a fifth of the simulation's time, and a front without limits needs none of them.
        """
        largest = extremes(Grid(self._steps).samples, self.outputs)
        extreme = Trajectory.from_outputs(self.task.plant, np.zeros(2), largest)
        return Motion.from_samples(
            self.task,
            extreme.motion if self.joint.has_jerk else extreme.motion._replace(jerk=None),
            extreme.tips,
            extreme.torque,
            residual=self.residual,
            energy=self.energy,
            net_work=self.net_work,
        )

    def peak(self, name: str) -> float:
        """As of `WithPeaks`."""
        return self.residual if name == "residual" else self.motion.peak(name)

    @property
    def _steps(self) -> int:
        """Steps of the quadrature on every piece."""
        return self.outputs.shape[1] // len(self.joint.given[-1]) // NODES

    @property
    def trajectory(self) -> Trajectory:
        """Samples of the move and of the residual window after it.

        Where two pieces meet there are two samples of the same time: before and after a jump of
        torque or acceleration.
        """
        lengths = self.joint.given[-1]
        begins = np.append(0.0, np.cumsum(lengths[:-1]))
        times = (begins[:, None] + np.outer(lengths, Grid(self._steps).samples)).ravel()
        times = np.minimum(times, self.task.duration)  # beyond it by rounding
        moving = vars(Trajectory.from_outputs(self.task.plant, times, self.outputs))
        resting = vars(rest_of(self.task, self.arrival))
        return Trajectory(
            **{name: np.concatenate([moving[name], resting[name]]) for name in moving}
        )


@one_at_a_time
@keep_interrupts()
def resimulated(task: PointToPoint, joint: PiecewiseMotion, errors: Errors = ()) -> Resimulation:
    """Simulate a joint motion with CVODES, on the nominal plant or one with errors."""
    vibration = after_arrival(task)[0]
    if errors:
        wrong_plant = perturb_plant(task.plant, dict(errors))
        vibration = FreeVibration(wrong_plant, task.target, task.residual_window)
    least = _SMOOTH_STEPS if joint.smooth else _STEPS
    fastest = fastest_along(task.plant, task.start, task.target)
    blocks = math.ceil(_STEPS_A_RADIAN * fastest * task.duration / least)
    of_a_piece = math.ceil(least * max(1, blocks) / joint.given.shape[1])
    steps = max(of_a_piece, _LEAST_STEPS_OF_A_PIECE)
    with cvodes_for(joint.remedy):
        names = tuple(name for name, _ in errors)
        figures = _figures(task.plant, joint.law, joint.given.shape, steps, names, task.energy)
        wrong = [[error for _, error in errors]]
        outputs, arrival, energy, net_work = (
            value.T.copy() for value in figures(joint.given.T, wrong, [task.initial_state])
        )
    arrived = arrival[:, 0]
    residual = float(vibration.peak(task.missed(arrived)))
    return Resimulation(task, joint, residual, energy.item(), net_work.item(), arrived, outputs)


@lru_cache(maxsize=32)
@keep_interrupts()
def _figures(
    plant: Plant,
    law: Law,
    shape: tuple[int, int],
    steps: int,
    names: tuple[str, ...],
    definition: Energy,
) -> BufferedFunction:
    """(given, errors, state before) -> outputs at nodes and ends, arrival, energy, net work."""
    given, grid = ca.MX.sym("p", *shape), Grid(steps)
    errors, initial = ca.MX.sym("e", len(names)), ca.MX.sym("x", 2 * plant.modes)
    states, outputs = _along(plant, law, shape, grid.samples, names)(given, errors, initial)
    rows = ca.vertsplit(outputs)
    torque, speed = (
        [samples[1 + node : -1 : NODES, :].T for node in range(NODES)]
        for samples in (ca.reshape(row, -1, shape[1]) for row in (rows[-1], rows[1]))
    )
    h = given[-1, :].T @ grid.columns()[1]
    power = [power_of(*node) for node in zip(torque, speed, strict=True)]
    energy, net_work = spent(definition, torque, speed, h), integrated(power, h)
    figures = [outputs, states[:, -1], ca.sum1(energy), ca.sum1(net_work)]
    dense = [ca.densify(figure) for figure in figures]  # a plant's output may be zero throughout
    return BufferedFunction(ca.Function("figures", [given, errors, initial], dense))


def _along(
    plant: Plant,
    law: Law,
    shape: tuple[int, int],
    fractions: NDArray[np.float64],
    names: tuple[str, ...] = (),
) -> ca.Function:
    """(given, errors, state before) -> states and outputs at these fractions of every piece."""
    (numbers, pieces), count = shape, len(fractions)
    integrate = _over_a_piece(plant, law, numbers, fractions, names)
    given, errors = ca.MX.sym("p", numbers, pieces), ca.MX.sym("e", len(names))
    initial = ca.MX.sym("x", 2 * plant.modes)
    with_each = ca.vertcat(given, ca.repmat(errors, 1, pieces))
    _, states = integrate.mapaccum(pieces)(initial, with_each)
    at_samples = [
        row if pieces == 1 else ca.vec(ca.repmat(row, count, 1)).T for row in ca.vertsplit(given)
    ]
    joint = law(at_samples, ca.DM(np.tile(fractions, pieces)).T, jerk=True)
    wrong = _wrong(plant, names, errors)
    outputs = outputs_of(wrong, joint, states)
    return ca.Function("along", [given, errors, initial], [states, outputs])


def _wrong(plant: Plant, names: tuple[str, ...], errors: ca.SX | ca.MX) -> Plant:
    return perturb_plant(plant, dict(zip(names, ca.vertsplit(errors), strict=True)))


def _over_a_piece(
    plant: Plant,
    law: Law,
    numbers: int,
    fractions: NDArray[np.float64],
    names: tuple[str, ...],
) -> ca.Function:
    """CVODES: (state before, given and errors) -> state after a piece, states along it."""
    count = numbers + len(names)
    state, fraction, both = (
        ca.SX.sym("x", 2 * plant.modes),
        ca.SX.sym("t"),
        ca.SX.sym("p", count),
    )
    given, wrong = ca.vertsplit(both[:numbers]), _wrong(plant, names, both[numbers:])
    rates = given[-1] * rates_of(wrong, law(given, fraction, jerk=False), state)
    problem = {"t": fraction, "x": state, "p": both, "ode": rates}
    times = fractions[1:]
    integrate = ca.integrator("piece", "cvodes", problem, 0.0, times.tolist(), options_for(times))
    before, both = ca.MX.sym("x", state.numel()), ca.MX.sym("p", count)
    states = ca.horzcat(before, integrate(x0=before, p=both)["xf"])
    return ca.Function("over", [before, both], [states[:, -1], states])
