"""Definition of a sweep: what is asked of it, and what its dataset holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from quietarm.ocp import Solver, SolveStatus, Sqp
from quietarm.ocp.checks import listed, not_negative, positive, quoted
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.limits import RESIDUAL, SWEEP, TORQUE_SPEED, quantities_of
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting, coefficient_bound
from quietarm.ocp.robustness import OF_MODES
from quietarm.ocp.solvers.choice import SOLVERS, stated_solver
from quietarm.ocp.solvers.solver import NAME
from quietarm.studies.sweep.move_grid import MoveGrid

STATUS = "status"
COEFFICIENTS = "coefficients"
SOLVED_BY = "solved_by"
JUMP = "jump"
DIGEST = "digest"
STATES = ("not computed", *(status.value for status in SolveStatus))
"""What `status` says, by its number."""


def number_of_solver(name: str) -> int:
    """Return what `solved_by` says of a solver: its place among all, -1 of none of them."""
    return [*SOLVERS].index(name) if name in SOLVERS else -1


class Variable(NamedTuple):
    """A variable of the dataset: its dimensions beside the axes, and what it is of no plan."""

    unit: str
    beside: Mapping[str, int] = {}
    empty: Any = np.nan
    attributes: Mapping[str, Any] = {}


@dataclass(frozen=True)
class PlanSettings:
    """Settings by which every cell of a sweep is planned, as its dataset states them.

    Attributes
    ----------
    residual_limit : float
        Largest residual [m]; 0 for rest on arrival, or for the default of an uncertain task.
    bound : float or None
        Largest absolute coefficient.
    starts : int
        1 where cells start from their neighbours; datasets of before may have more.
    solved_by : mapping of str to str, bool, int, float or None
        What solves, with its options that are not the default, as a record states them.
    seed, steps, guess, log
        Of datasets of before, which state them.

    Raises
    ------
    ValueError
        When a number is out of range, no solver is stated, or an option that it does not have.
    """

    residual_limit: float = 0.0
    bound: float | None = None
    starts: int = 1
    seed: int = 0
    steps: int | None = None
    guess: tuple[float, ...] | None = None
    log: bool = False
    solved_by: Mapping[str, Setting] = field(default_factory=lambda: Sqp().stated, hash=False)

    def __post_init__(self) -> None:
        _ = self.solver  # of what is stated

    @classmethod
    def of_saved(cls, settings: Any) -> Any:
        """Settings as they are today: datasets of before have the solver's among the others."""
        if not isinstance(settings, dict) or "solved_by" in settings:
            return settings
        solver = {name: entry for name, entry in settings.items() if name.startswith(NAME)}
        others = {name: entry for name, entry in settings.items() if name not in solver}
        stated = stated_solver(solver)
        return others | {"solved_by": stated.stated if stated else solver}

    @classmethod
    def of(cls, residual_limit: float | None, bound: float | None, solver: Solver) -> PlanSettings:
        """Make settings by which cells start from neighbours; ValueError if out of range."""
        if residual_limit is None:
            residual_limit = 0.0
        limit = not_negative("residual limit", residual_limit, "m")
        bound = None if bound is None else coefficient_bound(bound)
        return cls(limit, bound, solved_by=solver.stated)

    @cached_property
    def solver(self) -> Solver:
        """Solver with all of its options."""
        solver = stated_solver(self.solved_by)
        if solver is None:
            known = listed(SOLVERS)
            raise ValueError(f"solver is {quoted(self.solved_by.get(NAME))}; give one of {known}")
        return solver

    @property
    def from_neighbours(self) -> bool:
        """Return whether a cell starts from a neighbour."""
        return self.starts == 1


