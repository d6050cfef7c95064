"""Front: the trade-off between residual, energy and peaks, by whatever method it was found."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.ocp.checks import (
    IF_STATED,
    Count,
    NotNegative,
    Positive,
    not_negative,
    table_of,
    takes,
    whole,
)
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.files import write_whole
from quietarm.ocp.front.points import (
    Entries,
    FailedPoint,
    FrontPoint,
    Mark,
    evaluated,
    has_knee,
    knee_of,
    non_dominated,
)
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import FRONT
from quietarm.ocp.objectives import (
    RESIDUAL_AND_ENERGY,
    Objective,
    checked_objectives,
    objectives_on,
    peak_quantities,
)
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Record, Setting
from quietarm.ocp.rest import is_at_rest
from quietarm.ocp.saved import Answer, to_html
from quietarm.ocp.task import PointToPoint

if TYPE_CHECKING:
    import pandas

LEAST_REFERENCE = 1e-3
"""Where the plain cycloid arrives nearly still, its residual is no scale for hypervolumes [m]."""


@dataclass(frozen=True)
class Front(Answer):
    """Non-dominated points in the plane of residual and energy, or in the space of more objectives.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    points : tuple of FrontPoint
        Sorted by increasing residual; of two objectives energies fall along the front.
    record : Record
        Method, settings, candidates and iterations, versions, time.
    reference : tuple of float
        Residual [m], energy [J] and peaks of the corner that hypervolumes are measured from.
    failed : int
        Candidates whose values were not finite, or absurdly large; they never enter a front.
    infeasible : int
        Candidates that violated a limit of the task; not in the front either.
    failures : tuple of FailedPoint
        Points that could not be found, with the reason.
    gaps : tuple of (float, float)
        Ranges of the residual [m] in which a weighted sum has no point for any weight.
    history : tuple of Mark
        Its effort during the run, the end last.
    entries : Entries
        Of a search, every candidate that no earlier one dominated.
    objectives : tuple of str
        Names of the objectives, as of `quietarm list`: residual and energy first.

    Raises
    ------
    ValueError
        When an entry is not of its kind, a point has other than the profile's number of
        coefficients or is not finite, or the points are out of order, or one is dominated.
    """

    example: ClassVar[str] = "a front, such as Front.load('front.json')"
    kind: ClassVar[str] = "front"
    version: ClassVar[int] = 5
    read_by_2_0 = (4,)

    task: PointToPoint
    profile: JointProfile
    points: tuple[FrontPoint, ...]
    record: Record
    reference: tuple[Positive, ...]
    failed: Count = 0
    infeasible: Count = 0
    failures: tuple[FailedPoint, ...] = ()
    gaps: tuple[tuple[NotNegative, NotNegative], ...] = ()
    history: tuple[Mark, ...] = ()
    entries: Entries = field(default_factory=Entries, metadata=IF_STATED)
    objectives: tuple[str, ...] = field(default=RESIDUAL_AND_ENERGY, metadata=IF_STATED)

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple(self.points))
        object.__setattr__(self, "objectives", checked_objectives(self.objectives))
        if len(self.reference) != len(self.objectives):
            raise ValueError(
                f"its reference has {len(self.reference)} figures; give one for each of its "
                f"{len(self.objectives)} objectives"
            )
        quantities = peak_quantities(self.objectives)
        if len(self.entries) and tuple(self.entries.peaks) != quantities:
            raise ValueError("the peaks of its entries are not those of its objectives")
        for i, point in enumerate(self.points, start=1):
            self.profile.checked(point.coefficients)
            not_negative(f"residual of point {i}", point.residual, self.task.plant.tip_unit)
            not_negative(f"energy of point {i}", point.energy, "J")
            if set(point.peaks) != set(quantities):
                raise ValueError(
                    f"the peaks of point {i} are {', '.join(point.peaks) or 'none'}, and the "
                    f"front's objectives have {', '.join(quantities) or 'none'}"
                )
        if self.points != non_dominated(self.points, self.objectives):
            raise ValueError(
                "its points are out of order, or one is dominated; order them by "
                "residual and drop dominated ones, as non_dominated(points) does"
            )

    @classmethod
    def _class_of(cls, content: Mapping[str, Any]) -> type[Any]:
        """The class of a file's content: a front of a function has that in place of a task."""
        if "function" not in content:
            return cls
        # by its name: that file needs this one
        return import_module("quietarm.ocp.front.function_front").FunctionFront

    @property
    def tip_unit(self) -> str:
        """Unit of the residuals."""
        return self.task.plant.tip_unit

    @property
    def residuals(self) -> NDArray[np.float64]:
        """Residual of every point [m]."""
        return np.array([point.residual for point in self.points])

    @property
    def energies(self) -> NDArray[np.float64]:
        """Energy of every point [J]."""
        return np.array([point.energy for point in self.points])

    @property
    def objective_values(self) -> NDArray[np.float64]:
        """Every objective of every point, shape (points, objectives), in SI units."""
        quantities = peak_quantities(self.objectives)
        rows = [point.values(quantities) for point in self.points]
        return np.array(rows, dtype=float).reshape(len(rows), len(self.objectives))

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """``residual_m`` (or ``_rad``), ``energy_J``, ``a_1``, ``a_2``, ... of all points, by name.

        Peaks that are objectives, as ``peak_torque_Nm``, stand after the energy, and so do figures
        of one's own.

        The last, ``residual_window_s``, is the task's residual window, the same for all.
        """
        named = {f"a_{i + 1}": column for i, column in enumerate(self.coefficients.T)}
        window = {"residual_window_s": np.full(len(self.points), self.task.residual_window)}
        objectives = objectives_on(self.task.plant, self.objectives)
        values = {
            objective.column: column
            for objective, column in zip(objectives, self.objective_values.T)
        }
        more = {
            figure.column_on(self.task.plant): self.figure_values(figure)
            for figure in further_figures(FRONT, self.task)
        }
        return {**values, **more, **named, **window}

    def judged(self, point: FrontPoint) -> JudgedMotion:
        """Return the motion of a point, for CVODES."""
        return JudgedMotion.of_profile(self.task, self.profile, point.coefficients)

    def figure_values(self, figure: Figure) -> NDArray[np.float64]:
        """Return a figure of every point, by CVODES; NaN where a motion does not have it."""
        motions = map(self.judged, self.points)
        return np.array([motion.figures.get(figure.name, np.nan) for motion in motions])

    def figures_within(self, residual: float, place: str) -> dict[str, float]:
        """Return further figures of the point of least energy within a residual [m], by columns.

        NaN where the front has no such point, or its motion no such figure.
        """
        further = further_figures(place, self.task)
        point = self.cheapest_within(residual) if further else None
        figures = {} if point is None else self.judged(point).figures
        plant = self.task.plant
        return {figure.column_on(plant): figures.get(figure.name, np.nan) for figure in further}

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        plant = self.task.plant
        unit = plant.tip_unit
        added = further_figures(FRONT, self.task)
        values = [self.figure_values(figure) for figure in added]
        head = (
            f"residual within {self.task.residual_window:.4g} s [{unit}]",
            "energy [J]",
            *(f"{objective.label} [{objective.unit}]" for objective in self._peaks),
            *(f"{figure.label_on(plant)} [{figure.unit_on(plant) or '-'}]" for figure in added),
            f"shadow price [J/{unit}]",
            "coefficients",
        )
        rows = [
            (
                "0" if is_at_rest(point.residual, self.task) else f"{point.residual:.3g}",
                f"{point.energy:.5g}",
                *(f"{point.peaks[objective.quantity]:.4g}" for objective in self._peaks),
                *(f"{column[i]:.{figure.digits}g}" for figure, column in zip(added, values)),
                f"{point.shadow_prices.get('residual', 0.0):.3g}" if point.shadow_prices else "-",
                ", ".join(f"{a:.4g}" for a in point.coefficients),
            )
            for i, point in enumerate(self.points)
        ]
        return to_html(rows, head)

    @property
    def _peaks(self) -> list[Objective]:
        """The objectives beside residual and energy."""
        objectives = objectives_on(self.task.plant, self.objectives)
        return [objective for objective in objectives if objective.quantity]

    def to_frame(self) -> pandas.DataFrame:
        """The points as a data frame of pandas by increasing residual, with the `columns`."""
        import pandas as pd  # not at the top: it takes half a second to load

        return pd.DataFrame(self.columns())

    @interruptible
    def save_csv(self, path: str | Path) -> None:
        """Write the `columns` as a table, by increasing residual, with every digit.

        ValueError when the file cannot be written.
        """
        write_whole(path, csv_table(self.columns()))

    @classmethod
    @takes(task=PointToPoint, profile=JointProfile)
    def from_coefficients(
        cls,
        task: PointToPoint,
        coefficients: ArrayLike,
        *,
        method: str,
        profile: JointProfile | None = None,
        bound: float | None = None,
        settings: Mapping[str, Setting] | None = None,
        seed: int | None = None,
        evaluations: int | None = None,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
    ) -> Self:
        """The front of motions that another program found.

        Each motion is evaluated by CVODES; dominated motions, and those that violate a limit of the
        task, are dropped.

        Parameters
        ----------
        task, method, bound, settings, seed
            As of a front and its record; the bound must be kept.
        coefficients : array_like, shape (motions, profile.size)
            The profile's coefficients, one row for each motion.
        profile : JointProfile, optional
            How the joint moves; by default a `CycloidPolynomial` of as many terms.
        evaluations : int, optional
            Candidates that it took to find them; as many as there are motions by default.
        objectives : sequence of str
            What dominates: residual, energy, and peaks beside them.

        Returns
        -------
        Front
            Its `failed` are those at which CVODES fails, `infeasible` those that violate a limit.

        Raises
        ------
        ValueError
            When the array is no table of finite numbers, or does not fit the profile or the bound.
        """
        began = time.perf_counter()
        table = table_of(coefficients)
        profile = CycloidPolynomial(table.shape[1]) if profile is None else profile
        if evaluations is not None:
            evaluations = whole("evaluations", evaluations, len(table))
        names = checked_objectives(objectives)
        motions = evaluated(task, profile, table, bound, objectives=names)
        record = Record(
            method,
            settings or {},
            bound,
            seed,
            evaluations=len(table) if evaluations is None else evaluations,
            seconds=time.perf_counter() - began,
        )
        return cls(
            task=task,
            profile=profile,
            points=motions.points,
            record=record,
            reference=reference_corner(task, names),
            failed=motions.failed,
            infeasible=motions.infeasible,
            objectives=names,
        )

    def __repr__(self) -> str:
        """Return its method and sizes: all of its points would fill pages."""
        count = self.record.evaluations
        candidates = f" of {count} candidates" if count else ""  # the gradient has none
        name = type(self).__name__
        return f"<{name} by {self.record.method}: {len(self.points)} points{candidates}>"

    def restated(self, **changes: Any) -> Front:
        """Return this front with other entries of its record."""
        return replace(self, record=replace(self.record, **changes))

    def smallest_residual(self) -> FrontPoint:
        """The point of smallest residual; ValueError when the front is empty."""
        return self._nonempty()[0]

    def cheapest(self, residual_limit: float | None = None) -> FrontPoint:
        """The point of least energy, of those within a residual limit [m] where one is given.

        ValueError when there is none, with the least residual there is.
        """
        points = self._nonempty()
        unit = self.tip_unit
        if residual_limit is None:
            return min(reversed(points), key=_energy)
        if not residual_limit >= 0:  # nor NaN; all of them are below infinity
            raise ValueError(f"residual limit is {residual_limit:g} {unit}; give 0 or more")
        cheapest = self.cheapest_within(residual_limit)
        if cheapest is None:
            raise ValueError(
                f"no point of the front has a residual of {residual_limit:g} {unit} or less; give "
                f"at least the smallest residual, {points[0].residual:.3g} {unit}"
            )
        return cheapest

    def cheapest_within(self, residual: float) -> FrontPoint | None:
        """Return the point of least energy within a residual [m]; None where there is none."""
        within = [point for point in self.points if point.residual <= residual]
        return min(reversed(within), key=_energy, default=None)

    def least_energy(self, residual: float) -> float:
        """Least energy [J] of the points within a residual [m]; NaN where there is none."""
        cheapest = self.cheapest_within(residual)
        return float("nan") if cheapest is None else cheapest.energy

    @property
    def coefficients(self) -> NDArray[np.float64]:
        """Coefficients of every point, shape (points, profile.size)."""
        rows = [point.coefficients for point in self.points]
        return np.array(rows, dtype=float).reshape(len(rows), self.profile.size)

    def knee(self) -> FrontPoint:
        """Return the point with the least sum of its objectives, as shares of `reference`.

        These are the plain cycloid's residual and twice its energy, so that a front has the same
        knee by whichever method it is found. Whether it bends there is said by `has_knee`.
        """
        points = self._nonempty()
        return points[knee_of(self.objective_values, self.reference)]

    @property
    def has_knee(self) -> bool:
        """Return whether the knee is between the ends, not chance on a nearly straight front."""
        return has_knee(self.objective_values, self.reference)

    def _nonempty(self) -> Sequence[FrontPoint]:
        if len(self.points) == 0:
            raise ValueError(self.why_empty())
        return self.points

    def why_empty(self) -> str:
        """Say why there is no point, from what became of the candidates, and what to try."""
        none = "the front has no point;"
        if 0 < self.record.evaluations == self.failed:
            return f"{none} the motions of all {self.failed} candidates overflow; narrow the bound"
        if self.infeasible == 0:
            return f"{none} search longer or widen the bound"
        limits = ", ".join(map(str, self.task.limits))
        overflow = f" and the motions of {self.failed} overflow" if self.failed else ""
        return (
            f"{none} {self.infeasible} of {self.record.evaluations} candidates break the "
            f"limits ({limits}){overflow}; widen them or the bound, or search longer"
        )


def _energy(point: FrontPoint) -> float:
    return point.energy


@takes(task=PointToPoint)
def reference_corner(
    task: PointToPoint, objectives: Sequence[str] = RESIDUAL_AND_ENERGY
) -> tuple[float, ...]:
    """The corner that hypervolumes of a task's fronts are measured from.

    Residual [m] of the plain cycloid, 1 mm at least, twice its energy [J], and twice its peaks.
    """
    cycloid = JudgedMotion.of_profile(task, CycloidPolynomial(0), [])
    quantities = peak_quantities(checked_objectives(objectives))
    peaks = [2 * cycloid.motion.peak(name) for name in quantities]
    return (max(cycloid.residual, LEAST_REFERENCE), 2 * cycloid.energy, *peaks)
