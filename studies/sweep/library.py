"""Moves between the cells of a sweep, at once: coefficients by interpolation."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp import (
    Plan,
    PointToPoint,
    QuietarmError,
    evaluate_coefficients,
    plan_move,
    plan_moves,
)
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.studies.sweep.asked import COEFFICIENTS, JUMP
from quietarm.studies.sweep.grid import Grid
from quietarm.studies.sweep.interpolation import Interpolation
from quietarm.studies.sweep.store import Store

Array = NDArray[np.float64]
_SAMPLES = 100
"""Random moves between the cells, by which a library says how good it is."""


@dataclass(frozen=True)
class Between:
    """What moves between the cells leave [m] and cost: the worst of some random ones, by CVODES.

    Cost is the share of the energy above that of a plan of the same move; `of_limits` is peak over
    limit, of the limit that is kept worst, 0 without limits.
    """

    residual: float
    excess: float
    of_limits: float
    samples: int

    @property
    def words(self) -> str:
        """All of it in a line."""
        beyond = self.of_limits - 1
        kept = f"limits broken by {beyond:.1%}" if beyond > OVERRUN else "limits kept"
        return ", ".join([
            f"between the cells: {1e3 * self.residual:.3g} mm left",
            f"{self.excess:.2%} more energy than plans of their own",
            *([kept] if self.of_limits else []),
            f"each the largest of {self.samples} random moves",
        ])  # fmt: skip


class BeyondError(ValueError):
    """A move that a library has no coefficients for."""


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
        self.grid, self.profile = self.store.sweep.grid, self.store.sweep.profile
        if self.store.missing():
            raise ValueError(f"{path} has cells that are not computed; give its line again")

    @cached_property
    def interpolation(self) -> Interpolation:
        """Between the cells of one branch."""
        axes = [np.array(axis.values) for axis in self.grid.axes]
        marks = self.store.read(JUMP).astype(np.int32)
        return Interpolation(axes, self.store.read(COEFFICIENTS), marks)

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
        self._check_names(at)
        for axis in self.grid.axes:
            values = np.asarray(at[axis.name], float)
            low, high = min(axis.values), max(axis.values)
            if not ((low <= values) & (values <= high)).all():
                worst = values.ravel()[np.argmax(np.abs(values - (low + high) / 2))]
                raise BeyondError(
                    f"{axis.name} is {worst:g} {axis.unit}, and the grid has {low:g} to {high:g}; "
                    "sweep a wider one, or add --solve"
                )
        places = np.stack(
            np.broadcast_arrays(*(np.asarray(at[axis.name], float) for axis in self.grid.axes)),
            axis=-1,
        )
        found = self.interpolation(places.reshape(-1, places.shape[-1]))
        if not np.isfinite(found).all():
            raise BeyondError(
                "the move is next to a cell without a plan, or where the least energy jumps from "
                "one motion to another; add --solve, or sweep a finer grid"
            )
        return found.reshape(*places.shape[:-1], -1)

    def _check_names(self, at: dict[str, ArrayLike]) -> None:
        names = [axis.name for axis in self.grid.axes]
        if {*at} != {*names}:
            raise ValueError(f"give a value of each axis, {', '.join(names)}, and no other")

    def task(self, **at: float) -> PointToPoint:
        """The move of some values of the axes."""
        self._check_names({**at})
        axes = (replace(axis, values=(at[axis.name],)) for axis in self.grid.axes)
        one = Grid(self.grid.task, tuple(axes))
        return one.tasks(one.chunks[0])[0]

    def plan(self, *, solve: bool = False, **at: float) -> Plan:
        """The move that is looked up, with its figures by CVODES.

        One that the library has no coefficients for is planned by `plan_move` where `solve` says
        so, else refused; so is one that breaks a limit, else it is returned as it is.
        """
        task, settings = self.task(**at), self.store.sweep.settings
        try:
            coefficients = self.coefficients(**at)
        except BeyondError:
            if not solve:
                raise
        else:
            found = evaluate_coefficients(task, coefficients, profile=self.profile, method="lookup")
            if not (solve and found.motion.exceeded(task.limits, OVERRUN)):
                return found
        limit = settings.residual_limit or (None if task.ranges else 0.0)
        return plan_move(task, self.profile, residual_limit=limit, bound=settings.bound)

    def between(self, samples: int = _SAMPLES) -> Between:
        """What random moves between the cells leave and cost; kept in the dataset."""
        known = self.store.noted("between the cells")
        if known.get("samples") == samples:
            return Between(**known)
        random, tasks, plans = np.random.default_rng(0), list[PointToPoint](), list[Plan]()
        for _ in range(20 * samples):
            if len(tasks) == samples:
                break
            at = {one.name: float(random.uniform(min(one.values), max(one.values)))
                  for one in self.grid.axes}  # fmt: skip
            try:
                plans.append(self.plan(solve=False, **at))
            except ValueError:
                continue
            tasks.append(self.task(**at))
        if not tasks:
            raise ValueError(
                f"{self.store.path} has no move between its cells that can be looked up"
            )
        least = self._least(tasks)
        energies = np.array([plan.energy for plan in plans])
        worst = max(plan.residual for plan in plans)
        peaks = [
            max(one.motion.exceeded(one.task.limits, -1).values(), default=0.0) for one in plans
        ]
        found = Between(worst, float(np.nanmax(energies / least - 1)), max(peaks), len(tasks))
        self.store.note("between the cells", vars(found))
        return found

    def _least(self, tasks: Sequence[PointToPoint]) -> Array:
        """Energies of the plans of moves, NaN where one has none; those of one plant at once."""
        settings, least = self.store.sweep.settings, np.full(len(tasks), np.nan)
        limit, bound = settings.residual_limit, settings.bound
        if tasks[0].ranges:
            for k, task in enumerate(tasks):
                with suppress(QuietarmError):
                    plan = plan_move(task, self.profile, residual_limit=limit or None, bound=bound)
                    least[k] = plan.energy
            return least
        for plant in {task.plant for task in tasks}:
            places = [k for k, task in enumerate(tasks) if task.plant == plant]
            some = [tasks[k] for k in places]
            moves = plan_moves(some, self.profile, residual_limit=limit, bound=bound, starts=2)
            least[places] = moves.energy
        return least
