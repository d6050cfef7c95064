"""The grid of a free motion: fine where the speed jumps, and finer from level to level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.free_motion import FreeMotion, joint_after
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.program.ipopt import OPTIONS, Point, compiled, run_ipopt
from quietarm.ocp.program.solution import ENERGY
from quietarm.ocp.simulation.collocation import (
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    NODES,
    NodeState,
    Step,
    mesh,
    step,
)
from quietarm.ocp.simulation.objective import power_of
from quietarm.ocp.simulation.rollout import march
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
    boundaries = mesh(ca.DM(np.arange(even + 1)), even)[0].full().ravel()
    boundaries[-1] = 1.0
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
_COLD = {**OPTIONS, "tol": 1e-8, "max_iter": 400, "mumps_pivot_order": 0}
"""The systems are sparse and have no dense columns: minimum degree makes them a quarter faster."""
_WARM = {**_COLD, "mu_strategy": "monotone", "mu_init": 1e-6, "max_iter": 150}
"""From a coarser grid's solution; with a larger barrier the solver would move away from it."""
_SCALE_STEPS = 40
_ROOM = 1e-2
"""How far the two parts of the power start inside their bounds, as a share of its peak."""
POWER = "power"


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
    values: dict[str, Array]  # (values at the nodes, intervals) of the power and each quantity


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
        self._peaks = {name: float(np.abs(of).max()) or 1.0 for name, of in values.items()}
        for name, row in _of_joint(task.limits, smooth, self._states).items():
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
        solver = _solver(self.plant, self.smooth, free.steps, names, warm)
        at = self._simulated(free)
        power = at.values[POWER] / self._peaks[POWER]
        parts = np.maximum(np.vstack([power, -power]), 0.0) + _ROOM
        peaks = [np.abs(self._of(name, at)).max() / self._peaks[name] for name in names]
        start = _flat(peaks, np.vstack([at.unknowns / scale[:, None], parts]))
        upper = np.full((len(scale) + len(parts), free.steps), np.inf)
        lower = -upper
        lower[len(scale) :] = 0.0
        lower[: self._states, 0] = upper[: self._states, 0] = self._at_rest(self.task.start)
        most = [limits.get(name, np.inf) / self._peaks[name] for name in names]
        weights = [float(name == minimise) for name in (ENERGY, *names)]
        measures = [self._peaks[name] for name in (POWER, *names)]
        arrived = self._at_rest(self.task.target)
        count = (self._states + NODES * self.plant.modes + NODES) * free.steps
        of_constraints = np.zeros(solver.size1_in("lbg")), np.full(solver.size1_in("lbg"), np.inf)
        of_constraints[1][:count] = 0.0
        stop = run_ipopt(
            solver,
            Point(start),
            (_flat(np.zeros(len(names)), lower), _flat(most, upper)),
            of_constraints,
            np.concatenate([lengths, scale, measures, arrived, weights]),
        )
        found = stop.point.unknowns[len(names) :].reshape(free.steps, -1).T
        rows = found[: len(scale)] * scale[:, None]
        last = rows[self._states]
        energy = lengths @ (GAUSS_WEIGHTS * 2 @ found[len(scale) :]) * self._peaks[POWER]
        reached = zip(names, stop.point.unknowns, strict=False)
        return FreeSolution(
            free=FreeMotion(
                free.times,
                rows[2] if self.smooth else last,
                last if self.smooth else np.zeros(free.steps),
            ),
            energy=float(energy),
            peaks={name: float(peak * self._peaks[name]) for name, peak in reached},
            status=SolveStatus.from_ipopt(stop.return_status),
            iterations=stop.iterations,
        )

    def _at_rest(self, angle: float) -> Array:
        """The state, scaled."""
        return np.append(angle / self._scale[0], np.zeros(self._states - 1))

    def _of(self, name: str, at: _Simulated) -> Array:
        row = _of_joint([name], self.smooth, self._states).get(name)
        return at.values[name] if row is None else at.unknowns[row]

    def _simulated(self, free: FreeMotion) -> _Simulated:
        """The modes along a motion, and what it takes."""
        before = [*free.boundaries(self.task.start)[:, :-1], free.acceleration]
        joint = [ca.DM(row).T for row in (*before, *([free.jerk] if self.smooth else []))]
        h = ca.DM(free.lengths).T
        joints = [joint_after(joint, share * h) for share in GAUSS_NODES]
        one = step(self.plant, joints, h)
        W, dW, _ = march(*one.transition(), h.shape)
        ddW = one.accelerations(W, dW)
        values = _at_nodes(self.plant, joints, one.nodes(W, dW, ddW), tuple(QUANTITIES))
        rows = [*joint[:-1], *W, *dW, joint[-1], *(x for at_node in ddW for x in at_node)]
        numbers = {name: _rows(of, free.steps) for name, of in values.items() if of}
        return _Simulated(_rows(rows, free.steps), numbers)


