"""Fronts of one task compared: how far each is from the best of all."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import NamedTuple

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.run_files import BESIDE_SETTINGS
from quietarm.metaheuristics.score import CORNER, Scale, filled, objectives, whole_of, within
from quietarm.metaheuristics.spread import Spread
from quietarm.ocp import Front, PointToPoint, task_difference
from quietarm.ocp.checks import quoted, takes
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.saved import plain
from quietarm.ocp.solvers.choice import STAND_IN, without_part
from quietarm.studies.compare.staircase import best_of, evenly_spaced
from quietarm.views.report.method_rows import is_gradient, label_of
from quietarm.views.report.words import objective_words

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ScoredFront:
    """One front and its figures in a comparison.

    Energies [J] are the least within each level. A front of few points would lose by its steps, so
    the `scores`, indicators by name, are those of the front filled with motions `between` its
    points; `scores_found` are those of its points alone.
    """

    name: str
    front: Front
    between: Array
    scores: Mapping[str, float]
    scores_found: Mapping[str, float]
    energies: tuple[float, ...]
    gaps: tuple[float, ...]
    gaps_between: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class RunsOfMethod:
    """The runs of one method with one set of settings, one for each seed.

    `best`, `median` and `worst` are attainment surfaces: what one, half, and all of them reach.
    """

    label: str
    runs: tuple[ScoredFront, ...]
    best: Array
    median: Array
    worst: Array

    @property
    def by_gradient(self) -> bool:
        """Return whether the gradient found the runs, so that the points lie on a line."""
        return is_gradient(self.runs[0].front.record.method)

    @property
    def band(self) -> tuple[Array, Array, Array]:
        """Residuals at which the best or the worst of the runs steps, and their energies there."""
        stairs = np.unique([*self.best[:, 0], *self.worst[:, 0]])
        return stairs, within(self.best, stairs), within(self.worst, stairs)

    def spread(self, figure: str, entry: int | str | None = None) -> Spread:
        """Quartiles over the runs of a figure of `ScoredFront`, as `front.record.seconds`.

        Of `energies` and the like the entry of a level, of `scores` that of an indicator.
        """
        figures = [attrgetter(figure)(run) for run in self.runs]
        values = figures if entry is None else [several[entry] for several in figures]
        return Spread.of([float(value) for value in values])


@dataclass(frozen=True, eq=False)
class Comparison:
    """Fronts of one task, all measured in the same way.

    Attributes
    ----------
    task : PointToPoint
        The move.
    groups : tuple of RunsOfMethod
        Methods, in the order in which they were given.
    reference : str
        What IGD+ and additive epsilon are measured against.
    objectives : tuple of str
        Names of the objectives of all fronts. Indicators are of all of them; attainment surfaces,
        the best front and energies within a residual are of residual and energy, whatever the
        peaks are.
    corner : tuple of float
        Residual [m], energy [J] and peaks up to which hypervolumes are measured, as in a bench: a
        tenth of its extent beyond the ends of the reference front. They are shares of that front's.
    extent : tuple of float
        The same between the ends of the reference front: the units of IGD+ and additive epsilon, so
        that all objectives have the same weight.
    levels : tuple of float
        Residuals [m] at which energies are compared.
    best_front : ndarray, shape (n, 2), read-only
        What no filled front dominates: residuals [m], rising, and energies [J].
    best : tuple of float
        Its least energy [J] within each level; NaN where it has none.
    fill : bool
        Whether motions between the points of a front count.
    floor : float or None
        Energy [J] of the best free motion at rest on arrival of the nominal plant, where known.
    """

    task: PointToPoint
    groups: tuple[RunsOfMethod, ...]
    reference: str
    objectives: tuple[str, ...]
    corner: tuple[float, ...]
    extent: tuple[float, ...]
    levels: tuple[float, ...]
    best_front: Array
    best: tuple[float, ...]
    fill: bool
    floor: float | None = None

    @property
    def runs(self) -> tuple[ScoredFront, ...]:
        """The runs of all groups."""
        return tuple(run for group in self.groups for run in group.runs)

    def above_best(self, points: Array) -> Array:
        """Return the share of energy of points above the best front's within their residuals."""
        return points[:, 1] / within(self.best_front, points[:, 0]) - 1


