"""Moves between the cells of a sweep, at once: coefficients by interpolation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import islice
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp import InfeasibleTaskError, Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.studies.sweep.cells import by_plant, plan_cells
from quietarm.studies.sweep.definition import COEFFICIENTS
from quietarm.studies.sweep.interpolation import Interpolation
from quietarm.studies.sweep.store import Store

Array = NDArray[np.float64]
_SAMPLES = 100
"""Random moves between the cells, by which a library says how good it is."""
_STARTS, _TRIES = 2, 20
"""Starts of a plan of such a move; places that are tried for each."""
_SPARE = 1.5
"""A margin is advised that is this much larger than the worst excess of these."""
_ALONE = "plan this move by itself: leave --from out"


@dataclass(frozen=True)
class Between:
    """What moves between the cells leave [m] and cost: the worst of some random ones, by CVODES.

    `excess` is the share of the energy above that of a plan of the same move; `of_limits` is peak
    over limit, of the limit that is kept worst, 0 without limits.
    """

    residual: float
    excess: float
    of_limits: float
    samples: int

    @property
    def keeps_limits(self) -> bool:
        """Whether all of them keep their limits."""
        return self.of_limits <= 1 + OVERRUN

    @property
    def words(self) -> str:
        """All of it in a line."""
        broken = f"limits broken by up to {self.of_limits - 1:.1%}"
        return ", ".join([
            f"between the cells: residual {1e3 * self.residual:.3g} mm",
            f"{self.excess:.2%} more energy than plans of their own",
            *(["limits kept" if self.keeps_limits else broken] if self.of_limits else []),
            f"each the largest of {self.samples} random moves",
        ])  # fmt: skip

    @property
    def remedy(self) -> str:
        """How moves between the cells come to keep their limits."""
        share = ceil(100 * _SPARE * (self.of_limits - 1))
        return f"sweep again with --limit-margin {share}% or on a finer grid"


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
        self.grid, self.profile = definition.grid, definition.profile
        if self.store.missing():
            raise ValueError(f"{path} has cells that are not computed; give its line again")

    @cached_property
    def interpolation(self) -> Interpolation:
        """Between the cells of one branch."""
        axes = [np.array(axis.values) for axis in self.grid.axes]
        return Interpolation(axes, self.store.read(COEFFICIENTS))

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
        columns = np.broadcast_arrays(*(np.asarray(at[name], float) for name in self.grid.names))
        for axis, values in zip(self.grid.axes, columns):
            low, high = axis.values[0], axis.values[-1]
            if beyond := values[~((low <= values) & (values <= high))].tolist():
                raise ValueError(
                    f"{axis.name} is {beyond[0]:g} {axis.unit}, and the grid has {low:g} to "
                    f"{high:g}; sweep a wider one, or {_ALONE}"
                )
        places = np.stack(columns, axis=-1)
        found = self.interpolation(places.reshape(-1, places.shape[-1]))
        if not np.isfinite(found).all():
            raise ValueError(
                "the move is next to a cell without a plan, or where the least energy jumps from "
                f"one motion to another; sweep a finer grid, or {_ALONE}"
            )
        return found.reshape(*places.shape[:-1], -1)

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
        task, coefficients = self.task(**at), self.coefficients(**at)
        return evaluate_coefficients(
            task, coefficients, profile=self.profile, method="interpolated"
        )

    def between(self, samples: int = _SAMPLES) -> Between:
        """Residual and energy of random moves between the cells; kept in the dataset."""
        known = self.store.kept("between the cells")
        if known.get("samples") == samples:
            return Between(**known)
        low, high = np.array([(axis.values[0], axis.values[-1]) for axis in self.grid.axes]).T
        random = np.random.default_rng(0).uniform(low, high, (_TRIES * samples, len(low)))
        places = list(islice(
            (one for one in random if np.isfinite(self.interpolation(one[None])).all()), samples
        ))  # fmt: skip
        if not places:
            raise ValueError(
                f"{self.store.path} has no move between its cells that has coefficients"
            )
        names, definition = self.grid.names, self.store.definition
        plans = [self.plan(**dict(zip(names, one.tolist()))) for one in places]
        own = [energy for group in by_plant([plan.task for plan in plans])
               for energy in plan_cells(definition, group, _STARTS)["energy"]]  # fmt: skip
        of_limits = [share for plan in plans
                     for share in plan.motion.exceeded(plan.task.limits, -1).values()]  # fmt: skip
        found = Between(
            max(plan.residual for plan in plans),
            float(np.nanmax([plan.energy for plan in plans] / np.array(own) - 1)),
            max(of_limits, default=0.0),
            len(plans),
        )
        self.store.keep("between the cells", asdict(found))
        return found


def plan_from(path: str | Path, **at: float) -> tuple[Plan, Between, InfeasibleTaskError | None]:
    """A move from the dataset of a sweep, without solving anything.

    Parameters
    ----------
    path : str or Path
        The dataset of `quietarm sweep`.
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
    library = MoveLibrary(path)
    plan, between = library.plan(**at), library.between()
    broken = " and ".join(plan.motion.exceeded(plan.task.limits, OVERRUN))
    words = f"between the cells the move breaks its limit of {broken}; {between.remedy}"
    return plan, between, InfeasibleTaskError(words) if broken else None
