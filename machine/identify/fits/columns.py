"""Columns that a recording's signals consist of, by a plant's parameters.

With the joint at rest they are free decays. Where it moves a signal is a column for the joint's
motion and one for each entry of the state at the start.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.response import Response
from quietarm.machine.recordings.recording import Recording
from quietarm.machine.recordings.recursion import decaying_sums
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS

Array = NDArray[np.float64]


class BasisColumns(Protocol):
    """The columns of a part of a recording.

    Attributes
    ----------
    driven : bool
        Whether the first column is what the joint's motion does.
    count : int
        Of the parameters.
    """

    driven: bool
    count: int

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals or 1, rows, columns), and their derivatives (parameters, as these)."""
        ...


class FreeDecay(BasisColumns):
    """The columns of a recording whose joint is at rest, the same for every signal."""

    driven = False

    def __init__(self, response: Response, recording: Recording) -> None:
        self._response = response
        self._time = recording.time - recording.time[0]
        self.count = len(response.names)
        self._angle = 0.0 if recording.angle is None else float(recording.angle.mean())

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (1, rows, columns), and their derivatives (parameters, 1, rows, columns)."""
        values, slopes = self._response.eigenvalues(p, self._angle)
        time = self._time[:, None]
        swings = np.exp(time * values)
        of_parameters = slopes.T[: None if derivatives else 0, None]
        by_p = of_parameters * (time * swings)
        return parts(swings)[None], parts(by_p)[:, None]


class Forced(BasisColumns):
    """The columns of a recording whose joint moves, by the linear equations of the modes.

    Each eigenvalue is a filter of the joint's acceleration, exact but for the acceleration's course
    within a step, that has Gauss's three nodes. The columns are those of `Driven`.
    """

    driven = True

    def __init__(self, response: Response, time: Array, spline: Any, fastest: float) -> None:
        self._response = response
        self.count = len(response.names)
        self._time = time - time[0]
        self._step = self._even_step(time, fastest)
        steps = round(self._time[-1] / self._step)
        whole_steps = np.floor(self._time / self._step + 1e-6).astype(int)
        self._rows = np.minimum(whole_steps, steps)
        rest = np.maximum(self._time - self._rows * self._step, 0.0)
        rest[rest < 1e-6 * self._step] = 0.0
        self._rest = rest

        def joint(at: Array) -> Array:
            return spline(np.clip(at, time[0], time[-1]), 2)

        begins = time[0] + self._step * np.arange(steps)
        self._nodes = np.stack([joint(begins + c * self._step) for c in GAUSS_NODES])
        last = min(time[-1], time[0] + self._step * steps)
        at_rows = np.minimum(time[0] + self._step * self._rows, last)
        self._row_nodes = np.stack([joint(at_rows + c * rest) for c in GAUSS_NODES])
        self._acceleration = joint(time)
        self._lever = _lever(response, self._acceleration)

    def _even_step(self, time: Array, fastest: float) -> float:
        """A step that ends with the rows, in which the fastest mode goes through 0.25 rad."""
        usual = float(np.median(np.diff(time)))
        step = self._time[-1] / max(round(self._time[-1] / usual), 1)
        return step / max(np.ceil(fastest * step / 0.25), 1)

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these).

        The last is of an accelerometer at some distance from the joint.
        """
        values, residues, feed = self._response.modal_form(p)
        answers, slopes = self._answers(values, derivatives)
        forced = (residues @ answers).real + np.outer(feed, self._acceleration)
        free = np.exp(np.outer(self._time, values))
        columns = self._side_by_side(forced, parts(free), self._lever)
        if not derivatives:
            return columns, columns[:0]
        by_p = list[Array]()
        for dvalues, dresidues, dfeed in self._derivatives(p):
            of_values = residues @ (dvalues[:, None] * slopes)
            dforced = (dresidues @ answers + of_values).real
            dforced += np.outer(dfeed, self._acceleration)
            dfree = self._time[:, None] * free * dvalues
            by_p.append(self._side_by_side(dforced, parts(dfree), 0 * self._lever))
        return columns, np.stack(by_p)

    def _side_by_side(self, forced: Array, free: Array, lever: Array) -> Array:
        states = np.broadcast_to(free, (len(forced), *free.shape))
        return np.concatenate([forced[..., None], states, lever], axis=-1)

    def _answers(self, values: Any, derivatives: bool) -> tuple[Any, Any]:
        """Return each eigenvalue's answer to the acceleration at the rows, and its slope by it."""
        answers = list[Any]()
        slopes = list[Any]()
        for value in values:
            grown, added, added_slope = _over_a_step(value, self._step, self._nodes)
            at_steps = decaying_sums(grown, np.append(0.0, added))
            answer = at_steps[self._rows]
            slope: Any = 0.0
            if derivatives:
                pushed = added_slope + self._step * grown * at_steps[:-1]
                slope = decaying_sums(grown, np.append(0.0, pushed))[self._rows]
            if self._rest.any():
                grown, added, added_slope = _over_a_step(value, self._rest, self._row_nodes)
                slope = grown * (slope + self._rest * answer) + added_slope
                answer = grown * answer + added
            answers.append(answer)
            slopes.append(slope)
        return np.array(answers), np.array(slopes)

    def _derivatives(self, p: Array) -> Iterator[tuple[Array, ...]]:
        """Yield central differences of eigenvalues, residues and feed by each parameter."""
        share = 1e-6  # of a parameter
        for k, size in enumerate(np.maximum(np.abs(p), 1e-3)):
            change = np.zeros(len(p))
            change[k] = share * size
            above = self._response.modal_form(p + change)
            below = self._response.modal_form(p - change)
            yield tuple((u - v) / (2 * change[k]) for u, v in zip(above, below))


