"""Motions as a picture: what the joint does, what the tip does, what the motor does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from quietarm.models.joint_motion import ROTARY, joint_label, joint_unit
from quietarm.ocp import Floor, Plan, evaluate_coefficients
from quietarm.ocp.limits import QUANTITIES, quantities_of
from quietarm.studies.figures.axes import (
    TITLE,
    axes_or_new,
    legend_below,
    legend_of,
    letter,
    new_figure,
)
from quietarm.studies.figures.looks import BLUE, GREY, RED, Dash, look
from quietarm.studies.report.words import raised, title_of

_SHOWN, _ABOVE = 0.99, 1.15
"""A panel with short pulses ends at this multiple of the 99 % quantile."""
_LETTERS = 48
"""Of a title, for each column of panels."""
_IN_SIGHT = 0.4
"""A limit is drawn where a motion comes to this share of it; else it would flatten the motion."""


_GIVE_MOTIONS = "give one motion or more, all of one duration"
QUANTITIES_DRAWN = ("angle", "speed", "acceleration", "jerk", "deflection", "torque", "power")
"""What can be drawn: the joint's angle, the quantities that a task may limit, and the power."""
_WHERE_LIMITED = ("jerk", "power")
"""These are no panels of a motion, but where a task limits them."""
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
        Any of matplotlib's; by default one of `COLOURS`, with dashes to match.
    style : str or tuple
        Its dashes, where there is a colour.
    """

    plan: Plan | Floor
    label: str
    colour: str = ""
    style: Dash = "-"


Motions = Sequence[Line] | Plan | Floor


def draw_quantity(motions: Motions, quantity: str, ax: Axes | None = None) -> Axes:
    """Draw one quantity of motions against time, with its limits and the moment of arrival.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        The motions, all of one duration; a plan alone is drawn over the plain cycloid of its
        task.
    quantity : str
        A name in `QUANTITIES_DRAWN`: angle, speed, acceleration, jerk, deflection, torque or power.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, titled with the quantity and its unit; every line has a label for a legend. A
        limit too far off to be drawn is named in the title.

    Raises
    ------
    ValueError
        When there is no motion, their durations differ, or there is no such quantity.
    """
    if quantity not in QUANTITIES_DRAWN:
        known = ", ".join(QUANTITIES_DRAWN)
        raise ValueError(f"no quantity is called {quantity!r}; give one of {known}")
    return draw_lines(_of_one_duration(motions), quantity, axes_or_new(ax))


def draw_lines(lines: Sequence[Line], quantity: str, ax: Axes) -> Axes:
    """`draw_quantity` of motions that may have several durations."""
    words, values = [heading(quantity, lines[0].plan.task.plant.joint)], list[NDArray[np.float64]]()
    for line in lines:
        values.append(np.column_stack(curves(line.plan, quantity)))
        for i, column in enumerate(values[-1].T):
            time = line.plan.trajectory.time
            ax.plot(time, column, color=line.colour, **_looks(line, i))
    for duration in {line.plan.task.duration for line in lines}:
        ax.axvline(duration, color="0.6", linewidth=0.8, linestyle="--")
    limits = [line.plan.task.limit_of(quantity) for line in lines]
    scale = _shown(quantity)[2]
    bounds = [(scale * one.lower, scale * one.upper) for one in limits if one is not None]
    words += _draw_limits(ax, bounds, values)
    words += _cut_off_pulses(ax, lines, values)
    ax.set_title(", ".join(words), **TITLE)
    ax.set_xlabel("time [s]  (dashed: arrival)")
    ax.margins(x=0)
    return ax


def curves(motion: Plan | Floor, quantity: str) -> list[NDArray[np.float64]]:
    """A quantity of a motion at the times of its trajectory, a curve each, in the shown unit."""
    at = motion.trajectory
    if quantity in QUANTITIES:
        columns = QUANTITIES[quantity].of(at.motion, list(at.tips.T), at.torque)
    else:
        columns = [at.joint[:, 0] if quantity == "angle" else at.power]
    return [_shown(quantity)[2] * np.asarray(column) for column in columns]


def heading(quantity: str, joint: str = ROTARY) -> str:
    """A quantity with the unit that is shown: tip displacement [mm]."""
    label, unit, _ = _shown(quantity, joint)
    return f"{label} [{raised(unit)}]"


def _shown(quantity: str, joint: str = ROTARY) -> tuple[str, str, float]:
    """Label, unit that is shown, and the factor to it."""
    if quantity in QUANTITIES:
        known = quantities_of(joint)[quantity]
        millimetres = known.unit == "m"
        return known.label, "mm" if millimetres else known.unit, 1e3 if millimetres else 1.0
    if quantity == "angle":
        return joint_label("joint angle", joint), joint_unit("rad", joint), 1.0
    return "power", "W", 1.0


def motion_figure(
    motions: Motions, title: str | None = None, quantities: Sequence[str] | None = None
) -> Figure:
    """Draw several quantities of motions, one panel for each.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        As for `draw_quantity`.
    title : str, optional
        Title of the picture; by default the plant, the move and its limits.
    quantities : sequence of str, optional
        Names in `QUANTITIES_DRAWN`; by default all but the power, and the jerk where it is limited.
        `PAPER_PANELS` are those of the paper.

    Returns
    -------
    matplotlib.figure.Figure
        The panels, lettered where there are several, with one legend.

    Raises
    ------
    ValueError
        As `draw_quantity`.
    """
    lines = _of_one_duration(motions)
    if quantities is None:
        limited = {limit.name for line in lines for limit in line.plan.task.limits}
        quantities = [
            name for name in QUANTITIES_DRAWN if name in limited or name not in _WHERE_LIMITED
        ]
    if not quantities:
        raise ValueError("no quantity is given to draw; name some, as ['torque']")
    count = len(quantities)
    columns = min(count, 2) if count <= 4 else 3
    rows = -(-count // columns)
    figure = new_figure(0.8 + 3.8 * columns, 0.8 + 2.6 * rows)
    axes: list[Axes] = list(figure.subplots(rows, columns, sharex=True, squeeze=False).flat)
    for quantity, ax in zip(quantities, axes, strict=False):
        draw_quantity(lines, quantity, ax).tick_params(labelbottom=True)
    for ax in axes[: max(0, count - columns)]:  # another stands below it
        ax.set_xlabel("")
    if count > 1:
        letter(axes[:count])
    spare = axes[count:]
    for ax in spare:
        ax.axis("off")
        ax.margins(x=0)  # time is shared
    if spare:
        spare[0].legend(*legend_of(axes[:count]), loc="center left", fontsize=10, frameon=False)
    else:
        legend_below(figure, axes, min(3, len(lines)), 9)
    title = title_of(lines[0].plan.task) if title is None else title
    if title:
        figure.suptitle(fill(title, _LETTERS * columns), fontsize=12)
    return figure


def floor_figure(floor: Floor, plan: Plan | None) -> Figure:
    """The panels of a floor, over the plan where there is one."""
    lines = [Line(floor, f"floor, {floor.energy:.4g} J", BLUE)]
    if plan is not None:
        label = f"plan of {plan.profile.size} terms, {plan.energy:.4g} J"
        lines.insert(0, Line(plan, label, RED, "--"))
    return motion_figure(lines)


def lines_of(motions: Motions) -> list[Line]:
    """The lines of a picture, each with a colour; ValueError where there is none."""
    if isinstance(motions, Plan):
        cycloid = evaluate_coefficients(motions.task, [])
        motions = [Line(cycloid, "plain cycloid", GREY), Line(motions, "this plan", BLUE)]
    elif isinstance(motions, Floor):
        motions = [Line(motions, f"floor, {motions.energy:.4g} J", BLUE)]
    if not motions:
        raise ValueError(_GIVE_MOTIONS)
    looks = [look(i) for i in range(len(motions))]
    return [
        line if line.colour else replace(line, colour=own.colour, style=own.dash)
        for line, own in zip(motions, looks, strict=True)
    ]


def _of_one_duration(motions: Motions) -> list[Line]:
    """`lines_of`; ValueError where their durations differ, too."""
    lines = lines_of(motions)
    if len({line.plan.task.duration for line in lines}) != 1:
        raise ValueError(_GIVE_MOTIONS)
    return lines


def _looks(line: Line, tip: int) -> dict[str, Any]:
    """Label and style of a tip: the line's own for its first one, thin for those of samples."""
    others = [s for s in (":", "-.", "--") if s != line.style]
    if tip == 0:
        return {"label": line.label, "linestyle": line.style, "linewidth": 1.6}
    style = others[(tip - 1) % len(others)]
    return {"label": f"{line.label}, tip {tip + 1}", "linestyle": style, "linewidth": 1.6}