@takes(fronts=[Front], reference=Front)
def compare_fronts(
    fronts: Sequence[Front],
    names: Sequence[str] = (),
    *,
    reference: Front | None = None,
    reference_name: str = "the reference front",
    levels: Sequence[float] = LEVELS,
    fill: bool = True,
) -> Comparison:
    """Measure fronts of one task against each other.

    The indicators are moocore's. IGD+ and additive epsilon are measured against the reference
    front, or the points that none of any front dominates, thinned to even distances, so that the
    front of most points does not decide.

    Parameters
    ----------
    fronts : sequence of Front
        One or more, of one task; those of one method with the same settings are runs of it.
    names : sequence of str, optional
        What each is called.
    reference, reference_name : Front and str, optional
        What to measure against.
    levels : sequence of float
        Residuals [m] at which energies are compared.
    fill : bool
        Whether motions between the points of a front count.

    Returns
    -------
    Comparison
        Every front with its measures.

    Raises
    ------
    ValueError
        When there is no front, one has no point, is given twice, or is of another task or other
        objectives.
    """
    names = names or [f"front {i}" for i in range(1, len(fronts) + 1)]
    if not fronts or len(names) != len(fronts):
        raise ValueError(f"{len(fronts)} fronts have {len(names)} names; give each front a name")
    references = [] if reference is None else [reference]
    all_names = [*names, reference_name]
    _refuse(
        [*fronts, *references],
        all_names[: len(fronts) + len(references)],
        len(fronts),
    )
    points = [objectives(front) for front in fronts]
    between = [best_of([filled(front)]) for front in fronts] if fill else points
    best_front = best_of([_curve(cloud) for cloud in between])
    known = best_of(between) if reference is None else best_of([filled(reference)])
    smallest_extent = np.max([front.reference for front in fronts], axis=0)
    is_line = reference is not None
    scale = _scale_of(known, smallest_extent, is_line=is_line)
    corner = scale.ideal + CORNER * (scale.nadir - scale.ideal)
    extent = scale.nadir - scale.ideal
    best = within(best_front, levels)
    clouds = map(_Cloud, names, fronts, points, between)
    measured = [_measured(cloud, scale, levels, best) for cloud in clouds]
    groups = [
        RunsOfMethod(
            label,
            tuple(measured[i] for i in members),
            *_surfaces([_curve(points[i]) for i in members]),
        )
        for label, members in grouped(fronts).items()
    ]
    return Comparison(
        task=fronts[0].task,
        groups=tuple(groups),
        reference="the best of all fronts" if reference is None else reference_name,
        objectives=fronts[0].objectives,
        corner=tuple(corner.tolist()),
        extent=tuple(extent.tolist()),
        levels=tuple(levels),
        best_front=_frozen(best_front),
        best=tuple(best.tolist()),
        fill=fill,
    )


def _curve(points: Array) -> Array:
    """Residuals and energies of points, whatever their peaks."""
    return points[:, : len(RESIDUAL_AND_ENERGY)]


def _scale_of(known: Array, single: Array, *, is_line: bool) -> Scale:
    """Return the scale of a front's points; `single` is the extent of an objective of one value.

    The hypervolume that counts as 1 is that of the points, or of the line that they are samples of.
    """
    ideal = known.min(axis=0)
    extent = np.ptp(known, axis=0)
    extent = np.where(extent > 0, extent, single)
    scaled = (known - ideal) / extent
    corner = [CORNER] * known.shape[1]
    whole = whole_of(scaled) if is_line else float(moocore.hypervolume(scaled, ref=corner))
    return Scale(ideal, ideal + extent, evenly_spaced(scaled), whole)


class _Cloud(NamedTuple):
    """A front, its points, and these with motions between them where such count."""

    name: str
    front: Front
    points: Array
    between: Array


def _measured(cloud: _Cloud, scale: Scale, levels: Sequence[float], best: Array) -> ScoredFront:
    """A front with its figures."""
    energies = within(cloud.points, levels)
    energies_between = within(cloud.between, levels)
    return ScoredFront(
        name=cloud.name,
        front=cloud.front,
        between=best_of([_curve(cloud.between)]),
        scores=scale.scores(cloud.between),
        scores_found=scale.scores(cloud.points),
        energies=tuple(energies.tolist()),
        gaps=tuple((energies / best - 1).tolist()),
        gaps_between=tuple((energies_between / best - 1).tolist()),
    )


