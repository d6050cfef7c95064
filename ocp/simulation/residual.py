"""After arrival: the tip's motion is a constant matrix times the state at arrival."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import JointMotion, Plant
from quietarm.ocp.checks import whole
from quietarm.ocp.interrupts import keep_interrupts, one_at_a_time
from quietarm.ocp.simulation.collocation import NODES, modal_system, step
from quietarm.ocp.task import PointToPoint

MOST_SAMPLES = 200_000
_TIMES_AT_ONCE = 256
RADIANS_A_SAMPLE = 0.02
"""Phase of the fastest mode between samples: these miss at most 5e-5 of a peak."""
_ANGLES = 49
"""Of the joint, at which the fastest mode of a move is looked for: both ends and between them."""


@lru_cache(maxsize=256)
@keep_interrupts()  # casadi loses a Ctrl-C
def fastest_along(plant: Plant, start: float, target: float) -> float:
    """Largest angular frequency of a plant at rest, from start to target [rad/s]."""
    angles = np.linspace(start, target, _ANGLES)
    return float(np.abs(np.linalg.eigvals(state_matrices(plant, angles))).max())


def vibrations(plant: Plant, angle: float) -> list[tuple[float, float]]:
    """Undamped frequency [rad/s] and damping ratio of every mode that oscillates at rest.

    The slowest first.
    """
    values = _eigenvalues(plant, angle)
    oscillating = sorted(values[values.imag > 0], key=abs)
    return [(float(abs(value)), float(-value.real / abs(value))) for value in oscillating]


def slowest_swing(plant: Plant, angle: float) -> float:
    """Period of the slowest mode at rest [s]; 1 where none swings."""
    swings = vibrations(plant, angle)
    return 2 * math.pi / swings[0][0] if swings else 1.0


def _fastest(plant: Plant, angle: float) -> float:
    return float(np.abs(_eigenvalues(plant, angle)).max())


@lru_cache(maxsize=256)
@keep_interrupts()  # casadi loses a Ctrl-C
def _eigenvalues(plant: Plant, angle: float) -> NDArray[np.complex128]:
    """Of the matrix that gives (W', W'') by (W, W') with the joint at rest [1/s]; read-only."""
    values = np.linalg.eigvals(state_matrices(plant, np.array([angle]))[0]).astype(complex)
    values.setflags(write=False)
    return values


def state_matrices(plant: Plant, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """What gives (W', W'') by (W, W') with the joint at rest at each angle [1/s]."""
    system, modes = modal_system(plant, JointMotion(ca.DM(angles), 0.0, 0.0)), plant.modes
    matrices = np.zeros((len(angles), 2 * modes, 2 * modes))
    matrices[:, :modes, modes:] = np.eye(modes)
    for part, columns in ((system.K, slice(0, modes)), (system.D, slice(modes, None))):
        for i, row in enumerate(part):
            entries = [np.broadcast_to(np.array(ca.DM(x)).ravel(), len(angles)) for x in row]
            matrices[:, modes + i, columns] = -np.array(entries).T
    return matrices


def residuals_at_rest(
    task: PointToPoint, targets: NDArray[np.float64], arrivals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """F1 [m] of many moves of a task's plant and window, by modal decomposition.

    The joint rests at the targets [rad]; a row of arrivals is W [m] and then W' [m/s].
    """
    plant, modes = task.plant, task.plant.modes
    values, vectors = np.linalg.eig(state_matrices(plant, targets))
    count = math.ceil(task.residual_window * np.abs(values).max() / RADIANS_A_SAMPLE) + 1
    times = np.linspace(0.0, task.residual_window, count)
    shares = np.linalg.solve(vectors, arrivals[:, :, None].astype(complex))[:, :, 0]
    units = [[float(i == j) for i in range(modes)] for j in range(modes)]
    tips = np.array([[float(ca.DM(x)) for x in plant.tip_displacements(one)] for one in units]).T
    of_tips = (tips @ vectors[:, :modes, :]) * shares[:, None, :]
    most = np.zeros(len(targets))
    for first in range(0, count, _TIMES_AT_ONCE):
        moved = np.exp(values[:, :, None] * times[first : first + _TIMES_AT_ONCE])
        most = np.maximum(most, np.abs((of_tips @ moved).real).max(axis=(1, 2)))
    return most


def residual_samples(task: PointToPoint) -> int:
    """Times in the residual window that resolve the fastest mode of all scenarios at the target."""
    plants, window = task.perturbed_plants, task.residual_window
    return max(_samples(plant, task.target, window) for plant in plants)


def _samples(plant: Plant, target: float, window: float) -> int:
    fastest = _fastest(plant, target)
    samples = window * fastest / RADIANS_A_SAMPLE
    if samples > MOST_SAMPLES:
        most = MOST_SAMPLES * RADIANS_A_SAMPLE / fastest
        raise ValueError(
            f"residual window {window:g} s is {samples * RADIANS_A_SAMPLE:.3g} "
            f"radians of the plant's fastest mode; give at most {most:.3g} s"
        )
    return max(2, math.ceil(samples) + 1)  # both ends of the window at least


@one_at_a_time
def residual_matrix(task: PointToPoint, samples: int | None = None) -> NDArray[np.float64]:
    """Matrix that turns the state at arrival into the tip's motion afterwards.

    Parameters
    ----------
    task : PointToPoint
        The move; its target and residual window count.
    samples : int, optional
        Number of times in the window; `residual_samples` of the task by default.

    Returns
    -------
    ndarray, shape (samples * tips, 2 * modes), read-only
        L, with tip displacements [m] = L @ [W, W'] at times over the window. F1 of eq (11) is
        the largest absolute entry of the product.

    Raises
    ------
    ValueError
        When its window cannot be resolved by so many samples.
    """
    if samples is not None:
        memory = "a matrix of more takes too much memory"
        samples = whole("samples", samples, 2, MOST_SAMPLES, memory)
    samples = samples or residual_samples(task)
    return _residual_matrix(task.plant, task.target, task.residual_window, samples)


@lru_cache(maxsize=256)
@keep_interrupts()  # casadi loses a Ctrl-C
def _residual_matrix(
    plant: Plant, target: float, window: float, samples: int
) -> NDArray[np.float64]:
    modes = plant.modes
    one = step(plant, [JointMotion(target, 0.0, 0.0)] * NODES, window / (samples - 1))
    columns = one.transition()[1]
    transition = np.array([[float(ca.DM(x)) for x in column] for column in columns]).T
    tip_of_state = np.zeros((plant.tips, 2 * modes))
    for mode in range(modes):
        unit = [float(other == mode) for other in range(modes)]
        tip_of_state[:, mode] = [float(tip) for tip in plant.tip_displacements(unit)]
    matrix = tip_of_state
    while len(matrix) < samples * plant.tips:
        matrix = np.vstack([matrix, matrix @ transition])
        transition = transition @ transition
    matrix = matrix[: samples * plant.tips].copy()
    matrix.setflags(write=False)
    return matrix


def residual_rows(
    task: PointToPoint, plant: Plant | None = None, samples: int | None = None
) -> NDArray[np.float64]:
    """The rows of `residual_matrix` that hold the largest displacement of some state; read-only.

    Of the task's nominal plant, or of another in its place.
    """
    plant = task.plant if plant is None else plant
    samples = samples or _samples(plant, task.target, task.residual_window)
    return _residual_rows(plant, task.target, task.residual_window, samples)


@lru_cache(maxsize=256)
def _residual_rows(plant: Plant, target: float, window: float, samples: int) -> NDArray[np.float64]:
    rows = extreme_rows(_residual_matrix(plant, target, window, samples), plant.tips)
    rows.setflags(write=False)
    return rows


def extreme_rows(matrix: NDArray[np.float64], tips: int) -> NDArray[np.float64]:
    """The rows of a residual matrix that hold the largest displacement of some state.

    The tip turns in a plane when one mode moves it: of its rows and their negatives those on the
    convex hull suffice, about half a period of them.
    """
    kept: list[NDArray[np.float64]] = []
    for tip in range(tips):
        rows = matrix[tip::tips]
        _, spread, axes = np.linalg.svd(rows, full_matrices=False)
        if spread[2:].max(initial=0.0) <= 1e-12 * spread[0]:
            rows = rows[_hull(rows @ axes[:2].T)]
        kept.append(rows)
    return np.vstack(kept)


def _hull(points: NDArray[np.float64]) -> list[int]:
    """Indices of points in the plane that lie, or whose negatives lie, on their common hull."""
    both = np.vstack([points, -points])
    order = np.lexsort(both.T[::-1])
    at: list[list[float]] = both.tolist()  # NumPy's own numbers take much longer one by one
    corners: set[int] = set()
    for direction in (order, order[::-1]):  # Andrew's monotone chain: lower hull, then upper
        chain: list[int] = []
        for i in direction.tolist():
            while len(chain) > 1 and _left_turn(at[chain[-2]], at[chain[-1]], at[i]) <= 0:
                chain.pop()
            chain.append(i)
        corners.update(index % len(points) for index in chain)
    return sorted(corners)


def _left_turn(a: Sequence[float], b: Sequence[float], c: Sequence[float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
