"""Motions as a picture: what the joint does, what the tip does, what the motor does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecFromSubplotSpec
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.models import Plant
from quietarm.models.dimensions import WATT, WAY, Unit, Words
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import Floor, Plan, evaluate_coefficients
from quietarm.ocp.checks import instance, takes, unknown
from quietarm.ocp.limits import QUANTITIES, Shares, units_of_joints
from quietarm.views.pictures.axes import (
    TITLE,
    axes_or_new,
    broken_into_lines,
    head,
    legend_below,
    legend_of,
    letter,
    new_figure,
)
from quietarm.views.pictures.grammar import AFTER_ARRIVAL, ARRIVAL, LIMIT, PLAN, Dash, Look, looks
from quietarm.views.pictures.meaning import is_plain_cycloid, meaning_of
from quietarm.views.pictures.panel import Panel, known_panels
from quietarm.views.report.captions import caption_of_motions, verified_words
from quietarm.views.report.words import raised, title_of_picture
from quietarm.views.tips import tip_scale

Array = NDArray[np.float64]
_SHOWN = 0.99
_ABOVE = 1.15
"""A panel with short pulses ends at this multiple of the 99 % quantile over time."""
_PANEL_OF_JOINT = 1.9
_NUMBERS = 0.45
_BESIDE_JOINTS = 0.7
"""Width of a panel of a joint, of its numbers and beside all panels [inch]: of five quantities
the picture is 10.2 inches wide; in a page of 736 pixels its letters of 9 points are 9 high."""
_BESIDE_QUANTITIES: Mapping[str, tuple[Words, Unit]] = {
    "angle": (Words("joint angle", "joint position"), WAY),
    "power": (Words("power"), WATT),
}
"""What is drawn that a task does not limit."""
PAPER_PANELS = ("angle", "speed", "deflection", "torque")
"""The panels of the paper's Figs 2 and 5, in their order."""


@dataclass(frozen=True)
class Line:
    """One motion in a picture.

    Parameters
    ----------
    plan : Plan or Floor
        The motion.
    label : str
        What the legend calls it.
    colour : str, optional
        Any of matplotlib's; by default that of what the motion is, with dashes to match: a plan,
        the plain cycloid, a robust plan, a floor.
    style : str or tuple
        Its dashes, where there is a colour.
    """

    example: ClassVar[str] = "a line, such as Line(plan, 'plan')"

    plan: Plan | Floor
    label: str
    colour: str = ""
    style: Dash = "-"

    def __post_init__(self) -> None:
        instance("plan", self.plan, Plan, Floor)


Motions = Sequence[Line] | Plan | Floor


@interruptible
def drawn_quantities() -> tuple[str, ...]:
    """Name what can be drawn: the joint's angle, quantities that a task may limit, the power."""
    return ("angle", *sorted(QUANTITIES, key=lambda name: QUANTITIES[name].panel), "power")


def _is_always_drawn(name: str) -> bool:
    """Return whether a quantity is a panel of every motion; others are where a task limits them."""
    return QUANTITIES[name].always_drawn if name in QUANTITIES else name == "angle"


def _words_and_unit(quantity: str) -> tuple[Words, Unit]:
    if quantity in _BESIDE_QUANTITIES:
        return _BESIDE_QUANTITIES[quantity]
    return QUANTITIES[quantity].label, QUANTITIES[quantity].unit


@interruptible
def draw_quantity(
    motions: Motions, quantity: str, ax: Axes | None = None, *, curve: int | None = None
) -> Axes:
    """Draw one quantity of motions against time, with its limits until the arrival.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        The motions; a plan alone is drawn over the plain cycloid of its task.
    quantity : str
        A name of `drawn_quantities`: angle, speed, acceleration, jerk, deflection, torque or power;
        or that of a `Panel` of one's own.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    curve : int, optional
        The joint or the tip by its number from 0; by default all of them.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, titled with the quantity and its unit; every line has a label for a legend. Limits
        that no motion comes near are left out.

    Raises
    ------
    ValueError
        When there is no motion, or the quantity is not known.
    """
    if quantity not in (drawn := _drawn()):
        raise ValueError(unknown("quantity", quantity, drawn))
    return _draw(lines_of(motions), quantity, axes_or_new(ax), curve)


def _drawn() -> list[str]:
    """Name what can be drawn, with the user's own panels."""
    return [*drawn_quantities(), *known_panels(drawn_quantities())]


