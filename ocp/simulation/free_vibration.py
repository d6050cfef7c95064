"""After arrival: with the joint at rest the modes are linear, with constant coefficients."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.checks import numbers, takes
from quietarm.ocp.simulation.collocation import modal_system
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.window import MOST_RADIANS

Array = NDArray[np.float64]


class _Sampling(NamedTuple):
    """Sampling of a window: `samples` in a stride, strides in `columns`, these in `rounds`.

    The `rows` give displacements and scaled rates at the samples of a stride from the state at its
    beginning; `stride` and `following` move that on by a stride, and by all columns.
    """

    samples: int
    rows: Array
    columns: int
    stride: Array
    rounds: int
    following: Array


class FreeVibration:
    """Free vibration of the modes after arrival; states are W [m], then W' [m/s].

    If a state other than rest is wanted on arrival, pass the difference from it
    (`PointToPoint.missed`).

    Parameters
    ----------
    plant : Plant
        The plant. Its parameters may be columns with an entry for each of several plants.
    angle : float or array_like, shape (n,)
        Joint angle [rad]; n vibrations at once have arrays with a leading axis of n.
    window : float or array_like, shape (n,)
        Time after arrival in which displacements count [s], of n vibrations one for each or for
        all; frequencies and states need none.

    Attributes
    ----------
    matrix : ndarray, shape (2 * modes, 2 * modes)
        Derivative of a state by the state [1/s].
    tips : ndarray, shape (tips, 2 * modes)
        Tip displacements [m] by the state; along the plant's `tip_lines`, where it has some.
    displacements : ndarray, shape (tips, 2 * modes)
        Tip displacements [m] by the state, each along its own axis.
    is_in_space : bool
        Whether these are displacements of one tip along perpendicular axes.
    fastest : ndarray, shape ()
        Largest angular frequency [rad/s].

    Raises
    ------
    ValueError
        When the window is too long to be resolved.
    """

    @takes(plant=Plant)
    @on_one_thread
    def __init__(self, plant: Plant, angle: ArrayLike, window: ArrayLike = 0.0) -> None:
        self.window: Array = numbers("residual window", window, "numbers in s")
        angles = np.atleast_1d(numbers("angle", angle, "numbers in rad"))
        modes = plant.modes
        of_rates = np.zeros((len(angles), 2 * modes, 2 * modes))
        of_rates[:, :modes, modes:] = np.eye(modes)
        at_rest = JointMotion(ca.DM(angles), 0.0, 0.0)
        system = modal_system(plant, at_rest)
        for part, columns in ((system.K, slice(0, modes)), (system.D, slice(modes, None))):
            of_rates[:, modes:, columns] = -_stacked(part, len(angles))
        of_tips = np.zeros((len(angles), plant.tips, 2 * modes))
        units = np.eye(modes).tolist()
        by_mode = [list(plant.tips_at(at_rest, unit)) for unit in units]
        of_tips[:, :, :modes] = _stacked(by_mode, len(angles)).transpose(0, 2, 1)
        self.displacements = of_tips[0] if np.ndim(angle) == 0 else of_tips
        self.is_in_space = plant.tip_lines is not None
        if plant.tip_lines is not None:
            of_tips = plant.tip_lines @ of_tips
            of_tips = of_tips[:, outermost([rows[:, :modes] for rows in of_tips])]
        single = np.ndim(angle) == 0
        self.matrix, self.tips = (of_rates[0], of_tips[0]) if single else (of_rates, of_tips)
        self._eigenvalues = np.linalg.eigvals(self.matrix).astype(complex)
        self.fastest: Array = np.abs(self._eigenvalues).max(axis=-1)
        self._most = float(self.fastest.max())
        longest = float(self.window.max())
        self._radians = longest * self._most
        if self._radians > MOST_RADIANS:
            raise ValueError(
                f"residual window {longest:g} s is {self._radians:.3g} radians of the plant's "
                f"fastest mode; give at most {longest * MOST_RADIANS / self._radians:.3g} s"
            )

    @property
    def modes(self) -> list[tuple[float, float]]:
        """Undamped frequency [rad/s] and damping ratio of each oscillating mode, slowest first."""
        swinging = [complex(value) for value in self._eigenvalues if value.imag > 0]
        return [(abs(value), -value.real / abs(value)) for value in sorted(swinging, key=abs)]

    @cached_property
    def rows(self) -> Array:
        """Residual: the largest absolute product of a row and a state, to 5e-5; (rows, 2 * modes).

        To 1.3e-3 along the lines of a plant with `tip_lines`, which has a row for each of these at
        every time: `certify` makes up for what is missed of a peak.
        """
        return self.rows_every(radians=0.1 if self.is_in_space else 0.02)

    @on_one_thread
    def rows_every(self, radians: float) -> Array:
        """Return the rows at samples of another distance [rad of the fastest mode].

        A peak between two samples is missed by an eighth of the distance's square, as a share.
        """
        samples = max(2, math.ceil(self._radians / radians) + 1)  # both ends at least
        step = exponential(self.matrix, self.window / (samples - 1), self._most)
        rows = extreme_rows(powers(self.tips, step, samples), len(self.tips))
        rows.setflags(write=False)
        return rows

    @on_one_thread
    def peak(self, states: ArrayLike) -> Array:
        """Residual [m]: the largest absolute displacement of a tip within the window.

        States on arrival have shape (2 * modes,) or (n, 2 * modes), many of one vibration or one of
        each; the peaks () or (n,), between the samples where a tip turns back there.
        """
        rows_of_states = self._checked("states", states)
        state = rows_of_states.reshape(-1, 1, rows_of_states.shape[-1])
        sampling = self._sampling
        starts = powers(state, sampling.stride, sampling.columns)
        most = np.zeros(len(state))
        for _ in range(sampling.rounds):
            moved = sampling.rows @ starts.swapaxes(1, 2)
            moved = moved.reshape(len(state), sampling.samples + 1, 2, -1)
            most = np.maximum(most, _largest(moved[:, :, 0], moved[:, :, 1]))
            starts = starts @ sampling.following
        return most.reshape(rows_of_states.shape[:-1])

    def _checked(self, name: str, states: ArrayLike) -> Array:
        """States as numbers; those of motions that were not finite stay so."""
        rows = numbers(name, states, "numbers in m and m/s", infinite=True)
        count = self.matrix.shape[-1]
        if not rows.ndim or rows.shape[-1] != count:
            raise ValueError(
                f"{name} has shape {rows.shape}; give {count} numbers, W and W' of each mode"
            )
        return rows

    @cached_property
    @on_one_thread
    def _sampling(self) -> _Sampling:
        matrix, tips = (
            matrices.reshape(-1, *matrices.shape[-2:]) for matrices in (self.matrix, self.tips)
        )
        # Phase of the fastest mode between samples: the cubic between two misses 3e-8 of a peak.
        radians = 0.06
        # Samples are products of so many rows and so many states.
        samples = 16
        states_at_once = 64
        strides = max(1, math.ceil(self._radians / radians / samples))
        rounds = math.ceil(strides / states_at_once)
        columns = math.ceil(strides / rounds)
        between = self.window / (rounds * columns * samples)
        step = exponential(matrix, between, self._most)
        outputs = np.concatenate([tips, between[..., None, None] * tips @ matrix], axis=1)
        stride = np.linalg.matrix_power(step, samples).swapaxes(1, 2)
        return _Sampling(
            samples,
            powers(outputs, step, samples + 1),
            columns,
            stride,
            rounds,
            np.linalg.matrix_power(stride, columns),
        )

    @on_one_thread
    def states(self, state: ArrayLike, times: ArrayLike) -> Array:
        """The states at times since arrival [s], shape (times, 2 * modes), of one vibration."""
        at = np.atleast_1d(numbers("times", times, "numbers in s"))
        first = self._checked("state", state)
        at_once = 4096
        parts = np.split(at, range(at_once, len(at), at_once))
        return np.concatenate(
            [exponential(self.matrix, part, self._most) @ first for part in parts]
        )


def after_arrival(task: PointToPoint) -> list[FreeVibration]:
    """The vibration at a task's target, in each of its scenarios."""
    plants = task.perturbed_plants
    window = task.residual_window
    return [vibration_of(plant, task.target, window) for plant in plants]


