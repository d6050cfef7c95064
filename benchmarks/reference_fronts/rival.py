"""Another program for the least energy at a residual: RK4 on even steps, SciPy's SLSQP, DOP853.

It shares the plants' equations and the profiles with the program that finds the fronts, and nothing
else: other steps, another quadrature, no samples of the residual, another solver.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from quietarm.models import JointMotion
from quietarm.ocp import JointProfile, PointToPoint
from quietarm.ocp.sample import sample_plant

Array = NDArray[np.float64]
STEPS = 601
"""A prime: its steps share no end with 48, 64, 80, 192 or 500 of another grid."""
_NEAR = 0.03
"""The solver is given limits where a quantity is within this share of its limit at the start."""
_REST = 1e-8
"""A residual up to this is rest [m]."""
_ITERATIONS = 200
_PRECISION = 1e-10
"""Share of the energy by which SLSQP's steps have to change it."""


@dataclass(frozen=True)
class Motion:
    """A motion by the rival's steps, and its derivatives by the coefficients.

    The work [J] and the power [W] are at the ends of the steps, shape (steps + 1,), the states on
    arrival have shape (scenarios, 2 * modes), the limited quantities (limits, values). Derivatives
    have the coefficients as their last axis.
    """

    work: Array
    power: Array
    arrival: Array
    limited: Array
    work_slopes: Array
    power_slopes: Array
    arrival_slopes: Array
    limited_slopes: Array


