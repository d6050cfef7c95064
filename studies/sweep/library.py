"""Moves between the cells of a sweep, at once: coefficients by interpolation."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients, plan_moves
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.saved import typed
from quietarm.studies.sweep.grid import Axis, Grid
from quietarm.studies.sweep.store import opened

Array = NDArray[np.float64]
_SAMPLES = 100
"""Random moves between the cells, by which a library says how good it is."""
_JUMP = 4.0
"""Where coefficients change by so many times what they do on either side, a branch ends."""
_OF_SMOOTH, _OF_OTHERS = "cubic", "linear"


@dataclass(frozen=True)
class Between:
    """What moves between the cells leave and cost: the worst of some random ones.

    Attributes
    ----------
    residual : float
        F1 [m], by CVODES.
    excess : float
        Share of the energy above that of a plan of the same move.
    samples : int
        How many moves were looked at.
    """

    residual: float
    excess: float
    samples: int


def _stand_out(steps: Array) -> NDArray[np.bool_]:
    """Steps along the first axis that are much larger than those before and after them."""
    beside = np.zeros_like(steps)
    beside[1:] = steps[:-1]
    beside[:-1] = np.fmax(beside[:-1], steps[1:])
    return steps > _JUMP * beside


class MoveLibrary:
    """Coefficients of any move within a sweep's grid.

    Where all cells have a plan and no two neighbours are of different branches, the interpolation
    is cubic, else linear within each box of neighbours.

    Parameters
    ----------
    path : str or Path
        The dataset of `quietarm sweep`.

    Raises
    ------
    FileFormatError
        When it is none.
    ValueError
        When a cell was not computed, or an axis has fewer than four values.
    """

    def __init__(self, path: str | Path) -> None:
        self.path, self._group = Path(path), opened(Path(path))
        asked = json.loads(str(self._group.attrs["asked"]))
        axes = tuple(
            Axis(name, tuple(values), str(self._array(name).attrs["units"]))
            for name, values in asked["axes"].items()
        )
        self.grid = Grid(typed(asked["task"], PointToPoint), axes)
        self.profile = typed(asked["profile"], JointProfile)
        self._settings = asked["settings"]
        for axis in axes:  # what a cubic takes
            if len(axis.values) < 4:
                raise ValueError(
                    f"axis {axis.name} has {len(axis.values)} values, too few between which to "
                    "interpolate; sweep four or more"
                )
        if (np.asarray(self._array("status")[...]) == 0).any():
            raise ValueError(f"{path} has cells that are not computed; give its line again")

    def _array(self, name: str) -> Any:
        return self._group[name]

    @cached_property
    def _cells(self) -> Array:
        """Coefficients; NaN on both sides of a jump from one branch to another."""
        cells: Array = np.asarray(self._array("coefficients")[...])
        holed = cells.copy()
        for axis in range(len(self.grid.axes)):
            steps = np.linalg.norm(np.diff(cells, axis=axis), axis=-1)
            jumps = np.moveaxis(_stand_out(np.moveaxis(steps, axis, 0)), 0, axis)
            for side in (0, 1):
                place = [slice(None)] * len(self.grid.axes)
                place[axis] = slice(side, cells.shape[axis] - 1 + side)
                holed[tuple(place)][jumps] = np.nan
        return holed

    @cached_property
    def _interpolate(self) -> Any:
        from scipy.interpolate import RegularGridInterpolator  # takes long to load
        from scipy.sparse.linalg import spsolve

        whole = bool(np.isfinite(self._cells).all())
        points = [axis.values for axis in self.grid.axes]
        method = _OF_SMOOTH if whole else _OF_OTHERS
        exact: dict[str, Any] = (
            {"solver": spsolve} if whole else {}
        )  # the default one stops within 1e-5
        return RegularGridInterpolator(points, self._cells, method=method, **exact)

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
        names = [axis.name for axis in self.grid.axes]
        if {*at} != {*names}:
            raise ValueError(f"give a value of each axis, {', '.join(names)}, and no other")
        for axis in self.grid.axes:
            values = np.asarray(at[axis.name], float)
            low, high = min(axis.values), max(axis.values)
            if not ((low <= values) & (values <= high)).all():
                worst = values.ravel()[np.argmax(np.abs(values - (low + high) / 2))]
                raise ValueError(
                    f"{axis.name} is {worst:g} {axis.unit}, and the grid has {low:g} to {high:g}; "
                    "sweep a wider one, or solve"
                )
        places = np.stack(np.broadcast_arrays(*(at[name] for name in names)), axis=-1)
        found: Array = self._interpolate(places).reshape(*places.shape[:-1], -1)
        if not np.isfinite(found).all():
            raise ValueError(
                "the move is next to a cell without a plan, or where the least energy jumps from "
                "one motion to another; solve it, or sweep a finer grid"
            )
        return found

    def task(self, **at: float) -> PointToPoint:
        """The move of some values of the axes."""
        axes = (replace(axis, values=(at[axis.name],)) for axis in self.grid.axes)
        one = Grid(self.grid.task, tuple(axes))
        return one.tasks(one.chunks[0])[0]

    def plan(self, **at: float) -> Plan:
        """The move that is looked up, with its figures by CVODES."""
        found = self.coefficients(**at)
        return evaluate_coefficients(self.task(**at), found, profile=self.profile, method="lookup")

    def between(self, samples: int = _SAMPLES) -> Between:
        """What random moves between the cells leave and cost; kept in the dataset."""
        known: Mapping[str, Any] = json.loads(str(self._group.attrs.get("between", "{}")))
        if known.get("samples") == samples:
            return Between(**known)
        random, tasks, looked_up = np.random.default_rng(0), [], []
        for _ in range(20 * samples):
            if len(tasks) == samples:
                break
            at = {one.name: float(random.uniform(min(one.values), max(one.values)))
                  for one in self.grid.axes}  # fmt: skip
            try:
                looked_up.append(self.plan(**at))
            except ValueError:
                continue
            tasks.append(self.task(**at))
        if not tasks:
            raise ValueError(f"{self.path} has no move between its cells that can be looked up")
        least = np.array([self._least(task) for task in tasks])
        energies = np.array([plan.energy for plan in looked_up])
        worst = max(plan.residual for plan in looked_up)
        found = Between(worst, float(np.nanmax(energies / least - 1)), len(tasks))
        self._group.attrs["between"] = json.dumps(vars(found))
        return found

    def _least(self, task: PointToPoint) -> float:
        """Energy of the plan of a move."""
        limit, bound = self._settings["residual_limit"], self._settings["bound"]
        moves = plan_moves([task], self.profile, residual_limit=limit, bound=bound)
        return float(moves.energy[0]) if moves.status[0].solved else math.nan
