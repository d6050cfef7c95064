"""Fronts of several methods compared, in pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray
from quietarm.studies.figures.axes import (
    TITLE,
    axes_or_new,
    draw_front,
    legend_of,
    letter,
    logarithmic,
    name_objectives,
    new_figure,
)
from quietarm.studies.figures.looks import Look, look
from quietarm.studies.report.words import title_of

if TYPE_CHECKING:
    from quietarm.studies.compare.fronts import Comparison, Group

_MOST_NAMED = 10
"""More fronts than this are drawn without a name."""
_LEAST_SPAN = 0.01
"""The axis of energies spans at least this share of their median: seeds that agree lie close."""
_LEAST, _ASIDE = 1e-6, 0.9
"""A logarithmic axis begins at this residual [m], or at this multiple of the least of all."""
_END = 5.0
"""The end of small residuals reaches at least to this multiple of the least of all."""
_TALLEST = 1.6
"""Upper end of the panels, as a multiple of the best front's energy at its least residual."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class KnownPoint:
    """A motion that a front is compared with: its name, residual [m] if known, and energy [J]."""

    label: str
    residual: float | None
    energy: float


def comparison_figure(
    comparison: Comparison, known: Sequence[KnownPoint] = (), title: str | None = None
) -> Figure:
    """Draw fronts over each other.

    Parameters
    ----------
    comparison : Comparison
        The fronts.
    known : sequence of KnownPoint, optional
        Motions to compare them with, such as the paper's.
    title : str, optional
        Title of the picture; the task by default.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels: whole fronts; small residuals, logarithmic; points above the best of all. Of
        several seeds the median attainment surface, in a band from the best to the worst. The
        legend stands beside the third.
    """
    figure = new_figure(10, 7.4)
    axes: list[Axes] = list(figure.subplots(2, 2).flat)
    draw_whole(comparison, known, axes[0])
    draw_small_residuals(comparison, known, axes[1])
    draw_gaps(comparison, axes[2])
    letter(axes[:3])
    axes[3].axis("off")
    several = any(len(group.runs) > 1 for group in comparison.groups)
    handles, labels = legend_of(axes)
    axes[3].legend(
        handles, [fill(label, 48) for label in labels], loc="center left", frameon=False,
        fontsize=10, alignment="left",
        title="Several seeds: the line is what half of them reach\n"
        "(of two, the better one), the band best to worst" if several else None,
    )  # fmt: skip
    figure.suptitle(title_of(comparison.task) if title is None else title, fontsize=12)
    return figure


def draw_whole(
    comparison: Comparison, known: Sequence[KnownPoint] = (), ax: Axes | None = None
) -> Axes:
    """Draw energy against residual, both linear.

    Parameters
    ----------
    comparison : Comparison
        The fronts, by `compare_fronts`.
    known : sequence of KnownPoint, optional
        Motions to compare them with.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; of several seeds there is the median attainment surface, in a band from the best
        to the worst.
    """
    ax, right = axes_or_new(ax), 1.04 * _right(comparison)
    _draw_compared(ax, comparison, known, right)
    ax.set_xlim(0, right * 1e3)
    ax.set_title("the whole fronts", **TITLE)
    return ax


def draw_small_residuals(
    comparison: Comparison, known: Sequence[KnownPoint] = (), ax: Axes | None = None
) -> Axes:
    """Draw energy against small residuals, logarithmic.

    Parameters, and what is returned, are those of `draw_whole`. The end reaches to the largest of
    the comparison's levels, or further where no front reaches these.
    """
    ax, least = axes_or_new(ax), float(comparison.best_front[0, 0])
    right = min(max(*comparison.levels, _END * least), _right(comparison))
    _draw_compared(ax, comparison, known, right)
    _logarithmic(ax, comparison, right)
    ax.set_title("small residuals", **TITLE)
    return ax


