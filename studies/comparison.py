"""Fronts of one task held against each other: by how much each misses what the best found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import moocore
import numpy as np
from numpy.typing import NDArray

from metaheuristics.ensemble import Spread
from ocp import Front, PointToPoint
from studies.comparison_groups import check_fronts, grouped

LEVELS = (1e-4, 1e-3, 5e-3)
"""Residuals [m] at which energies are compared."""
_STATIONS = 101
_MARGIN = 1.1

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measured:
    """One front and its figures in a comparison.

    A front is read as a staircase: within a residual only motions count that were found with that
    residual or less. A front of few points loses by its steps alone; `steps` says how much.

    Attributes
    ----------
    name : str
        Name of its file, or of the run.
    front : Front
        The front.
    hypervolume : float
        Share of the box from the origin to `Comparison.corner` that it dominates.
    igd_plus : float
        Mean distance by which it misses the reference front, in `Comparison.extent`.
    epsilon : float
        Least shift in both objectives after which nothing of the reference front is better, in
        `Comparison.extent`.
    energies : tuple of float
        Least energy [J] within each of `Comparison.levels`; NaN where it has no such motion.
    gaps : tuple of float
        How far these are above the best of all fronts there, as a share of it.
    steps : tuple of float
        How much of a gap a denser sampling of the same front could at most take away: the fall of
        energy to its next point, as a share of the best.
    """

    name: str
    front: Front
    hypervolume: float
    igd_plus: float
    epsilon: float
    energies: tuple[float, ...]
    gaps: tuple[float, ...]
    steps: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Group:
    """The runs of one method with one set of settings, a seed each.

    Attributes
    ----------
    label : str
        The method, with its settings where another group has the same method.
    runs : tuple of Measured
        Its fronts.
    best, median, worst : ndarray, shape (points, 2), read-only
        Attainment surfaces, residual [m] and energy [J]: what at least one run, half of the runs
        and every run attained. Alike for a single run.
    """

    label: str
    runs: tuple[Measured, ...]
    best: Array
    median: Array
    worst: Array

    def spread(self, figure: str, level: int | None = None) -> Spread:
        """Quartiles over the runs of a figure of `Measured`, or of its front, by name."""
        values: list[float] = []
        for run in self.runs:
            value = getattr(run if hasattr(run, figure) else run.front, figure)
            values.append(float(value if level is None else value[level]))
        return Spread.of(values)

    def reached(self, level: int) -> int:
        """How many runs have a motion within this one of the residual levels."""
        return sum(bool(np.isfinite(run.energies[level])) for run in self.runs)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Fronts of one task, measured alike.

    Attributes
    ----------
    task : PointToPoint
        The move.
    groups : tuple of Group
        Methods, in the order in which they were given.
    reference : str
        What IGD+ and epsilon are measured against.
    corner : tuple of float
        Residual [m] and energy [J] that hypervolumes are measured from: the largest reference of
        the fronts, or a tenth beyond the best front's ends where these lie farther out.
    extent : tuple of float
        Residual [m] and energy [J] between the ends of the reference front: the units of IGD+ and
        epsilon, so that both objectives weigh alike.
    levels : tuple of float
        Residuals [m] at which energies are compared.
    best : tuple of float
        Least energy [J] of all fronts within each level; NaN where none reaches it.
    coverage : ndarray, shape (groups, groups), read-only
        Share of the column's points that the row dominates or equals (the C-metric); the median
        over the pairs of runs.
    floor : float or None
        Least energy [J] of any joint motion at rest on arrival, where it is known.
    """

    task: PointToPoint
    groups: tuple[Group, ...]
    reference: str
    corner: tuple[float, float]
    extent: tuple[float, float]
    levels: tuple[float, ...]
    best: tuple[float, ...]
    coverage: Array
    floor: float | None = None

    @property
    def runs(self) -> tuple[Measured, ...]:
        """The runs of all groups."""
        return tuple(run for group in self.groups for run in group.runs)

    def group(self, label: str) -> Group:
        """The group of this label; KeyError where there is none."""
        for group in self.groups:
            if group.label == label:
                return group
        raise KeyError(label)


