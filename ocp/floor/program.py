"""A task over free motions as a sparse nonlinear program on a grid, which IPOPT solves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.figures import ENERGY
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
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp, run_ipopt
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.task import PointToPoint

COLD = {**OPTIONS, "tol": 1e-8, "max_iter": 400, "mumps_pivot_order": 0}
"""The systems are sparse and have no dense columns: minimum degree makes them a quarter faster."""
_WARM = {**COLD, "max_iter": 150, "mu_strategy": "monotone", "mu_init": 1e-6}
"""From a coarser grid's solution; with a larger barrier the solver would move away from it."""

Array = NDArray[np.float64]


def first_grid(steps: int) -> Array:
    """Boundaries of about `steps` intervals, as fractions of the move, finer at the ends.

    The first and last interval are cut at 1/4, 1/16 and 1/64 of their length: without a limit
    against it, the motion of least energy starts and stops the joint with a jolt.
    """
    powers = np.arange(3, 0.0, -1)
    even = Mesh(max(2, steps - 2 * len(powers))).boundaries
    cuts = even[1] * 4.0**-powers
    return np.concatenate([[0.0], cuts, even[1:-1], 1 - cuts[::-1], [1.0]])


def finer(free: FreeMotion, jolt: float = 0.02, shortest: float = 4e-5) -> FreeMotion:
    """The motion on a grid of twice the intervals, and more where its speed jumps.

    An interval that changes the speed by more than the share `jolt` of its largest is cut in four;
    those shorter than the share `shortest` of the move are not cut.
    """
    h = free.lengths
    change = np.abs(h * (free.acceleration + h * free.jerk / 2))
    _, speed = free.boundaries(0.0)
    jumps = change > jolt * np.abs(speed).max()
    parts = np.where(jumps, 4, 2)
    parts[h < shortest * free.times[-1]] = 1
    return free.split(parts)


def _interval(
    plant: Plant, smooth: bool, quantities: Sequence[Quantity], energy: Energy
) -> ca.Function:
    """(column, length) -> state after, collocation equations, power, smooth energy, quantities.

    The power of the first joint at the nodes comes before that of the second.

    A column is the state before the interval (joint, W, W'), the last derivative of the joint, and
    W'' at the nodes. Quantities of the joint count where the interval begins, all else at nodes.
    """
    modes = plant.modes
    orders = 2 + smooth
    states = orders + 2 * modes
    x = ca.SX.sym("x", states + 1 + NODES * modes)
    h = ca.SX.sym("h")
    at_begin = [*ca.vertsplit(x[:orders]), x[states]]
    modal = ca.vertcat(x[orders:states], x[states + 1 :])
    W, dW, *ddW = map(ca.vertsplit, ca.vertsplit(modal, modes))
    interval = Step(h, [], modes)
    sample = sample_plant(plant, JointMotion(*at_begin), W, dW, ddW[0])
    limited = [
        list(quantity.values(sample)) if quantity.derivative else [] for quantity in quantities
    ]
    equations: list[Expression] = []
    powers: list[list[Expression]] = []
    rest: list[Expression] = []
    for share, node in zip(GAUSS_NODES, interval.nodes(W, dW, ddW)):
        joint = joint_after(at_begin, share * h)
        by_plant = plant.modal_accelerations(joint, node.W, node.dW)
        equations += [unknown - exact for unknown, exact in zip(node.ddW, by_plant)]
        sample = sample_plant(plant, joint, *node)
        powers.append(sample.powers)
        rest.append(smooth_power(energy, sample))
        for quantity, values in zip(quantities, limited):
            if not quantity.derivative:
                values += quantity.values(sample)
    power = [of_node for of_joint in zip(*powers) for of_node in of_joint]
    W_after, dW_after = interval.end(W, dW, ddW)
    after = [*joint_after(at_begin, h)[:orders], *W_after, *dW_after]
    outputs = [ca.vertcat(*rows) for rows in (after, equations, power, rest, *limited)]
    return ca.Function("interval", [x, h], outputs, {"cse": True})


@dataclass(frozen=True)
class FreeSolution:
    """The result of one run of the solver, in SI units and by its own discretisation."""

    free: FreeMotion
    energy: float
    peaks: dict[str, float]
    status: SolveStatus