def draw_gaps(comparison: Comparison, ax: Axes | None = None) -> Axes:
    """Draw how far points are above the best of all filled fronts, residual logarithmic.

    Points rather than staircases: the steps of a coarse front would make it look bad between its
    points. Parameters, and what is returned, are those of `draw_whole`.
    """
    ax = axes_or_new(ax)
    for group, own, wider in _drawn(comparison):
        ax.plot(
            np.maximum(group.median[:, 0], _left(comparison)) * 1e3,
            100 * comparison.above_best(group.median), own.mark, color=own.colour,
            markersize=3.2 + wider, markeredgewidth=0, label=group.label,
        )  # fmt: skip
    ax.set_yscale("symlog", linthresh=0.1, linscale=0.5)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_ylim(-0.008, None)
    _logarithmic(ax, comparison, _right(comparison))
    ax.set_ylabel("energy above the best [%]")
    ax.set_title("each point above the best of all", **TITLE)
    return ax


def _drawn(comparison: Comparison) -> Iterator[tuple[Group, Look, float]]:
    """Every group, its look, and how much wider it is drawn, to be seen below the next ones."""
    last = len(comparison.groups) - 1
    for place, group in enumerate(comparison.groups):
        yield group, look(place), 0.35 * (last - place)


def _draw_compared(
    ax: Axes, comparison: Comparison, known: Sequence[KnownPoint], right: float
) -> None:
    """Draw fronts up to a residual [m], known points and the best free motion.

    A search's front is the staircase of what it found; that of the gradient is a line, of which it
    computed some points: motions between these lie on it.
    """
    for group, own, wider in _drawn(comparison):
        style: dict[str, Any] = {"color": own.colour, "linestyle": own.dash, "label": group.label}
        line = group.by_gradient and len(group.runs) == 1 and comparison.fill
        shown = _up_to(group.runs[0].between if line else group.median, right)
        draw_front(ax, *shown.T, exact=line, width=1.2 + wider, **style)
        if len(group.runs) > 1:
            residuals, best, worst = group.band
            shown = residuals <= right
            ax.fill_between(
                residuals[shown] * 1e3, best[shown], worst[shown], step="post",
                color=own.colour, alpha=0.2, linewidth=0,
            )  # fmt: skip
    for point, mark in zip(known, cycle("*Pv"), strict=False):
        if point.residual is None:
            ax.axhline(point.energy, color="black", lw=1, ls=":", label=point.label)
        else:
            ax.plot(
                point.residual * 1e3, point.energy, mark, color="black", markersize=11,
                markeredgecolor="white", label=point.label, zorder=5,
            )  # fmt: skip
    if comparison.floor is not None:
        label = f"any joint motion at rest{' (nominal plant)' * bool(comparison.task.ranges)}"
        ax.axhline(comparison.floor, color="0.45", linewidth=1.2, linestyle="-.", label=label)
    ax.set_ylim(*_energies_shown(comparison, known, right))
    name_objectives(ax)


def _up_to(points: Array, right: float) -> Array:
    """Points up to a residual, and the last one's energy there."""
    inside = points[points[:, 0] <= right]
    return inside if not len(inside) else np.vstack([inside, [right, inside[-1, 1]]])


def _energies_shown(
    comparison: Comparison, known: Sequence[KnownPoint], right: float
) -> tuple[float, float]:
    """The least and the largest energy on the axis: the whole best front, and others near it."""
    most = float(comparison.best_front[0, 1])
    top = min(max(group.median[0, 1] for group in comparison.groups), _TALLEST * most)
    marks = [point.energy for point in known]
    marks += [] if comparison.floor is None else [comparison.floor]
    reached = [_up_to(group.best, right) for group in comparison.groups]
    ends = [points[-1, 1] for points in reached if len(points)]
    low, high = min([*marks, *ends, most]), max([*marks, top, most])
    margin = 0.06 * ((high - low) or high)
    return low - margin, high + margin


def _left(comparison: Comparison) -> float:
    return max(_LEAST, _ASIDE * float(comparison.best_front[0, 0]))


def _right(comparison: Comparison) -> float:
    return max([*(group.best[-1, 0] for group in comparison.groups), *comparison.levels])


def _logarithmic(ax: Axes, comparison: Comparison, right: float) -> None:
    left = _left(comparison)
    logarithmic(ax, right / left)
    ax.set_xlim(left * 1e3, right * 1e3)
    ax.set_xlabel("residual F1 [mm], logarithmic")
    for level in comparison.levels:
        if left <= level <= right:
            ax.axvline(level * 1e3, color="0.75", linewidth=0.8, zorder=0)