def _over_a_step(value: complex, step: Any, nodes: Array) -> tuple[Any, Any, Any]:
    """Return a mode's growth over steps, what an acceleration adds, and that by the eigenvalue."""
    added = 0.0
    slope = 0.0
    for c, weight, acceleration in zip(GAUSS_NODES, GAUSS_WEIGHTS, nodes):
        to_end = step * (1 - c)
        share = weight * step * np.exp(value * to_end) * acceleration
        added = added + share
        slope = slope + to_end * share
    return np.exp(value * step), added, slope


class Driven(BasisColumns):
    """The columns of a recording whose joint moves: first what its motion does to the signals.

    By the plant's own equations, or where these are unknown but for the modes, by its linear ones:
    those of a slow joint, that feel its acceleration alone.
    """

    driven = True

    def __init__(
        self, response: Response, time: Array, spline: Any, fastest: float, linear: bool
    ) -> None:
        self._response = response
        self.count = len(response.names)
        orders = (1.0, 0.0, 1.0) if linear else (1.0, 1.0, 1.0)

        def joint(at: Array) -> list[Array]:
            return [size * spline(at, k) for k, size in enumerate(orders)]

        most_phase = 0.4  # [rad] of the fastest mode in a step: errors are below 1e-6 of a period
        steps = np.diff(time)
        counts = np.maximum(np.ceil(fastest * steps / most_phase), 1).astype(int)
        self._rows = np.concatenate([[0], np.cumsum(counts)])
        lengths = np.append(np.repeat(steps / counts, counts), 0.0)
        begins = time[0] + np.concatenate([[0.0], np.cumsum(lengths[:-1])])
        nodes = [row for c in GAUSS_NODES for row in joint(begins + c * lengths)]
        motion = np.vstack([lengths, *nodes, *joint(begins)])
        # marches are compiled for multiples of 512 steps, the last of no length
        self._motion = np.pad(motion, ((0, 0), (0, -motion.shape[1] % 512)))
        self._lever = _lever(response, spline(time, 2))

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these).

        The last is of an accelerometer at some distance from the joint.
        """
        march = self._response.march(self._motion.shape[1], derivatives)
        table, *slopes = march(self._motion, p)
        columns = self._columns(table, self._lever)[0]
        if not derivatives:
            return columns, columns[:0]
        return columns, self._columns(slopes[0], 0 * self._lever)

    def _columns(self, table: Array, lever: Array) -> Array:
        """A table of the march by (parameters, signals, rows, columns), with the lever's."""
        signals = len(self._response.kinds)
        steps = table.reshape(-1, signals, table.shape[1])
        by_step = steps.reshape(*steps.shape[:2], -1, self._motion.shape[1])
        by_row = by_step[..., self._rows].transpose(2, 1, 3, 0)
        levers = np.broadcast_to(lever, (*by_row.shape[:3], 1))
        return np.concatenate([by_row, levers], axis=-1)


def _lever(response: Response, acceleration: Array) -> Array:
    """Return what accelerometers feel by their distance from the joint (signals, rows, 1)."""
    return np.outer(response.kinds == "acceleration", acceleration)[..., None]


def parts(values: Any) -> Array:
    """Real and imaginary parts of columns, side by side."""
    return np.ascontiguousarray(values).view(np.float64)
