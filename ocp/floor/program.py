"""A task over free motions as a sparse nonlinear program on a grid, which IPOPT solves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.limits import Limit, Quantity
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import FreeMotion, joint_after
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.sample import sample_plant, total
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES, Step, step
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.objective import smooth_power
from quietarm.ocp.simulation.rollout import march
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp, options_of, run_ipopt
from quietarm.ocp.solvers.problem import ENERGY
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.task import PointToPoint

_AT_AN_END, _SHRINK = 3, 4.0
"""The first and last interval are cut at 1/4, 1/16 and 1/64 of their length: without a limit
against it, the motion of least energy starts and stops the joint with a jolt."""
_JOLT, _PARTS_OF_A_JOLT = 0.02, 4
"""An interval that changes the speed by more than this share of its largest is cut in four."""
_SHORTEST = 4e-5
"""Intervals shorter than this share of the move are left alone."""
_SCALE_STEPS = 40
_ROOM = 1e-2
"""How far the two parts of the power start inside their bounds, as a share of its peak."""
_LARGER = 10
"""A floor's tolerance is so many times that of its solver."""
_MOST_ITERATIONS = 400
_MOST_ITERATIONS_WARM = 150
COLD = {**OPTIONS, "tol": 1e-8, "max_iter": _MOST_ITERATIONS, "mumps_pivot_order": 0}
"""The systems are sparse and have no dense columns: minimum degree makes them a quarter faster."""
_WARM = {**COLD, "mu_strategy": "monotone", "mu_init": 1e-6}
"""From a coarser grid's solution; with a larger barrier the solver would move away from it."""

Array = NDArray[np.float64]


def first_grid(steps: int) -> Array:
    """Boundaries of about `steps` intervals, as fractions of the move, finer at the ends."""
    even = Mesh(max(2, steps - 2 * _AT_AN_END)).boundaries
    cuts = even[1] * _SHRINK ** -np.arange(_AT_AN_END, 0.0, -1)
    return np.concatenate([[0.0], cuts, even[1:-1], 1 - cuts[::-1], [1.0]])


def finer(free: FreeMotion) -> FreeMotion:
    """The motion on a grid of twice the intervals, and more where its speed jumps."""
    h = free.lengths
    change = np.abs(h * (free.acceleration + h * free.jerk / 2))
    jolt = change > _JOLT * np.abs(free.boundaries(0.0)[1]).max()
    parts = np.where(jolt, _PARTS_OF_A_JOLT, 2)
    parts[h < _SHORTEST * free.times[-1]] = 1
    return free.split(parts)


def _interval(
    plant: Plant, smooth: bool, quantities: Sequence[Quantity], energy: Energy
) -> ca.Function:
    """(column, length) -> state after, collocation equations, power, smooth energy, quantities.

    The power of the first joint at the nodes comes before that of the second.

    A column is the state before the interval (joint, W, W'), the last derivative of the joint, and
    W'' at the nodes. Quantities of the joint count where the interval begins, all else at nodes.
    """
    modes, orders = plant.modes, 2 + smooth
    states = orders + 2 * modes
    x, h = ca.SX.sym("x", states + 1 + NODES * modes), ca.SX.sym("h")
    begun = [*ca.vertsplit(x[:orders]), x[states]]
    modal = ca.vertcat(x[orders:states], x[states + 1 :])
    W, dW, *ddW = map(ca.vertsplit, ca.vertsplit(modal, modes))
    one = Step(h, [], modes)
    equations, powers, rest = list[Expression](), list[list[Expression]](), list[Expression]()
    at_begin = sample_plant(plant, JointMotion(*begun), W, dW, ddW[0])
    limited = [
        list(quantity.values(at_begin)) if quantity.derivative else [] for quantity in quantities
    ]
    for share, node in zip(GAUSS_NODES, one.nodes(W, dW, ddW)):
        joint = joint_after(begun, share * h)
        by_plant = plant.modal_accelerations(joint, node.W, node.dW)
        equations += [own - other for own, other in zip(node.ddW, by_plant)]
        sample = sample_plant(plant, joint, *node)
        powers.append(sample.powers)
        rest.append(smooth_power(energy, sample))
        for quantity, values in zip(quantities, limited):
            if not quantity.derivative:
                values += quantity.values(sample)
    power = [of_node for of_joint in zip(*powers) for of_node in of_joint]
    W_after, dW_after = one.end(W, dW, ddW)
    after = [*joint_after(begun, h)[:orders], *W_after, *dW_after]
    outputs = [ca.vertcat(*rows) for rows in (after, equations, power, rest, *limited)]
    return ca.Function("interval", [x, h], outputs, {"cse": True})


