"""Read what was typed of a command: the plant, the task or the grid of tasks."""

from __future__ import annotations

import shlex
from collections.abc import Collection
from functools import cached_property
from typing import Any

import click
from click.core import ParameterSource

from quietarm.models import Drive, Plant
from quietarm.models.drive import Recorded
from quietarm.ocp import JointProfile, PointToPoint, Solver
from quietarm.ocp.planning.named_profiles import profile_of
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.cli.effort import announce_minutes, refuse_endless, seconds_of_solve
from quietarm.studies.cli.plants import Kind, build_plant, choose_kind, parameters_of
from quietarm.studies.cli.quantities import (
    RESIDUAL_LIMIT,
    parse_drive,
    parse_of_plant,
    parse_parameters,
    single_values,
)
from quietarm.studies.cli.read_task import read_grid, read_task
from quietarm.studies.sweep.move_grid import MoveGrid


class Given:
    """The options of a command by their names, as `given.terms`."""

    def __init__(self, context: click.Context) -> None:
        self._context = context
        self.remarks: list[str] = []
        """What was taken where nothing was typed; it stands beneath the answer."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self._context.params[name]
        except KeyError:
            raise AttributeError(name) from None

    def pick(self, *names: str) -> dict[str, Any]:
        """Some options, by name."""
        return {name: self._context.params[name] for name in names}

    def typed(self, name: str) -> bool:
        """Return whether an option was typed."""
        return self._context.get_parameter_source(name) is ParameterSource.COMMANDLINE

    def is_command(self, *names: str) -> bool:
        """Return whether what was typed is one of these commands."""
        return self._context.command.name in names

    @property
    def line(self) -> str:
        """The whole line that was typed."""
        return shlex.join(["quietarm", *self._context.obj])

    @cached_property
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
        """Read an option that is in the plant's units; None where it was not typed."""
        text = self._context.params[name]
        try:
            if text is None:
                return None
            kinds = dict(zip(plant.joint_names, plant.joint_kinds))
            return parse_of_plant(name, text, plant.joint, plant.tip_unit, kinds)
        except ValueError as error:
            hint = f"'--{name.replace('_', '-')}'"
            raise click.BadParameter(str(error), param_hint=hint) from None

    def read_drive(self, plant: Plant, recorded: Recorded | None = None) -> Drive | None:
        """The drive that was typed, in the units of the plant's joint; None where none was.

        How the frequencies were recorded is `recorded` where it was not typed.
        """
        try:
            return parse_drive(self.drive, plant.joint, recorded)
        except ValueError as error:
            raise click.BadParameter(str(error), param_hint="'--drive'") from None

    def read_place(self, plant: Plant) -> dict[str, float]:
        """Read where a move is in the grid of a sweep: a value of each axis that was typed."""
        typed = [name for name in OF_MOVES if self.typed(name)]
        values = {name: self.read_of_plant(name, plant) for name in typed}
        return single_values(values | parse_parameters(plant, self.parameters))

    def read_plant(self, named: Kind | None) -> Plant:
        """The plant, with the parameters that were typed."""
        kind = choose_kind(named, self.plant_file)
        return build_plant(kind, single_values(parameters_of(kind, self.parameters)))

    def read_solver(self) -> Solver:
        """The solver that was typed, with its options: the one place where commands make it."""
        chosen = SOLVERS[self.solver]
        own = {entry.name for entry in chosen.stated_options()}
        typed = dict[str, Any]()
        for kind in SOLVERS.values():
            for entry in kind.stated_options():
                value = self._context.params[entry.name]
                if value is None:
                    continue
                if entry.name not in own:
                    others = f"is an option of {kind.name}, and the solver is {chosen.name}"
                    self.refuse([entry.name], others)
                typed[entry.name] = value
        return chosen(**typed)

    def read_profile(self, task: PointToPoint) -> JointProfile:
        """The joint profile; hours of solves from all starts, for all points, are refused."""
        options = self._context.params
        profile = profile_of(self.profile, task, self.terms)
        if "starts" in options:
            points = len(options.get("weights", ())) or options.get("points", 1)
            seconds = seconds_of_solve(profile)
            refuse_endless(self.starts * points, "solves", seconds, yes=self.yes)
        if not self.is_command("search") and not self.quiet:
            announce_minutes(profile)
        return profile

    def read_task(self, **known: float) -> PointToPoint:
        """The task, with what is `known` in the place of options."""
        return read_task(self, known)

    def read_grid(self) -> MoveGrid:
        """The task, and axes over what has several values."""
        return read_grid(self)