def draw_briefly(motions: Motions, quantity: str, ax: Axes) -> Axes:
    """Draw a quantity as `draw_quantity`, of a tip that moves in space its distance alone."""
    return _draw(lines_of(motions), quantity, axes_or_new(ax), is_short=True)


def _draw(
    lines: Sequence[Line],
    quantity: str,
    ax: Axes,
    curve: int | None = None,
    is_short: bool = False,
) -> Axes:
    """Draw all curves of a quantity, or the one of a joint or a tip by its number."""
    curves_of = short_curves if is_short else curves
    if quantity not in drawn_quantities():
        return _draw_own(lines, known_panels(drawn_quantities())[quantity], ax)
    plant = lines[0].plan.task.plant
    drawn = list[Array]()
    title = short_heading(plant, quantity) if is_short else heading_of_plant(plant, quantity, curve)
    for line in lines:
        other_styles = _other_styles(line)
        for i, values in enumerate(curves_of(line.plan, quantity)):
            if curve not in (None, i):
                continue
            alone = i == 0 or curve is not None
            style = line.style if alone else other_styles[(i - 1) % len(other_styles)]
            of = "" if curve is not None else _which(line.plan.task.plant, quantity, i)
            label = line.label + of
            drawn.append(values)
            _draw_curve(ax, line, values, style, label)
    durations = _draw_arrivals(ax, lines)
    without_limit = is_short and is_distance(plant, quantity)
    values_drawn = np.concatenate(drawn)
    limits = [] if without_limit else limits_in_sight(lines, quantity, values_drawn, curve)
    for k, level in enumerate(limits):
        label = "_" if k else "limit"  # once in the legend
        # a limit holds on the way, not for what comes after it
        ax.plot([0.0, max(durations)], [level, level], color=LIMIT.colour, linewidth=LIMIT.width,
                linestyle=LIMIT.dash, label=label)  # fmt: skip
    if _cut_off_pulses(ax, lines, quantity, curve):
        title += ", pulses cut off"
    return _named_over_time(ax, title)


def _draw_own(lines: Sequence[Line], panel: Panel, ax: Axes) -> Axes:
    """Draw a panel of the user's own."""
    for line in lines:
        styles = [line.style, *_other_styles(line)]
        for i, (name, values) in enumerate(panel.curves(line.plan).items()):
            label = f"{line.label}, {name}" if name else line.label
            _draw_curve(ax, line, values, styles[i % len(styles)], label)
    _draw_arrivals(ax, lines)
    return _named_over_time(ax, panel.title)


def _other_styles(line: Line) -> list[Dash]:
    """Dashes of the further curves of a motion."""
    further: tuple[Dash, ...] = ("-.", "--", (0, (5, 1, 1, 1, 1, 1)))  # none dotted, as a limit is
    return [style for style in further if style != line.style]


def _draw_arrivals(ax: Axes, lines: Sequence[Line]) -> set[float]:
    """Draw when motions arrive; their durations [s]."""
    durations = {line.plan.task.duration for line in lines}
    for duration in durations:
        draw_arrival(ax, duration)
    return durations


def _named_over_time(ax: Axes, title: str) -> Axes:
    ax.set_title(title, **TITLE)
    ax.set_xlabel("time [s]  (dashed: arrival)")
    ax.margins(x=0)
    return ax


def _draw_curve(ax: Axes, line: Line, values: Array, style: Dash, label: str) -> None:
    """Draw a quantity over time, lighter after arrival."""
    time = line.plan.trajectory.time
    after = int(np.searchsorted(time, line.plan.task.duration))
    width = PLAN.width
    ax.plot(time[: after + 1], values[: after + 1], color=line.colour, linestyle=style,
            linewidth=width, label=label)  # fmt: skip
    ax.plot(time[after:], values[after:], color=line.colour, linestyle=style,
            linewidth=width, alpha=AFTER_ARRIVAL, label="_")  # fmt: skip


def draw_arrival(ax: Axes, duration: float) -> None:
    """Draw the moment of arrival [s], a thin dashed line."""
    ax.axvline(duration, color=ARRIVAL.colour, linewidth=ARRIVAL.width, linestyle=ARRIVAL.dash)


