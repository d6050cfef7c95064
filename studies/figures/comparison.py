"""Fronts in one picture: whole, the nearly still end, and how far above the best."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count, cycle
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray
from quietarm.studies.comparison.measures import Comparison as Comparison
from quietarm.studies.comparison.measures import Group
from quietarm.studies.comparison.measures import compare_fronts as compare_fronts
from quietarm.studies.comparison.staircase import within
from quietarm.studies.display.words import title_of
from quietarm.studies.figures.axes import (
    TITLE,
    axes_or_new,
    legend_below,
    legend_of,
    letter,
    logarithmic,
    new_figure,
)
from quietarm.studies.figures.looks import Look, look
from quietarm.studies.paper import PaperPoint
from quietarm.studies.registry.methods import EPSILON, NSGA2, VEPSO, WEIGHTED, Kind

_NUMBERS = {
    method: number
    for number, method in enumerate(
        (EPSILON, NSGA2, VEPSO, NSGA2.then_polished(), VEPSO.then_polished(), WEIGHTED)
    )
}
"""The methods that have a look of their own in every picture, by its number."""
_STILLEST = 1e-6
"""The logarithmic axes begin at this residual [m]: below it, differences do not matter."""
_ASIDE = 0.9
"""Or at this multiple of the least residual of all, which is then seen beside the edge."""
_NEARLY_STILL = 5.0
"""The nearly still end reaches at least to this multiple of the least residual of all."""
_TALLEST = 1.6
"""Upper end of the panels, as a multiple of the energy of the best front's stillest motion."""
_LEGEND = 48
"""Characters in a line of the legend beside the panels."""

BANDS = (
    "Several seeds: the line is what half of them reach\n"
    "(of two, the better one), the band best to worst"
)

Array = NDArray[np.float64]


def looks(comparison: Comparison) -> dict[str, Look]:
    """The look of every group, by label; a method keeps its own where it can."""
    own = {_NUMBERS[group.method]: group for group in reversed(comparison.groups)
           if group.method in _NUMBERS}  # fmt: skip  # of several of one method the first
    numbers = {group.label: number for number, group in own.items()}
    spare = (number for number in count() if number not in own)
    return {
        group.label: look(numbers[group.label] if group.label in numbers else next(spare))
        for group in comparison.groups
    }


def comparison_figure(
    comparison: Comparison, paper: Sequence[PaperPoint] = (), title: str | None = None
) -> Figure:
    """Draw fronts over each other.

    Parameters
    ----------
    comparison : Comparison
        The fronts.
    paper : sequence of PaperPoint, optional
        The paper's own points.
    title : str, optional
        Title of the picture; the task by default.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels: whole fronts; the nearly still end, residual logarithmic; points above the
        best of all. Of several seeds the median attainment surface, in a band from the best to
        the worst. The legend stands beside the third.

    Raises
    ------
    ValueError
        When it is no comparison.
    """
    figure = new_figure(10, 7.4)
    axes: list[Axes] = list(figure.subplots(2, 2).flat)
    for ax, draw in zip(axes, PANELS.values(), strict=False):
        draw(comparison, paper, ax)
    letter(axes[:3])
    axes[3].axis("off")
    several = any(len(group.runs) > 1 for group in comparison.groups)
    handles, labels = legend_of(axes)
    axes[3].legend(
        handles, [fill(label, _LEGEND) for label in labels], loc="center left", frameon=False,
        fontsize=10, alignment="left", title=BANDS if several else None,
    )  # fmt: skip
    figure.suptitle(title_of(comparison.task) if title is None else title, fontsize=12)
    return figure


def panel_figure(comparison: Comparison, panel: str, paper: Sequence[PaperPoint] = ()) -> Figure:
    """Draw one of `PANELS` alone, small enough for a phone, with the legend below it."""
    figure = new_figure(4.8, 4.6)
    ax = PANELS[panel](comparison, paper, figure.subplots())
    legend_below(figure, [ax], 2, 8.5)
    return figure


def draw_whole(
    comparison: Comparison, paper: Sequence[PaperPoint] = (), ax: Axes | None = None
) -> Axes:
    """Draw energy against residual, both linear.

    Parameters
    ----------
    comparison : Comparison
        The fronts, by `compare_fronts`.
    paper : sequence of PaperPoint, optional
        The paper's own points.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; of several seeds there is the median attainment surface, in a band from the best
        to the worst.

    Raises
    ------
    ValueError
        When it is no comparison, or `ax` no axes.
    """
    ax, right = axes_or_new(ax), 1.04 * _right(comparison)
    _draw_fronts(ax, comparison, paper, right)
    ax.set_xlim(0, right * 1e3)
    ax.set_xlabel("residual F1 [mm]")
    ax.set_title("the whole fronts", **TITLE)
    return ax


def draw_still(
    comparison: Comparison, paper: Sequence[PaperPoint] = (), ax: Axes | None = None
) -> Axes:
    """Draw energy against residual at the nearly still end, residual logarithmic.

    Parameters, and what is returned, are those of `draw_whole`. The end reaches to the largest of
    the comparison's levels, or further where no front reaches these.
    """
    ax, stillest = axes_or_new(ax), float(comparison.best_front[0, 0])
    right = min(max(*comparison.levels, _NEARLY_STILL * stillest), _right(comparison))
    _draw_fronts(ax, comparison, paper, right)
    _logarithmic(ax, comparison, right)
    ax.set_title("the nearly still end", **TITLE)
    return ax


