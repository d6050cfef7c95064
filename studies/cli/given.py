"""What was typed of a command, and the plant, the task or the grid of tasks that it describes."""

from __future__ import annotations

import shlex
from collections.abc import Collection
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from quietarm.machine.identify import Identified
from quietarm.models import Plant, Robot, RobotOnPath
from quietarm.ocp import JointProfile, PointToPoint, Solver
from quietarm.ocp.limits import QUANTITIES, TORQUE_SPEED
from quietarm.ocp.planning.named_profiles import profile_of
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.cli.effort import announce_minutes, refuse_endless, seconds_of_solve
from quietarm.studies.cli.plants import (
    ROBOT_IS_NO_PLANT,
    Kind,
    build_plant,
    build_uncertainty,
    choose_kind,
    warn_of_notes,
    warn_of_payload,
)
from quietarm.studies.cli.quantities import (
    RESIDUAL_LIMIT,
    parse_of_plant,
    parse_parameters,
    single_values,
)
from quietarm.studies.cli.robot_options import LINE_NAMES, OF_ROBOT, read_robot_task
from quietarm.studies.sweep.move_grid import OF_MOVES, Axis, MoveGrid


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

    @property
    def _params(self) -> list[click.Parameter]:
        """The command's own arguments and options."""
        command: Any = self._context.command
        return command.own_params

    def refuse(self, names: Collection[str], why: str) -> None:
        """Refuse options that were typed where they have no meaning."""
        for param in self._params:
            if param.name in names and self.typed(param.name):
                name = param.opts[0] if isinstance(param, click.Option) else param.name.upper()
                raise ValueError(f"{name} {why}; leave it out")

    def refuse_others(self, than: Collection[str], why: str) -> None:
        """Refuse all options that were typed but some."""
        names = {param.name for param in self._params if param.name}
        self.refuse(names - {*than}, why)

    def read_residual_limit(self, plant: Plant) -> float | None:
        """The residual limit in the unit of the plant's tips; None where none was typed."""
        return self.read_of_plant(RESIDUAL_LIMIT, plant)

    def read_of_plant(self, name: str, plant: Plant) -> Any:
        """What an option says that is in the plant's units; None where it was not typed."""
        text = self._context.params[name]
        try:
            if text is None:
                return None
            kinds = dict(zip(plant.joint_names, plant.joint_kinds))
            return parse_of_plant(name, text, plant.joint, plant.tip_unit, kinds)
        except ValueError as error:
            hint = f"'--{name.replace('_', '-')}'"
            raise click.BadParameter(str(error), param_hint=hint) from None

    def read_place(self, plant: Plant) -> dict[str, float]:
        """Where a move is in the grid of a sweep: a value of each axis that was typed."""
        typed = [name for name in OF_MOVES if self.typed(name)]
        values = {name: self.read_of_plant(name, plant) for name in typed}
        return single_values(values | parse_parameters(plant, self.parameters))

    def read_plant(self, named: Kind | None) -> Plant:
        """The plant, with the parameters that were typed."""
        kind = choose_kind(named, self.plant_file)
        return build_plant(kind, single_values(self._parameters_of(kind)))

    def _parameters_of(self, kind: Kind) -> dict[str, tuple[float, ...]]:
        if isinstance(kind, Robot):
            raise ValueError(ROBOT_IS_NO_PLANT)
        plant = kind.plant if isinstance(kind, Identified) else kind
        return parse_parameters(plant, self.parameters)

    def read_solver(self) -> Solver:
        """The solver that was typed, with its options: the one place where commands make it."""
        return SOLVERS[self.solver](tolerance=self.tolerance)

    def read_profile(self, task: PointToPoint) -> JointProfile:
        """The joint profile; hours of solves from all starts, for all points, are refused."""
        options = self._context.params
        profile = profile_of(self.profile, task, self.terms)
        if "starts" in options:
            points = len(options.get("weights", ())) or options.get("points", 1)
            seconds = seconds_of_solve(profile)
            refuse_endless(self.starts * points, "solves", seconds, yes=self.yes)
        if self._context.command.name != "search" and not self.quiet:
            announce_minutes(profile)
        return profile

    def read_task(self, **known: float) -> PointToPoint:
        """The task, with what is `known` in the place of options."""
        grid = self.read_grid(**known)
        single_values({axis.name: axis.values for axis in grid.axes})
        return grid.task

    def read_grid(self, **known: float) -> MoveGrid:
        """The task, and axes over what has several values."""
        kind = choose_kind(self.plant, self.plant_file)
        if isinstance(kind, Robot):
            return self._read_robot(kind, **known)
        if self._context.command.name != "evaluate":  # which has recorded paths
            self.refuse(["path"], OF_ROBOT)
        self.refuse(LINE_NAMES, OF_ROBOT)
        parameters = self._parameters_of(kind)
        plant = build_plant(kind, {name: min(values) for name, values in parameters.items()})
        uncertainty = build_uncertainty(kind, self.errors, parameters)
        options = self.pick("residual_window", "initial", "final", "energy")
        options |= {name: (value,) for name, value in known.items()}
        limits = [quantity.limit for quantity in QUANTITIES.values()]
        for name in [*OF_MOVES, *limits, TORQUE_SPEED]:
            if name not in known:
                options[name] = self.read_of_plant(name, plant)
        for name, example in {"target": "30deg", "duration": "0.8"}.items():
            if options[name] is None:
                raise click.UsageError(f"Missing option '--{name}'. Give it as --{name} {example}")
        moves = {name: options.pop(name) for name in OF_MOVES}
        units = {name: unit.of(plant.joint) for name, unit in OF_MOVES.items()}
        axes = [
            Axis(name, values, (plant.units() | units)[name])
            for name, values in {**parameters, **moves}.items()
            if len(values) > 1
        ]
        # of several values the furthest from 0, so that the grid's own task is a move
        furthest: dict[str, Any] = {name: max(values, key=abs) for name, values in moves.items()}
        task = PointToPoint(plant, **furthest, **options, uncertainty=uncertainty)
        warn_of_payload(kind, plant, parameters)
        return MoveGrid(task, tuple(axes))

    def _shows_rows(self) -> bool:
        """Whether the answer has rows of figures, beside which a plant's notes stand."""
        name = self._context.command.name
        return name == "plan" or (name == "evaluate" and not isinstance(self.coefficients, Path))

    def _read_robot(self, robot: Robot, **known: float) -> MoveGrid:
        """The task of a robot along its path; axes over durations and multiples of the robot's."""
        text: str | None = self._context.params["duration"]
        duration = known.get("duration")
        if duration is None and text is None:
            raise click.UsageError("Missing option '--duration'. Give it as --duration 0.8")
        durations: tuple[float, ...] = (duration,) if duration is not None else ()
        if not durations:
            durations = parse_of_plant("duration", str(text), "rotary", "m")
        multiples = parse_parameters(RobotOnPath, self.parameters)
        task = read_robot_task(self, robot, max(durations), multiples)
        if not self._shows_rows():
            warn_of_notes(task.plant)
        units = RobotOnPath.units() | {"duration": str(OF_MOVES["duration"])}
        axes = [
            Axis(name, values, units[name])
            for name, values in {**multiples, "duration": durations}.items()
            if len(values) > 1
        ]
        return MoveGrid(task, tuple(axes))