def _surfaces(clouds: Sequence[Array]) -> tuple[Array, Array, Array]:
    points = np.vstack(clouds)
    sets = np.repeat(np.arange(len(clouds)), [len(c) for c in clouds])
    table = moocore.eaf(points, sets, percentiles=[0, 50, 100])
    best, median, worst = (_frozen(table[table[:, 2] == share, :2]) for share in (0, 50, 100))
    return best, median, worst


def _frozen(values: object) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


def _refuse(fronts: Sequence[Front], names: Sequence[str], apart: int) -> None:
    """Refuse fronts without points or of several tasks; of the first ones, also what is twice."""
    for i, (front, name) in enumerate(zip(fronts, names)):
        if not front.points:
            raise ValueError(f"{name} has no finite point; leave it out, or search longer")
        if isinstance(front, FunctionFront) or isinstance(fronts[0], FunctionFront):
            _refuse_other_function(front, fronts[0], name, names[0])
            difference = ""
        else:
            difference = task_difference(front.task, fronts[0].task)
        if difference:
            task = fronts[0].task
            remedy = "compare fronts of one task"
            if differ_in_window_alone(front.task, task):
                remedy = f"find it again with --residual-window {task.residual_window:.10g}s"
            raise ValueError(
                f"{name} is of another task than {names[0]}: its {difference}; {remedy}"
            )
        if front.objectives != fronts[0].objectives:
            raise ValueError(
                f"{name} has the objectives {objective_words(front.objectives)}, and {names[0]} "
                f"{objective_words(fronts[0].objectives)}; compare fronts of the same objectives"
            )
        if i < apart and front in fronts[:i]:
            first = names[list(fronts).index(front)]
            twin = "given twice" if name == first else f"the same front as {first}"
            raise ValueError(f"{name} is {twin}; give every front once")


def _refuse_other_function(front: Front, first: Front, name: str, first_name: str) -> None:
    """Refuse a front of another function, or of a move beside one of a function."""
    if type(front) is not type(first):
        raise ValueError(
            f"{name} and {first_name} are a front of a function and one of a move; compare those "
            "of one kind"
        )
    for entry in ("lower", "upper", "units", "constraints"):
        own, others = getattr(front.task, entry), getattr(first.task, entry)
        if own != others:
            raise ValueError(
                f"{name} is of another function than {first_name}: its {entry} are "
                f"{quoted(own)}, not {quoted(others)}; compare fronts of one function"
            )


def differ_in_window_alone(task: PointToPoint, other_task: PointToPoint) -> bool:
    """Return whether two tasks differ in the residual window, and in nothing else."""
    alike = replace(task, residual_window=other_task.residual_window)
    return bool(task_difference(task, other_task)) and not task_difference(alike, other_task)


def grouped(fronts: Sequence[Front]) -> dict[str, list[int]]:
    """Return which fronts are runs of one method with one set of settings, by its label."""
    groups: dict[str, list[int]] = {}
    for i, front in enumerate(fronts):
        stated = {name: value for name, value in _settings(front).items() if value is not None}
        key = json.dumps([front.record.method, stated], sort_keys=True)
        groups.setdefault(key, []).append(i)
    firsts = [fronts[members[0]] for members in groups.values()]
    return {
        _label(
            front, [rival for rival in firsts if rival.record.method == front.record.method]
        ): members
        for front, members in zip(firsts, groups.values())
    }


def _settings(front: Front) -> dict[str, object]:
    if isinstance(front, FunctionFront):
        return {name: value for name, value in front.record.settings.items()
                if name not in BESIDE_SETTINGS}  # fmt: skip
    profile = plain(front.profile)
    settings = {"bound": front.record.bound, **front.record.settings}
    for name in BESIDE_SETTINGS:  # of a bench's run, and no setting of its method
        settings.pop(name, None)
    settings = without_part(STAND_IN, settings)  # which depends on the seed
    return {**settings, "profile": profile.pop("name"), **profile}


def _label(front: Front, alike: Sequence[Front]) -> str:
    """The method, with the settings in which it differs from others of the same method."""
    words = [label_of(front.record.method)]
    known = [_settings(rival) for rival in alike]
    for name, value in _settings(front).items():
        if all(settings.get(name) == value for settings in known):
            continue
        shown = str(value).removesuffix(".0")  # every digit: two groups never share a label
        words.append(f"no {name}" if value is None else f"{name} {shown}")
    return ", ".join(words)