@dataclass(frozen=True)
class Definition:
    """The definition of a sweep.

    Parameters
    ----------
    grid : MoveGrid
        The moves.
    profile : JointProfile
        How the joint moves.
    settings : PlanSettings
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

    grid: MoveGrid
    profile: JointProfile
    settings: PlanSettings
    front: int = 0
    margin: float = 0.0

    @classmethod
    def of_saved(cls, definition: Any) -> Any:
        """A definition as it is today."""
        if not isinstance(definition, dict) or "settings" not in definition:
            return definition
        return definition | {"settings": PlanSettings.of_saved(definition["settings"])}

    def __post_init__(self) -> None:
        most = 0.5
        if self.margin:
            positive("limit margin", self.margin, most=most)
            if not self.grid.task.limits:
                raise ValueError("the limit margin is of limits, and none is given; give one")

    @cached_property
    def chunk(self) -> tuple[int, ...]:
        """Cells of a chunk along each axis; along one that is cut, chunks are alike."""
        # a second or two of work; a robust plan or a front is as much work as many plans
        cells_of_a_chunk = 256
        work = 1
        for expensive in (self.grid.task.ranges, self.front):
            work *= 32 if expensive else 1
        sizes = list[int]()
        room = max(1, cells_of_a_chunk // work)
        for length in reversed(self.grid.shape):
            parts = -(-length // max(1, room))
            sizes.append(-(-length // parts))
            room //= sizes[-1]
        return tuple(reversed(sizes))

    @cached_property
    def chunks(self) -> list[tuple[slice, ...]]:
        """The cells of every chunk."""
        return [
            *product(
                *(
                    [slice(first, min(first + size, length)) for first in range(0, length, size)]
                    for size, length in zip(self.chunk, self.grid.shape)
                )
            )
        ]

    @cached_property
    def planned(self) -> MoveGrid:
        """The moves as they are planned: their limits less the margin."""
        share = 1 - self.margin
        task = self.grid.task
        limits = dict[str, Any]()
        for limit in task.limits if self.margin else ():
            if limit.name == TORQUE_SPEED:
                line = task.torque_speed or ()
                limits[TORQUE_SPEED] = tuple((share * torque, speed) for torque, speed in line)
            else:
                limits[limit.quantity.limit] = share * limit.lower, share * limit.upper
        return replace(self.grid, task=replace(task, **limits))

    @cached_property
    def variables(self) -> dict[str, Variable]:
        """The dataset's variables by name."""
        task = self.grid.task
        size = {"coefficient": self.profile.size}
        tip = task.plant.tip_unit
        units = {
            "energy": "J",
            "residual": tip,
            f"price_{RESIDUAL}": f"J/{tip}",
            "iterations": "1",
            "cold_excess": "1",
        }
        quantities = quantities_of(task.plant.joint, tip).values()
        units |= {quantity.peak: str(quantity.unit) for quantity in quantities}
        units |= {
            f"price_{entry.name}": f"J/({str(entry.quantity.unit) or '1'})" for entry in task.limits
        }
        for name in OF_MODES:
            units |= {f"energy_by_{name}": "J", f"residual_by_{name}": tip}
        meanings = [state.replace(" ", "_") for state in STATES]
        states = {"flag_values": [*range(len(STATES))], "flag_meanings": " ".join(meanings)}
        nexts = [f"to_the_next_{name}" for name in self.grid.names]
        jumps = {
            "flag_masks": [1 << k for k in range(len(nexts))],
            "flag_meanings": " ".join(nexts),
        }
        window = {"residual_window_s": task.residual_window}
        variables = {name: Variable(unit) for name, unit in units.items()}
        variables["residual"] = Variable(tip, attributes=window)
        variables[COEFFICIENTS] = Variable("1", size)
        variables[STATUS] = Variable("1", {}, np.int8(0), states)
        solvers = {"flag_values": [*range(len(SOLVERS))], "flag_meanings": " ".join(SOLVERS)}
        variables[SOLVED_BY] = Variable("1", {}, np.int8(-1), solvers)
        variables[JUMP] = Variable("1", {}, np.int32(0), jumps)
        if self.front:
            point = {"point": self.front}
            variables["front_residual"] = Variable(tip, point, attributes=window)
            variables["front_energy"] = Variable("J", point)
            variables["front_coefficients"] = Variable("1", point | size)
        taken = (*variables, *self.grid.names, DIGEST)
        for figure in self.figures:
            if figure.name in taken:
                raise ValueError(
                    f"{figure.name} is a variable of a dataset already; give the figure another "
                    "name"
                )
            variables[figure.name] = Variable(figure.unit_on(task.plant) or "1")
        return variables

    @property
    def figures(self) -> list[Figure]:
        """Further figures that the dataset holds, without peaks, which it holds anyway."""
        return [figure for figure in further_figures(SWEEP, self.grid.task) if not figure.quantity]

    def difference(self, other: Definition) -> str:
        """Names of all in which two sweeps differ, and the residual window of the other."""
        mine = self._entries()
        theirs = other._entries()
        names = [name for name in mine | theirs if mine.get(name) != theirs.get(name)]
        there = {"residual_window": f" ({other.grid.task.residual_window:.10g} s there)"}
        return ", ".join(f"{name}{there.get(name, '')}" for name in names)

    def _entries(self) -> dict[str, Any]:
        of = self.grid.task, self.settings, self
        entries = {entry.name: getattr(part, entry.name) for part in of for entry in fields(part)}
        entries["margin of the band"] = self.grid.task.margin  # beside that of the limits
        del entries["grid"], entries["settings"], entries["solved_by"]
        return entries | self.settings.solver.stated | {axis.name: axis for axis in self.grid.axes}
