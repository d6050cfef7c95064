"""The task that a command's line describes, and the grid of tasks of a sweep.

A plant makes its task (`Plant.task`), within limits of its own: here is what was typed beside it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from quietarm.models import Plant, Robot, RobotOnPath
from quietarm.models.robot.robot_notes import far_above_urdf
from quietarm.ocp import PointToPoint, Uncertainty
from quietarm.ocp.limits import QUANTITIES, TORQUE_SPEED
from quietarm.ocp.simulation.servo import as_held
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.cli.plants import (
    build_plant,
    build_uncertainty,
    choose_kind,
    floor_words,
    parameters_of,
    recorded_of,
    uncertainty_of_band,
    warn_of_notes,
    warn_of_payload,
)
from quietarm.studies.cli.quantities import (
    BAND,
    is_none,
    once,
    parse_of_plant,
    parse_parameters,
    single_values,
)
from quietarm.studies.cli.robot_options import OF_ROBOT, PATH_NAMES, needed_path
from quietarm.studies.sweep.move_grid import Axis, MoveGrid

if TYPE_CHECKING:
    from collections.abc import Mapping

    from quietarm.studies.cli.given import Given
    from quietarm.studies.cli.plants import Kind

_OTHERS = ("residual_window", "initial", "final", "energy")
"""What every task has beside its move, its limits and its uncertainty, by the options' names."""
_EXAMPLES = {"target": "30deg", "duration": "0.8"}


@dataclass(frozen=True)
class Asked:
    """The plant and the move of a command, with all values that were typed.

    Attributes
    ----------
    plant : Plant
        By the least of several values of its parameters.
    values : mapping of str to tuple of float
        Of every parameter and every quantity of the move, in SI units: several in a sweep.
    uncertainty : Uncertainty, optional
        Ranges of the plant's errors.
    """

    plant: Plant
    values: Mapping[str, tuple[float, ...]]
    uncertainty: Uncertainty | None

    def axes(self) -> tuple[Axis, ...]:
        """The axes: quantities with several values."""
        units = self.plant.units()
        units |= {name: unit.of(self.plant.joint) for name, unit in OF_MOVES.items()}
        several = {name: values for name, values in self.values.items() if len(values) > 1}
        return tuple(Axis(name, values, units[name]) for name, values in several.items())

    def move(self) -> dict[str, float]:
        """The move; of several values the furthest from 0, so that a grid's own task is a move."""
        return {name: max(self.values[name], key=abs) for name in OF_MOVES if name in self.values}


def read_task(given: Given, known: Mapping[str, float]) -> PointToPoint:
    """The task, with what is known of the move in the place of options."""
    kind = choose_kind(given.plant, given.plant_file)
    asked = _read_asked(given, kind, known)
    single_values(asked.values)
    return _make_task(given, kind, asked)


def read_grid(given: Given) -> MoveGrid:
    """The task, and axes over what has several values."""
    kind = choose_kind(given.plant, given.plant_file)
    asked = _read_asked(given, kind, {})
    return MoveGrid(_make_task(given, kind, asked), asked.axes())


def _make_task(given: Given, kind: Kind, asked: Asked) -> PointToPoint:
    """The task, whose limits that were typed are in the place of the plant's own."""
    plant = asked.plant
    band = given.read_of_plant(BAND, plant)
    uncertainty = asked.uncertainty
    if band is None:
        given.refuse(["band_margin"], "is of a --band, and none is given")
    elif uncertainty is None:
        changed = [name for name in asked.values if name not in OF_MOVES]
        uncertainty, why = uncertainty_of_band(kind, changed)
        given.remarks.append(f"the band is for {why}")
    names = [*(quantity.limit for quantity in QUANTITIES.values()), TORQUE_SPEED]
    removed = [name for name in names if is_none(given.pick(name)[name])]
    typed = {name: given.read_of_plant(name, plant) for name in names if name not in removed}
    task = plant.task(
        **asked.move(),
        **{name: limit for name, limit in typed.items() if limit is not None},
        **dict.fromkeys(removed),
        **given.pick(*_OTHERS),
        uncertainty=uncertainty,
        band=band,
        margin=given.band_margin,
    )
    if task.plant.drive is not None and task.plant.drive.has_loops:
        as_held(task.plant, task.target)  # refuses a frequency that is of no structure on the servo
    warn_of_payload(kind, plant, asked.values)
    if isinstance(kind, Robot):
        typed_limits = [name for name, limit in typed.items() if limit is not None]
        given.remarks += _far_above_urdf(kind, task, typed_limits)
    if isinstance(kind, Robot) and not _shows_rows(given):
        warn_of_notes(plant)
    return task


