"""Moves between the cells of a sweep, at once: coefficients by interpolation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.ocp import InfeasibleTaskError, Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.joint_words import broken_limits
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.studies.sweep.between import Between, assess
from quietarm.studies.sweep.cell_interpolation import Interpolation
from quietarm.studies.sweep.definition import COEFFICIENTS
from quietarm.studies.sweep.store import Store

Array = NDArray[np.float64]


class MoveLibrary:
    """Coefficients of any move within a sweep's grid.

    Parameters
    ----------
    path : str or Path
        The dataset of `quietarm sweep`.

    Raises
    ------
    FileFormatError
        When it is none.
    ValueError
        When a cell was not computed.
    """

    def __init__(self, path: str | Path) -> None:
        self.store = Store(Path(path))
        definition = self.store.definition
        self.grid = definition.grid
        self.profile = definition.profile
        if self.store.missing():
            raise ValueError(f"{path} has cells that are not computed; give its line again")
        coefficients = self.store.read(COEFFICIENTS)
        axes = [np.array(axis.values) for axis in self.grid.axes]
        self.interpolation = Interpolation(axes, coefficients)

    def has(self, place: Array) -> bool:
        """Return whether there are coefficients at a place, a value for each axis."""
        return bool(np.isfinite(self.interpolation(place[None])).all())

    def energies(self, places: Array) -> Array:
        """Energies of the cells, interpolated as their coefficients are [J], at each place."""
        cells = self.store.read("energy")[..., None]
        return self.interpolation.of(cells, places)[:, 0]

    def coefficients(self, **at: ArrayLike) -> Array:
        """Coefficients of moves.

        Parameters
        ----------
        **at : array_like
            A value of every axis by its name [SI units], or as many of each.

        Returns
        -------
        ndarray, shape (..., profile.size)
            A row a move.

        Raises
        ------
        ValueError
            When an axis is missing, a move is beyond the grid, or next to a cell without a plan or
            to a jump from one branch to another.
        """
        remedy = "plan this move by itself: leave --from out"
        self._check_names(at)
        columns = np.broadcast_arrays(*(np.asarray(at[name], float) for name in self.grid.names))
        for axis, values in zip(self.grid.axes, columns):
            low = axis.values[0]
            high = axis.values[-1]
            if beyond := values[~((low <= values) & (values <= high))].tolist():
                raise ValueError(
                    f"{axis.name} is {beyond[0]:g} {axis.unit}, and the grid has {low:g} to "
                    f"{high:g}; sweep a wider one, or {remedy}"
                )
        places = np.stack(columns, axis=-1)
        coefficients = self.interpolation(places.reshape(-1, places.shape[-1]))
        if not np.isfinite(coefficients).all():
            raise ValueError(
                "the move is next to a cell without a plan, or where the least energy jumps from "
                f"one motion to another; sweep a finer grid, or {remedy}"
            )
        return coefficients.reshape(*places.shape[:-1], -1)

    def _check_names(self, at: Mapping[str, object]) -> None:
        names = self.grid.names
        if {*at} != {*names}:
            raise ValueError(f"give a value of each axis, {', '.join(names)}, and no other")

    def task(self, **at: float) -> PointToPoint:
        """The move of some values of the axes."""
        self._check_names(at)
        return self.grid.task_at(at)

    def plan(self, **at: float) -> Plan:
        """The move between the cells, evaluated by CVODES; it may violate a limit.

        ValueError where the library has no coefficients for it.
        """
        task = self.task(**at)
        coefficients = self.coefficients(**at)
        return evaluate_coefficients(
            task, coefficients, profile=self.profile, method="interpolated"
        )

    def between(self) -> Between:
        """Residual and energy of random moves between the cells; kept in the dataset."""
        # the note of the dataset that keeps what `between` says
        entry = "moves between the cells"
        if known := self.store.kept(entry):
            return Between(**known)
        assessed = assess(self)
        self.store.keep(entry, asdict(assessed))
        return assessed


@interruptible
def plan_from(
    dataset: str | Path | MoveLibrary, **at: float
) -> tuple[Plan, Between, InfeasibleTaskError | None]:
    """A move from the dataset of a sweep, without solving anything.

    Parameters
    ----------
    dataset : str, Path or MoveLibrary
        The dataset of `quietarm sweep`, or what was opened of it.
    **at : float
        A value of every axis by its name [SI units].

    Returns
    -------
    Plan, Between, InfeasibleTaskError or None
        The move, residual and energy of moves between the cells, and an error if this one violates
        a limit.

    Raises
    ------
    FileFormatError, ValueError
        As of `MoveLibrary` and its `coefficients`.
    """
    library = dataset if isinstance(dataset, MoveLibrary) else MoveLibrary(dataset)
    plan = library.plan(**at)
    between = library.between()
    broken = " and ".join(broken_limits(plan.candidate, plan.task.limits, OVERRUN))
    words = f"between the cells the move breaks its limit of {broken}; {between.remedy}"
    return plan, between, InfeasibleTaskError(words) if broken else None
