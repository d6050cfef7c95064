"""A task over free motions: its grids, fine where the speed jumps, and what it gives on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.floor.transcription import (
    POWER,
    SMOOTH,
    of_joint,
    parts_of,
    solver_of,
    values_at_nodes,
)
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import FreeMotion, joint_after
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.simulation.collocation import (
    GAUSS_NODES,
    NODES,
    step,
)
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.simulation.rollout import march
from quietarm.ocp.solvers.nlp import run_ipopt
from quietarm.ocp.solvers.transcription import ENERGY
from quietarm.ocp.task import QUANTITIES, PointToPoint, ask_for_jerk

_AT_AN_END, _SHRINK = 3, 4.0
"""The first and last interval are cut at 1/4, 1/16 and 1/64 of their length: without a limit
against it, the motion of least energy starts and stops the joint with a jolt."""
_JOLT, _PARTS_OF_A_JOLT = 0.02, 4
"""An interval that changes the speed by more than this share of its largest is cut in four."""
_SHORTEST = 4e-5
"""Intervals shorter than this share of the move are left alone."""


def first_grid(steps: int) -> NDArray[np.float64]:
    """Boundaries of about `steps` intervals, as fractions of the move, finer at the ends."""
    even = max(2, steps - 2 * _AT_AN_END)
    boundaries = Grid(even).boundaries
    cuts = boundaries[1] * _SHRINK ** -np.arange(_AT_AN_END, 0.0, -1)
    return np.concatenate([[0.0], cuts, boundaries[1:-1], 1 - cuts[::-1], [1.0]])


def finer(free: FreeMotion) -> FreeMotion:
    """The motion on a grid of twice the intervals, and more where its speed jumps."""
    h = free.lengths
    change = np.abs(h * (free.acceleration + h * free.jerk / 2))
    jolt = change > _JOLT * np.abs(free.boundaries(0.0)[1]).max()
    parts = np.where(jolt, _PARTS_OF_A_JOLT, 2)
    parts[h < _SHORTEST * free.times[-1]] = 1
    return free.split(parts)


Array = NDArray[np.float64]
_SCALE_STEPS = 40
_ROOM = 1e-2
"""How far the two parts of the power start inside their bounds, as a share of its peak."""


@dataclass(frozen=True)
class FreeSolution:
    """What one run of the solver gives, in SI units and by its own discretisation."""

    free: FreeMotion
    energy: float
    peaks: dict[str, float]
    status: SolveStatus
    iterations: int


class _Simulated(NamedTuple):
    """A motion's unknowns but for the power, and what they give at the nodes."""

    unknowns: Array  # (rows, intervals): state before, last derivative of the joint, W'' at nodes
    values: dict[str, Array]  # (values at the nodes, intervals) of what `values_at_nodes` names