def curves(motion: Plan | Floor, quantity: str) -> list[Array]:
    """A quantity of a motion at the times of its trajectory, a curve each, in the shown unit."""
    at = motion.trajectory
    if quantity in QUANTITIES:
        columns = QUANTITIES[quantity].values(at.sample)
    else:
        angles = [joint.angle for joint in at.sample.joints]
        columns = angles if quantity == "angle" else [at.power]
    scale = scale_of(quantity, motion.task.plant.tip_unit)
    return [scale * np.asarray(column) for column in columns]


def short_curves(motion: Plan | Floor, quantity: str) -> list[Array]:
    """The curves of a quantity; of a tip that moves in space one, its distance from rest."""
    lines = curves(motion, quantity)
    across = motion.task.plant.tip_lines
    if across is None or not is_distance(motion.task.plant, quantity):
        return lines
    return [np.abs(across @ np.array(lines)).max(axis=0)]


def is_distance(plant: Plant, quantity: str) -> bool:
    """Return whether the short curve of a quantity is the distance of a tip in space.

    Peaks and limits are of its displacement along each axis, which may be smaller.
    """
    return quantity == "deflection" and plant.tip_lines is not None


def short_heading(plant: Plant, quantity: str) -> str:
    """Return the heading of a quantity's short curves: tip's distance from rest [mm]."""
    of_axes = heading_of_plant(plant, quantity)
    if not is_distance(plant, quantity):
        return of_axes
    return of_axes.replace(QUANTITIES[quantity].label.of(plant.joint), "tip's distance from rest")


def names_of_curves(plant: Plant, quantity: str) -> list[str]:
    """The joint, or the tip, that each of several curves of a quantity is of."""
    if quantity in QUANTITIES and QUANTITIES[quantity].of_joints:
        units = units_of_joints(quantity, plant)
        several = len(set(units.values())) > 1
        return [f"{joint} [{raised(unit)}]" if several else joint for joint, unit in units.items()]
    return [_which_tip(plant, curve).removeprefix(", ") for curve in range(len(plant.tip_names))]


def _which(plant: Plant, quantity: str, curve: int) -> str:
    """Say which joint or tip a curve is of, where there are several."""
    joints = plant.joint_names
    if len(joints) > 1 and _is_of_joints(quantity):
        return f", {joints[curve]}"
    return _which_tip(plant, curve) if curve else ""


def _which_tip(plant: Plant, curve: int) -> str:
    """Say which of several tips, or the axis along which a tip moves that moves in space."""
    place = plant.tip_names[curve].removeprefix("tip_")
    if plant.tip_lines is None:
        return f", tip {place}"
    return f", along {place}" if place.isalpha() else f", direction {place}"


def heading(quantity: str, joint: str = ROTARY, tip_unit: str = "m") -> str:
    """A quantity with the unit that is shown: tip displacement [mm]."""
    label, unit = _words_and_unit(quantity)
    shown = tip_scale(tip_unit)[0] if unit.is_tip_way else raised(unit.of(joint, tip_unit))
    return f"{label.of(joint)} [{shown}]"


def heading_of_plant(plant: Plant, quantity: str, curve: int | None = None) -> str:
    """Return the heading of a plant's quantity: of all its joints, or of one by its number."""
    kind = plant.joint if curve is None or not _is_of_joints(quantity) else plant.joint_kinds[curve]
    return heading(quantity, kind, plant.tip_unit)


def scale_of(quantity: str, tip_unit: str = "m") -> float:
    """Return the factor from the quantity's unit to the one that is shown."""
    return tip_scale(tip_unit)[1] if _words_and_unit(quantity)[1].is_tip_way else 1.0


