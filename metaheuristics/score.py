"""Score the points of a front; scores are computed when they are asked for.

An indicator is one class: searches, benches and comparisons use, tabulate and test every one that
is known. Formulas: docs/measures.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import nan
from typing import Any, ClassVar

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.evaluation.population import figures_of_motions
from quietarm.metaheuristics.thinning import MOST_POINTS, thinned
from quietarm.ocp import Front, Mark
from quietarm.ocp.checks import (
    failed_in,
    forgotten_if_refused,
    known,
    object_of,
    quoted,
    ships,
    takes,
)
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.front.interpolated import coefficients_between
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY

Array = NDArray[np.float64]
CORNER = 1.1
"""Hypervolumes are measured from here, where 0 is the reference front's least and 1 its largest
value of each objective: as is usual, a tenth beyond, so that the ends of the front count."""


@dataclass(frozen=True, eq=False)
class Scale:
    """The scale against which points are measured.

    Attributes
    ----------
    ideal, nadir : ndarray, shape (objectives,)
        Residual [m], energy [J] and peaks that are 0 and 1 of the scale.
    stations : ndarray, shape (n, objectives)
        Points of the front to come near to, in this scale.
    whole : float
        The hypervolume that counts as 1: the reference front's.
    """

    ideal: Array
    nadir: Array
    stations: Array
    whole: float

    def scaled(self, points: Array) -> Array:
        """Objectives, shape (n, objectives), from 0 at the ideal to 1 at the nadir."""
        return (points - self.ideal) / (self.nadir - self.ideal)

    def scores(self, points: Array) -> dict[str, float]:
        """Every indicator of points, shape (n, objectives), by its name."""
        return {
            name: self.score(points, indicator) for name, indicator in known_indicators().items()
        }

    def score(self, points: Array, indicator: Indicator) -> float:
        """An indicator of points, shape (n, objectives), in SI units.

        Of those that no other dominates: motions between points may be dominated, which would count
        in a mean over them.
        """
        if not len(points):
            return indicator.of_nothing
        return indicator(moocore.filter_dominated(self.scaled(points)), self)


class Reference(Scale):
    """A reference front as a scale for others.

    Parameters
    ----------
    front : Front
        The reference front; ValueError where it is a single motion, which is no scale.
    """

    front: Front

    @takes(front=Front)
    def __init__(self, front: Front) -> None:
        if len(front.points) < 2:
            raise ValueError(
                "the reference front is a single motion, which is no scale for others; give "
                "another problem"
            )
        points = objectives(front)
        ideal = points.min(axis=0)
        nadir = points.max(axis=0)
        stations = (points - ideal) / (nadir - ideal)
        super().__init__(ideal, nadir, stations, whole_of(stations))
        object.__setattr__(self, "front", front)


class Indicator(ABC):
    """One number for the points of a front. A new one is a class with a `name` and a `value`.

    Every table, report, test and csv of benches and comparisons has a column for it as soon as it
    is defined, in a `--plant-file` or anywhere in Python.

    Raises
    ------
    ValueError
        If the name of a subclass cannot head a column.
    """

    name: ClassVar[str]
    """The column in tables."""
    label: ClassVar[str]
    """The heading; by default the name."""
    unit: ClassVar[str] = ""
    """The unit in headings: empty for a plain number, "%" for a share of 1."""
    more_is_better: ClassVar[bool] = False
    """True for a share that should be 1, False for a distance that should be 0."""
    meaning: ClassVar[str]
    """An explanation for reports; by default the first line of the docstring."""
    form: ClassVar[str] = ".2g"
    """The format of its digits in tables of comparisons."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        name = vars(cls).get("name")
        if name is None:
            return
        with forgotten_if_refused(cls):
            if not isinstance(name, str) or not name.isidentifier():
                raise ValueError(
                    f"name of the indicator {cls.__name__} is {quoted(name)}; give letters, digits "
                    "and _, which head a column"
                )
            if cls.value is Indicator.value:
                raise ValueError(
                    f"indicator {name} measures nothing; define value(self, points, scale)"
                )
        if "label" not in vars(cls):
            cls.label = name.replace("_", " ")
        if "meaning" not in vars(cls):
            first = (cls.__doc__ or cls.label).partition("\n")[0].rstrip(".")
            cls.meaning = first[:1].lower() + first[1:]

    @abstractmethod
    def value(self, points: Array, scale: Scale) -> float:
        """Return its value for the non-dominated points of a front.

        Parameters
        ----------
        points : ndarray, shape (n, objectives)
            The points, scaled from 0 at the ideal to 1 at the nadir.
        scale : Scale
            The scale; its `stations` are the points of the reference front.
        """

    @property
    def of_nothing(self) -> float:
        """Return its value for a front without points."""
        return 0.0 if self.more_is_better else nan

    def __call__(self, points: Array, scale: Scale) -> float:
        """Return its value as a number; ValueError if its code fails."""
        try:
            return float(self.value(points, scale))
        except Exception as error:
            if ships(type(self)):
                raise
            raise failed_in(f"indicator {self.name}", type(self), error) from error