class FloorProgram:
    """A task, to be solved on any grid."""

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(self, task: PointToPoint, smooth: bool) -> None:
        if ask_for_jerk(task.limits) and not smooth:
            raise ValueError(
                f"jerk limit is {task.jerk_limit:g} rad/s^3 and the acceleration of this floor "
                "jumps; ask for a smooth floor (smooth=True, or --smooth)"
            )
        self.task, self.smooth, self.plant = task, smooth, task.plant
        self._states = 2 + smooth + 2 * task.plant.modes
        path = CycloidPolynomial(0).path([], *task.move)
        unknowns, values = self._simulated(self.along(path, first_grid(_SCALE_STEPS)))
        # what the plain cycloid reaches, so that the solver sees numbers of order one
        self._scale = np.abs(unknowns).max(axis=1)
        self._scale[0] = abs(task.span)
        self._scale[self._scale == 0] = 1.0
        values[POWER] = task.energy.absolute * np.abs(values[POWER]) + np.abs(values.pop(SMOOTH))
        self._peaks = {name: float(np.abs(of).max()) or 1.0 for name, of in values.items()}
        for name, row in of_joint(task.limits, smooth, self._states).items():
            self._peaks[name] = float(self._scale[row])

    def along(self, path: JointPath, fractions: Array) -> FreeMotion:
        """A motion of this kind on a grid whose speed at the grid is that of a path."""
        times = self.task.duration * fractions
        h = np.diff(times)
        if self.smooth:
            acceleration = path(times, 2)
            acceleration[[0, -1]] = 0.0
            return FreeMotion(times, acceleration[:-1], np.diff(acceleration) / h)
        return FreeMotion(times, np.diff(path(times, 1)) / h, np.zeros(len(h)))

    @keep_interrupts()
    def solve(
        self,
        free: FreeMotion,
        limits: Mapping[str, float],
        minimise: str = ENERGY,
        warm: bool = False,
    ) -> FreeSolution:
        """Run the solver from one motion, on its grid."""
        names, lengths, scale = tuple(self.task.limits), free.lengths, self._scale
        kind = self.plant, self.smooth, free.steps, names, self.task.energy
        solver = solver_of(*kind, warm)
        at = self._simulated(free)
        power = at.values[POWER] / self._peaks[POWER]
        parts = np.maximum(np.vstack([power, -power]), 0.0) + _ROOM
        parts = parts[: parts_of(self.task.energy)]
        peaks = [np.abs(self._of(name, at)).max() / self._peaks[name] for name in names]
        start = _flat(peaks, np.vstack([at.unknowns / scale[:, None], parts]))
        upper = np.full((len(scale) + len(parts), free.steps), np.inf)
        lower = -upper
        lower[len(scale) :] = 0.0
        begun = self._state(self.task.start, self.task.initial_state)
        lower[: self._states, 0] = upper[: self._states, 0] = begun
        most = [limits.get(name, np.inf) / self._peaks[name] for name in names]
        weights = [float(name == minimise) for name in (ENERGY, *names)]
        measures = [self._peaks[name] for name in (POWER, *names)]
        arrived = self._state(self.task.target, self.task.final_state)
        count = (self._states + NODES * self.plant.modes + len(parts) // 2) * free.steps
        of_constraints = np.zeros(solver.size1_in("lbg")), np.full(solver.size1_in("lbg"), np.inf)
        of_constraints[1][:count] = 0.0
        parameters = np.concatenate([lengths, scale, measures, arrived, weights])
        bounds = _flat(np.zeros(len(names)), lower), _flat(most, upper)
        stop = run_ipopt(solver, start, bounds, of_constraints, parameters)
        found = stop.unknowns[len(names) :].reshape(free.steps, -1).T
        rows = found[: len(scale)] * scale[:, None]
        last = rows[self._states]
        parameters[-len(weights) :] = np.eye(len(weights))[0]
        mean = float(solver.get_function("nlp_f")(stop.unknowns, parameters))
        reached = zip(names, stop.unknowns, strict=False)
        return FreeSolution(
            free=FreeMotion(
                free.times,
                rows[2] if self.smooth else last,
                last if self.smooth else np.zeros(free.steps),
            ),
            energy=mean * self.task.duration * self._peaks[POWER],
            peaks={name: float(peak * self._peaks[name]) for name, peak in reached},
            status=SolveStatus.from_ipopt(stop.return_status),
            iterations=stop.iterations,
        )

    def _state(self, angle: float, modes: tuple[float, ...]) -> Array:
        """The state, scaled, with the joint at rest."""
        resting = [0.0] * (self._states - len(modes) - 1)
        return np.array([angle, *resting, *modes]) / self._scale[: self._states]

    def _of(self, name: str, at: _Simulated) -> Array:
        row = of_joint([name], self.smooth, self._states).get(name)
        return at.values[name] if row is None else at.unknowns[row]

    def _simulated(self, free: FreeMotion) -> _Simulated:
        """The modes along a motion, and what it takes."""
        before = [*free.boundaries(self.task.start)[:, :-1], free.acceleration]
        joint = [ca.DM(row).T for row in (*before, *([free.jerk] if self.smooth else []))]
        h = ca.DM(free.lengths).T
        joints = [joint_after(joint, share * h) for share in GAUSS_NODES]
        one = step(self.plant, joints, h)
        W, dW, _ = march(*one.transition(), h.shape, self.task.initial_state)
        ddW = one.accelerations(W, dW)
        nodes, names = one.nodes(W, dW, ddW), tuple(QUANTITIES)
        values = values_at_nodes(self.plant, joints, nodes, names, self.task.energy)
        rows = [*joint[:-1], *W, *dW, joint[-1], *(x for at_node in ddW for x in at_node)]
        numbers = {name: _rows(of, free.steps) for name, of in values.items() if of}
        return _Simulated(_rows(rows, free.steps), numbers)


def _rows(entries: Sequence[Any], steps: int) -> Array:
    return np.array([np.broadcast_to(ca.DM(x).full().ravel(), steps) for x in entries])


def _flat(peaks: Sequence[float] | Array, columns: Array) -> Array:
    """Unknowns as the solver takes them: the peaks, then interval after interval."""
    return np.concatenate([peaks, columns.T.ravel()])
