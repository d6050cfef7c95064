"""What is asked of a sweep, and what its dataset holds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from quietarm.ocp import PointToPoint, SolveSettings, SolveStatus
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.robustness.perturbed import OF_MODES
from quietarm.ocp.saved import plain, typed
from quietarm.ocp.solvers.transcription import RESIDUAL
from quietarm.ocp.task import QUANTITIES
from quietarm.studies.sweep.grid import Axis, Grid

STATUS, COEFFICIENTS, JUMP = "status", "coefficients", "jump"
STATES = ("not computed", *(status.value for status in SolveStatus))
"""What `status` says, by its number."""
_SECONDS_OF_WORK = 256
"""Cells of a chunk; of a robust plan or a front each is as much work as many plans."""
_OF_ROBUST = _OF_FRONT = 32


@dataclass(frozen=True)
class Variable:
    """A variable of the dataset: its unit, and its dimensions beside the axes with their sizes."""

    unit: str
    beside: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True)
class Sweep:
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
    refine : float or None
        Residual [m] between the cells down to which axes are halved.
    """

    grid: Grid
    profile: JointProfile
    settings: SolveSettings
    front: int = 0
    refine: float | None = None

    def __post_init__(self) -> None:
        dear = (_OF_ROBUST if self.grid.task.ranges else 1) * (_OF_FRONT if self.front else 1)
        at_once = max(1, _SECONDS_OF_WORK // dear)
        object.__setattr__(self, "grid", replace(self.grid, at_once=at_once))

    @property
    def variables(self) -> dict[str, Variable]:
        """The numbers of every cell by name; `status` is apart."""
        units = {"energy": "J", "residual": "m"}
        units |= {f"peak_{name}": quantity.unit for name, quantity in QUANTITIES.items()}
        units[f"price_{RESIDUAL}"] = "J/m"
        limits = self.grid.task.limits
        units |= {f"price_{one.name}": f"J/({one.quantity.unit or '1'})" for one in limits}
        units |= {f"energy_by_{name}": "J" for name in OF_MODES}
        units |= {f"residual_by_{name}": "m" for name in OF_MODES}
        units |= {"iterations": "1", "cold_excess": "1"}
        found = {name: Variable(unit) for name, unit in units.items()}
        of_profile = ("coefficient", self.profile.size)
        found[COEFFICIENTS] = Variable("1", (of_profile,))
        if self.front:
            point = ("point", self.front)
            found["front_residual"], found["front_energy"] = (Variable(u, (point,)) for u in "mJ")
            found["front_coefficients"] = Variable("1", (point, of_profile))
        return found

    def to_json(self) -> dict[str, Any]:
        """What makes two sweeps the same, in numbers and text."""
        axes = {axis.name: [axis.unit, *axis.values] for axis in self.grid.axes}
        return {
            "axes": axes, "task": plain(self.grid.task), "profile": plain(self.profile),
            "settings": {**plain(self.settings), "front": self.front, "refine": self.refine},
        }  # fmt: skip

    @classmethod
    def from_json(cls, asked: dict[str, Any]) -> Sweep:
        """The sweep of what `to_json` gave."""
        axes = (Axis(name, tuple(values), unit) for name, (unit, *values) in asked["axes"].items())
        settings = dict(asked["settings"])
        front, refine = settings.pop("front"), settings.pop("refine")
        return cls(
            Grid(typed(asked["task"], PointToPoint), tuple(axes)),
            typed(asked["profile"], JointProfile), typed(settings, SolveSettings), front, refine,
        )  # fmt: skip