class Hypervolume(Indicator):
    """The volume that points dominate up to the corner, as a share of the reference front's."""

    name = "hypervolume"
    unit = "%"
    more_is_better = True
    meaning = (
        "area that a front dominates, up to a tenth of the reference front's extent beyond its "
        "ends, as a share of the reference front's area"
    )
    form = ".4f"

    def value(self, points: Array, scale: Scale) -> float:
        """The share."""
        return float(moocore.hypervolume(points, ref=[CORNER] * points.shape[1])) / scale.whole


class InvertedDistance(Indicator):
    """Mean distance by which the stations are missed."""

    name = "igd_plus"
    label = "IGD+"
    meaning = "mean distance by which a front is worse than the reference, in units of its extent"

    def value(self, points: Array, scale: Scale) -> float:
        """The mean."""
        return float(moocore.igd_plus(points, ref=scale.stations))


class AdditiveEpsilon(Indicator):
    """The least shift by which the points weakly dominate the stations."""

    name = "epsilon"
    label = "additive epsilon"
    meaning = "least shift by which a front would dominate the reference, in units of its extent"

    def value(self, points: Array, scale: Scale) -> float:
        """The shift."""
        return float(moocore.epsilon_additive(points, ref=scale.stations))


def known_indicators() -> Mapping[str, Indicator]:
    """Return all indicators by name: those of quietarm, then the user's own."""
    return {name: _indicator_of(kind) for name, kind in known(Indicator).items()}


def __getattr__(name: str) -> Any:
    """Name the successor of a name of 2.0."""
    if name == "INDICATORS":
        raise AttributeError(
            "INDICATORS is gone; give known_indicators(), and a new one as a class of Indicator"
        )
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@cache
def _indicator_of(kind: type[Indicator]) -> Indicator:
    """Return the only object of a class."""
    return object_of(kind)


HYPERVOLUME = _indicator_of(Hypervolume)


GAP = "hypervolume gap [%]"
"""The heading of what a front lacks of the reference front's hypervolume: see `gap`."""


def gap(score: float) -> float:
    """Return the hypervolume gap [%] of a score of `HYPERVOLUME`: what the reference has more."""
    return 100 * (1 - score)


def objectives(front: Front) -> Array:
    """Residual [m], energy [J] and peaks of every point, shape (points, objectives)."""
    return front.objective_values


def within(points: Array, residuals: Sequence[float] | Array) -> Array:
    """Return the least energies [J] of points within residuals [m]; NaN if there is none."""
    energies = [points[points[:, 0] <= residual, 1] for residual in residuals]
    return np.array([some.min() if some.size else np.nan for some in energies])


def share_of_box(points: Array, corner: tuple[float, ...]) -> float:
    """Share of the hypervolume from zero to a corner, of all objectives, that points dominate.

    A user's own function may have objectives below zero: it begins at the least of these.
    """
    if not len(points):
        return 0.0
    origin = np.minimum(points.min(axis=0), 0.0)
    extent = np.array(corner) - origin
    if not (extent > 0).all():
        return 0.0
    return float(moocore.hypervolume((points - origin) / extent, ref=[1.0] * len(corner)))