class FloorProgram:
    """A task, to be solved on any grid by IPOPT, with the options of a solver.

    Unknowns are the largest value of each limited quantity, and of every interval its column (see
    `_interval`) and both parts of the power at the nodes, scaled by what the plain cycloid reaches.
    """

    room: ClassVar[float] = 1e-2
    """How far the two parts of the power start inside their bounds, as a share of its peak."""
    larger_tolerance: ClassVar[float] = 10
    """A floor's tolerance is so many times that of its solver."""
    scale_steps: ClassVar[int] = 40
    """Of the plain cycloid, for the scales."""

    def __init__(self, task: PointToPoint, smooth: bool, solver: Solver = Ipopt()) -> None:
        jerk = task.limit_of("jerk")
        if jerk is not None and not smooth:
            raise ValueError(
                f"jerk limit is {jerk.bounds} and the acceleration of this floor jumps; ask for a "
                "smooth floor (smooth=True, or --smooth)"
            )
        self.task = task
        self.smooth = smooth
        self._limits = task.limits
        self.solver = solver.as_kind(Ipopt)
        """What solves it, with the options of the solver that was given."""
        self._states = 2 + smooth + 2 * task.plant.modes
        joints = len(task.plant.joint_names)
        self._parts = NODES * joints if task.energy.absolute else 0
        quantities = [limit.quantity for limit in task.limits]
        self._interval = Compiled(lambda: _interval(task.plant, smooth, quantities, task.energy))
        self._solver = lru_cache(maxsize=4)(self._compile)
        plain = CycloidPolynomial(0).path([], *task.move)
        cycloid = self.along(plain, first_grid(self.scale_steps))
        columns, (power, rest, *limited) = self._simulate(cycloid)
        self._scale = np.abs(columns).max(axis=1)
        self._scale[0] = abs(task.span)
        self._scale[self._scale == 0] = 1.0
        of_joints = np.abs(power).reshape(-1, *rest.shape).sum(axis=0)
        energy = task.energy.absolute * of_joints + np.abs(rest)
        measures = [energy.max(), *self._peaks(limited)]
        self._measures = np.array([measure or 1.0 for measure in measures])

    def _peaks(self, limited: Sequence[Array]) -> list[float]:
        """The peak of each limited quantity, of its values."""
        return [
            float(limit.peak(values.min(), values.max()))
            for limit, values in zip(self._limits, limited)
        ]

    def _compile(self, steps: int, warm: bool) -> tuple[Compiled, Array]:
        """Build the solver for a number of steps, guarded, and the upper bounds of its unknowns."""
        solver, upper = Compiled.guard(lambda: self._build(steps, warm))
        return Compiled(lambda: solver, silent=True), upper

    def _build(self, steps: int, warm: bool) -> tuple[ca.Function, Array]:
        """IPOPT, of lengths and weights of what is least, and its constraints' upper bounds."""
        rows = len(self._scale)
        states = self._states
        parts = self._parts
        scale = ca.repmat(ca.DM(self._scale), 1, steps)
        of_energy, *measures = self._measures.tolist()
        lengths = ca.MX.sym("lengths", steps)
        weights = ca.MX.sym("weights", 1 + len(measures))
        peaks = ca.MX.sym("peaks", len(measures))
        x = ca.MX.sym("x", rows + 2 * parts, steps)
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
        positive: list[ca.MX] = []
        limited = zip(self._limits, ca.vertsplit(peaks), values, measures)
        for limit, peak, value, measure in limited:
            below, above = limit.sides
            scaled = value / measure
            positive += [above * peak - scaled, scaled - below * peak]
        of_intervals = (ca.DM(GAUSS_WEIGHTS).T @ spent).T
        mean = ca.dot(lengths, of_intervals) / ca.sum1(lengths)
        nlp = {
            "x": ca.vertcat(peaks, ca.vec(x)),
            "p": ca.vertcat(lengths, weights),
            "f": ca.dot(weights, ca.vertcat(mean, peaks)),
            "g": ca.vertcat(*map(ca.vec, [*equal, *positive])),
        }
        counts = [sum(entry.numel() for entry in kind) for kind in (equal, positive)]
        upper = np.repeat([0.0, np.inf], counts)
        return compile_nlp(nlp, self._options(warm)), upper

    def _options(self, warm: bool) -> dict[str, str | int | float]:
        """Options of IPOPT; a floor takes a larger tolerance, and fewer iterations."""
        options = _WARM if warm else COLD
        return {
            **options,
            **self.solver.own_options,
            "tol": self.larger_tolerance * self.solver.tolerance,
            "max_iter": min(options["max_iter"], self.solver.iterations),
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

    @on_one_thread
    def solve(
        self, free: FreeMotion, limits: Sequence[Limit], minimise: str = ENERGY, warm: bool = False
    ) -> FreeSolution:
        """Run the solver from one motion, on its grid."""
        names = [limit.name for limit in self._limits]
        units = np.eye(1 + len(names))
        least = [ENERGY, *names].index(minimise)
        solver, upper = self._solver(free.steps, warm)
        stop = run_ipopt(
            solver,
            self._guess(free),
            self._bounds(limits, free.steps),
            (np.zeros(len(upper)), upper),
            np.append(free.lengths, units[least]),
        )
        objective = Compiled(lambda: solver.function.get_function("nlp_f"))
        (mean,) = objective(stop.unknowns, np.append(free.lengths, units[0]))
        peaks, of_intervals = np.split(stop.unknowns, [len(names)])
        scaled = of_intervals.reshape(free.steps, -1).T[: len(self._scale)]
        return FreeSolution(
            free=self._motion(free.times, scaled * self._scale[:, None]),
            energy=float(mean.item() * self.task.duration * self._measures[0]),
            peaks=dict(zip(names, (peaks * self._measures[1:]).tolist())),
            status=SolveStatus.from_ipopt(stop.return_status),
        )

    def _motion(self, times: Array, columns: Array) -> FreeMotion:
        """The motion that the columns describe, in SI units."""
        last = columns[self._states]
        if self.smooth:
            return FreeMotion(times, columns[2], last)
        return FreeMotion(times, last, np.zeros(len(last)))

    def _guess(self, free: FreeMotion) -> Array:
        columns, (power, _, *limited) = self._simulate(free)
        peaks = self._peaks(limited) / self._measures[1:]
        both_signs = np.concatenate([power, -power])[: 2 * self._parts]
        parts = np.maximum(both_signs / self._measures[0], 0.0) + self.room
        return _flat(peaks, np.vstack([columns / self._scale[:, None], parts]))

    def _bounds(self, limits: Sequence[Limit], steps: int) -> tuple[Array, Array]:
        upper = np.full((len(self._scale) + 2 * self._parts, steps), np.inf)
        lower = -upper
        lower[len(self._scale) :] = 0.0
        at_start = self._resting(self.task.start, self.task.initial_state)
        lower[: self._states, 0] = at_start
        upper[: self._states, 0] = at_start
        sizes = {limit.name: limit.size for limit in limits}
        most = [sizes.get(limit.name, np.inf) for limit in self._limits] / self._measures[1:]
        return _flat(np.zeros(len(most)), lower), _flat(most, upper)

    def _resting(self, angle: float, modes: tuple[float, ...]) -> Array:
        """The state with the joint at rest, scaled."""
        return np.array([angle, *[0.0] * (1 + self.smooth), *modes]) / self._scale[: self._states]

    def _simulate(self, free: FreeMotion) -> tuple[Array, list[Array]]:
        """The columns of a motion, and the values of `_interval` from the power on."""
        return Compiled.guard(lambda: self._values_along(free))

    def _values_along(self, free: FreeMotion) -> tuple[Array, list[Array]]:
        h = ca.DM(free.lengths).T
        joint = [*free.boundaries(self.task.start)[:, :-1], free.acceleration, free.jerk]
        at_begin = [ca.DM(row).T for row in joint[: 3 + self.smooth]]
        at_nodes = [joint_after(at_begin, share * h) for share in GAUSS_NODES]
        intervals = step(self.task.plant, at_nodes, h)
        W, dW, _ = march(*intervals.transition(), h.shape, self.task.initial_state)
        accelerations = intervals.accelerations(W, dW)
        ddW = [ca.DM.zeros(h.shape) + entry for node in accelerations for entry in node]
        columns = ca.vertcat(*at_begin[:-1], *W, *dW, at_begin[-1], *ddW)
        outputs = self._interval.function(columns, h)
        return columns.full(), [values.full() for values in outputs[2:]]


def _flat(peaks: ArrayLike, columns: Array) -> Array:
    """Unknowns as the solver takes them: the peaks, then interval after interval."""
    return np.append(peaks, columns.T)
