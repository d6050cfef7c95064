"""What a plant's modes make of a recording: columns that its signals consist of.

With the joint at rest they are exponentials of the plant's eigenvalues. Where the joint moves they
are followed through the recording by the collocation of the plans: the modes are affine in their
state at the start, so that a signal is a column for the joint's motion and one for each entry of
that state. All have exact derivatives by the plant's parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any, TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.simulation.collocation import (
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    NODES,
    modal_system,
    step,
)
from quietarm.ocp.uncertainty import with_values
from quietarm.studies.identify.recording import Recording

Array = NDArray[np.float64]
_STEP = 0.4
"""Of a phase [rad], the most that the fastest mode goes through in a step: its error is then below
1e-6 of a period."""
_FILTER_STEP = 0.25
"""The same of a step of a filter of the joint's acceleration."""
_DIFFERENCE = 1e-6
"""Share of a parameter, by which the differences of modes are taken."""
_AT_ONCE = 512
"""Marches are compiled for multiples of so many steps."""
_KNOTS = (12, 24, 48, 96, 192, 384, 768, 1536)


class Response:
    """How a plant's signals answer its joint, by some of its parameters.

    Parameters
    ----------
    plant : Plant
        Its equations.
    names : sequence of str
        The parameters.
    kinds : sequence of str
        ``"tip"``, ``"acceleration"`` or ``"torque"``, of each signal.
    """

    def __init__(self, plant: Plant, names: Sequence[str], kinds: Sequence[str]) -> None:
        self.plant, self.names, self.kinds = plant, list(names), np.array(kinds)
        modes, size, p = plant.modes, 2 * plant.modes, ca.SX.sym("p", len(names))
        changed = with_values(plant, dict(zip(names, ca.vertsplit(p))))
        angle = ca.SX.sym("angle")
        system = modal_system(changed, JointMotion(angle, 0.0, 0.0))
        K, D = (ca.vertcat(*(ca.horzcat(*row) for row in M)) for M in (system.K, system.D))
        A = ca.blockcat([[ca.SX(modes, modes), ca.SX.eye(modes)], [-K, -D]])
        of_p = [ca.densify(A), ca.densify(ca.jacobian(ca.vec(A), p))]
        self._at_rest = ca.Function("A", [p, angle], of_p)
        given, X = ca.SX.sym("given", 4 + 3 * NODES), ca.SX.sym("X", size, 1 + size)
        joints = [JointMotion(*ca.vertsplit(given[k : k + 3])) for k in range(1, 4 + 3 * NODES, 3)]
        constant, by_state = step(changed, joints[:NODES], given[0]).transition()
        after = ca.horzcat(*(ca.vertcat(*column) for column in by_state)) @ X
        after[:, 0] += ca.vertcat(*constant)
        seen = self._seen(changed, joints[-1], X)
        self._step = ca.Function("step", [X, given, p], [after, ca.vec(seen)], {"cse": True})
        self.march = lru_cache(maxsize=8)(self._march)
        self._linear = self._linear_system(changed, p)

    @property
    def is_linear(self) -> bool:
        """Whether signals answer the joint's acceleration alone, the same at every angle."""
        return self._linear is not None

    def _linear_system(self, plant: Plant, p: ca.SX) -> ca.Function | None:
        """A, B, C, D by p: the state answers an acceleration, and the signals both.

        None where the angle or a constant matters, or where it is not linear.
        """
        angle, acceleration, X = (
            ca.SX.sym("angle"),
            ca.SX.sym("ddq"),
            ca.SX.sym("X", 2 * plant.modes),
        )
        W, dW = (ca.vertsplit(half) for half in ca.vertsplit(X, plant.modes))
        joint = JointMotion(angle, ca.SX(0.0), acceleration)
        if "torque" in self.kinds:
            return None
        ddW = [ca.SX(entry) for entry in plant.modal_accelerations(joint, W, dW)]
        rates, seen = ca.vertcat(*dW, *ddW), self._signals(plant, joint, W, dW, ddW)
        both, inputs = ca.vertcat(rates, seen), ca.vertcat(X, acceleration)
        slopes = ca.jacobian(both, inputs)
        constant = ca.substitute(both, inputs, ca.SX.zeros(inputs.numel()))
        simple = ca.simplify(constant).is_zero() if constant.nnz() else True
        if not simple or ca.depends_on(slopes, ca.vertcat(inputs, angle)):
            return None
        return ca.Function("linear", [p], [ca.densify(slopes)])

    def modal_form(self, p: Array) -> tuple[Array, Array, Array]:
        """Eigenvalues above the real axis or on it, slowest first; residues; what is fed through.

        The signals are the real part of residues (signals, eigenvalues) times what each eigenvalue
        makes of the joint's acceleration, and that times the feed (signals,).
        """
        assert self._linear is not None
        slopes, size = self._linear(p).full(), 2 * self.plant.modes
        A, C = slopes[:size, :size], slopes[size:, :size]
        values: Any
        values, right = np.linalg.eig(A.astype(complex))
        residues = (C @ right) * np.linalg.solve(right, slopes[:size, size])
        order = [k for k in np.argsort(values.imag) if values[k].imag >= 0]
        twice = np.where(values[order].imag > 0, 2.0, 1.0)
        return values[order], residues[:, order] * twice, slopes[size:, size]

    def _seen(self, plant: Plant, joint: JointMotion, X: ca.SX) -> ca.SX:
        """What is recorded, a row each, of columns of the state."""
        W, dW = (ca.vertsplit(half) for half in ca.vertsplit(X[:, 0], plant.modes))
        ddW = plant.modal_accelerations(joint, W, dW)
        seen = self._signals(plant, joint, W, dW, ddW)
        return ca.horzcat(seen, ca.jacobian(seen, X[:, 0]) @ X[:, 1:])

    def _signals(self, plant: Plant, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> ca.SX:
        """What is recorded, a row each, of modal amplitudes and their rates."""
        made = {
            "tip": iter(plant.tips_at(joint, W)),
            "acceleration": iter(plant.tips_at(joint, ddW)),
            "torque": iter([plant.torque(joint, W, dW, ddW)]),
        }
        return ca.vertcat(*(next(made[kind]) for kind in self.kinds))

    def eigenvalues(self, p: Array, angle: float = 0.0) -> tuple[Any, Any]:
        """Those that swing with the joint at rest, slowest first, and their derivatives by p."""
        A, by_p = (entry.full() for entry in self._at_rest(p, angle))
        values: Any
        values, right = np.linalg.eig(A)
        transposed = by_p.T.reshape(-1, *A.shape)
        slopes = np.einsum("kl,jil,ik->kj", np.linalg.inv(right), transposed, right)
        order = [k for k in np.argsort(values.imag) if values[k].imag > 0]
        return values[order], slopes[order]

    def _march(self, count: int, derivatives: bool) -> ca.Function:
        """Columns of so many steps, and their derivatives by p."""
        p, given = ca.MX.sym("p", len(self.names)), ca.MX.sym("given", 4 + 3 * NODES, count)
        size = 2 * self.plant.modes
        start = np.eye(size, 1 + size, 1)
        rows = self._step.mapaccum(count)(start, given, ca.repmat(p, 1, count))[1]
        by_p = [ca.jtimes(rows, p, ca.DM.eye(len(self.names)))] if derivatives else []
        return ca.Function("march", [given, p], [rows, *by_p])


class FreeDecay:
    """The columns of a recording whose joint is at rest, the same for every signal."""

    driven = False

    def __init__(self, response: Response, recording: Recording) -> None:
        self._response, self._time = response, recording.time - recording.time[0]
        self.count = len(response.names)
        self._angle = 0.0 if recording.angle is None else float(recording.angle.mean())

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (1, rows, columns), and their derivatives (parameters, 1, rows, columns)."""
        values, slopes = self._response.eigenvalues(p, self._angle)
        swings = np.exp(self._time[:, None] * values)
        by_p = slopes.T[: None if derivatives else 0, None] * (self._time[:, None] * swings)
        return _parts(swings)[None], _parts(by_p)[:, None]


class Forced:
    """The columns of a recording whose joint moves, by the linear equations of the modes.

    Each eigenvalue is a filter of the joint's acceleration, exact but for the acceleration's course
    within a step, that has Gauss's three nodes. The columns are those of `Driven`.
    """

    driven = True

    def __init__(self, response: Response, time: Array, spline: Any, fastest: float) -> None:
        self._response, self.count = response, len(response.names)
        self._time = time - time[0]
        usual = float(np.median(np.diff(time)))
        step = self._time[-1] / max(round(self._time[-1] / usual), 1)  # that ends with the rows
        step /= max(np.ceil(fastest * step / _FILTER_STEP), 1)
        self._step, steps = step, round(self._time[-1] / step)
        self._rows = np.minimum(np.floor(self._time / step + 1e-6).astype(int), steps)
        self._rest = np.maximum(self._time - self._rows * step, 0.0)
        self._rest[self._rest < 1e-6 * step] = 0.0
        begins = time[0] + step * np.arange(steps)
        last = min(time[-1], time[0] + step * steps)
        joint = lambda at: spline(np.clip(at, time[0], time[-1]), 2)  # noqa: E731
        self._nodes = np.stack([joint(begins + c * step) for c in GAUSS_NODES])
        at_rows = time[0] + step * self._rows
        self._row_nodes = np.stack([
            joint(np.minimum(at_rows, last) + c * self._rest) for c in GAUSS_NODES
        ])  # fmt: skip
        self._acceleration = joint(time)
        self._lever = np.outer(response.kinds == "acceleration", self._acceleration)[..., None]

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these).

        The last is of an accelerometer at some distance from the joint.
        """
        values, residues, feed = self._response.modal_form(p)
        answers, slopes = self._answers(values, derivatives)
        forced = (residues @ answers).real + np.outer(feed, self._acceleration)
        free = np.exp(np.outer(self._time, values))
        B = self._side_by_side(forced, _parts(free), self._lever)
        if not derivatives:
            return B, B[:0]
        dB = list[Array]()
        for dvalues, dresidues, dfeed in self._derivatives(p):
            dforced = (dresidues @ answers + residues @ (dvalues[:, None] * slopes)).real
            dforced += np.outer(dfeed, self._acceleration)
            dfree = self._time[:, None] * free * dvalues
            dB.append(self._side_by_side(dforced, _parts(dfree), 0 * self._lever))
        return B, np.stack(dB)

    def _side_by_side(self, forced: Array, free: Array, lever: Array) -> Array:
        states = np.broadcast_to(free, (len(forced), *free.shape))
        return np.concatenate([forced[..., None], states, lever], axis=-1)

    def _answers(self, values: Any, derivatives: bool) -> tuple[Any, Any]:
        """What each eigenvalue makes of the acceleration at the rows, and its derivative by it."""
        from scipy.signal import lfilter  # not at the top: it takes long to load

        found, slopes = list[Any](), list[Any]()
        for value in values:
            grown, by_step, by_step_slope = _over_a_step(value, self._step, self._nodes)
            at = lfilter([1.0], [1.0, -grown], np.append(0.0, by_step))
            begin, slope = at[self._rows], 0.0
            if derivatives:
                pushed = by_step_slope + self._step * grown * at[:-1]
                slope = lfilter([1.0], [1.0, -grown], np.append(0.0, pushed))[self._rows]
            if self._rest.any():
                further, by_rest, by_rest_slope = _over_a_step(value, self._rest, self._row_nodes)
                slope = further * (slope + self._rest * begin) + by_rest_slope
                begin = further * begin + by_rest
            found.append(begin)
            slopes.append(slope)
        return np.array(found), np.array(slopes)

    def _derivatives(self, p: Array) -> Iterator[tuple[Array, Array, Array]]:
        """Of eigenvalues, residues and feed by each parameter: central differences."""
        for k, size in enumerate(np.maximum(np.abs(p), 1e-3)):
            change = np.zeros(len(p))
            change[k] = _DIFFERENCE * size
            above, below = (self._response.modal_form(p + sign * change) for sign in (1, -1))
            yield tuple((u - v) / (2 * change[k]) for u, v in zip(above, below))


def _over_a_step(value: complex, step: Any, nodes: Array) -> tuple[Any, Any, Any]:
    """How a mode grows over steps, what an acceleration adds, and that by the eigenvalue."""
    added, slope = 0.0, 0.0
    for c, weight, u in zip(GAUSS_NODES, GAUSS_WEIGHTS, nodes):
        left = step * (1 - c)
        share = weight * step * np.exp(value * left) * u
        added = added + share
        slope = slope + left * share
    return np.exp(value * step), added, slope


class Driven:
    """The columns of a recording whose joint moves: first what its motion does to the signals.

    By the plant's own equations, or where these are unknown but for the modes, by its linear ones:
    those of a slow joint, that feel its acceleration alone.
    """

    driven = True

    def __init__(
        self, response: Response, time: Array, spline: Any, fastest: float, linear: bool
    ) -> None:
        self._response, self.count, steps = response, len(response.names), np.diff(time)
        orders = (1.0, 0.0, 1.0) if linear else (1.0, 1.0, 1.0)
        joint = lambda at: [size * spline(at, k) for k, size in enumerate(orders)]  # noqa: E731
        counts = np.maximum(np.ceil(fastest * steps / _STEP), 1).astype(int)
        self._rows = np.concatenate([[0], np.cumsum(counts)])
        lengths = np.append(np.repeat(steps / counts, counts), 0.0)
        begins = time[0] + np.concatenate([[0.0], np.cumsum(lengths[:-1])])
        nodes = [row for c in GAUSS_NODES for row in joint(begins + c * lengths)]
        given = np.vstack([lengths, *nodes, *joint(begins)])
        self._given = np.pad(given, ((0, 0), (0, -given.shape[1] % _AT_ONCE)))  # of no length
        self._lever = np.outer(response.kinds == "acceleration", spline(time, 2))[..., None]

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these).

        The last is of an accelerometer at some distance from the joint.
        """
        march = self._response.march(self._given.shape[1], derivatives)
        found = march.call([self._given, p])
        B, *dB = (self._columns(one, k == 0) for k, one in enumerate(found))
        return B[0], dB[0] if derivatives else B[:0]

    def _columns(self, table: ca.DM, lever: bool) -> Array:
        """A table of the march by (parameters, signals, rows, columns), with the lever's."""
        signals = len(self._response.kinds)
        steps = table.full().reshape(-1, signals, table.shape[1])
        blocks = steps.reshape(*steps.shape[:2], -1, self._given.shape[1])[..., self._rows]
        found = blocks.transpose(2, 1, 3, 0)
        return np.concatenate(
            [found, np.broadcast_to(lever * self._lever, (*found.shape[:3], 1))], axis=-1
        )