class Rival:
    """A task along a profile, with its box."""

    def __init__(
        self, task: PointToPoint, profile: JointProfile, bound: float, steps: int = STEPS
    ) -> None:
        self.task, self.profile, self.bound, self.steps = task, profile, bound, steps
        self.h = task.duration / steps
        self.plants = task.perturbed_plants
        modes = task.plant.modes
        self._states = 2 * modes * len(self.plants) + 1  # of every scenario, and the work
        self._vibrations = [
            _Vibration.of_mode(plant, mode, task.target)
            for plant in self.plants
            for mode in range(modes)
        ]
        if min(one.half_turn for one in self._vibrations) > task.residual_window:
            raise ValueError("the window is shorter than half a turn of a mode")

    def _outputs(self, x: Any, a: Any, fraction: Any) -> tuple[Any, Any]:
        """Time derivatives of the states, and the power with the limited quantities."""
        task, modes = self.task, self.task.plant.modes
        elements = [a[i] for i in range(self.profile.size)]
        move = task.start, task.target, task.duration
        joint = JointMotion(*self.profile.motion(elements, fraction, *move)[:3])
        rates, power, limited = [], None, []
        for number, plant in enumerate(self.plants):
            first = 2 * modes * number
            W = [x[first + i] for i in range(modes)]
            dW = [x[first + modes + i] for i in range(modes)]
            ddW = list(plant.modal_accelerations(joint, W, dW))
            rates += [*dW, *ddW]
            sample = sample_plant(plant, joint, W, dW, ddW)
            if number == 0:
                power = sample.power
            for limit in task.limits:
                if number == 0 or limit.quantity.in_scenarios:
                    values = limit.quantity.values(sample)
                    limited += [value / limit.size for value in values]
        return ca.vertcat(*rates, power), ca.vertcat(power, *limited)

    @cached_property
    def _run(self) -> Any:
        """All steps: states and outputs with their derivatives, from the coefficients."""
        n, size, h = self.profile.size, self._states, self.h
        x, a, k = ca.SX.sym("x", size), ca.SX.sym("a", n), ca.SX.sym("k")
        S = ca.SX.sym("S", size, n)

        def rates(state: Any, after: float) -> Any:
            return self._outputs(state, a, (k + after) / self.steps)[0]

        first = rates(x, 0.0)
        second = rates(x + h / 2 * first, 0.5)
        third = rates(x + h / 2 * second, 0.5)
        fourth = rates(x + h * third, 1.0)
        end = x + h / 6 * (first + 2 * second + 2 * third + fourth)
        out = self._outputs(x, a, k / self.steps)[1]

        def sensitivity(of: Any) -> Any:
            return ca.jacobian(of, x) @ S + ca.jacobian(of, a)

        before = ca.vertcat(x, ca.vec(S))
        after = ca.vertcat(end, ca.vec(sensitivity(end)))
        outputs = ca.vertcat(out, ca.vec(sensitivity(out)))
        step = ca.Function("step", [before, a, k], [after, before, outputs])
        return step.mapaccum("run", self.steps + 1)

    def evaluate(self, coefficients: Array) -> Motion:
        """The motion of coefficients."""
        n, size = self.profile.size, self._states
        numbers = np.arange(self.steps + 1)[None]
        table = np.repeat(coefficients[:, None], self.steps + 1, axis=1)
        _, states, outputs = (
            np.array(one) for one in self._run(np.zeros(size * (1 + n)), table, numbers)
        )
        slopes = states[size:].reshape(n, size, -1).transpose(2, 1, 0)  # (steps + 1, size, n)
        count = outputs.shape[0] // (1 + n)
        out_slopes = outputs[count:].reshape(n, count, -1).transpose(2, 1, 0)
        return Motion(
            work=states[size - 1],
            power=outputs[0],
            arrival=states[: size - 1, -1].reshape(len(self.plants), -1),
            limited=outputs[1:count].ravel(),
            work_slopes=slopes[:, size - 1],
            power_slopes=out_slopes[:, 0],
            arrival_slopes=slopes[-1, : size - 1].reshape(len(self.plants), -1, n),
            limited_slopes=out_slopes[:, 1:].transpose(1, 0, 2).reshape(-1, n),
        )

    def energy(self, motion: Motion) -> tuple[float, Array]:
        """F2 [J] and its gradient: how far the work rises and falls, by cubics between the nodes.

        Where the work turns the power is zero, so that the place of a turn has no part in the
        gradient.
        """
        ends, slopes = [motion.work[0]], [motion.work_slopes[0]]
        w, p, h = motion.work, motion.power, self.h
        rise = w[:-1] - w[1:]
        # the work's slope over a step from 0 to 1, times its length
        quadratics = np.array([
            6 * rise + 3 * h * (p[:-1] + p[1:]),
            -6 * rise - 4 * h * p[:-1] - 2 * h * p[1:],
            h * p[:-1],
        ])  # fmt: skip
        for k in _where_they_turn(*quadratics):
            for root in np.sort_complex(np.roots(quadratics[:, k])):
                if root.imag == 0 and 0 < root.real < 1:
                    weights = _hermite(float(root.real), h)
                    values = [w[k], p[k], w[k + 1], p[k + 1]]
                    by_a = [
                        motion.work_slopes[k],
                        motion.power_slopes[k],
                        motion.work_slopes[k + 1],
                        motion.power_slopes[k + 1],
                    ]
                    ends.append(float(np.dot(weights, values)))
                    slopes.append(np.dot(weights, by_a))
        rises = np.diff(np.append(ends, w[-1]))
        by_a = np.diff(np.vstack([*slopes, motion.work_slopes[-1]]), axis=0)
        return float(np.abs(rises).sum()), np.sign(rises) @ by_a

    def displacements(self, motion: Motion) -> tuple[Array, Array]:
        """Return every mode's tip on arrival and at its next turn by scenario [m], and slopes.

        The largest of them is the residual.
        """
        modes = self.task.plant.modes
        values, slopes = [], []
        for number, vibration in enumerate(self._vibrations):
            scenario, mode = divmod(number, modes)
            rows = [mode, modes + mode]
            state = motion.arrival[scenario][rows]
            for row in vibration.rows(state):
                values.append(row @ state)
                slopes.append(row @ motion.arrival_slopes[scenario][rows])
        return np.array(values), np.array(slopes)

    def solve(self, residual: float, start: Array, room: float = 0.0) -> Array | None:
        """Where SLSQP ends within a residual [m]; None where it finds no motion.

        Limits of the task keep a share of `room` at the nodes.
        """
        first = self.evaluate(start)
        near = np.flatnonzero(np.abs(first.limited) > 1 - _NEAR)
        scale = self.energy(first)[0]
        rest = residual <= _REST
        known: dict[bytes, Motion] = {}

        def at(a: Array) -> Motion:
            key = a.tobytes()
            if key not in known:
                known.clear()
                known[key] = self.evaluate(a)
            return known[key]

        def bounded(a: Array) -> tuple[Array, Array]:
            """Shares of what is limited, within -1 and 1, and their slopes."""
            motion = at(a)
            values = motion.limited[near] / (1 - room)
            slopes = motion.limited_slopes[near] / (1 - room)
            if rest:
                return values, slopes
            tips, tip_slopes = self.displacements(motion)
            return (
                np.concatenate([values, tips / residual]),
                np.vstack([slopes, tip_slopes / residual]),
            )

        constraints: list[Any] = [{
            "type": "ineq",
            "fun": lambda a: np.concatenate([1 - bounded(a)[0], 1 + bounded(a)[0]]),
            "jac": lambda a: np.vstack([-bounded(a)[1], bounded(a)[1]]),
        }]  # fmt: skip
        if rest:
            scales = _arrival_scales(first)
            at_rest = {
                "type": "eq",
                "fun": lambda a: at(a).arrival.ravel() / scales,
                "jac": lambda a: at(a).arrival_slopes.reshape(-1, len(a)) / scales[:, None],
            }
            constraints = [at_rest, *(constraints if len(near) else [])]
        found = minimize(
            lambda a: self.energy(at(a))[0] / scale,
            start,
            jac=lambda a: self.energy(at(a))[1] / scale,
            method="SLSQP",
            bounds=[(-self.bound, self.bound)] * self.profile.size,
            constraints=constraints,
            options={"maxiter": _ITERATIONS, "ftol": _PRECISION},
        )
        return np.clip(found.x, -self.bound, self.bound) if np.isfinite(found.fun) else None