def compare(
    fronts: Sequence[Front],
    names: Sequence[str] = (),
    *,
    reference: Front | None = None,
    reference_name: str = "the reference front",
    floor: float | None = None,
    levels: Sequence[float] = LEVELS,
) -> Comparison:
    """Measure fronts of one task against each other.

    Indicators are moocore's; the front that IGD+ and epsilon are measured against is what no point
    of any front beats, thinned to even distances, so that the front of most points does not decide.

    Parameters
    ----------
    fronts : sequence of Front
        Two or more, of one task, by any methods.
    names : sequence of str, optional
        What to call them in messages and tables; numbered by default.
    reference : Front, optional
        Measure IGD+ and epsilon against this front.
    reference_name : str
        What to call it.
    floor : float, optional
        Least energy [J] of any joint motion at rest on arrival.
    levels : sequence of float
        Residuals [m] at which energies are compared.

    Returns
    -------
    Comparison
        The figures of every front, grouped by method.

    Raises
    ------
    ValueError
        When there are fewer than two fronts, one is empty, one stands twice, or their tasks differ.
    """
    names = list(names) or [f"front {i}" for i in range(1, len(fronts) + 1)]
    check_fronts(fronts, names)
    if reference is not None:
        check_fronts([fronts[0], reference], [names[0], reference_name], twice=True)
    clouds = [objectives(front) for front in fronts]
    best_front = moocore.filter_dominated(np.vstack(clouds))
    known = best_front if reference is None else objectives(reference)
    corner = np.max([*(front.reference for front in fronts), _MARGIN * best_front.max(0)], axis=0)
    extent = np.where(np.ptp(known, axis=0) > 0, np.ptp(known, axis=0), corner)
    stations = evenly_spaced(known / extent)
    table = np.array([within(cloud, levels) for cloud in clouds])
    best = np.array([column[np.isfinite(column)].min(initial=np.inf) for column in table.T])
    best[np.isinf(best)] = np.nan

    def measured(i: int) -> Measured:
        scaled = clouds[i] / extent
        return Measured(
            name=names[i],
            front=fronts[i],
            hypervolume=float(moocore.hypervolume(clouds[i] / corner, ref=[1.0, 1.0])),
            igd_plus=float(moocore.igd_plus(scaled, ref=stations)),
            epsilon=float(moocore.epsilon_additive(scaled, ref=stations)),
            energies=_floats(table[i]),
            gaps=_floats(table[i] / best - 1),
            steps=_floats(_steps(clouds[i], levels) / best),
        )

    groups = tuple(
        Group(label, tuple(measured(i) for i in members), *_surfaces([clouds[i] for i in members]))
        for label, members in grouped(fronts).items()
    )
    return Comparison(
        task=fronts[0].task,
        groups=groups,
        reference="the best of all fronts" if reference is None else reference_name,
        corner=(float(corner[0]), float(corner[1])),
        extent=(float(extent[0]), float(extent[1])),
        levels=tuple(levels),
        best=_floats(best),
        coverage=_frozen([[_coverage(one, other) for other in groups] for one in groups]),
        floor=floor,
    )


def objectives(front: Front) -> Array:
    """Residual [m] and energy [J] of every point, shape (points, 2)."""
    return np.column_stack([front.residuals, front.energies])


def within(front: Array, residuals: Sequence[float] | Array, missing: float = np.nan) -> Array:
    """Least energies [J] on a staircase within residuals.

    Parameters
    ----------
    front : ndarray, shape (points, 2)
        Residuals [m], rising, and energies [J], falling.
    residuals : array_like, shape (n,)
        Residuals [m].
    missing : float
        What stands for the energy within a residual that no point has.

    Returns
    -------
    ndarray, shape (n,)
        Energies [J].
    """
    count = np.searchsorted(front[:, 0], residuals, side="right")
    return np.where(count > 0, front[np.maximum(count - 1, 0), 1], missing)


def _steps(front: Array, residuals: Sequence[float]) -> Array:
    """How much energy falls from the motion within each residual to the next one beyond it [J]."""
    count = np.searchsorted(front[:, 0], residuals, side="right")
    beyond = front[np.minimum(count, len(front) - 1), 1]
    return within(front, residuals) - beyond


def evenly_spaced(points: Array, stations: int = _STATIONS) -> Array:
    """The points of a front nearest to stations at even distances along it, shape (few, 2)."""
    ordered = points[np.argsort(points[:, 0])]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ordered, axis=0).T))])
    wanted = np.linspace(0.0, along[-1], stations)
    return ordered[np.unique(np.abs(along - wanted[:, None]).argmin(axis=1))]


def _surfaces(clouds: Sequence[Array]) -> tuple[Array, Array, Array]:
    points, sets = np.vstack(clouds), np.repeat(np.arange(len(clouds)), [len(c) for c in clouds])
    table = moocore.eaf(points, sets, percentiles=[0, 50, 100])
    best, median, worst = (_frozen(table[table[:, 2] == share, :2]) for share in (0, 50, 100))
    return best, median, worst


def _coverage(one: Group, other: Group) -> float:
    """Median over the pairs of runs of the share of `other` that `one` dominates or equals."""
    if one is other:
        return np.nan
    shares: list[float] = []
    for a, b in product(one.runs, other.runs):
        mine = within(objectives(a.front), b.front.residuals, np.inf)
        shares.append(float(np.mean(mine <= b.front.energies)))
    return float(np.median(shares))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _frozen(values: object) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
