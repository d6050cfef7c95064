"""A plan's drive in rows of a name and a value: what it leaves there, and cycles there and back."""

from __future__ import annotations

import math

import numpy as np

from quietarm.models import Plant
from quietarm.models.dimensions import EFFORT, TORQUE
from quietarm.models.drive import NUMBERS, unit_of
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp import Plan, PointToPoint, SolverFailedError
from quietarm.ocp.planning.cycle import Cycle
from quietarm.ocp.rest import rest_of
from quietarm.ocp.simulation.servo import Mode
from quietarm.views.report.words import signed_errors
from quietarm.views.tips import tip_words

Row = tuple[str, str]


def drive_rows(plan: Plan) -> list[Row]:
    """The drive, and what its simulation says of a plan; what is unknown of it is named."""
    plant = plan.task.plant
    drive = plant.drive
    if drive is None:
        return []
    try:
        figures = plan.candidate.on_drive
    except SolverFailedError as error:
        return [*_stated_rows(plant), ("on the drive", f"warning: {error}"), *_doubts(plan)]
    if figures is None:
        unknown = ("on the drive", "not simulated: " + _LOOPS)
        return [*_stated_rows(plant), unknown, *_doubts(plan)]
    residual = tip_words(figures.residual, plant.tip_unit)
    way = "m" if plant.joint == LINEAR else "rad"
    following = tip_words(figures.following_error, way)
    off_path = tip_words(figures.off_path, way)
    effort = EFFORT.of(plant.joint)
    of_tip = "" if plant.joint == LINEAR else " of the tip from the joint"
    heat = "" if figures.heat is None else f", {figures.heat:.4g} J of copper loss"
    return [
        *_stated_rows(plant),
        *_servo_rows(plan),
        (
            "on the drive",
            f"{residual} left{of_tip}, follows within {following}, the load is within {off_path} "
            f"of the plan, peak {figures.peak_torque:.4g} {effort} with friction{heat}",
        ),
        *_worst_on_drive(plan),
        *_doubts(plan),
    ]


def _doubts(plan: Plan) -> list[Row]:
    """Return a warning for each number of a drive that no servo or belt has, with the remedy."""
    # a tenth of the way: belts and gears of machines give by a hundredth of that
    most_give = 0.1
    plant, drive = plan.task.plant, plan.task.plant.drive
    assert drive is not None
    rows = list[Row]()
    if drive.position_loop is not None and drive.speed_loop is not None:
        speed_gain = math.tau * drive.speed_loop
        if drive.position_loop > speed_gain:
            rows.append(
                (
                    "warning",
                    f"the position loop of {drive.position_loop:g}/s is faster than the speed loop "
                    f"of {drive.speed_loop:g} Hz, which is {speed_gain:.3g}/s; position_loop is "
                    "usually a third of that at most",
                )
            )
    gives = (drive.compliance or 0.0) * plan.figures.peak("torque")
    distance = abs(plan.task.span)
    if gives > most_give * distance:
        way = "m" if plant.joint == LINEAR else "rad"
        unit = unit_of("compliance", plant.joint)
        rows.append(
            (
                "warning",
                f"with a compliance of {drive.compliance:.3g} {unit} belt or gear gives by "
                f"{gives:.3g} {way} at the plan's peak, and its way is {distance:.3g} {way}; check "
                "the unit of compliance",
            )
        )
    return rows


def _worst_on_drive(plan: Plan) -> list[Row]:
    """Return a row of what a robust plan leaves on the drive at the errors that are worst there.

    They may be others than those of the plant alone: the servo gives way to what a structure of
    another frequency does to it.
    """
    if plan.worst is None:
        return []
    task = plan.task
    corners = [dict(zip(task.ranges, sizes)) for sizes in task.scenarios[1:]]
    left = [
        (figures.residual, errors)
        for errors in (dict(plan.worst.errors), *corners)
        if (figures := plan.candidate.perturbed(errors).on_drive) is not None
    ]
    residual, errors = max(left, key=lambda one: one[0])
    words = f"{tip_words(residual, task.plant.tip_unit)} with {signed_errors(errors)} left"
    if task.band is not None and residual > task.band:
        words += f"  (warning: beyond the band of {tip_words(task.band, 'm')}, which holds for a "
        words += "larger speed_loop or smaller errors)"
    return [("worst on it", words)]


