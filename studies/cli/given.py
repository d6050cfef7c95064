"""What was typed of a command, and the plant, the task or the grid of tasks that it describes."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import click
from click.core import ParameterSource
from rich.console import Console

from quietarm.models import Plant, Robot
from quietarm.models.joint_motion import joint_unit
from quietarm.ocp import JointProfile, PointToPoint, Solver
from quietarm.ocp.limits import QUANTITIES, TORQUE_SPEED
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.cli.plants import (
    Kind,
    build_plant,
    build_uncertainty,
    choose_kind,
    read_parameters,
    warn_of_payload,
)
from quietarm.studies.cli.quantities import RESIDUAL_LIMIT, parse_of_plant
from quietarm.studies.cli.robots import LINE_NAMES, OF_ROBOT, read_robot_task
from quietarm.studies.reading.profiles import profile_of
from quietarm.studies.report.words import print_lines
from quietarm.studies.sweep.grid import OF_MOVES, Axis, Grid

_OF_JOINT = (*OF_MOVES, *(quantity.limit for quantity in QUANTITIES.values()), TORQUE_SPEED)
"""Options that are read once the plant is known: in radians, or in metres of a linear axis."""
_OTHERS = ("residual_window", "initial", "final", "energy")
_MANY_HOURS = 10
_MANY_COEFFICIENTS = 40
"""With so many a solve takes minutes; six to thirty take seconds."""
_FEW_COEFFICIENTS, _SECONDS_OF_FEW = 6, 0.05
"""A solve of so many takes this long; the time rises with a power of their number: of the square
where they enter linearly (28 terms of a polynomial take 1 s), and faster where they do not (31
coefficients of ten nodes take 18 s, of ten Gaussians 9 s; all by processor time)."""
_NEEDED = {"target": "30deg", "duration": "0.8"}


class Given:
    """The options of a command by their names, as `given.terms`."""

    def __init__(self, context: click.Context) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        try:
            return self._context.params[name]
        except KeyError:
            raise AttributeError(name) from None

    def pick(self, *names: str) -> dict[str, Any]:
        """Some options, by name."""
        return {name: self._context.params[name] for name in names}

    def typed(self, name: str) -> bool:
        """Whether an option was typed."""
        return self._context.get_parameter_source(name) is ParameterSource.COMMANDLINE

    @property
    def line(self) -> str:
        """The whole line that was typed."""
        return shlex.join(["quietarm", *self._context.obj])

    def refuse(self, names: Collection[str], why: str) -> None:
        """Refuse options that were typed where they have no meaning."""
        for one in self._context.command.params:
            if one.name in names and self.typed(one.name):
                name = one.opts[0] if isinstance(one, click.Option) else one.name.upper()
                raise ValueError(f"{name} {why}; leave it out")

    def refuse_others(self, than: Collection[str], why: str) -> None:
        """Refuse all options that were typed but some."""
        self.refuse({one.name for one in self._context.command.params if one.name} - {*than}, why)

    def refuse_endless(self, number: int, what: str, seconds: float) -> None:
        """Refuse work of many hours, so many seconds each, unless --yes is typed."""
        hours = number * seconds / 3600
        if hours > _MANY_HOURS and not self.yes:
            raise ValueError(
                f"{number} {what} take some {hours:.3g} hours on a core; give fewer, or --yes"
            )

    def _refuse_endless_solves(self, profile: JointProfile) -> None:
        """Refuse hours of solves from all starts, for each point of a front, unless --yes."""
        options = self._context.params
        points = len(options.get("weights", ())) or options.get("points", 1)
        power = 3.5 if profile.sharp else 2.0
        seconds = _SECONDS_OF_FEW * max(1.0, profile.size / _FEW_COEFFICIENTS) ** power
        self.refuse_endless(self.starts * points, "solves", seconds)

    def read_residual_limit(self, plant: Plant) -> float | None:
        """The residual limit in the unit of the plant's tips; None where none was typed."""
        return self.read_of_plant(RESIDUAL_LIMIT, plant)

    def read_of_plant(self, name: str, plant: Plant) -> Any:
        """What an option says that is in the plant's units; None where it was not typed."""
        text = self._context.params[name]
        try:
            return None if text is None else parse_of_plant(name, text, plant.joint, plant.tip_unit)
        except ValueError as error:
            hint = f"'--{name.replace('_', '-')}'"
            raise click.BadParameter(str(error), param_hint=hint) from None

    def read_plant(self, named: Kind | None) -> Plant:
        """The plant, with the parameters that were typed."""
        kind = choose_kind(named, self.plant_file)
        return build_plant(kind, single_values(read_parameters(kind, self.parameters)))

    def read_solver(self) -> Solver:
        """The solver that was typed, with its options: the one place where commands make it."""
        return SOLVERS[self.solver]()

    def read_profile(self, task: PointToPoint) -> JointProfile:
        """The joint profile; where it has many coefficients, a word of how long that takes."""
        profile = profile_of(self.profile, task, self.terms)
        if "starts" in self._context.params:
            self._refuse_endless_solves(profile)
        by_gradient = self._context.command.name != "search"
        if profile.size > _MANY_COEFFICIENTS and by_gradient:
            print_lines(
                Console(stderr=True, quiet=self.quiet),
                f"{profile.size} coefficients: a plan takes minutes; with fewer --terms seconds",
            )
        return profile

    def read_task(self, **known: float) -> PointToPoint:
        """The task, with what is `known` in the place of options."""
        grid = self.read_grid(**known)
        single_values({axis.name: axis.values for axis in grid.axes})
        return grid.task

    def read_grid(self, **known: float) -> Grid:
        """The task, and axes over what has several values."""
        kind = choose_kind(self.plant, self.plant_file)
        if isinstance(kind, Robot):
            return self._read_robot(kind, **known)
        if self._context.command.name != "evaluate":  # which has recorded paths
            self.refuse(["path"], OF_ROBOT)
        self.refuse(LINE_NAMES, OF_ROBOT)
        parameters = read_parameters(kind, self.parameters)
        plant = build_plant(kind, {name: min(values) for name, values in parameters.items()})
        uncertainty = build_uncertainty(kind, self.errors, parameters)
        given: dict[str, Any] = self.pick(*_OTHERS)
        given |= {name: (value,) for name, value in known.items()}
        typed = [name for name in _OF_JOINT if name not in known]
        given |= {name: self.read_of_plant(name, plant) for name in typed}
        for name, example in _NEEDED.items():
            if given[name] is None:
                raise click.UsageError(f"Missing option '--{name}'. Give it as --{name} {example}")
        moves = {name: given.pop(name) for name in OF_MOVES}
        units = {name: joint_unit(unit, plant.joint) for name, unit in OF_MOVES.items()}
        axes = [
            Axis(name, values, (plant.units() | units)[name])
            for name, values in {**parameters, **moves}.items()
            if len(values) > 1
        ]
        # of several values the furthest from 0, so that the grid's own task is a move
        furthest: dict[str, Any] = {name: max(values, key=abs) for name, values in moves.items()}
        task = PointToPoint(plant, **furthest, **given, uncertainty=uncertainty)
        warn_of_payload(kind, plant, parameters)
        return Grid(task, tuple(axes))

    def _read_robot(self, robot: Robot, **known: float) -> Grid:
        """The task of a robot along its path, and an axis where there are several durations."""
        text: str | None = self._context.params["duration"]
        duration = known.get("duration")
        if duration is None and text is None:
            raise click.UsageError("Missing option '--duration'. Give it as --duration 0.8")
        durations: tuple[float, ...] = (duration,) if duration is not None else ()
        if not durations:
            durations = parse_of_plant("duration", str(text), "rotary", "m")
        axes = (Axis("duration", durations, "s"),) if len(durations) > 1 else ()
        return Grid(read_robot_task(self, robot, max(durations)), axes)


def single_values(given: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Values by name; a click error where there are several of one."""
    for name, values in given.items():
        if len(values) > 1:
            raise click.UsageError(
                f"{name} has {len(values)} values here; give one (a number has a decimal point), "
                "or quietarm sweep for all"
            )
    return {name: values[0] for name, values in given.items()}