vibration_of = lru_cache(maxsize=256)(FreeVibration)
"""A vibration that is kept for the next who asks for it."""


@lru_cache(maxsize=256)
def fastest_along(plant: Plant, start: float, target: float) -> float:
    """Largest angular frequency of a plant at rest, from start to target [rad/s]."""
    return fastest_of_moves(plant, [start], [target]).item()


def fastest_of_moves(plant: Plant, starts: ArrayLike, targets: ArrayLike) -> Array:
    """Return the fastest natural frequency of a plant along each of many moves [rad/s]."""
    ends = np.asarray(starts, dtype=float), np.asarray(targets, dtype=float)
    angles = np.linspace(*ends, 49)
    fastest = FreeVibration(plant, angles.ravel()).fastest
    return fastest.reshape(angles.shape).max(axis=0)


def exponential(matrix: Array, times: ArrayLike, fastest: float) -> Array:
    """exp(matrix * time) for each time [s]; fastest is the largest absolute eigenvalue."""
    at = matrix * np.asarray(times, dtype=float)[..., None, None]
    radians = fastest * float(np.max(times, initial=0.0))
    # Up to a phase of 0.1 ten terms of the Taylor series give it to 1e-18.
    halvings = max(0, math.ceil(math.log2(max(radians, 0.1) / 0.1)))
    small = at / 2**halvings
    unit = np.eye(matrix.shape[-1])
    result = np.broadcast_to(unit, small.shape)
    for term in range(10, 0, -1):
        result = unit + small @ result / term
    for _ in range(halvings):
        result = result @ result
    return result


