"""The gradient's fronts as a picture: what was found, what failed, what polish gained."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from quietarm.ocp import Front, Polish
from quietarm.ocp.front.curve import RESIDUAL_LIMIT
from quietarm.studies.figures.axes import (
    axes_or_new,
    draw_front,
    name_objectives,
    scale_residuals,
    side_by_side,
)
from quietarm.studies.figures.looks import BLUE, ORANGE, RED
from quietarm.studies.registry.methods import method_of
from quietarm.studies.report.words import millimetres, title_of


def draw_sweep(front: Front, ax: Axes | None = None) -> Axes:
    """Draw a front by gradient, the limits that failed, and the gaps that no weight reaches.

    Parameters
    ----------
    front : Front
        The front, with a point at least.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, energy against residual, with a legend.
    """
    ax = axes_or_new(ax)
    label = method_of(front.method).label
    for i, (begin, end) in enumerate(front.gaps):
        words = "_" if i else "no weight reaches these"  # once in the legend
        ax.axvspan(begin * 1e3, end * 1e3, color="0.5", alpha=0.15, linewidth=0, label=words)
    middles = [(begin + end) / 2 for begin, end in front.gaps]
    places = np.searchsorted(front.residuals, middles)  # no line crosses a gap
    draw_front(
        ax, np.insert(front.residuals, places, np.nan), np.insert(front.energies, places, np.nan),
        exact=True, color=BLUE, marker=".", markersize=5, linestyle="-" if front.complete else "--",
        label=label if front.complete else f"{label}, interrupted",
    )  # fmt: skip
    knee = front.knee()
    if len(front.points) > 2:
        ax.plot(
            knee.residual * 1e3, knee.energy, "o", color=BLUE, fillstyle="none",
            label=f"knee: {knee.energy:.4g} J at {millimetres(knee.residual)}",
        )  # fmt: skip
    _draw_failures(ax, front)
    name_objectives(ax)
    ax.legend(fontsize=8)
    return ax


def draw_polish(before: Front, polish: Polish, ax: Axes | None = None) -> Axes:
    """Draw a front before and after polishing.

    Parameters
    ----------
    before : Front
        The front that was given.
    polish : Polish
        What became of it.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, energy against residual, with a legend.
    """
    ax = axes_or_new(ax)
    for label, front, colour, mark in (
        ("before", before, ORANGE, "^"), ("after", polish.front, BLUE, "o"),
    ):  # fmt: skip
        draw_front(
            ax, front.residuals, front.energies,
            color=colour, marker=mark, markersize=3, label=label,
        )  # fmt: skip
    _draw_failures(ax, polish.front)
    scale_residuals(ax, _residuals(before, polish))
    name_objectives(ax)
    ax.legend(fontsize=8)
    return ax


def draw_savings(before: Front, polish: Polish, ax: Axes | None = None) -> Axes:
    """Draw the share of the energy that polishing saved, point by point.

    Parameters
    ----------
    before, polish, ax
        As for `draw_polish`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, energy saved [%] against residual, on the same scale as `draw_polish`.
    """
    ax = axes_or_new(ax)
    gains = [(1e3 * gain.residual, 100 * gain.share) for gain in polish.gains]
    ax.plot(*np.reshape(gains, (-1, 2)).T, "o", color=BLUE, markersize=3)
    ax.set(xlabel="residual F1 [mm]", ylabel="energy saved [%]")
    ax.set_ylim(bottom=0)
    scale_residuals(ax, _residuals(before, polish))
    return ax


def sweep_figure(front: Front) -> Figure:
    """The picture of `quietarm front` by the gradient: `draw_sweep` under the task."""
    figure, (ax,) = side_by_side(1, title_of(front.task), width=6.4)
    draw_sweep(front, ax)
    return figure


def polish_figure(before: Front, polish: Polish) -> Figure:
    """The picture of `quietarm polish`: `draw_polish` and `draw_savings` side by side."""
    name = method_of(polish.front.method).label
    figure, axes = side_by_side(2, f"{name}: {title_of(before.task)}", width=5.6)
    draw_polish(before, polish, axes[0])
    draw_savings(before, polish, axes[1])
    return figure


def _residuals(before: Front, polish: Polish) -> list[float]:
    """All that are drawn [mm]."""
    return (1e3 * np.concatenate([before.residuals, polish.front.residuals])).tolist()


def _draw_failures(ax: Axes, front: Front) -> None:
    """Draw a cross on the axis at every residual limit that failed; weights have no residual."""
    limits = [one.asked[RESIDUAL_LIMIT] for one in front.failures if RESIDUAL_LIMIT in one.asked]
    label = f"{len(front.failures)} not found"
    if limits:
        ax.plot(
            np.array(limits) * 1e3, np.full(len(limits), 0.03), "x", color=RED,
            transform=ax.get_xaxis_transform(), label=label,
        )  # fmt: skip
    elif front.failures:
        ax.plot([], [], "x", color=RED, label=label)