def draw_gaps(
    comparison: Comparison, paper: Sequence[PaperPoint] = (), ax: Axes | None = None
) -> Axes:
    """Draw how far points are above the best of all filled fronts, residual logarithmic.

    Points rather than staircases: the steps of a coarse front would make it look bad between its
    points. Parameters, and what is returned, are those of `draw_whole`; the paper's points are not
    drawn.
    """
    ax = axes_or_new(ax)
    for group, own, wider in _drawn(comparison):
        residuals, energies = group.median.T
        gap = 100 * (energies / within(comparison.best_front, residuals) - 1)
        ax.plot(
            np.maximum(residuals, _left(comparison)) * 1e3, gap, own.mark, color=own.colour,
            markersize=3.2 + wider, markeredgewidth=0,
            label=group.label,
        )  # fmt: skip
    ax.set_yscale("symlog", linthresh=0.1, linscale=0.5)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_ylim(-0.008, None)
    ax.set_ylabel("energy above the best [%]")
    _logarithmic(ax, comparison, _right(comparison))
    ax.set_title("each point above the best of all", **TITLE)
    return ax


PANELS = {"whole": draw_whole, "still": draw_still, "gaps": draw_gaps}


def _drawn(comparison: Comparison) -> Iterator[tuple[Group, Look, float]]:
    """Every group, its look, and how much wider it is drawn, to be seen below the next ones."""
    shown, last = looks(comparison), len(comparison.groups) - 1
    for place, group in enumerate(comparison.groups):
        yield group, shown[group.label], 0.35 * (last - place)


def _draw_fronts(
    ax: Axes, comparison: Comparison, paper: Sequence[PaperPoint], right: float
) -> None:
    """Draw fronts up to a residual [m], the paper's points and the floor.

    A search's front is the staircase of what it found; that of the gradient is a line, of which it
    computed some points: motions between these lie on it.
    """
    for group, own, wider in _drawn(comparison):
        style: dict[str, Any] = {"color": own.colour, "linestyle": own.dash, "label": group.label}
        style["linewidth"] = 1.2 + wider
        if group.method.kind is Kind.GRADIENT and len(group.runs) == 1 and comparison.fill:
            line = group.runs[0].between
            line = line[line[:, 0] <= right]
            ax.plot([*(line[:, 0] * 1e3), right * 1e3], [*line[:, 1], line[-1, 1]], **style)
            continue
        stairs = np.concatenate([group.best[:, 0], group.median[:, 0], group.worst[:, 0], [right]])
        stairs = np.unique(stairs[stairs <= right])
        best, median, worst = (within(s, stairs) for s in (group.best, group.median, group.worst))
        if len(group.runs) > 1:
            ax.fill_between(
                stairs * 1e3, best, worst, step="post", color=own.colour, alpha=0.2, linewidth=0
            )
        ax.plot(stairs * 1e3, median, drawstyle="steps-post", **style)
    marks = cycle("*Pv")
    for point in paper:
        if point.residual is None:
            ax.axhline(point.energy, color="black", lw=1, ls=":", label=point.label)
        else:
            ax.plot(
                point.residual * 1e3, point.energy, next(marks), color="black", markersize=11,
                markeredgecolor="white", linestyle="", label=point.label, zorder=5,
            )  # fmt: skip
    if comparison.floor is not None:
        label = f"floor: any joint motion, {comparison.of_floor}"
        ax.axhline(comparison.floor, color="0.45", linewidth=1.2, linestyle="-.", label=label)
    ax.set_ylim(*_energies_shown(comparison, paper, right))
    ax.set_ylabel("energy F2 [J]")


def _energies_shown(
    comparison: Comparison, paper: Sequence[PaperPoint], right: float
) -> tuple[float, float]:
    """The least and the largest energy on the axis: the whole best front, and others near it."""
    still = float(comparison.best_front[0, 1])
    top = min(max(group.median[0, 1] for group in comparison.groups), _TALLEST * still)
    marks = [point.energy for point in paper]
    marks += [] if comparison.floor is None else [comparison.floor]
    ends = [within(group.best, np.array([right]), np.inf)[0] for group in comparison.groups]
    low, high = min([*marks, *ends, still]), max([*marks, top, still])
    margin = 0.06 * ((high - low) or high)
    return low - margin, high + margin


def _left(comparison: Comparison) -> float:
    return max(_STILLEST, _ASIDE * float(comparison.best_front[0, 0]))


def _right(comparison: Comparison) -> float:
    ends = [group.best[-1, 0] for group in comparison.groups]
    return max([*ends, *comparison.levels])


def _logarithmic(ax: Axes, comparison: Comparison, right: float) -> None:
    left = _left(comparison)
    logarithmic(ax, right / left)
    ax.set_xlim(left * 1e3, right * 1e3)
    ax.set_xlabel("residual F1 [mm], logarithmic")
    for level in comparison.levels:
        if left <= level <= right:
            ax.axvline(level * 1e3, color="0.75", linewidth=0.8, zorder=0)
