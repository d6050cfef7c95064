"""What a plant's signals would have been, with derivatives by its parameters.

For a given joint motion the modes are affine in their state at the start, so that a signal is a
column for the joint's motion and one for each entry of that state. All columns, and their exact
derivatives by the parameters, are followed through the recording by the collocation of the plans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.simulation.collocation import GAUSS_NODES, modal_system, step
from quietarm.ocp.uncertainty import with_values
from quietarm.studies.identify.recording import Recording

Array = NDArray[np.float64]
_STEP = 0.6
"""Of a phase [rad], the most that the fastest mode goes through in a step: its error is then below
1e-6 of a period."""
_AT_ONCE = 200
"""Steps that are compiled together."""
_KNOTS = (12, 24, 48, 96, 192, 384, 768, 1536)


@dataclass(frozen=True, eq=False)
class Joint:
    """The joint's motion at any time, of a recorded angle: the smooth part of it."""

    spline: Any

    @classmethod
    def of(cls, recording: Recording) -> Joint:
        """The quintic spline whose number of knots has the least cross-validated error."""
        from scipy.interpolate import make_lsq_spline  # not at the top: it takes long to load

        time, angle = recording.time, recording.angle
        if angle is None or np.ptp(angle) == 0:
            return cls(None if angle is None else float(angle[0]))
        best, least = None, np.inf
        for count in _KNOTS:
            if count > len(time) / 4:
                break
            inner = np.interp(
                np.linspace(0, len(time) - 1, count)[1:-1], np.arange(len(time)), time
            )
            knots = np.concatenate([[time[0]] * 6, inner, [time[-1]] * 6])
            spline = make_lsq_spline(time, angle, knots, 5)
            rest = float(np.sum((spline(time) - angle) ** 2))
            error = rest / (len(time) - len(inner) - 6) ** 2
            if error < least:
                best, least = spline, error
        return cls(best)

    @property
    def moves(self) -> bool:
        """Whether it moves at all."""
        return callable(self.spline)

    def at(self, time: Array) -> Array:
        """Angle, speed and acceleration, a row each."""
        if self.moves:
            return np.array([self.spline(time, order) for order in range(3)])
        return np.array([np.full(len(time), self.spline or 0.0), 0 * time, 0 * time])