@interruptible
def motion_figure(
    motions: Motions, title: str | None = None, quantities: Sequence[str] | None = None
) -> Figure:
    """Draw several quantities of motions, one panel for each.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        As for `draw_quantity`.
    title : str, optional
        Title of the picture; by default what the motions take and leave, how that is verified, and
        of which plant, move and limits.
    quantities : sequence of str, optional
        Names of `drawn_quantities`; by default all but the power, the jerk where it is limited, and
        every `Panel` of one's own.
        `PAPER_PANELS` are those of the paper.

    Returns
    -------
    matplotlib.figure.Figure
        The panels, lettered where there are several, with one legend. Several joints stand above
        each other, a row each, and the tips below them.

    Raises
    ------
    ValueError
        As `draw_quantity`.
    """
    lines = lines_of(motions)
    if quantities is None:
        limited = {limit.name for line in lines for limit in line.plan.task.limits}
        quantities = [
            name for name in drawn_quantities() if name in limited or _is_always_drawn(name)
        ]
        own = known_panels(drawn_quantities())
        plans = [line.plan for line in lines]
        quantities += [name for name, panel in own.items() if all(map(panel.fits, plans))]
    if len(lines[0].plan.task.plant.joint_names) > 1 and len(quantities) > 1:
        return _figure_of_joints(lines, title, quantities)
    count = len(quantities)
    columns = min(count, 2) if count <= 4 else 3
    rows = -(-count // columns)
    figure = new_figure(0.8 + 3.8 * columns, 0.8 + 2.6 * rows)
    axes: list[Axes] = list(figure.subplots(rows, columns, sharex=True, squeeze=False).flat)
    panels = axes[:count]
    spare = axes[count:]
    for quantity, ax in zip(quantities, panels):
        draw_quantity(lines, quantity, ax).tick_params(labelbottom=True)
    for ax in panels[:-columns]:  # another stands below it, which says what is dashed
        ax.set_xlabel("time [s]")
    if count > 1:
        letter(panels)
    for ax in spare:
        ax.axis("off")
        ax.margins(x=0)  # time is shared
    for ax in spare[1:]:
        ax.remove()
    if spare:
        spare[0].legend(*legend_of(panels), loc="center left", fontsize=10, frameon=False)
    else:
        legend_below(figure, axes, min(3, len(lines)), 9)
    _head(figure, lines, title)
    return figure


def _head(figure: Figure, lines: Sequence[Line], title: str | None) -> None:
    """Set a picture's title: by default what the motions take and leave, and of which move."""
    if title is not None:
        head(figure, title)
        return
    motions = {line.label: line.plan for line in lines}
    facts = f"{title_of_picture(lines[0].plan.task)}; {verified_words([*motions.values()])}"
    head(figure, caption_of_motions(motions), facts)


def _figure_of_joints(
    lines: Sequence[Line], title: str | None, quantities: Sequence[str]
) -> Figure:
    """A row for each joint with what it does, and below them the tips, the power, the legend."""
    task = lines[0].plan.task
    names = task.plant.joint_names
    of_joints = [name for name in quantities if _is_of_joints(name)]
    others = [name for name in quantities if name not in of_joints]
    below = [(name, curve) for name in others for curve in _panels_below(lines[0].plan, name)]
    figure = new_figure(_BESIDE_JOINTS + _PANEL_OF_JOINT * max(len(of_joints), 3), 3.2 + len(names))
    grid = figure.add_gridspec(2, 1, height_ratios=(len(names), 1.7))
    upper = grid[0].subgridspec(len(names), max(len(of_joints), 1))
    axes = _panels_of_joints(figure, upper, lines, of_joints) if of_joints else []
    lower = grid[1].subgridspec(1, len(below) + 1)  # the last one is the legend's
    last = list[Axes]()
    for place, (quantity, curve) in enumerate(below):
        ax = _draw(lines, quantity, axes_or_new(figure.add_subplot(lower[place])), curve)
        if sum(name == quantity for name, _ in below) > 1:
            ax.set_title(ax.get_title(loc="left") + _which_tip(task.plant, curve), **TITLE)
        last.append(ax)
    room = figure.add_subplot(lower[len(below)])
    room.axis("off")
    room.legend(*legend_of([*axes, *last]), loc="center left", fontsize=10, frameon=False)
    _head(figure, lines, title)
    return figure


def _is_of_joints(quantity: str) -> bool:
    """Return whether a quantity has a curve for each joint."""
    return quantity == "angle" or (quantity in QUANTITIES and QUANTITIES[quantity].of_joints)


def _panels_below(plan: Plan | Floor, quantity: str) -> range:
    """The curves that have a panel each below the joints': of a panel of one's own all have one."""
    return range(len(curves(plan, quantity)) if quantity in drawn_quantities() else 1)


def _panels_of_joints(
    figure: Figure, grid: GridSpecFromSubplotSpec, lines: Sequence[Line], quantities: Sequence[str]
) -> list[Axes]:
    """A row for each joint, whose name stands beside it, and a column for each quantity."""
    plant = lines[0].plan.task.plant
    names = plant.joint_names
    kinds = plant.joint_kinds
    panels = grid.subplots(sharex=True, squeeze=False)
    for joint, (name, row) in enumerate(zip(names, panels)):
        for quantity, ax in zip(quantities, row):
            _draw(lines, quantity, axes_or_new(ax), joint)
            title = ax.get_title(loc="left")
            ax.set_title(broken_into_lines(title, _PANEL_OF_JOINT - _NUMBERS, 10), **TITLE)
            ax.set_xlabel(ax.get_xlabel().replace("  ", "\n"))
            if joint and kinds[joint] == kinds[joint - 1]:  # the panel above says what it is
                ax.set_title("", loc="left")
            if joint < len(names) - 1:
                ax.set_xlabel("")
        row[0].set_ylabel(_in_two_lines(name), fontsize=9)
    return list(panels.flat)


def _in_two_lines(name: str) -> str:
    """A joint's name beside its panels, broken near its middle."""
    words = name.split("_")
    half = -(-len(words) // 2)
    return "\n".join(filter(None, ["_".join(words[:half]), "_".join(words[half:])]))


@takes(floor=Floor, plan=Plan)
def floor_figure(floor: Floor, plan: Plan | None) -> Figure:
    """The panels of a floor, over the plan where there is one."""
    lines = [Line(floor, "floor")]
    if plan is not None:
        lines.insert(0, Line(plan, f"plan of {plan.profile.size} terms"))
    return motion_figure(lines)


def lines_of(motions: Motions) -> list[Line]:
    """The lines of a picture, each with a colour; ValueError where there is none."""
    if isinstance(motions, Plan):
        motions = _beside_the_cycloid(motions)
    elif isinstance(motions, Floor):
        motions = [Line(motions, "floor")]
    if not isinstance(motions, Sequence) or isinstance(motions, str):
        instance("motions", motions, Plan)  # which is what was meant
    if not motions:
        raise ValueError("no motion is given; give one or more")
    for i, line in enumerate(motions, start=1):
        instance(f"motion {i}", line, Line)
    of_meaning = iter(looks([meaning_of(line.plan) for line in motions if not line.colour]))
    return [line if line.colour else _as(line, next(of_meaning)) for line in motions]


def _beside_the_cycloid(plan: Plan) -> list[Line]:
    """A plan over the plain cycloid of its task; of that cycloid itself no second one."""
    if is_plain_cycloid(plan):
        return [Line(plan, "plain cycloid")]
    return [Line(evaluate_coefficients(plan.task, []), "plain cycloid"), Line(plan, "this plan")]


def _as(line: Line, look: Look) -> Line:
    return replace(line, colour=look.colour, style=look.dash)


def limits_in_sight(
    lines: Sequence[Line], quantity: str, values: Array, curve: int | None = None
) -> list[float]:
    """The limits of a quantity that its values come near, in the unit that is shown.

    Of limits by joint those of all, or of the joint of a curve.
    """
    # a limit is drawn where a motion comes to this share of it; else it would flatten the motion
    in_sight = 0.4
    limits = [line.plan.task.limit_of(quantity) for line in lines]
    scale = scale_of(quantity, lines[0].plan.task.plant.tip_unit)
    bounds = set[float]()
    for limit in limits:
        if limit is not None and isinstance(limit.quantity.values, Shares):
            by_joint = [
                bound for bound in limit.quantity.values.bounds if curve in (None, bound.place)
            ]
            bounds |= {level for bound in by_joint for level in (bound.lower, bound.upper)}
        elif limit is not None:
            bounds |= {limit.lower, limit.upper}
    return [
        level for level in sorted(scale * bound for bound in bounds)
        if (values * np.sign(level)).max() >= in_sight * abs(level)
    ]  # fmt: skip


def _cut_off_pulses(
    ax: Axes, lines: Sequence[Line], quantity: str, curve: int | None = None
) -> bool:
    """Cut off a floor's short pulses, a thousand times all other values; whether there are some."""
    if not any(isinstance(line.plan, Floor) for line in lines):
        return False
    peak = usual = 0.0
    for line in lines:
        evenly = np.linspace(0.0, line.plan.task.duration, 2001)
        shown = curves(line.plan, quantity)
        for values in np.abs(shown if curve is None else [shown[curve]]):
            on_the_way = np.interp(evenly, line.plan.trajectory.time, values)
            peak = max(peak, float(values.max()))
            usual = max(usual, float(np.quantile(on_the_way, _SHOWN)))
    highest = _ABOVE * usual
    if peak <= highest:
        return False
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -highest), min(high, highest))
    return True