def _rows(entries: Sequence[Any], steps: int) -> Array:
    return np.array([np.broadcast_to(ca.DM(x).full().ravel(), steps) for x in entries])


def _flat(peaks: Sequence[float] | Array, columns: Array) -> Array:
    """Unknowns as the solver takes them: the peaks, then interval after interval."""
    return np.concatenate([peaks, columns.T.ravel()])


def _of_joint(
    names: Sequence[str] | Mapping[str, float], smooth: bool, states: int
) -> dict[str, int]:
    """Quantities that are derivatives of the joint: their rows among the unknowns."""
    orders = {name: QUANTITIES[name].derivative for name in names}
    return {
        name: order if order < 2 + smooth else states
        for name, order in orders.items()
        if order is not None
    }


def _at_nodes(
    plant: Plant,
    joints: Sequence[JointMotion],
    nodes: Sequence[NodeState],
    names: Sequence[str],
) -> dict[str, list[Expression]]:
    """Power and quantities that follow from the modes, at the nodes of an interval."""
    values: dict[str, list[Expression]] = {POWER: []}
    for joint, node in zip(joints, nodes, strict=True):
        torque, tips = (
            plant.torque(joint, node.W, node.dW, node.ddW),
            plant.tip_displacements(node.W),
        )
        values[POWER].append(power_of(torque, joint.speed))
        for name in names:
            if QUANTITIES[name].derivative is None:
                values.setdefault(name, []).extend(QUANTITIES[name].of(joint, tips, torque))
    return values


def _interval(plant: Plant, smooth: bool, names: tuple[str, ...]) -> ca.Function:
    """(unknowns, length) -> state after, collocation equations, values at the nodes."""
    modes, joint = plant.modes, 2 + smooth
    states = joint + 2 * modes
    x, h = ca.SX.sym("x", states + 1 + NODES * modes), ca.SX.sym("h")
    W, dW = (ca.vertsplit(part) for part in ca.vertsplit(x[joint:states], modes))
    ddW = [ca.vertsplit(part) for part in ca.vertsplit(x[states + 1 :], modes)]
    derivatives = [*ca.vertsplit(x[:joint]), x[states]]
    joints = [joint_after(derivatives, share * h) for share in GAUSS_NODES]
    one = Step(h, [], modes)
    nodes = one.nodes(W, dW, ddW)
    equations = [
        given - by_plant
        for at, node in zip(joints, nodes, strict=True)
        for given, by_plant in zip(
            node.ddW, plant.modal_accelerations(at, node.W, node.dW), strict=True
        )
    ]
    W_after, dW_after = one.end(W, dW, ddW)
    after = [*joint_after(derivatives, h)[:joint], *W_after, *dW_after]
    values = _at_nodes(plant, joints, nodes, names).values()
    outputs = [ca.vertcat(*rows) for rows in (after, equations, *values)]
    return ca.Function("interval", [x, h], outputs, {"cse": True})


@lru_cache(maxsize=16)
def _solver(
    plant: Plant, smooth: bool, steps: int, names: tuple[str, ...], warm: bool
) -> ca.Function:
    """IPOPT over peaks and intervals; of lengths, scales, state at the end and weights."""
    interval = _interval(plant, smooth, names)
    rows, states = interval.size1_in(0), interval.size1_out(0)
    sizes = [steps, rows, 1 + len(names), states, 1 + len(names)]
    p = ca.MX.sym("p", sum(sizes))
    lengths, scale, measures, arrived, weights = ca.vertsplit(p, [0, *np.cumsum(sizes).tolist()])
    peaks, columns = ca.MX.sym("peaks", len(names)), ca.MX.sym("x", rows + 2 * NODES, steps)
    unknowns, forward, backward = ca.vertsplit(columns, [0, rows, rows + NODES, rows + 2 * NODES])
    wide = ca.repmat(scale, 1, steps)
    after, equations, power, *values = interval.map(steps)(unknowns * wide, lengths.T)
    following = ca.horzcat(unknowns[:states, 1:], arrived)
    of_joint = _of_joint(names, smooth, states)
    at_nodes = dict(zip((n for n in names if n not in of_joint), values, strict=True))
    constraints = [
        after / wide[:states, :] - following,
        equations / wide[states + 1 :, :],
        forward - backward - power / measures[0],
    ]
    for i, name in enumerate(names):
        row = of_joint.get(name)
        value = at_nodes[name] / measures[1 + i] if row is None else unknowns[row, :]
        constraints += [peaks[i] - value, peaks[i] + value]
    energy = ca.dot(lengths, (ca.DM(GAUSS_WEIGHTS).T @ (forward + backward)).T) / ca.sum1(lengths)
    problem = {
        "x": ca.vertcat(peaks, ca.vec(columns)),
        "p": p,
        "f": ca.dot(weights, ca.vertcat(energy, peaks)),
        "g": ca.vertcat(*map(ca.vec, constraints)),
    }
    return compiled(problem, _WARM if warm else _COLD)
