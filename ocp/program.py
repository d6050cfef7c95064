"""A nonlinear program for one task: scales, bounds and start values around the compiled one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from models import Plant
from ocp.interrupts import keep_interrupts
from ocp.profile import JointProfile
from ocp.residual import extreme_rows, residual_matrix
from ocp.status import SolveStatus
from ocp.task import PointToPoint
from ocp.transcription import RESIDUAL, NonlinearProgram, Point

ENERGY = "energy"
LEAST_ENERGY = {ENERGY: 1.0}
OPTIONS: dict[str, str | int | float] = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-9,
    "constr_viol_tol": 1e-10,
    "mu_strategy": "adaptive",
    "max_iter": 500,
    # Without these an infeasible task takes a hundred times as long: MUMPS's permutation fills in
    # the restoration phase's system, and IPOPT turns to that phase late. Feasible ones take the
    # same iterations either way.
    "mumps_permuting_scaling": 0,
    # Approximate minimum fill copes best with the dense columns of the coefficients: at 400 steps
    # and 20 terms a fifth of the default ordering's time.
    "mumps_pivot_order": 2,
    "expect_infeasible_problem": "yes",
}
_WARM_PUSH = 1e-6
_WARM_OPTIONS: dict[str, str | int | float] = {
    "warm_start_init_point": "yes",
    "mu_init": _WARM_PUSH,
    "warm_start_bound_push": _WARM_PUSH,
    "warm_start_bound_frac": _WARM_PUSH,
    "warm_start_slack_bound_push": _WARM_PUSH,
    "warm_start_slack_bound_frac": _WARM_PUSH,
    "warm_start_mult_bound_push": _WARM_PUSH,
}
"""From the solution beside it a point of a front takes a third of the iterations with these."""
_ROWS_AT_ONCE = 32
"""Residual rows are filled up to a multiple of this: tasks that differ by a row share a program."""
SLACK_ROOM = 1e-2
"""How far the slacks of |power| start inside their constraints, as a share of the peak power."""


@lru_cache(maxsize=16)
def _compiled(
    plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...], rows: int
) -> NonlinearProgram:
    return NonlinearProgram(plant, profile, steps, quantities, rows, OPTIONS, _WARM_OPTIONS)


@dataclass(frozen=True)
class Solution:
    """What one run of the solver gives, in SI units and by its own discretisation.

    Attributes
    ----------
    coefficients : ndarray, shape (profile.size,)
        The profile's coefficients.
    energy : float
        F2 [J].
    peaks : dict of str to float
        Each limited quantity, and the residual where the program has it as a variable.
    status : SolveStatus
        How it ended.
    slope : float
        Change of the least energy with the residual limit [J/m], at most 0; 0 without a limit.
    iterations : int
        Iterations of the solver that it took, those of other starts included.
    point : Point
        Where the solver stopped, to start a neighbouring solve from.
    """

    coefficients: NDArray[np.float64]
    energy: float
    peaks: dict[str, float]
    status: SolveStatus
    slope: float
    iterations: int
    point: Point

    @property
    def residual(self) -> float:
        """F1 [m]; 0 where the program asks for rest."""
        return self.peaks.get(RESIDUAL, 0.0)


class TaskProgram:
    """The compiled program with one task's numbers in it.

    Everything is measured against the profile with all coefficients zero, so that the solver sees
    numbers of order one for any plant.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    steps : int
        Number of steps.
    with_residual : bool
        Whether the residual is a variable, to be limited or minimised; else it is zero: the plant
        is at rest on arrival.
    """

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(
        self, task: PointToPoint, profile: JointProfile, steps: int, with_residual: bool
    ) -> None:
        self.task, self.steps = task, steps
        matrix = _residual_rows(task) if with_residual else np.zeros((0, 2 * task.plant.modes))
        self.program = _compiled(task.plant, profile, steps, tuple(task.limits), len(matrix))
        layout, groups = self.program.layout, self.program.model.groups
        states, outputs = self.program.simulate(
            np.zeros(profile.size), task.move, np.ones(self.program.model.scales)
        )
        peaks = [np.abs(outputs[group.where]).max() for group in groups[1:]]
        self.scale = np.array([*np.abs(states).max(axis=1), *peaks])
        self.scale[self.scale == 0] = 1.0
        self.reference = {
            group.name: float(scale)
            for group, scale in zip(groups[1:], self.scale[layout.state :], strict=True)
        }
        self.matrix = matrix * self.scale[: layout.state]
        if with_residual:
            self.reference[RESIDUAL] = float(np.abs(self.matrix).max())
            self.matrix = self.matrix / self.reference[RESIDUAL]

    @keep_interrupts()
    def solve(
        self,
        guess: NDArray[np.float64] | Solution,
        limits: Mapping[str, float],
        bound: float | None,
        minimise: Mapping[str, float] = LEAST_ENERGY,
    ) -> Solution:
        """Run the solver from one vector of coefficients, or on from another solution.

        Parameters
        ----------
        guess : ndarray, shape (profile.size,), or Solution
            Coefficients to start from, or a solution of this program with limits or weights that
            are a little different.
        limits : mapping of str to float
            Largest residual [m] and peaks [SI units]; a quantity without an entry is free.
        bound : float or None
            Largest absolute coefficient.
        minimise : mapping of str to float
            Weights of the energy [1/J] and of peaks [1/m, ...], whose sum is made least.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        layout = self.program.layout
        units = np.array([self._energy_unit, *(self.reference[name] for name in layout.peaks)])
        weights = units * [minimise.get(name, 0.0) for name in (ENERGY, *layout.peaks)]
        weights /= weights.max()
        parameters = np.concatenate(
            [self.task.move, self.scale, weights, self.matrix.ravel(order="F")]
        )
        lower, upper = self._bounds(limits, bound)
        start = guess.point if isinstance(guess, Solution) else self._start(guess)
        point, return_status, iterations = self.program.solve(start, lower, upper, parameters)
        x = point.unknowns
        mean_power = self.program.node_weights @ x[layout.first_slack :]
        peaks = dict(zip(layout.peaks, x[layout.coefficients : layout.first_state], strict=True))
        slope = 0.0
        if RESIDUAL in peaks:
            # the variable may lie anywhere between the residual and a limit that is not in the way
            at_arrival = x[layout.first_slack - layout.state : layout.first_slack]
            peaks[RESIDUAL] = np.abs(self.matrix @ at_arrival).max()
            multiplier = max(point.bound_multipliers[layout.coefficients], 0.0)
            slope = -multiplier * self._energy_unit / self.reference[RESIDUAL]
        return Solution(
            coefficients=np.clip(x, lower, upper)[: layout.coefficients],  # IPOPT passes by 1e-10
            energy=float(mean_power * self._energy_unit),
            peaks={name: float(peak * self.reference[name]) for name, peak in peaks.items()},
            status=SolveStatus.from_ipopt(return_status),
            slope=float(slope),
            iterations=iterations,
            point=point,
        )

    @property
    def _energy_unit(self) -> float:
        return self.reference["power"] * self.task.duration

    def _bounds(
        self, limits: Mapping[str, float], bound: float | None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        layout = self.program.layout
        lower, upper = np.full(layout.unknowns, -np.inf), np.full(layout.unknowns, np.inf)
        if bound is not None:
            lower[: layout.coefficients], upper[: layout.coefficients] = -bound, bound
        for i, name in enumerate(layout.peaks, start=layout.coefficients):
            lower[i], upper[i] = 0.0, limits.get(name, np.inf) / self.reference[name]
        at_rest = [slice(layout.first_state, layout.first_state + layout.state)]
        if RESIDUAL not in layout.peaks:
            at_rest.append(slice(layout.first_slack - layout.state, layout.first_slack))
        for entries in at_rest:
            lower[entries] = upper[entries] = 0.0
        return lower, upper

    def _start(self, guess: NDArray[np.float64]) -> Point:
        """Unknowns that agree with the guess: its own states, slacks and peaks."""
        states, outputs = self.program.simulate(guess, self.task.move, self.scale)
        values = {group.name: outputs[group.where] for group in self.program.model.groups}
        values[RESIDUAL] = self.matrix @ states[:, -1]
        peaks = [float(np.abs(values[name]).max()) for name in self.program.layout.peaks]
        slack = np.abs(values["power"].ravel(order="F")) + SLACK_ROOM
        return Point(np.concatenate([guess, peaks, states.ravel(order="F"), slack]))


def _residual_rows(task: PointToPoint) -> NDArray[np.float64]:
    rows = extreme_rows(residual_matrix(task), task.plant.tips)
    return np.pad(rows, ((0, -len(rows) % _ROWS_AT_ONCE), (0, 0)), mode="edge")