def powers(rows: Array, step: Array, count: int) -> Array:
    """The products of rows with the first `count` powers of a matrix, one after another."""
    most = count * rows.shape[-2]
    while rows.shape[-2] < most:
        rows = np.concatenate([rows, rows @ step], axis=-2)
        step = step @ step
    return rows[..., :most, :]


def _stacked(entries: Sequence[Sequence[Expression]], count: int) -> Array:
    """Stack entries that are numbers or columns into matrices."""
    columns = [
        [np.broadcast_to(np.array(ca.DM(entry)).ravel(), count) for entry in row] for row in entries
    ]
    return np.moveaxis(np.array(columns), -1, 0)


def _largest(tips: Array, rates: Array) -> Array:
    """Largest absolute value of samples (n, samples, tips), and of the cubics between them."""
    most = np.abs(tips).max(axis=(1, 2))
    turns = np.nonzero(rates[:, :-1] * rates[:, 1:] < 0)
    w = tips[:, :-1][turns]
    after = tips[:, 1:][turns]
    v = rates[:, :-1][turns]
    v_after = rates[:, 1:][turns]
    at = v / (v - v_after)
    rise = after - w  # where the rate, nearly a line, is zero
    second = 3 * rise - 2 * v - v_after
    third = v + v_after - 2 * rise
    np.maximum.at(
        most,
        turns[0],
        np.abs(w + at * (v + at * (second + at * third))),
    )
    return most


def outermost(tables: Sequence[Array]) -> list[int]:
    """Return which rows have the largest absolute product with some vector, in one of the tables.

    Rows of three numbers and more are all kept.
    """
    if tables[0].shape[1] > 2:
        return list(range(len(tables[0])))
    kept = set[int]()
    for rows in tables:
        if rows.shape[1] == 1:
            kept.add(int(np.argmax(np.abs(rows[:, 0]))))
        else:
            kept.update(_hull(rows))
    return sorted(kept)


def _hull(points: Array) -> list[int]:
    """Indices of points of a plane on the hull of these and their negatives."""
    both = np.vstack([points, -points])
    order = np.lexsort((both[:, 1], both[:, 0])).tolist()
    corners = list[int]()
    for way in (order, order[::-1]):  # below, and above
        chain = list[int]()
        for i in way:
            while len(chain) > 1 and not _turns_left(both[chain[-2]], both[chain[-1]], both[i]):
                chain.pop()
            chain.append(i)
        corners += chain[:-1]
    return [corner % len(points) for corner in corners]


def _turns_left(before: Array, at: Array, after: Array) -> bool:
    """Return whether the way through three points of a plane turns to the left at the second."""
    u, v = at - before
    x, y = after - at
    return bool(u * y - v * x > 0)


def extreme_rows(rows: Array, tips: int) -> Array:
    """Select the rows of displacements, tip after tip, that are largest for some state.

    A tip that one mode moves turns in a plane, and dies away: corners of half a turn suffice.
    """
    parts: list[Array] = []
    for tip in range(tips):
        of_tip = rows[tip::tips]
        turning, spread, _ = np.linalg.svd(of_tip, full_matrices=False)
        if spread[2:].max(initial=0.0) <= 1e-12 * spread[0]:
            of_tip = of_tip[_corners(turning[:, 0], turning[:, 1])]
        parts.append(of_tip)
    return np.vstack(parts)


def _corners(x: Array, y: Array) -> list[int]:
    """Indices of points, turning on and inwards, on the hull of these and their negatives."""
    angle = np.unwrap(np.arctan2(y, x))
    half = np.abs(angle - angle[0]) <= np.pi
    y = np.copysign(1.0, angle[-1] - angle[0]) * y  # anticlockwise
    points = [*zip(x[half].tolist(), y[half].tolist()), (-float(x[0]), -float(y[0]))]
    corners: list[int] = []
    for i, (u, v) in enumerate(points):
        while len(corners) > 1:
            a, b = points[corners[-2]]
            c, d = points[corners[-1]]
            if (c - a) * (v - b) > (d - b) * (u - a):
                break
            corners.pop()
        corners.append(i)
    return corners[:-1]