@dataclass(frozen=True)
class FreeSolution:
    """What one run of the solver gives, in SI units and by its own discretisation."""

    free: FreeMotion
    energy: float
    peaks: dict[str, float]
    status: SolveStatus


class FloorProgram:
    """A task, to be solved on any grid by IPOPT, with the options of a solver.

    Unknowns are the largest value of each limited quantity, and of every interval its column (see
    `_interval`) and both parts of the power at the nodes, scaled by what the plain cycloid reaches.
    """

    def __init__(self, task: PointToPoint, smooth: bool, solver: Solver = Ipopt()) -> None:
        jerk = task.limit_of("jerk")
        if jerk is not None and not smooth:
            raise ValueError(
                f"jerk limit is {jerk.bounds} and the acceleration of this floor jumps; ask for a "
                "smooth floor (smooth=True, or --smooth)"
            )
        self.task, self.smooth, self._limits = task, smooth, task.limits
        self._options = solver
        self._states = 2 + smooth + 2 * task.plant.modes
        joints = len(task.plant.joint_names)
        self._parts = NODES * joints if task.energy.absolute else 0
        quantities = [limit.quantity for limit in task.limits]
        self._interval = Compiled(lambda: _interval(task.plant, smooth, quantities, task.energy))
        self._solver = lru_cache(maxsize=4)(self._compile)
        cycloid = self.along(CycloidPolynomial(0).path([], *task.move), first_grid(_SCALE_STEPS))
        columns, (power, rest, *limited) = self._simulate(cycloid)
        self._scale = np.abs(columns).max(axis=1)
        self._scale[0] = abs(task.span)
        self._scale[self._scale == 0] = 1.0
        of_joints = np.abs(power).reshape(-1, *rest.shape).sum(axis=0)
        energy = task.energy.absolute * of_joints + np.abs(rest)
        self._measures = np.array([energy.max() or 1.0, *(x or 1.0 for x in self._peaks(limited))])

    def _peaks(self, limited: Sequence[Array]) -> list[float]:
        """The peak of each limited quantity, of its values."""
        each = zip(self._limits, limited)
        return [float(limit.peak(values.min(), values.max())) for limit, values in each]

    def _compile(self, steps: int, warm: bool) -> tuple[Compiled, Array]:
        """What `_build` gives, guarded."""
        solver, upper = Compiled.guard(lambda: self._build(steps, warm))
        return Compiled(lambda: solver, silent=True), upper

    def _build(self, steps: int, warm: bool) -> tuple[ca.Function, Array]:
        """IPOPT, of lengths and weights of what is least, and its constraints' upper bounds."""
        rows, states, parts = len(self._scale), self._states, self._parts
        scale = ca.repmat(ca.DM(self._scale), 1, steps)
        of_energy, *measures = self._measures.tolist()
        lengths, weights = ca.MX.sym("lengths", steps), ca.MX.sym("weights", 1 + len(measures))
        peaks, x = ca.MX.sym("peaks", len(measures)), ca.MX.sym("x", rows + 2 * parts, steps)
        columns, forward, backward = ca.vertsplit(x, [0, rows, rows + parts, rows + 2 * parts])
        after, equations, power, rest, *values = self._interval.function.map(steps)(
            columns * scale, lengths.T
        )
        arrived = ca.DM(self._resting(self.task.target, self.task.final_state))
        spent = rest / of_energy
        equal = [
            after / scale[:states, :] - ca.horzcat(columns[:states, 1:], arrived),
            equations / scale[states + 1 :, :],
        ]
        if parts:
            spent += self.task.energy.absolute * total(ca.vertsplit(forward + backward, NODES))
            equal.append(forward - backward - power / of_energy)
        positive = list[ca.MX]()
        for limit, peak, value, of in zip(self._limits, ca.vertsplit(peaks), values, measures):
            below, above = limit.sides
            positive += [above * peak - value / of, value / of - below * peak]
        mean = ca.dot(lengths, (ca.DM(GAUSS_WEIGHTS).T @ spent).T) / ca.sum1(lengths)
        problem = {
            "x": ca.vertcat(peaks, ca.vec(x)),
            "p": ca.vertcat(lengths, weights),
            "f": ca.dot(weights, ca.vertcat(mean, peaks)),
            "g": ca.vertcat(*map(ca.vec, [*equal, *positive])),
        }
        counts = [sum(rows.numel() for rows in kind) for kind in (equal, positive)]
        return compile_nlp(problem, self._ipopt(warm)), np.repeat([0.0, np.inf], counts)

    def _ipopt(self, warm: bool) -> dict[str, str | int | float]:
        """Options of IPOPT; a floor takes a larger tolerance, and fewer iterations."""
        most = _MOST_ITERATIONS_WARM if warm else _MOST_ITERATIONS
        return {
            **(_WARM if warm else COLD),
            **options_of(self._options),
            "tol": _LARGER * self._options.tolerance,
            "max_iter": min(most, self._options.iterations),
        }

    def along(self, path: JointPath, fractions: Array) -> FreeMotion:
        """A motion of this kind on a grid whose speed at the grid is that of a path."""
        times = self.task.duration * fractions
        h = np.diff(times)
        if self.smooth:
            acceleration = path(times, 2)
            acceleration[[0, -1]] = 0.0
            return FreeMotion(times, acceleration[:-1], np.diff(acceleration) / h)
        return FreeMotion(times, np.diff(path(times, 1)) / h, np.zeros(len(h)))

    def solve(
        self, free: FreeMotion, limits: Sequence[Limit], minimise: str = ENERGY, warm: bool = False
    ) -> FreeSolution:
        """Run the solver from one motion, on its grid."""
        names, units = [one.name for one in self._limits], np.eye(1 + len(self._limits))
        solver, upper = self._solver(free.steps, warm)
        stop = run_ipopt(
            solver,
            self._guess(free),
            self._bounds(limits, free.steps),
            (np.zeros(len(upper)), upper),
            np.append(free.lengths, units[[ENERGY, *names].index(minimise)]),
        )
        objective = Compiled(lambda: solver.function.get_function("nlp_f"))
        (mean,) = objective(stop.unknowns, np.append(free.lengths, units[0]))
        peaks, found = np.split(stop.unknowns, [len(names)])
        columns = found.reshape(free.steps, -1).T[: len(self._scale)] * self._scale[:, None]
        last = columns[self._states]
        acceleration, jerk = (columns[2], last) if self.smooth else (last, np.zeros(free.steps))
        return FreeSolution(
            free=FreeMotion(free.times, acceleration, jerk),
            energy=float(mean.item() * self.task.duration * self._measures[0]),
            peaks=dict(zip(names, (peaks * self._measures[1:]).tolist())),
            status=SolveStatus.from_ipopt(stop.return_status),
        )

    def _guess(self, free: FreeMotion) -> Array:
        columns, (power, _, *limited) = self._simulate(free)
        peaks = self._peaks(limited) / self._measures[1:]
        power = np.concatenate([power, -power])[: 2 * self._parts] / self._measures[0]
        return _flat(
            peaks, np.vstack([columns / self._scale[:, None], np.maximum(power, 0.0) + _ROOM])
        )

    def _bounds(self, limits: Sequence[Limit], steps: int) -> tuple[Array, Array]:
        upper = np.full((len(self._scale) + 2 * self._parts, steps), np.inf)
        lower = -upper
        lower[len(self._scale) :] = 0.0
        begun = self._resting(self.task.start, self.task.initial_state)
        lower[: self._states, 0] = upper[: self._states, 0] = begun
        sizes = {limit.name: limit.size for limit in limits}
        most = [sizes.get(one.name, np.inf) for one in self._limits] / self._measures[1:]
        return _flat(np.zeros(len(most)), lower), _flat(most, upper)

    def _resting(self, angle: float, modes: tuple[float, ...]) -> Array:
        """The state with the joint at rest, scaled."""
        return np.array([angle, *[0.0] * (1 + self.smooth), *modes]) / self._scale[: self._states]

    def _simulate(self, free: FreeMotion) -> tuple[Array, list[Array]]:
        """The columns of a motion, and the values of `_interval` from the power on."""
        return Compiled.guard(lambda: self._values_along(free))

    def _values_along(self, free: FreeMotion) -> tuple[Array, list[Array]]:
        h = ca.DM(free.lengths).T
        given = [*free.boundaries(self.task.start)[:, :-1], free.acceleration, free.jerk]
        begun = [ca.DM(row).T for row in given[: 3 + self.smooth]]
        one = step(self.task.plant, [joint_after(begun, share * h) for share in GAUSS_NODES], h)
        W, dW, _ = march(*one.transition(), h.shape, self.task.initial_state)
        ddW = [ca.DM.zeros(h.shape) + entry for node in one.accelerations(W, dW) for entry in node]
        columns = ca.vertcat(*begun[:-1], *W, *dW, begun[-1], *ddW)
        outputs = self._interval.function(columns, h)
        return columns.full(), [values.full() for values in outputs[2:]]


def _flat(peaks: ArrayLike, columns: Array) -> Array:
    """Unknowns as the solver takes them: the peaks, then interval after interval."""
    return np.append(peaks, columns.T)