def _arrival_scales(motion: Motion) -> Array:
    """Scales of the state on arrival: what a coefficient of 1 changes of it."""
    changes = np.abs(motion.arrival_slopes).max(axis=-1).ravel()
    return np.where(changes > 0, changes, 1.0)


def _where_they_turn(a: Array, b: Array, c: Array) -> list[int]:
    """Places of quadratics that have a zero between 0 and 1: one, or both."""
    with np.errstate(divide="ignore", invalid="ignore"):
        lowest = -b / (2 * a)
        both = (lowest > 0) & (lowest < 1) & (b * b > 4 * a * c)
    return np.flatnonzero((c * (a + b + c) < 0) | both).tolist()


def _hermite(at: float, h: float) -> tuple[float, float, float, float]:
    """Return the weights of values and slopes at both ends of a step within it, from 0 to 1."""
    return (
        (1 + 2 * at) * (1 - at) ** 2,
        h * at * (1 - at) ** 2,
        at**2 * (3 - 2 * at),
        h * at**2 * (at - 1),
    )


@dataclass(frozen=True)
class _Vibration:
    """One mode after arrival, and the tip that it moves: W'' = -k W - d W'."""

    k: float
    d: float
    phi: float

    @classmethod
    def of_mode(cls, plant: Any, mode: int, angle: float) -> _Vibration:
        """Make the vibration of a mode on which no other acts once the joint is at rest."""
        rest = JointMotion(angle, 0.0, 0.0)
        unit = [float(mode == i) for i in range(plant.modes)]
        zero = [0.0] * plant.modes
        by_amplitude = plant.modal_accelerations(rest, unit, zero)
        by_rate = plant.modal_accelerations(rest, zero, unit)
        tips = [float(tip) for tip in plant.tip_displacements(unit)]
        others = [float(by_amplitude[i]) for i in range(plant.modes) if i != mode]
        if any(others) or np.count_nonzero(tips) > 1:
            raise ValueError(f"modes of {plant.name} act on each other")
        return cls(-float(by_amplitude[mode]), -float(by_rate[mode]), max(tips, key=abs))

    @property
    def turning(self) -> float:
        """Damped angular frequency [rad/s]."""
        return float(np.sqrt(self.k - self.d**2 / 4))

    @property
    def half_turn(self) -> float:
        """Within which the mode turns back once [s]."""
        return float(np.pi / self.turning)

    def rows(self, state: Array) -> tuple[Array, Array]:
        """Return the weights of amplitude and rate on arrival in the tip there and at its turn."""
        amplitude, rate = state
        angle = np.arctan2(rate * self.turning, self.k * amplitude + self.d / 2 * rate) % np.pi
        after = angle / self.turning
        decay = self.phi * np.exp(-self.d / 2 * after)
        sine = np.sin(angle) / self.turning
        turned = decay * np.array([np.cos(angle) + self.d / 2 * sine, sine])
        return np.array([self.phi, 0.0]), turned


def by_dop853(
    task: PointToPoint, profile: JointProfile, coefficients: Array
) -> tuple[float, float]:
    """Residual [m] and energy [J] of the nominal plant by DOP853, split where the power is zero."""
    plant, modes = task.plant, task.plant.modes
    move = task.start, task.target, task.duration

    def parts(t: float, x: Array) -> tuple[list[float], float]:
        joint = profile.motion(list(coefficients), t / task.duration, *move)
        joint = JointMotion(*map(float, joint[:3]))
        W, dW = list(x[:modes]), list(x[modes : 2 * modes])
        ddW = [float(one) for one in plant.modal_accelerations(joint, W, dW)]
        return [*dW, *ddW], float(plant.torque(joint, W, dW, ddW)) * joint.speed

    def rates(t: float, x: Array) -> list[float]:
        of_state, power = parts(t, x)
        return [*of_state, power]

    def power(t: float, x: Array) -> float:
        return parts(t, x)[1]

    run = solve_ivp(
        rates, (0.0, task.duration), np.zeros(2 * modes + 1), "DOP853", rtol=1e-12, atol=1e-15,
        events=power, max_step=task.duration / 200,
    )  # fmt: skip
    turns = [float(state[-1]) for state in run.y_events[0]]
    work = [0.0, *turns, float(run.y[-1, -1])]
    state = run.y[: 2 * modes, -1]
    tips = [
        abs(row @ state[[mode, modes + mode]])
        for mode in range(modes)
        for row in _Vibration.of_mode(plant, mode, task.target).rows(state[[mode, modes + mode]])
    ]
    return float(max(tips)), float(np.abs(np.diff(work)).sum())