def shares_of_box(front: Front) -> Array:
    """Share of the hypervolume up to `Front.reference` that was dominated at every mark of a front.

    Of a search by all candidates that had entered. An earlier file has it as it states it.
    """
    return np.array([_share_at(front, mark) for mark in front.history])


def final_share_of_box(front: Front) -> float:
    """The last of these; 0 of a front without a mark."""
    return _share_at(front, front.history[-1]) if front.history else 0.0


def _share_at(front: Front, mark: Mark) -> float:
    if mark.hypervolume is not None:
        return mark.hypervolume
    return share_of_box(_dominating(front, mark), front.reference)


def _dominating(front: Front, mark: Mark, most: int | None = None) -> Array:
    """Return the points that were found until a mark; for the gradient, the front itself.

    At most so many points. What dominates is what the search believed; its true values are given.
    """
    if mark.gradients or not len(front.entries):
        points = objectives(front)
        return points if most is None else points[thinned(points, most)]
    beliefs = front.entries.beliefs(mark.evaluations)
    rows = np.flatnonzero(moocore.is_nondominated(beliefs))
    if most is not None or len(front.objectives) > len(RESIDUAL_AND_ENERGY):
        rows = rows[thinned(beliefs[rows], most or MOST_POINTS)]
    return front.entries.objectives(mark.evaluations)[rows]


def scores_on_the_way(front: Front, scale: Scale, indicator: Indicator = HYPERVOLUME) -> Array:
    """An indicator at every mark of a front: of at most 100 points, as a front would then have.

    The last is of the front itself. An earlier file has the others as it states them; NaN where it
    does not.
    """
    before = [
        _score_at(
            front,
            mark,
            scale,
            indicator,
        )
        for mark in front.history[:-1]
    ]
    return np.array([*before, scale.score(objectives(front), indicator)])


def _score_at(front: Front, mark: Mark, scale: Scale, indicator: Indicator) -> float:
    if mark.quality is not None:
        return getattr(mark.quality, indicator.name, nan)
    if mark.hypervolume is not None:  # an earlier file, where there was no point yet
        return indicator.of_nothing
    return scale.score(_dominating(front, mark, MOST_POINTS), indicator)


def filled(front: Front) -> Array:
    """Points of a front and of motions between neighbours, shape (n, objectives).

    Coefficients are interpolated and the motions simulated: each can be driven, and stays in the
    box. Those that break a limit do not count. So a front is not judged by its number of points.
    Of two objectives neighbours are those along the front, of more the nearest.
    """
    # share by which a motion between may exceed a limit, as those of a reference front
    overrun = 1e-6
    points = objectives(front)
    if len(points) < 2 or isinstance(front, FunctionFront):  # what lies between would cost calls
        return points
    inner = coefficients_between(front)
    if not len(inner):
        return points
    table, violations = figures_of_motions(front, inner)
    usable = np.isfinite(table).all(axis=1) & (violations <= overrun).all(axis=1)
    return np.vstack([points, table[usable]])


def whole_of(stations: Array) -> float:
    """Return the volume that a reference front dominates up to the corner, of its scaled points.

    Of two objectives they are samples of a line, and the area is that above it.
    """
    if stations.shape[1] > len(RESIDUAL_AND_ENERGY):
        return float(moocore.hypervolume(stations, ref=[CORNER] * stations.shape[1]))
    return _hypervolume_of_line(stations)


def _hypervolume_of_line(stations: Array) -> float:
    """Return the area that the straight lines through points dominate, up to the corner."""
    residuals, energies = stations.T
    # the last point is the cheapest there is
    residuals = np.append(residuals, CORNER)
    energies = np.append(energies, energies[-1])
    above = CORNER - (energies[1:] + energies[:-1]) / 2
    return float(np.sum(above * np.diff(residuals)))
