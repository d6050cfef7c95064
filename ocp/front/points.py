"""Points of a front, and which of them stay; motions from elsewhere."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp.checks import IF_STATED, Count, CountFromOne, NotNegative, Share, positive
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, peak_quantities
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import PointToPoint

LEVELS = (1e-4, 1e-3, 5e-3)
"""Residuals [m] at which the energies of fronts are compared; those that are compared have a point
at each, where they can."""


@dataclass(frozen=True)
class FrontPoint:
    """One motion on a front: its coefficients, residual [m] and energy [J].

    `Front` checks its points. The `shadow_prices` are the decrease of the least energy per unit of
    a widened limit [J by its unit], as of a `Plan`: that of the residual is the slope of the
    front. They are empty if they are not known. The `peaks` are those that are objectives of the
    front, by quantity [its SI unit].
    """

    coefficients: tuple[float, ...]
    residual: NotNegative
    energy: NotNegative
    shadow_prices: Mapping[str, float] = field(default_factory=dict, hash=False)
    peaks: Mapping[str, NotNegative] = field(default_factory=dict, hash=False, metadata=IF_STATED)

    def __post_init__(self) -> None:
        prices = {name: float(price) for name, price in sorted(self.shadow_prices.items())}
        coefficients = tuple(map(float, self.coefficients))
        object.__setattr__(self, "shadow_prices", prices)
        object.__setattr__(self, "coefficients", coefficients)
        object.__setattr__(self, "residual", float(self.residual))
        object.__setattr__(self, "energy", float(self.energy))
        peaks = {name: float(peak) for name, peak in self.peaks.items()}
        object.__setattr__(self, "peaks", peaks)

    def values(self, quantities: Sequence[str] = ()) -> tuple[float, ...]:
        """Residual, energy, and the peaks of these quantities."""
        return (self.residual, self.energy, *(self.peaks[name] for name in quantities))


@dataclass(frozen=True)
class FailedPoint:
    """A point of a front that was not found.

    Attributes
    ----------
    asked : mapping of str to float
        What was asked for: a residual limit [m], or the weights of the objectives.
    reason : str
        Why there is none.
    """

    asked: Mapping[str, float] = field(hash=False)
    reason: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "asked", dict(self.asked))


@dataclass(frozen=True)
class Quality:
    """Figures that a mark of an earlier file states; today they are computed from the points.

    All are scaled: 0 is the reference front's least and 1 its largest value of each objective.

    Attributes
    ----------
    hypervolume : float
        Share of the reference front's hypervolume.
    igd_plus, epsilon : float
        IGD+ and additive epsilon from the reference front's points.
    energies : tuple of float or None
        Least energy [J] within each of `LEVELS`; None where no point is within it.
    """

    hypervolume: NotNegative
    igd_plus: NotNegative
    epsilon: float
    energies: tuple[float | None, ...]


@dataclass(frozen=True)
class Mark:
    """Effort of a method at one moment.

    Attributes
    ----------
    evaluations : int
        Candidates simulated so far.
    hypervolume : float or None
        Share of the reference box (`Front.reference`) that the points found dominate, as an earlier
        file states it; None where it is computed from the entries or the points.
    seconds : float
        Processor time so far, without first builds and without checks [s].
    gradients, hessians : int
        Motions simulated with first and with second derivatives.
    quality, between : Quality or None
        As an earlier file states them: of the points; with motions between neighbouring points.
    """

    evaluations: Count
    hypervolume: Share | None = field(default=None, metadata=IF_STATED)
    seconds: NotNegative = field(default=0.0, compare=False)
    gradients: Count = 0
    hessians: Count = 0
    quality: Quality | None = field(default=None, metadata=IF_STATED)
    between: Quality | None = field(default=None, metadata=IF_STATED)


@dataclass(frozen=True)
class Entries:
    """The candidates of a search that no earlier one dominated, in the order of their evaluation.

    What a search had found at any moment follows from them. ValueError where the columns are not of
    one length, or the numbers do not rise from 1 or later.

    Attributes
    ----------
    candidates : tuple of int
        Their numbers, from 1.
    coefficients : tuple of tuple of float
        The profile's coefficients of each.
    residuals, energies : tuple of float
        Residual [m] and energy [J] at the steps of the search, without noise.
    peaks : mapping of str to tuple of float
        The peaks that are objectives, by quantity [its SI unit].
    believed : tuple of tuple of float
        Of a search with noise, all objectives as it took them; empty where these are the true ones.
    """

    candidates: tuple[CountFromOne, ...] = ()
    coefficients: tuple[tuple[float, ...], ...] = ()
    residuals: tuple[NotNegative, ...] = ()
    energies: tuple[NotNegative, ...] = ()
    peaks: Mapping[str, tuple[NotNegative, ...]] = field(
        default_factory=dict, hash=False, metadata=IF_STATED
    )
    believed: tuple[tuple[NotNegative, ...], ...] = field(default=(), metadata=IF_STATED)

    def __post_init__(self) -> None:
        columns = [self.coefficients, self.residuals, self.energies, *self.peaks.values()]
        if self.believed:
            columns.append(self.believed)
        lengths = {len(column) for column in columns}
        if lengths != {len(self.candidates)}:
            raise ValueError("its entries have columns of several lengths")
        if any(later <= number for number, later in pairwise(self.candidates)):
            raise ValueError("the numbers of its entries do not rise")

    def __len__(self) -> int:
        return len(self.candidates)

    def objectives(self, evaluations: int | None = None) -> NDArray[np.float64]:
        """Residuals [m], energies [J] and peaks, of those among so many candidates, a row each."""
        count = self._count(evaluations)
        columns = [self.residuals, self.energies, *self.peaks.values()]
        return np.column_stack([column[:count] for column in columns])

    def beliefs(self, evaluations: int | None = None) -> NDArray[np.float64]:
        """Return the objectives as the search took them: with its noise, if it had any."""
        if not self.believed:
            return self.objectives(evaluations)
        return np.array(self.believed[: self._count(evaluations)])

    def _count(self, evaluations: int | None) -> int:
        return len(self) if evaluations is None else bisect_right(self.candidates, evaluations)


def non_dominated(
    points: Iterable[FrontPoint], objectives: Sequence[str] = RESIDUAL_AND_ENERGY
) -> tuple[FrontPoint, ...]:
    """The non-dominated points, in order of residual, so that of two objectives energies fall.

    Points that are not finite are dropped; of equal ones the first is kept.
    """
    quantities = peak_quantities(objectives)
    finite = [point for point in points if np.isfinite(point.values(quantities)).all()]
    finite.sort(key=lambda point: point.values(quantities))
    if quantities:
        table = np.array([point.values(quantities) for point in finite])
        return tuple(finite[row] for row in non_dominated_rows(table))
    front: list[FrontPoint] = []
    for point in finite:
        if not front or point.energy < front[-1].energy:
            front.append(point)
    return tuple(front)


def non_dominated_rows(table: NDArray[np.float64]) -> list[int]:
    """Rows of objectives, sorted by the first, that no other dominates; of equal ones the first."""
    rows: list[int] = []
    for row, values in enumerate(table):  # whatever dominates it stands before it
        if not (table[rows] <= values).all(axis=1).any():
            rows.append(row)
    return rows


class Evaluated(NamedTuple):
    """Evaluated motions: the points of their front, how many are not in it, and why."""

    points: tuple[FrontPoint, ...]
    failed: int
    infeasible: int


def beyond(
    table: NDArray[np.float64],
    lower: ArrayLike,
    upper: ArrayLike,
    rounding: float = 1e-9,
) -> NDArray[np.int64]:
    """Row and column of every coefficient that is not within bounds, or is no number.

    It may pass the box by a share of its size: what decimals in a file may lose.
    """
    size = np.maximum(np.abs(lower), np.abs(upper))
    excess = np.abs(table - np.clip(table, lower, upper))
    return np.argwhere(~(excess <= rounding * size))


def refuse_beyond_box(
    profile: JointProfile,
    table: NDArray[np.float64],
    bound: float | None,
    remedy: str = "; correct it, or state a wider bound",
) -> None:
    """Refuse coefficients beyond the bounds of a profile for the bound that is stated."""
    if bound is None:
        return
    most = positive("its bound", bound)
    for row, column in beyond(table, *profile.box(most)):
        raise ValueError(
            f"point {row + 1} of {len(table)} has the coefficient {table[row, column]:.4g}, "
            f"beyond the stated bound of {most:g}{remedy}"
        )


def evaluated(
    task: PointToPoint,
    profile: JointProfile,
    table: NDArray[np.float64],
    bound: float | None = None,
    at_limit: float = 1e-9,
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
) -> Evaluated:
    """The front of motions by CVODES; those that fail or break a limit of the task are counted.

    A peak within the share `at_limit` of its limit counts as at it.
    """
    points: list[FrontPoint] = []
    failed = 0
    infeasible = 0
    rows = [profile.checked(row, task.duration) for row in table]
    refuse_beyond_box(profile, table, bound)
    for coefficients in rows:
        try:
            motion = JudgedMotion.of_profile(task, profile, coefficients)
            point = point_of(motion, objectives)
        except SolverFailedError:
            failed += 1
            continue
        if motion.figures.exceeded(task.limits, at_limit):
            infeasible += 1
        else:
            points.append(point)
    return Evaluated(non_dominated(points, objectives), failed, infeasible)


def point_of(motion: JudgedMotion, objectives: Sequence[str]) -> FrontPoint:
    """A motion, as CVODES judges it, as a point; SolverFailedError where it has no figures."""
    names = peak_quantities(objectives)
    peaks = {name: motion.motion.peak(name) for name in names} if names else {}
    return FrontPoint(motion.coefficients, motion.residual, motion.energy, peaks=peaks)


BENDS = 0.1
"""By what share the sum of a knee's objectives is below those of the front's ends, at least."""

BESIDE = 0.05
"""How far a knee is from each end at least, as a share of the corner."""


def knee_of(points: NDArray[np.float64], corner: ArrayLike) -> int:
    """Return which point has the least sum of its objectives, as shares of a corner.

    The corner is `Front.reference`, which follows from the task alone: where the ends of a front
    lie, and so by which method it was found, does not matter. The sum is least where a step along
    the front costs as large a share of one objective as it saves of the other.

    Parameters
    ----------
    points : ndarray, shape (points, objectives)
        Residuals [m], energies [J] and peaks.
    corner : array_like, shape (objectives,)
        The value of each that counts as 1.
    """
    return int(np.argmin(_shares(points, corner).sum(axis=1)))


def has_knee(points: NDArray[np.float64], corner: ArrayLike) -> bool:
    """Return whether the knee is between the ends of a front, and not chance.

    It is no end: its residual is a twentieth of the corner's at least, and each other objective as
    much above the least of the front. On a front that is nearly straight, which point has the least
    sum is chance: the sum has to be a tenth below those of the ends.
    """
    if len(points) < 3:
        return False
    shares = _shares(points, corner)
    sums = shares.sum(axis=1)
    least = shares.min(axis=0)
    least[0] = 0.0  # of residuals that is rest, wherever the front begins
    is_between = (shares[np.argmin(sums)] - least >= BESIDE).all()
    of_ends = sums[np.argmin(points, axis=0)]
    return bool(is_between and sums.min() <= (1 - BENDS) * of_ends.min())


def _shares(points: NDArray[np.float64], corner: ArrayLike) -> NDArray[np.float64]:
    """Return the objectives of every point as shares of the corner's."""
    return points / np.asarray(corner, dtype=float)