def _far_above_urdf(robot: Robot, task: PointToPoint, typed: list[str]) -> list[str]:
    """Words on limits that were typed and are several times those of the URDF."""
    several = len(robot.joints) > 1
    limits = {
        limit.name: {joint.name: joint.upper for joint in limit.bounds_of_joints(task.plant)}
        if several
        else dict.fromkeys(robot.joints, limit.upper)
        for limit in task.limits
        if f"{limit.name}_limit" in typed
    }
    of_file = [note.words for note in robot.notes]
    return [f"warning: {words}" for words in far_above_urdf(robot, limits) if words not in of_file]


def _read_asked(given: Given, kind: Kind, known: Mapping[str, float]) -> Asked:
    if isinstance(kind, Robot):
        return _of_robot(given, kind, known)
    return _of_joint(given, kind, known)


def _of_joint(given: Given, kind: Kind, known: Mapping[str, float]) -> Asked:
    """A plant of one joint, by its name or its file, and from where to where it moves."""
    if not given.is_command("evaluate"):  # which has recorded paths
        given.refuse(["path"], OF_ROBOT)
    given.refuse(PATH_NAMES, OF_ROBOT)
    parameters = parameters_of(kind, given.parameters)
    plant = build_plant(kind, {name: min(values) for name, values in parameters.items()})
    if given.drive:
        recorded = recorded_of(kind, parameters)
        drive = given.read_drive(plant, recorded)
        plant = replace(plant, drive=drive)
        if recorded is not None and drive is not None and drive.recorded != recorded:
            given.remarks.append(
                f"the machine's file says that it was recorded {recorded}, which is not used: "
                f"--drive says recorded={drive.recorded}"
            )
    uncertainty = build_uncertainty(kind, given.errors, parameters)
    given.remarks += floor_words(kind, given.errors)
    values = dict(parameters)
    for name in OF_MOVES:
        values[name] = (known[name],) if name in known else _needed(given, name, plant)
    return Asked(plant, values, uncertainty)


def _of_robot(given: Given, robot: Robot, known: Mapping[str, float]) -> Asked:
    """A robot on the path that was typed; it may have multiples of its payload, and durations."""
    given.refuse(["drive"], "is for a plant of one joint; a robot's file has its coulomb")
    durations = (known["duration"],) if "duration" in known else _needed(given, "duration", robot)
    multiples = parse_parameters(RobotOnPath, given.parameters)
    least = {name: min(values) for name, values in multiples.items()}
    plant = replace(robot.along(needed_path(given, robot)), **least)
    ranges = once(given.errors, "--error ")
    values = {**multiples, "target": (1.0,), "duration": durations}
    return Asked(plant, values, Uncertainty(ranges) if ranges else None)


def _needed(given: Given, name: str, plant: Plant | Robot) -> tuple[float, ...]:
    """The values of a quantity of the move, which has to be typed, or has a default."""
    text: str | None = given.pick(name)[name]
    if text is None:
        raise click.UsageError(f"Missing option '--{name}'. Give it as --{name} {_EXAMPLES[name]}")
    if isinstance(plant, Robot):
        return parse_of_plant(name, text, "rotary", "m")
    return given.read_of_plant(name, plant)


def _shows_rows(given: Given) -> bool:
    """Return whether the answer has rows of figures, beside which a plant's notes stand."""
    table = given.is_command("evaluate") and isinstance(given.coefficients, Path)
    return given.is_command("plan", "evaluate") and not table
