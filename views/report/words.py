"""Words for what is shown: lengths in millimetres, plants, moves and tasks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from quietarm.models import Plant
from quietarm.models.dimensions import WAY
from quietarm.ocp import Front, ModalState, PointToPoint
from quietarm.ocp.energy import ABSOLUTE_POWER
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.objectives import Objective, objectives_on
from quietarm.ocp.rest import is_at_rest, rest_of
from quietarm.views.tips import tip_scale, tip_words

if TYPE_CHECKING:
    from quietarm.metaheuristics.spread import Spread
    from quietarm.ocp.judged_motion import JudgedMotion


def counted(number: int, what: str) -> str:
    """Return a count in words, such as 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def raised(unit: str) -> str:
    """A unit as it is drawn, without a formula: rad/s², ±5 %."""
    return unit.replace("^2", "²").replace("^3", "³").replace("+-", "±")


def spread_words(spread: Spread, form: str, unit: str = "") -> str:
    """Median (quartiles) of seeds, and how many have the figure; one that has not is infinite."""
    if not spread.count:
        return "none"
    middle, low, high = (
        format(value, form) if isfinite(value) else "none"
        for value in (spread.median, spread.lower, spread.upper)
    )
    if spread.seeds == 1:
        return f"{middle}{unit}"
    some = f", {spread.count} of {spread.seeds} seeds" if spread.count < spread.seeds else ""
    unit = unit if isfinite(spread.median) else ""
    return f"{middle}{unit} ({low} to {high}{some})"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return tip_words(length, "m")


def span_words(begin: float, end: float) -> str:
    """Say from when to when [s], to the millisecond: a recorder's clock may count from anywhere."""
    return " to ".join(f"{round(time, 3):.12g}" for time in (begin, end)) + " s"


def residual_words(residual: float, task: PointToPoint) -> str:
    """A residual in the unit that is shown; `rest` where it counts as that."""
    return "rest" if is_at_rest(residual, task) else tip_words(residual, task.plant.tip_unit)


def scenarios_words(residual: float, worst: JudgedMotion | None, task: PointToPoint) -> str:
    """The residual of a front's point, at rest only where its worst case is; None has none."""
    words = residual_words(residual, task)
    if words != "rest" or worst is None or is_at_rest(worst.residual, task):
        return words
    return f"{tip_words(rest_of(task), task.plant.tip_unit)} or less in the scenarios"


def window_words(window: float) -> str:
    """A residual window [s], as "within 1.205 s" of the arrival."""
    return f"within {window:.4g} s"


def residual_place(task: PointToPoint) -> str:
    """Say where and when a residual is measured: "at the tip within 1 s"."""
    tips = 1 if task.plant.tip_lines is not None else task.plant.tips  # one, by its distance
    scenarios = len(task.scenarios)
    words = "tip" if tips == 1 else f"worst of {tips} tips"
    words = words if scenarios == 1 else f"{words}, worst of {scenarios} scenarios"
    return f"at the {words} {window_words(task.residual_window)}"


def plant_words(plant: Plant) -> str:
    """A plant's name, with the parameters that differ from those of its class, of its own."""
    changed: list[str] = []
    units = plant.units()
    for entry in plant.parameter_fields():
        value = plant.parameters[entry.name]
        unit = units[entry.name]
        if value != entry.default:
            changed.append(f"{entry.name} = {value:.5g}{'' if unit == '-' else f' {unit}'}")
    return f"{plant.label} with {', '.join(changed)}" if changed else plant.label


def error_words(task: PointToPoint) -> str:
    """The ranges of the parameter errors of a task: "frequency +-10 %"; empty without any."""
    return ", ".join(f"{name} +-{100 * size:.3g} %" for name, size in task.ranges.items())


def signed_errors(errors: Mapping[str, float]) -> str:
    """Return relative errors by name, with their signs: "frequency -5 %"."""
    return ", ".join(f"{name} {100 * error:+.3g} %" for name, error in errors.items())


def moved(task: PointToPoint) -> str:
    """The plant of a task, and the ranges of its parameter errors."""
    return ", ".join(filter(None, [plant_words(task.plant), error_words(task)]))


def move_of(task: PointToPoint) -> str:
    """The move of a task: "0 to 30 deg in 0.8 s"; its energy where that is not the paper's."""
    ringing = ", ringing at the start" if task.initial else ""
    wanted = ", to a state other than rest" if task.final else ""
    return ", ".join([f"{task.ends} in {task.duration:g} s{ringing}{wanted}", *energy_words(task)])


def unit_of_way(plant: Plant) -> str:
    """Return the unit of a way: "rad" or "m" of a joint, "of the path" if joints follow one."""
    return "of the path" if plant.has_path else WAY.of(plant.joint)


def note_lines(plant: Plant) -> list[str]:
    """All notes on a plant, where no rows of figures are for them to stand beside."""
    return [f"warning: {note.words}" for note in plant.notes]


def state_words(state: ModalState, tip_unit: str) -> str:
    """Say what rings, in millimetres, "W 5 mm, W' -300 mm/s", or in rad for a tip that turns."""
    shown, factor = tip_scale(tip_unit)
    W = " and ".join(f"{factor * amplitude:.3g}" for amplitude in state.W)
    dW = " and ".join(f"{factor * rate:.3g}" for rate in state.dW)
    return f"W {W} {shown}, W' {dW} {shown}/s"


def energy_words(task: PointToPoint) -> list[str]:
    """Say what counts as energy, such as "energy copper:0.12"; nothing if that is the paper's."""
    return [] if task.energy == ABSOLUTE_POWER else [f"energy {task.energy.label}"]


def title_of(task: PointToPoint) -> str:
    """A task in a line: its plant and move; its limits where it has any."""
    return ", ".join([moved(task), move_of(task), *limit_words(task)])


def title_of_picture(task: PointToPoint) -> str:
    """Return a task's title without the limits of several joints: a line would not hold them."""
    several = len(task.plant.joint_names) > 1
    return ", ".join([moved(task), move_of(task)]) if several else title_of(task)


def objective_words(names: Sequence[str]) -> str:
    """Objectives as they are typed: residual, energy, peak-torque."""
    return ", ".join(names).replace("_", "-")


def values_words(objectives: Sequence[Objective], values: Iterable[float]) -> str:
    """A value of each objective: 5 mm, 0.04 J and 0.1 N m."""
    words = [
        tip_words(value, objective.unit)
        if objective.name == RESIDUAL
        else f"{value:.4g} {objective.unit}"
        for objective, value in zip(objectives, values)
    ]
    return f"{', '.join(words[:-1])} and {words[-1]}"


def corner_words(front: Front) -> str:
    """Return the corner up to which a front's hypervolume counts: 77.1 mm and 0.182 J."""
    if isinstance(front, FunctionFront):
        return values_of_function(front, front.reference)
    return values_words(objectives_on(front.task.plant, front.objectives), front.reference)


def values_of_function(front: FunctionFront, values: Iterable[float]) -> str:
    """Objectives with their names and units: residual 0.001 m, energy 0.05 J."""
    words = [
        f"{entry.label} {value:.4g} {entry.unit}".rstrip()
        for entry, value in zip(front.outputs, values)
    ]
    return ", ".join(words)


def limit_words(task: PointToPoint) -> list[str]:
    """The limits of a task, as "acceleration within 40 rad/s^2"."""
    return [f"{limit.label} within {limit.bounds}" for limit in task.limits]