def _draw_limits(
    ax: Axes, limits: Sequence[tuple[float, float]], values: Sequence[NDArray[np.float64]]
) -> list[str]:
    """Draw the limits that a motion comes near; the others in words."""
    every = np.concatenate([one.ravel() for one in values])
    words, label = list[str](), "limit"
    for lower, upper in sorted(set(limits)):
        near = [upper] * bool(every.max() >= _IN_SIGHT * upper)
        near += [lower] * bool(every.min() <= _IN_SIGHT * lower)
        for level in near:
            ax.axhline(level, color="black", linewidth=1.1, linestyle=":", label=label)
            label = "_"  # once in the legend
        bounds = f"{upper:g}" if lower == -upper else f"{lower:g} to {upper:g}"
        words += [] if near else [f"limit {bounds} far off"]
    return words


def _cut_off_pulses(
    ax: Axes, lines: Sequence[Line], values: Sequence[NDArray[np.float64]]
) -> list[str]:
    """Cut off a floor's short pulses, a thousand times all other values, and say so in words."""
    if not any(isinstance(line.plan, Floor) for line in lines):
        return []
    peaks, usual = [0.0], [0.0]
    for line, drawn in zip(lines, values, strict=True):
        time = line.plan.trajectory.time
        moving = time <= line.plan.task.duration  # at rest afterwards, nothing is usual
        sizes = np.abs(drawn).max(axis=1)[moving]
        held, order = np.gradient(time)[moving], np.argsort(sizes)
        most_of_the_time = np.searchsorted(np.cumsum(held[order]), _SHOWN * held.sum())
        peaks.append(float(sizes.max()))
        usual.append(float(sizes[order][min(most_of_the_time, len(order) - 1)]))
    highest = _ABOVE * max(usual)
    if max(peaks) <= highest:
        return []
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -highest), min(high, highest))
    return ["pulses cut off"]
