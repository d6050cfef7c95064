"""The independent integrator along a profile: CVODES, sampled at the nodes of a fine quadrature.

Every figure that a plan reports comes from here, not from the optimiser's own fixed steps. CVODES
is built once for a plant and a profile: what differs between moves is a parameter, and time is the
fraction of the duration, so that one grid of samples serves every move.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models import Expression, JointMotion, Plant
from ocp.base.interrupts import keep_interrupts
from ocp.profiles.joint_profile import JointProfile
from ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES, mesh
from ocp.simulation.cvodes import (
    CVODES,
    Trajectory,
    after_arrival,
    cvodes_for,
    outputs_at_rest,
    outputs_of,
    rates_of,
    residual_of,
)
from ocp.simulation.extremes import extremes
from ocp.simulation.objective import Motion, beyond_quadratic, resolved_energy
from ocp.simulation.residual import fastest_mode, residual_samples
from ocp.task.point_to_point import PointToPoint

_STEPS = 500
"""Steps of the quadrature, or a multiple: its nodes are a thousandth of the move apart at most."""
_STEPS_A_RADIAN = 10
"""The same in radians of the plant's fastest mode."""


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
        raise ValueError("sample times must be finite and increase from 0 or later")
    checked = profile.checked(coefficients, task.duration)
    moving, later = grid[grid <= task.duration], grid[grid > task.duration] - task.duration
    fractions, at = np.unique(np.append(moving / task.duration, [0.0, 1.0]), return_inverse=True)
    with _cvodes_along(checked):
        states, outputs = _along(task.plant, profile, fractions)([*checked, *task.move])
        rows = outputs.full()[:, at[:-2]]
        if later.size:
            resting = after_arrival(task.plant, task.target, later)(x0=states[:, -1])["xf"]
            rows = np.hstack([rows, outputs_at_rest(task, resting)])
    return Trajectory.from_outputs(task.plant, grid, rows)


def resimulate(task: PointToPoint, profile: JointProfile, coefficients: ArrayLike) -> Motion:
    """Residual, energy and diagnostics of a motion by CVODES.

    Arguments and errors as for `resimulated`, whose figures it returns.
    """
    return resimulated(task, profile, coefficients)[0]


@keep_interrupts()
def resimulated(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike
) -> tuple[Motion, NDArray[np.float64]]:
    """Residual, energy and diagnostics of a motion by CVODES, and its state on arrival.

    CVODES gives the modes at the nodes of a fine quadrature, which finds the power's sign changes.

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
    ndarray, shape (2 * modes,)
        W (m) and then W' (m/s) on arrival.

    Raises
    ------
    ValueError
        When the coefficients or the duration do not fit the profile.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    residual_samples(task)  # refuses a window beyond reason
    checked = profile.checked(coefficients, task.duration)
    blocks = math.ceil(_STEPS_A_RADIAN * fastest_mode(task) * task.duration / _STEPS)
    steps = _STEPS * max(1, blocks)
    fractions = np.concatenate([[0.0], _nodes(steps), [1.0]])
    with _cvodes_along(checked):
        figures = _figures(task.plant, profile, steps)
        values = [value.full() for value in figures([*checked, *task.move])]
    outputs, arrival, energy, net_work = values
    extreme = Trajectory.from_outputs(task.plant, np.zeros(2), extremes(fractions, outputs))
    motion = Motion.from_samples(
        task,
        extreme.motion,
        extreme.tips,
        extreme.torque,
        residual=residual_of(task, arrival[:, 0]),
        energy=energy.item(),
        net_work=net_work.item(),
    )
    return motion, arrival[:, 0]


def _cvodes_along(coefficients: Sequence[float]) -> AbstractContextManager[None]:
    largest = max(map(abs, coefficients), default=0.0)
    return cvodes_for(f"; are the coefficients far out of scale? (largest is {largest:g})")


@lru_cache(maxsize=16)
def _nodes(steps: int) -> NDArray[np.float64]:
    """When the Gauss nodes of all steps come, as shares of the duration."""
    begin, length = (entry.full() for entry in mesh(ca.DM(np.arange(steps)), steps))
    return (begin + length * np.array(GAUSS_NODES)).ravel()


@lru_cache(maxsize=16)
@keep_interrupts()
def _figures(plant: Plant, profile: JointProfile, steps: int) -> ca.Function:
    """(coefficients and move) -> outputs at the nodes and ends, state at arrival, energy, work."""
    length = mesh(ca.DM(np.arange(steps)).T, steps)[1]
    given = ca.MX.sym("p", profile.size + 3)
    states, outputs = _along(plant, profile, np.concatenate([[0.0], _nodes(steps), [1.0]]))(given)
    rows = ca.vertsplit(outputs)
    power, h = (rows[-1] * rows[1])[1:-1], given[-1] * length
    at_nodes = ca.vertsplit(ca.reshape(power, NODES, steps))
    beyond = (ca.horzcat(*at_nodes) @ weights for weights in beyond_quadratic(steps))
    energy = resolved_energy(at_nodes, h, *beyond)
    net_work = ca.sum2(h * sum(w * p for w, p in zip(GAUSS_WEIGHTS, at_nodes, strict=True)))
    return ca.Function("figures", [given], [outputs, states[:, -1], energy, net_work])


def _along(plant: Plant, profile: JointProfile, fractions: NDArray[np.float64]) -> ca.Function:
    """(coefficients and move) -> states and outputs at these fractions of the move, from 0 on."""

    def joint(given: Expression, fraction: Expression, jerk: bool = False) -> JointMotion:
        entries = ca.vertsplit(given)
        return profile.motion(entries[:-3], fraction, *entries[-3:], jerk=jerk)

    size, count = 2 * plant.modes, len(fractions)
    state, fraction, given = ca.SX.sym("x", size), ca.SX.sym("t"), ca.SX.sym("p", profile.size + 3)
    rates = given[-1] * rates_of(plant, joint(given, fraction), state)
    problem = {"t": fraction, "x": state, "p": given, "ode": rates}
    integrate = ca.integrator("move", "cvodes", problem, 0.0, fractions[1:].tolist(), CVODES)
    states, fraction = ca.MX.sym("x", size, count), ca.MX.sym("t", 1, count)
    given = ca.MX.sym("p", profile.size + 3)
    outputs = outputs_of(plant, joint(given, fraction, jerk=True), states)
    observe = ca.Function("observe", [fraction, states, given], [outputs])
    at_rest = ca.DM.zeros(size)
    states = ca.horzcat(at_rest, integrate(x0=at_rest, p=given)["xf"])
    return ca.Function("along", [given], [states, observe(ca.DM(fractions).T, states, given)])