@lru_cache(maxsize=64)
def response_of(plant: Plant, names: tuple[str, ...], kinds: tuple[str, ...]) -> Response:
    """The response of a plant, built once for all recordings with the same signals."""
    return Response(plant, names, kinds)


Columns: TypeAlias = FreeDecay | Forced | Driven


def smooth(recording: Recording) -> Any:
    """The quintic spline of an angle whose number of knots has the least cross-validated error."""
    from scipy.interpolate import make_lsq_spline  # not at the top: it takes long to load

    time, angle, found = recording.time, recording.angle, list[tuple[float, int, Any]]()
    rows = len(time)
    for count in _KNOTS:
        if count > max(rows / 4, _KNOTS[0]):
            break
        inner = np.interp(np.linspace(0, rows - 1, count)[1:-1], np.arange(rows), time)
        knots = np.concatenate([[time[0]] * 6, inner, [time[-1]] * 6])
        spline = make_lsq_spline(time, angle, knots, 5)
        rest = float(np.sum((spline(time) - angle) ** 2))
        found.append((rest / (rows - len(inner) - 6) ** 2, count, spline))
    return min(found)[2]


def _parts(values: Any) -> Array:
    """Real and imaginary parts of columns, side by side."""
    return np.ascontiguousarray(values).view(np.float64)
