"""What is asked of a sweep, and what its dataset holds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from quietarm.ocp import PointToPoint, SolveSettings, SolveStatus
from quietarm.ocp.checks import positive
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.robustness.perturbed import OF_MODES
from quietarm.ocp.saved import plain, typed
from quietarm.ocp.solvers.transcription import RESIDUAL
from quietarm.studies.sweep.grid import Axis, Grid

STATUS, COEFFICIENTS, JUMP = "status", "coefficients", "jump"
STATES = ("not computed", *(status.value for status in SolveStatus))
"""What `status` says, by its number."""
_CELLS_OF_A_CHUNK = 256
"""A second or two of work; a robust plan or a front is as much work as many plans."""
_WORK_OF_ROBUST = _WORK_OF_FRONT = 32
_MOST_MARGIN = 0.5


@dataclass(frozen=True)
class Variable:
    """A variable of the dataset: its unit, and its dimensions beside the axes with their sizes."""

    unit: str
    beside: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True)
class Definition:
    """What is asked of a sweep.

    Parameters
    ----------
    grid : Grid
        The moves.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        Of every plan.
    front : int
        Points of a front for every move; 0 for none.
    margin : float
        Share of each limit that plans leave unused, for the moves between the cells.

    Raises
    ------
    ValueError
        When the margin is out of range, or there is no limit to leave it to.
    """

    grid: Grid
    profile: JointProfile
    settings: SolveSettings
    front: int = 0
    margin: float = 0.0

    def __post_init__(self) -> None:
        if self.margin:
            positive("limit margin", self.margin, most=_MOST_MARGIN)
            if not self.grid.task.limits:
                raise ValueError("the limit margin is of limits, and none is given; give one")
        work = (_WORK_OF_ROBUST if self.grid.task.ranges else 1) * (
            _WORK_OF_FRONT if self.front else 1
        )
        at_once = max(1, _CELLS_OF_A_CHUNK // work)
        object.__setattr__(self, "grid", replace(self.grid, at_once=at_once))

    def tasks(self, number: int) -> list[PointToPoint]:
        """The moves of a chunk as they are planned: their limits less the margin."""
        share, of = 1 - self.margin, self.grid.task
        limits: dict[str, Any] = {
            quantity.limit: tuple(share * one for one in given)
            if isinstance(given, tuple)
            else share * given
            for quantity in QUANTITIES.values()
            if (given := getattr(of, quantity.limit)) is not None
        }
        if of.torque_speed is not None:
            limits["torque_speed"] = tuple((share * torque, at) for torque, at in of.torque_speed)
        return [replace(task, **limits) for task in self.grid.tasks(self.grid.chunks[number])]

    @property
    def variables(self) -> dict[str, Variable]:
        """The numbers of every cell by name; `status` and `jump` are apart."""
        units = {"energy": "J", "residual": "m"}
        units |= {f"peak_{name}": quantity.unit for name, quantity in QUANTITIES.items()}
        units[f"price_{RESIDUAL}"] = "J/m"
        limits = self.grid.task.limits
        units |= {f"price_{one.name}": f"J/({one.quantity.unit or '1'})" for one in limits}
        units |= {f"energy_by_{name}": "J" for name in OF_MODES}
        units |= {f"residual_by_{name}": "m" for name in OF_MODES}
        units |= {"iterations": "1", "cold_excess": "1"}
        variables = {name: Variable(unit) for name, unit in units.items()}
        of_profile = ("coefficient", self.profile.size)
        variables[COEFFICIENTS] = Variable("1", (of_profile,))
        if self.front:
            point = ("point", self.front)
            variables["front_residual"] = Variable("m", (point,))
            variables["front_energy"] = Variable("J", (point,))
            variables["front_coefficients"] = Variable("1", (point, of_profile))
        return variables

    def to_json(self) -> dict[str, Any]:
        """What makes two sweeps the same, in numbers and text."""
        axes = {axis.name: [axis.unit, *axis.values] for axis in self.grid.axes}
        return {
            "axes": axes, "task": plain(self.grid.task), "profile": plain(self.profile),
            "settings": {**plain(self.settings), "front": self.front, "margin": self.margin},
        }  # fmt: skip

    @classmethod
    def from_json(cls, saved: dict[str, Any]) -> Definition:
        """The definition of what `to_json` gave."""
        axes = (Axis(name, tuple(values), unit) for name, (unit, *values) in saved["axes"].items())
        settings = dict(saved["settings"])
        front, margin = settings.pop("front"), settings.pop("margin")
        return cls(
            Grid(typed(saved["task"], PointToPoint), tuple(axes)),
            typed(saved["profile"], JointProfile), typed(settings, SolveSettings), front, margin,
        )  # fmt: skip
