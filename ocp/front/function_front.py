"""The front of a user's own function: what a search of a simulator or a machine has found."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import IF_STATED, CountFromOne, finite
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import Entries, FrontPoint, non_dominated_rows
from quietarm.ocp.front.searched_function import SearchedFunction
from quietarm.ocp.objectives import Objective
from quietarm.ocp.saved import to_html


@dataclass(frozen=True)
class FunctionPoint(FrontPoint):
    """One candidate on the front of a function: its coefficients and its objectives.

    `residual` and `energy` are the first two objectives, whatever the function calls them; `peaks`
    are the others, by name. All are in the function's own units, and may be negative.
    """

    residual: float
    energy: float
    peaks: Mapping[str, float] = field(default_factory=dict, hash=False, metadata=IF_STATED)


@dataclass(frozen=True)
class FunctionEntries(Entries):
    """The candidates of a function that no earlier one dominated, in order of their evaluation.

    `residuals`, `energies` and `peaks` are its objectives, as of a `FunctionPoint`.
    """

    candidates: tuple[CountFromOne, ...] = ()
    residuals: tuple[float, ...] = ()
    energies: tuple[float, ...] = ()
    peaks: Mapping[str, tuple[float, ...]] = field(
        default_factory=dict, hash=False, metadata=IF_STATED
    )
    believed: tuple[tuple[float, ...], ...] = field(default=(), metadata=IF_STATED)


@dataclass(frozen=True, repr=False)
class FunctionFront(Front):
    """Non-dominated candidates of a user's own function, as `qa.search` finds them.

    A `Front` in whatever needs no task: it is saved and loaded by `Front.load`, compared, drawn and
    written as a table. What needs a plant or a move says so (`NoTaskError`).

    Attributes
    ----------
    function : SearchedFunction
        Name, box, objectives, units and constraints of the function; also as `task`.
    points : tuple of FunctionPoint
        Sorted by the first objective, with the values that the function gave.
    reference : tuple of float
        The corner that hypervolumes are measured from.
    record, failed, infeasible, history, entries, objectives
        As of a `Front`.
    """

    # these two follow from the function
    task: Any = field(default=None, repr=False, compare=False, kw_only=True)
    profile: Any = field(default=None, repr=False, compare=False, kw_only=True)
    points: tuple[FunctionPoint, ...]
    reference: tuple[float, ...]
    entries: FunctionEntries = field(default_factory=FunctionEntries, metadata=IF_STATED)
    function: SearchedFunction = field(kw_only=True)

    def __post_init__(self) -> None:
        function = self.function
        values = {"task": function, "profile": function, "objectives": function.objectives}
        for name, value in {**values, "points": tuple(self.points)}.items():
            object.__setattr__(self, name, value)
        if len(self.reference) != len(self.objectives):
            raise ValueError(
                f"its reference has {len(self.reference)} figures; give one for each of its "
                f"{len(self.objectives)} objectives"
            )
        others = set(self.objectives[2:])
        for number, point in enumerate(self.points, start=1):
            function.checked(point.coefficients)
            if set(point.peaks) != others:
                raise ValueError(f"point {number} has other objectives than the function; give its")
            for name, value in zip(self.objectives, point.values(self.objectives[2:])):
                finite(f"{name} of point {number}", value)
        if len(self.entries) and set(self.entries.peaks) != others:
            raise ValueError("the objectives of its entries are not those of the function")
        if self.points != ordered_points(self.points, self.objectives):
            raise ValueError(
                "its points are out of order, or one is dominated; order them by the first "
                "objective and drop dominated ones"
            )

    def as_saved(self, entries: dict[str, Any]) -> dict[str, Any]:
        """The entries of its file: task and profile are the function."""
        return {name: entries[name] for name in entries if name not in ("task", "profile")}

    @property
    def objective_values(self) -> NDArray[np.float64]:
        """Every objective of every point, shape (points, objectives), in the function's units."""
        rows = [point.values(self.objectives[2:]) for point in self.points]
        return np.array(rows, dtype=float).reshape(len(rows), len(self.objectives))

    @property
    def outputs(self) -> tuple[Objective, ...]:
        """The objectives, with their units."""
        return self.function.outputs

    @property
    def tip_unit(self) -> str:
        """Unit of the first objective."""
        return self.function.units[0]

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """Objectives, as ``residual_m``, and ``a_1``, ``a_2``, ... of all points, by name."""
        names = [objective.column for objective in self.outputs]
        values = dict(zip(names, self.objective_values.T))
        return {**values, **dict(zip(self.function.variables, self.coefficients.T))}

    def judged(self, point: FrontPoint) -> NoReturn:
        """Raise NoTaskError: a function has no motion that CVODES could judge."""
        raise self.function.no_task()

    def figures_within(self, residual: float, place: str) -> dict[str, float]:
        """Return nothing: figures are of motions."""
        return {}

    @property
    def _peaks(self) -> list[Objective]:
        """The objectives beside the first two."""
        return list(self.outputs[2:])

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        head = [f"{objective.label} [{objective.unit or '-'}]" for objective in self.outputs]
        rows = [
            (*(f"{value:.5g}" for value in values), ", ".join(f"{a:.4g}" for a in coefficients))
            for values, coefficients in zip(self.objective_values, self.coefficients)
        ]
        return to_html(rows, [*head, "coefficients"])

    def why_empty(self) -> str:
        """Say why there is no point, from what became of the candidates, and what to try."""
        count = self.record.evaluations
        if 0 < count == self.failed:
            return (
                f"the front has no point; {self.function.name} gave no finite numbers for any of "
                f"{count} candidates; mend it, or give other bounds"
            )
        if not self.infeasible:
            return "the front has no point; search longer"
        failed = f" and {self.failed} have no finite numbers" if self.failed else ""
        names = ", ".join(self.function.constraints)
        return (
            f"the front has no point; {self.infeasible} of {count} candidates violate the "
            f"constraints ({names}){failed}; give wider bounds, or search longer"
        )


def ordered_points(
    points: Iterable[FunctionPoint], objectives: Sequence[str]
) -> tuple[FunctionPoint, ...]:
    """The points that no other dominates, in order of the first objective; equal ones once."""
    others = tuple(objectives)[2:]
    in_order = sorted(points, key=lambda point: point.values(others))
    table = np.array([point.values(others) for point in in_order])
    rows = non_dominated_rows(table.reshape(len(in_order), len(objectives)))
    return tuple(in_order[row] for row in rows)