def cycle_rows(plan: Plan) -> list[Row]:
    """Effort and energy of a cycle there and back, and what builds up over many."""
    cycle = plan.cycles
    if cycle is None:
        return []
    plant = plan.task.plant
    shuttle = cycle.shuttle
    effort = EFFORT.of(plant.joint)
    torques = ", ".join(f"{torque:.4g}" for torque in cycle.rms_torques)
    heat = "heat unknown without motor_constant in --drive"
    if cycle.heat is not None:
        heat = f"{cycle.heat:.4g} J ({cycle.heat / cycle.time:.4g} W) of copper loss"
    worst = cycle.worst()
    return [
        (
            "cycle",
            f"there and back in {cycle.time:.4g} s with a dwell of {shuttle.dwell:g} s after each "
            f"move: RMS {TORQUE.of(plant.joint)} {torques} {effort}, {heat}",
        ),
        (
            "energy of a cycle",
            f"{cycle.energy:.4g} J, or {cycle.energy_with_recovery:.4g} J where the DC link gives "
            "back what the motor generates",
        ),
        (f"left in {_cycles(shuttle.repeat)}", _builds_up(plan.task, cycle.left)),
        (f"if {signed_errors(worst.errors)}", _builds_up(plan.task, worst.left)),
        *_cycles_on_drive(plan.task, worst),
    ]


def _cycles_on_drive(task: PointToPoint, worst: Cycle) -> list[Row]:
    """Return a row of what builds up on the drive at the worst errors."""
    try:
        left = worst.on_drive()
    except SolverFailedError as error:
        return [("the same on the drive", f"warning: {error}")]
    return [] if left is None else [("the same on the drive", _builds_up(task, left))]


def _cycles(count: int) -> str:
    return "1 cycle" if count == 1 else f"{count} cycles"


def _builds_up(task: PointToPoint, left: np.ndarray) -> str:
    """Say how the vibration after each move changes from the first to the last."""
    rest = rest_of(task)
    unit = task.plant.tip_unit
    if left.max() < rest:
        return f"at rest after each move (below {tip_words(rest, unit)})"
    first, last, most = (tip_words(size, unit) for size in (left[0], left[-1], left.max()))
    return f"{first} after the first move, {last} after the last, {most} at most"


def _servo_rows(plan: Plan) -> list[Row]:
    """Say how the plan accounts for the servo."""
    held, moving = plan.candidate.modes_on_drive
    words = f"{_hertz(held)} with the joint held, {_hertz(moving)} on the servo"
    if plan.candidate.inverts_drive:
        held_words = "as recorded with the joint held"
        return [("set points", f"of the load's path through the drive; {words}, {held_words}")]
    return [("set points", f"the planned path, as recorded on the moving servo; {words}")]


def _hertz(mode: Mode) -> str:
    return f"{mode.frequency / math.tau:.5g} Hz ({100 * mode.damping:.2g} %)"


def _stated_rows(plant: Plant) -> list[Row]:
    """Return rows of what is known of a plant's drive, and of what is not."""
    drive = plant.drive
    if drive is None:
        return []
    known = [name for name in NUMBERS if name not in drive.unknown]
    words = [
        f"{name.replace('_', ' ')} {getattr(drive, name):.4g} {unit_of(name, plant.joint)}"
        for name in known
    ]
    words.append(f"feed-forward {_FORWARD[drive.feedforward]}")
    unknown = ", ".join(name.replace("_", " ") for name in drive.unknown)
    rows = [("drive", ", ".join(words))]
    return rows + ([("drive unknown", unknown)] if unknown else [])


_FORWARD = {"acceleration": "of speed and acceleration", "speed": "of speed", "none": "none"}
_LOOPS = "give position_loop and speed_loop"
