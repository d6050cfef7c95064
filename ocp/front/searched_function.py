"""The bounds and the names that a front of a user's own function has in the place of a task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import clipped, numbers, quoted, several
from quietarm.ocp.errors import QuietarmError
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, Objective
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import PointToPoint

_USUAL_UNITS = {RESIDUAL: "m", "energy": "J"}
"""Units of the objectives that a function has where it states none."""
_LONGEST = 60
"""Letters of a name: it heads a column."""


class NoTaskError(QuietarmError, ValueError, AttributeError):
    """A front is of a function, and what was asked for needs a plant and a move."""


@dataclass(frozen=True)
class SearchedFunction:
    """A function of coefficients, as a file keeps it: its name, its bounds and what it returns.

    It stands where a front of a move has its task and its profile. The function itself is not in
    it: no file holds what could be run.

    Attributes
    ----------
    name : str
        What the function is called.
    lower, upper : tuple of float
        The box of its coefficients.
    objectives : tuple of str
        Names of what is minimised, two at least.
    units : tuple of str
        Unit of each; empty for a plain number.
    constraints : tuple of str
        Names of the violations that it returns beside them; a candidate whose violations are 0 or
        less is feasible.

    Raises
    ------
    ValueError
        When the box is empty, a name is missing or stands twice, or there are not as many units as
        objectives.
    """

    name: str
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    objectives: tuple[str, ...] = RESIDUAL_AND_ENERGY
    units: tuple[str, ...] = ()
    constraints: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        lower, upper = checked_box(self.lower, self.upper)
        names = _checked_names("objectives", self.objectives)
        if len(names) < 2:
            raise ValueError(
                f"objectives are {', '.join(names) or 'none'}; give two or more, such "
                "as ('residual', 'energy'): a front trades them"
            )
        units = _checked_units(self.units, names)
        broken = _checked_names("constraints", self.constraints)
        if twice := sorted({*names} & {*broken}):
            raise ValueError(f"{twice[0]} is an objective and a constraint; give each its own name")
        columns = [_column(name, unit) for name, unit in zip(names, units)]
        columns += [f"a_{i + 1}" for i in range(len(lower))]
        for column in columns:
            if columns.count(column) > 1:
                raise ValueError(f"two columns of its tables are called {quoted(column)}; give "
                                 "the objectives other names")  # fmt: skip
        values = {"lower": lower, "upper": upper, "objectives": names, "units": units}
        for entry, value in {**values, "constraints": broken}.items():
            object.__setattr__(self, entry, value)

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("_") or not (hasattr(PointToPoint, name) or name in _OF_TASKS):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        raise self.no_task()

    def no_task(self) -> NoTaskError:
        """Error to raise where a plant or a move is needed."""
        return NoTaskError(
            f"this front is of the function {clipped(self.name)}, which has no plant and no task; "
            "give a front of a move for this"
        )

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return len(self.lower)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the coefficients."""
        return tuple(f"a_{i + 1}" for i in range(self.size))

    @property
    def outputs(self) -> tuple[Objective, ...]:
        """Objectives with units, and with the columns that they have in tables."""
        return tuple(
            Objective(name, unit, name.replace("_", " "), _column(name, unit))
            for name, unit in zip(self.objectives, self.units)
        )

    def checked(self, coefficients: Sequence[float], duration: float = 0.0) -> tuple[float, ...]:
        """Coefficients as floats; ValueError where they are not as many, or not finite."""
        del duration  # of a move
        row = numbers("coefficients", coefficients, f"{self.size} numbers").ravel()
        if len(row) != self.size:
            raise ValueError(f"{self.name} takes {self.size} coefficients; it got {len(row)}")
        return tuple(row.tolist())


_OF_TASKS = frozenset(vars(JointProfile)) | frozenset(PointToPoint.__dataclass_fields__)
"""What else is asked of a task and of a profile."""


def checked_box(lower: Any, upper: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The lower and upper bounds, as many numbers each; one of them may be a single number."""
    sides = {"lower": lower, "upper": upper}
    rows = dict[str, NDArray[np.float64]]()
    for side, value in sides.items():
        if value is None:
            raise ValueError(
                f"{side} is missing; give lower and upper, the bounds of the function's "
                "coefficients, or set them as attributes of the function"
            )
        rows[side] = numbers(side, value, "a number for each coefficient")
        if rows[side].ndim > 1:
            raise ValueError(
                f"{side} has shape {rows[side].shape}; give a number for each coefficient"
            )
    if all(row.ndim == 0 for row in rows.values()):
        raise ValueError(
            "lower and upper are single numbers; give one of them as a list, a number for each "
            "coefficient"
        )
    try:
        low, high = np.broadcast_arrays(rows["lower"], rows["upper"])
    except ValueError:
        raise ValueError(
            f"lower has {rows['lower'].size} numbers and upper {rows['upper'].size}; give one for "
            "each coefficient"
        ) from None
    if not low.size:
        raise ValueError("lower and upper are empty; give a number for each coefficient")
    for number, (least, most) in enumerate(zip(low.tolist(), high.tolist()), start=1):
        if not least < most:
            raise ValueError(
                f"coefficient {number} has the bounds {least:g} to {most:g}; give a lower one that "
                "is less than the upper"
            )
    return tuple(low.tolist()), tuple(high.tolist())


def _checked_names(what: str, names: Any) -> tuple[str, ...]:
    """Names of objectives or constraints, each once."""
    example = "touch" if what == "constraints" else "energy"
    entries = several(what, names, f"names, such as ['{example}']")
    for name in entries:
        if not isinstance(name, str) or not name.strip() or len(name) > _LONGEST:
            raise ValueError(
                f"one of the {what} is {quoted(name)}; give a name of up to {_LONGEST} letters"
            )
        if entries.count(name) > 1:
            raise ValueError(f"{quoted(name)} stands twice in the {what}; give it once")
    return tuple(entries)


def _checked_units(units: Any, objectives: Sequence[str]) -> tuple[str, ...]:
    """A unit of each objective; the usual ones of residual and energy where none are stated."""
    stated = several("units", units, "a unit for each objective, such as ['m', 'J']")
    if not stated:
        return tuple(_USUAL_UNITS.get(name, "") for name in objectives)
    for unit in stated:
        if not isinstance(unit, str) or len(unit) > _LONGEST:
            raise ValueError(f"one of the units is {quoted(unit)}; give a word, such as 'm', or ''")
    if len(stated) != len(objectives):
        raise ValueError(
            f"{len(objectives)} objectives have {len(stated)} units; give one for each"
        )
    return tuple(stated)


def _column(name: str, unit: str) -> str:
    """The heading of an objective in a table: residual_m."""
    words = [name, unit.replace("/", "_per_")]
    return "_".join("_".join(word.split()) for word in words if word)
