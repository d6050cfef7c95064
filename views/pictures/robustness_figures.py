"""Residuals under parameter errors: over one error, and each motion's energy over its residual."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from quietarm.interrupts import interruptible
from quietarm.ocp import Robustness
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.rest import REST, rest_of
from quietarm.views.pictures.axes import (
    axes_or_new,
    logarithmic,
    name_objectives,
    residual_label,
    side_by_side,
)
from quietarm.views.pictures.grammar import LIMIT, looks
from quietarm.views.pictures.named_ends import NamedEnd, name_right
from quietarm.views.report.captions import caption_of_judged
from quietarm.views.tips import tip_scale

if TYPE_CHECKING:
    from quietarm.studies.compare.compared_motions import ComparedMotion


@interruptible
def draw_robustness(
    plans: Mapping[str, Robustness],
    name: str,
    ax: Axes | None = None,
    meanings: Sequence[str] | None = None,
) -> Axes:
    """Draw residuals over the errors of one parameter.

    Parameters
    ----------
    plans : mapping of str to Robustness
        The robustness of each plan by its name in the legend.
    name : str
        The error: ``"frequency"``, ``"damping"`` or a parameter; each plan has a sweep of it.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    meanings : sequence of str, optional
        What each of the plans is in the grammar of pictures, as ``"robust plan"``; by default what
        its name says.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: residual, in per cent of the plain cycloid's on the nominal plant, against the
        error [%]; where a curve first exceeds 5 %, it is marked.
    """
    ax = axes_or_new(ax)
    limit = 100 * TOLERATED
    for (label, plan), how in zip(plans.items(), looks(meanings or list(plans))):
        (sweep,) = [candidate for candidate in plan.sweeps if candidate.name == name]
        per_cent = 100 / plan.cycloid if plan.cycloid > 0 else 0.0  # a joint that moves no mode
        ax.plot(
            100 * sweep.errors, per_cent * sweep.figures.residual, color=how.colour,
            linestyle=how.dash, linewidth=how.width, label=label,
        )  # fmt: skip
        if sweep.insensitivity is not None:
            both = zip(sweep.insensitivity, sweep.open_ends)
            ends = [100 * end for end, is_open in both if not is_open]
            ax.plot(ends, [limit] * len(ends), how.mark, color=how.colour, markersize=5)
    ax.axhline(limit, color=LIMIT.colour, linewidth=LIMIT.width, linestyle=LIMIT.dash,
               label=f"{limit:g} %")  # fmt: skip
    ax.set(xlabel=f"error of {name} [%]", ylabel="residual [% of the plain cycloid's]")
    ax.set_ylim(bottom=0)
    ax.margins(x=0)
    return ax


@interruptible
def draw_motions(
    motions: Sequence[ComparedMotion], ax: Axes | None = None, tip_unit: str = "m"
) -> Axes:
    """Draw the energy of motions over their residual: open nominal, filled in the worst case.

    Parameters
    ----------
    motions : sequence of ComparedMotion
        Those that there are are drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    tip_unit : str
        Unit of the plant's tips, m or rad.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, residuals logarithmic; each motion has a label for a legend.
    """
    ax = axes_or_new(ax)
    least = REST
    for judged, how in zip(motions, looks([judged.meaning for judged in motions])):
        if judged.motion is None:
            continue
        energy = judged.motion.energy
        worst = judged.motion.residual if judged.worst is None else judged.worst.residual
        scale = tip_scale(tip_unit)[1]
        rest = rest_of(judged.task)
        least = min(least, rest)
        ends = [scale * max(residual, rest) for residual in (judged.motion.residual, worst)]
        line: dict[str, Any] = {"color": how.colour, "marker": how.mark, "markersize": 5}
        ax.plot(ends[0], energy, fillstyle="none", **line)
        ax.plot(ends, [energy] * 2, linestyle=how.dash, linewidth=1, label=judged.name,
                markevery=[1], **line)  # fmt: skip
    logarithmic(ax, [least, 1.0])
    name_objectives(ax, tip_unit, _window(motions))
    return ax


def _window(motions: Sequence[ComparedMotion]) -> float | None:
    """The residual window of motions that are judged together [s]."""
    return next((judged.window for judged in motions if judged.window is not None), None)


@interruptible
def motions_figure(motions: Sequence[ComparedMotion], title: str, tip_unit: str = "m") -> Figure:
    """Draw motions over each other: `draw_motions`, and `draw_robustness` for each error."""
    curves = {motion.name: motion.robustness for motion in motions if motion.robustness is not None}
    meanings = [motion.meaning for motion in motions if motion.robustness is not None]
    names = list(next(iter(curves.values())).ranges) if curves else []
    caption = caption_of_judged(motions)
    figure, axes = side_by_side(1 + len(names), caption, title, width=6.0)
    draw_motions(motions, axes[0], tip_unit)
    if any(judged.worst for judged in motions):
        label = residual_label(tip_unit, _window(motions))
        axes[0].set_xlabel(f"{label} (open: nominal plant, filled: worst case)")
    for name, ax in zip(names, axes[1:]):
        draw_robustness(curves, name, ax, meanings)
        words = f"{100 * TOLERATED:g} %"
        ax.annotate(words, (0.01, 100 * TOLERATED), (0, 3), color=LIMIT.colour, fontsize=8,
                    xycoords=("axes fraction", "data"), textcoords="offset points",
                    bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})  # fmt: skip
    for ax in axes:
        _name_lines(ax)
    return figure


def _name_lines(ax: Axes) -> None:
    """Write the name of each line right of the axes, beside where it ends."""
    limits = {f"{100 * TOLERATED:g} %"}
    lines = [
        line
        for line in ax.get_lines()
        if not str(line.get_label()).startswith("_") and line.get_label() not in limits
    ]
    ends = [
        NamedEnd(
            float(np.asarray(line.get_xdata())[-1]),
            float(np.asarray(line.get_ydata())[-1]),
            str(line.get_label()),
            to_hex(line.get_color()),
        )
        for line in lines
    ]
    name_right(ends, ax)
