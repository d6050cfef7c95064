"""Motions as a picture: what the joint does, what the tip does, what the motor does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from quietarm.ocp import Floor, Plan, Trajectory, evaluate_coefficients
from quietarm.ocp.robustness.uncertain import assumed_plant
from quietarm.ocp.task.quantities import QUANTITIES
from quietarm.studies.display.words import error_words, title_of
from quietarm.studies.figures.axes import TITLE, axes_or_new, legend_of, new_figure
from quietarm.studies.figures.looks import BLUE, GREY, RED, Dash, look

_SHOWN, _ABOVE = 0.99, 1.15
"""A panel with jolts ends at this multiple of the 99 % quantile."""
_IN_SIGHT = 0.4
"""A limit is drawn where a motion comes to this share of it; else it would flatten the motion."""


_GIVE_MOTIONS = "give one motion or more, all of one duration"
_ANGLE, _JERK = "angle", "jerk"
_IN_MILLIMETRES = {"m": ("mm", 1e3)}
"""Units that pictures replace by others, with the factor."""
QUANTITIES_DRAWN = (_ANGLE, "speed", "acceleration", _JERK, "deflection", "torque")
"""What can be drawn: the joint's angle, and the quantities that a task may limit."""
PAPER_PANELS = (_ANGLE, "speed", "deflection", "torque")
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
        A name in `QUANTITIES_DRAWN`: angle, speed, acceleration, jerk, deflection or torque.
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
    lines, (name, unit, scale) = _of_one_duration(motions), _name_and_unit(quantity)
    ax = axes_or_new(ax)
    for line in lines:
        sampled = line.plan.trajectory
        for i, column in enumerate(_values(quantity, sampled).T):
            ax.plot(sampled.time, column, color=line.colour, **_looks(line, i))
    ax.axvline(lines[0].plan.task.duration, color="0.6", linewidth=0.8, linestyle="--")
    words = [f"{name} [{unit}]", *_draw_limits(ax, quantity, scale, lines)]
    words += _leave_out_jolts(ax, quantity, lines)
    ax.set_title(", ".join(words), **TITLE)
    ax.set_xlabel("time [s]  (dashed: arrival)")
    ax.margins(x=0)
    return ax


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
        Names in `QUANTITIES_DRAWN`; by default all, but the jerk only where a task limits it.
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
    quantities = _panels_of(lines) if quantities is None else quantities
    if not quantities:
        raise ValueError("no quantity is given to draw; name some, as ['torque']")
    count = len(quantities)
    columns = min(count, 2) if count <= 4 else 3
    rows = -(-count // columns)
    figure = new_figure(1.0 + 4.4 * columns, 0.8 + 2.9 * rows)
    axes: list[Axes] = list(figure.subplots(rows, columns, sharex=True, squeeze=False).flat)
    for i, quantity in enumerate(quantities):
        ax = draw_quantity(lines, quantity, axes[i])
        if count > 1:
            ax.set_title(f"({'abcdefghi'[i]}) {ax.get_title(loc='left')}", **TITLE)
        ax.tick_params(labelbottom=True)
        if i + columns < count:  # another stands below it
            ax.set_xlabel("")
    spare = axes[count:]
    for ax in spare:
        ax.axis("off")
        ax.margins(x=0)  # time is shared
    if spare:
        spare[0].legend(*legend_of(axes[:count]), loc="center left", fontsize=10, frameon=False)
    else:
        figure.legend(
            *legend_of(axes),
            loc="outside lower center",
            ncols=min(3, len(lines)),
            fontsize=9,
            frameon=False,
        )
    title = title_of(lines[0].plan.task) if title is None else title
    if title:
        figure.suptitle(title, fontsize=12)
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


def _panels_of(lines: Sequence[Line]) -> list[str]:
    """What is drawn by default: all, but the jerk only where a task limits it."""
    jerk = any(_JERK in line.plan.task.limits for line in lines)
    return [name for name in QUANTITIES_DRAWN if jerk or name != _JERK]


def _name_and_unit(quantity: str) -> tuple[str, str, float]:
    """What a quantity is called, the unit it is drawn in, and that unit for one of SI."""
    if quantity == _ANGLE:
        return "joint angle", "rad", 1.0
    drawn = QUANTITIES[quantity]
    unit, scale = _IN_MILLIMETRES.get(drawn.unit, (drawn.unit, 1.0))
    return drawn.label, unit, scale


def _values(quantity: str, sampled: Trajectory) -> NDArray[np.float64]:
    """A quantity of a motion as it is drawn, shape (samples, lines)."""
    if quantity == _ANGLE:
        return sampled.joint[:, :1]
    columns = QUANTITIES[quantity].of(sampled.motion, list(sampled.tips.T), sampled.torque)
    _, _, scale = _name_and_unit(quantity)
    return scale * np.column_stack(columns)


def _looks(line: Line, tip: int) -> dict[str, Any]:
    """Label and style of a tip: the line's own for its first one, thin for those of samples."""
    plant, others = line.plan.task.plant, [s for s in (":", "-.", "--") if s != line.style]
    own = assumed_plant(plant).tips
    if tip >= own:
        label = f"{line.label}, {error_words(plant)}" if tip == own else "_"
        return {"label": label, "linestyle": line.style, "linewidth": 0.6, "alpha": 0.6}
    if tip == 0:
        return {"label": line.label, "linestyle": line.style, "linewidth": 1.6}
    style = others[(tip - 1) % len(others)]
    return {"label": f"{line.label}, tip {tip + 1}", "linestyle": style, "linewidth": 1.6}


def _draw_limits(ax: Axes, quantity: str, scale: float, lines: Sequence[Line]) -> list[str]:
    """Draw the limits that a motion comes near; the others in words."""
    values = np.concatenate([_values(quantity, line.plan.trajectory).ravel() for line in lines])
    every = [line.plan.task.limits.get(quantity) for line in lines]
    words, label = list[str](), "limit"
    for limit in sorted({scale * limit for limit in every if limit is not None}):
        sides = [side for side in (1, -1) if (side * values).max() >= _IN_SIGHT * limit]
        for side in sides:
            ax.axhline(side * limit, color="black", linewidth=1.1, linestyle=":", label=label)
            label = "_"  # once in the legend
        words += [] if sides else [f"limit {limit:g} far off"]
    return words


def _leave_out_jolts(ax: Axes, quantity: str, lines: Sequence[Line]) -> list[str]:
    """Cut off a floor's jolts, a thousand times the rest for a moment, and say so in words."""
    peaks, usual = [0.0], [0.0]
    for line in lines:
        time = line.plan.trajectory.time
        moving = time <= line.plan.task.duration  # at rest afterwards, nothing is usual
        sizes = np.abs(_values(quantity, line.plan.trajectory)).max(axis=1)[moving]
        held, order = np.gradient(time)[moving], np.argsort(sizes)
        most_of_the_time = np.searchsorted(np.cumsum(held[order]), _SHOWN * held.sum())
        peaks.append(float(sizes.max()))
        usual.append(float(sizes[order][min(most_of_the_time, len(order) - 1)]))
    highest = _ABOVE * max(usual)
    if max(peaks) <= highest or not any(isinstance(line.plan, Floor) for line in lines):
        return []
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -highest), min(high, highest))
    return ["jolts left out"]