class Response:
    """The columns of a plant's signals over a recording, and their derivatives by parameters.

    Signals are ``"tip"``, ``"acceleration"``, ``"torque"``.
    """

    def __init__(self, plant: Plant, names: Sequence[str], signals: Sequence[str]) -> None:
        self.names = tuple(names)
        counts = [1 if kind == "torque" else plant.tips for kind in signals]
        self.kinds = np.repeat(list(signals), counts)
        p = ca.SX.sym("p", len(names))
        changed = with_values(plant, dict(zip(names, ca.vertsplit(p), strict=True)))
        size, count = 2 * plant.modes, 1 + 2 * plant.modes
        h, nodes, at = ca.SX.sym("h"), ca.SX.sym("nodes", 3, len(GAUSS_NODES)), ca.SX.sym("at", 3)
        X = ca.SX.sym("X", size, count)
        dX = [ca.SX.sym(f"dX{k}", size, count) for k in range(len(names))]
        taken = step(changed, [JointMotion(*ca.vertsplit(nodes[:, j])) for j in range(3)], h)
        constant, columns = taken.transition()
        moved = ca.horzcat(*(ca.vertcat(*column) for column in columns)) @ X
        moved[:, 0] += ca.vertcat(*constant)
        joint = JointMotion(*ca.vertsplit(at))
        seen = self._seen(changed, signals, joint, X)

        def derivatives(of: ca.SX) -> list[ca.SX]:
            by_p = [ca.reshape(ca.jtimes(of, p, unit), of.shape) for unit in _units(len(names))]
            by_X = [ca.reshape(ca.jtimes(of, X, one), of.shape) for one in dX]
            return [a + b for a, b in zip(by_p, by_X, strict=True)]

        state = ca.horzcat(X, *dX)
        after = ca.horzcat(moved, *derivatives(moved))
        given = ca.vertcat(h, ca.vec(nodes), at)
        output = ca.vec(ca.horzcat(seen, *derivatives(seen)))
        one = ca.Function("step", [state, given, p], [after, output], {"cse": True})
        self._steps = one.mapaccum(_AT_ONCE)
        self._start = np.hstack(
            [np.zeros((size, 1)), np.eye(size), np.zeros((size, count * len(names)))]
        )
        self._fastest = ca.Function("fastest", [at, p], [_fastest(changed, joint)])
        self._shape = seen.shape

    @staticmethod
    def _seen(plant: Plant, signals: Sequence[str], joint: JointMotion, X: ca.SX) -> ca.SX:
        """What is recorded, a row a signal; of a column of the state as of the state itself."""
        modes = plant.modes

        def rows(column: int) -> list[ca.SX]:
            W, dW = (ca.vertsplit(half) for half in ca.vertsplit(X[:, column], modes))
            zero = [0.0] * modes
            ddW = plant.modal_accelerations(joint, W, dW)
            torque = plant.torque(joint, W, dW, ddW)
            if column:  # of the state alone
                held = plant.modal_accelerations(joint, zero, zero)
                ddW = [a - b for a, b in zip(ddW, held, strict=True)]
                torque = torque - plant.torque(joint, zero, zero, held)
            found: list[ca.SX] = []
            for signal in signals:
                if signal == "tip":
                    found += plant.tip_displacements(W)
                elif signal == "acceleration":
                    found += plant.tip_displacements(ddW)
                else:
                    found.append(torque)
            return found

        return ca.horzcat(*(ca.vertcat(*rows(column)) for column in range(X.shape[1])))

    def over(self, recording: Recording, joint: Joint, p: Array) -> tuple[Array, Array]:
        """Columns (rows, signals, 1 + 2 modes), and their derivatives (parameters, as these)."""
        time = recording.time
        fastest = float(self._fastest(joint.at(time[:1])[:, 0], p))
        parts = max(1, ceil(fastest * np.diff(time).max() / _STEP))
        given = _steps(recording, joint, parts)
        found = self._marched(given, p)
        rows = found[:, ::parts].T
        size = int(np.prod(self._shape))
        blocks = rows.reshape(len(time), -1, size).reshape(
            len(time), 1 + len(self.names), self._shape[1], self._shape[0]
        )
        blocks = blocks.transpose(1, 0, 3, 2)
        return blocks[0], blocks[1:]

    def _marched(self, given: Array, p: Array) -> Array:
        """The outputs of all steps, a column each."""
        count, state, found = given.shape[1], ca.DM(self._start), list[Array]()
        padded = np.hstack([given, np.zeros((len(given), -count % _AT_ONCE))])  # steps of no length
        for first in range(0, count, _AT_ONCE):
            states, outputs = self._steps(state, padded[:, first : first + _AT_ONCE], p)
            state = states[:, -self._start.shape[1] :]
            found.append(outputs.full())
        return np.hstack(found)[:, :count]


@lru_cache(maxsize=64)
def _steps(recording: Recording, joint: Joint, parts: int) -> Array:
    """Length, joint at the nodes and at the begin of every step; one more at the end."""
    time, steps = recording.time, np.diff(recording.time)
    begins = (time[:-1, None] + steps[:, None] * np.arange(parts) / parts).ravel()
    begins, lengths = np.append(begins, time[-1]), np.append(np.repeat(steps / parts, parts), 0.0)
    nodes = [joint.at(begins + c * lengths) for c in GAUSS_NODES]
    return np.vstack([lengths, *nodes, joint.at(begins)])


def _units(count: int) -> list[ca.DM]:
    return [ca.DM(np.eye(count)[:, k]) for k in range(count)]


def _fastest(plant: Plant, joint: JointMotion) -> Expression:
    """A bound on the frequencies of the modes [rad/s]."""
    K = modal_system(plant, joint).K
    return ca.sqrt(ca.mmax(ca.vertcat(*(sum(ca.fabs(entry) for entry in row) for row in K))))
