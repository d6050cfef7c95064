"""The pictures of a contest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from studies.contest.measures import TARGETS, Arena, quartiles
from studies.contest.tables import label_of
from studies.figures.axes import axes_or_new, new_figure
from studies.figures.looks import Look, look

Array = NDArray[np.float64]
_LEAST = 1e-4
"""Shares below are drawn here: the exact front's own hypervolume is no better known."""


def looks_of(methods: Sequence[str]) -> dict[str, Look]:
    """The look of every method, the same in all pictures of a contest."""
    return {method: look(number) for number, method in enumerate(methods)}


def anytime_figure(arena: Arena, looks: dict[str, Look]) -> Figure:
    """What is missing over evaluations and over time, medians in a band of the quartiles."""
    figure = new_figure(9.6, 4.2)
    left, right = figure.subplots(1, 2, sharey=True)
    draw_evaluations(arena, looks, left)
    draw_times(arena, looks, right)
    right.set_ylabel("")
    figure.legend(*left.get_legend_handles_labels(), loc="outside right center", frameon=False)
    return figure


def draw_evaluations(arena: Arena, looks: dict[str, Look], ax: Axes | None = None) -> Axes:
    """Draw the share of the exact hypervolume that is missing over evaluations.

    Parameters
    ----------
    arena : Arena
        The problem.
    looks : dict of str to Look
        By method.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: a line is the median over the seeds, its band the quartiles.
    """
    ax = axes_or_new(ax)
    for field in arena.fields:
        _band(ax, field.evaluations, field.missing, looks[field.method], field.method)
    _finished(ax)
    ax.set_xlabel("evaluations")
    return ax


def draw_times(arena: Arena, looks: dict[str, Look], ax: Axes | None = None) -> Axes:
    """Draw the same over processor time; parameters and what is returned as `draw_evaluations`."""
    ax = axes_or_new(ax)
    for field in arena.fields:
        # up to where the slowest run ends: beyond, some runs would stand still
        times = arena.times[arena.times <= field.seconds[:, -1].max() * (1 + 1e-9)]
        _band(ax, times, field.after_times(times), looks[field.method], field.method)
    _finished(ax)
    ax.set_xlabel("processor time [s]")
    return ax


def _band(ax: Axes, x: Array | NDArray[np.int64], rows: Array, own: Look, method: str) -> None:
    lower, median, upper = np.maximum(100 * quartiles(rows), 100 * _LEAST)
    ax.fill_between(x, lower, upper, step="post", color=own.colour, alpha=0.18, linewidth=0)
    ax.plot(x, median, color=own.colour, linestyle=own.dash, drawstyle="steps-post",
            label=label_of(method))  # fmt: skip


def _finished(ax: Axes) -> None:
    for target in TARGETS:
        ax.axhline(100 * target, color="0.6", linewidth=0.8, linestyle=":")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(top=110)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_ylabel("hypervolume missing [% of the exact front's]")
