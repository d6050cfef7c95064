"""Fronts of several methods compared, in pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.score import within
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL
from quietarm.ocp.rest import rest_of
from quietarm.views.pictures.axes import (
    TITLE,
    axes_or_new,
    draw_front,
    head,
    in_lines,
    legend_of,
    letter,
    logarithmic,
    name_objectives,
    new_figure,
    residual_label,
)
from quietarm.views.pictures.grammar import FAINT, FLOOR, PAPER, Look, looks
from quietarm.views.pictures.marked_points import mark_points
from quietarm.views.report.captions import spans_of_fronts
from quietarm.views.report.method_rows import with_kind
from quietarm.views.report.words import title_of_picture
from quietarm.views.tips import tip_scale, tip_words

if TYPE_CHECKING:
    from quietarm.studies.compare.front_comparison import Comparison, RunsOfMethod

_END = 5.0
"""The end of small residuals reaches at least to this multiple of the least of all."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class KnownPoint:
    """A motion that a front is compared with: its name, residual [m] if known, and energy [J]."""

    label: str
    residual: float | None
    energy: float


@interruptible
def comparison_figure(comparison: Comparison, known: Sequence[KnownPoint] = ()) -> Figure:
    """Draw fronts over each other.

    Parameters
    ----------
    comparison : Comparison
        The fronts.
    known : sequence of KnownPoint, optional
        Motions to compare them with, such as the paper's.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels: whole fronts; small residuals, logarithmic; points above the best of all. The
        legend stands beside the third.
    """
    figure = new_figure(10, 7.6)
    axes: list[Axes] = list(figure.subplots(2, 2).flat)
    draw_comparison(comparison, known, axes[0])
    draw_comparison(comparison, known, axes[1], small=True)
    draw_gaps(comparison, axes[2])
    letter(axes[:3])
    axes[3].axis("off")
    several = any(len(group.runs) > 1 for group in comparison.groups)
    handles, labels = legend_of(axes)
    axes[3].legend(
        handles, [in_lines(label, 48) for label in labels], loc="center left", frameon=False,
        fontsize=10, alignment="left",
        title="Several seeds: the line is what half of them reach\n"
        "(of two, the better one), the band best to worst" if several else None,
    )  # fmt: skip
    head(figure, _caption(comparison), title_of_picture(comparison.task))
    return figure


@interruptible
def draw_comparison(
    comparison: Comparison,
    known: Sequence[KnownPoint] = (),
    ax: Axes | None = None,
    *,
    small: bool = False,
) -> Axes:
    """Draw energy against residual.

    A search's front is the staircase of what it found; that of the gradient is a line, of which it
    computed some points: motions between these lie on it.

    Parameters
    ----------
    comparison : Comparison
        The fronts, by `compare_fronts`.
    known : sequence of KnownPoint, optional
        Motions to compare them with.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    small : bool
        Small residuals, logarithmic, up to the largest of the comparison's levels, or further where
        no front reaches these; the whole fronts by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; of several seeds there is the median attainment surface, in a band from the best
        to the worst.
    """
    # upper end of the panels, as a multiple of the best front's energy at its least residual
    tallest = 1.6
    ax = axes_or_new(ax)
    right = _right(comparison)
    tip_unit = comparison.task.plant.tip_unit
    scale = tip_scale(tip_unit)[1]
    if small:
        right = min(max(*comparison.levels, _END * float(comparison.best_front[0, 0])), right)
    for group, look_of_group, wider in drawn_groups(comparison):
        line = group.by_gradient and len(group.runs) == 1 and comparison.fill
        shown = up_to(group.runs[0].between if line else group.median, right)
        draw_front(
            ax, shown[:, 0], shown[:, 1], tip_unit, exact=line, width=1.2 + wider,
            color=look_of_group.colour, linestyle=look_of_group.dash,
            label=with_kind(group.label, group.by_gradient),
        )  # fmt: skip
        draw_band(ax, group, look_of_group, right, scale)
    for point, mark in zip(known, cycle("*Pv")):
        if point.residual is None:
            ax.axhline(point.energy, color=PAPER.colour, lw=PAPER.width, ls=PAPER.dash,
                       label=point.label)  # fmt: skip
        else:
            ax.plot(
                point.residual * scale, point.energy, mark, color=PAPER.colour, markersize=11,
                markeredgecolor="white", label=point.label, zorder=5,
            )  # fmt: skip
    if comparison.floor is not None:
        _draw_floor(ax, comparison, scale * _left(comparison) if small else 0.0)
    if not small:
        corner = comparison.runs[0].front.reference
        mark_points(ax, comparison.best_front, comparison.task, corner)
    highest = max(
        [tallest * comparison.best_front[0, 1], *(1.05 * point.energy for point in known)]
    )
    ax.set_ylim(top=min(ax.get_ylim()[1], highest))
    if comparison.floor is not None:
        _leave_room_below(ax, comparison.floor)
    name_objectives(ax, tip_unit, comparison.task.residual_window)
    ax.set_title("small residuals" if small else "the whole fronts", **TITLE)
    if small:
        _logarithmic(ax, comparison, right)
    else:
        ax.set_xlim(0, right * scale)
    return ax


def draw_band(ax: Axes, group: RunsOfMethod, look: Look, right: float, scale: float = 1.0) -> None:
    """Draw from the best to the worst of several runs, up to a value of the first objective."""
    if len(group.runs) < 2:
        return
    stairs, best, worst = group.band
    shown = np.flatnonzero(stairs <= right)
    shown = np.append(shown, shown[-1:])  # the last step goes on to the right end
    places = np.append(stairs[shown[:-1]], [right] if len(shown) else [])
    ax.fill_between(
        places * scale, best[shown], worst[shown], step="post", color=look.colour,
        alpha=0.2, linewidth=0,
    )  # fmt: skip


def _draw_floor(ax: Axes, comparison: Comparison, rest: float) -> None:
    """Mark the best motion without parametrisation where it is: at rest, on the left edge."""
    assert comparison.floor is not None
    nominal = ", nominal plant" * bool(comparison.task.ranges)
    stillest = float(comparison.best_front[0, 1])
    ax.plot(rest, comparison.floor, FLOOR.mark, color=FLOOR.colour, markersize=7, clip_on=False,
            zorder=6, label=f"best without parametrisation, at rest{nominal}")  # fmt: skip
    share = 100 * (1 - comparison.floor / stillest)
    side = "less" if share > 0 else "more"
    words = f"{comparison.floor:.4g} J at rest,\n{abs(share):.2g} % {side}"
    ax.annotate(words, (rest, comparison.floor), (10, -1), textcoords="offset points",
                color=FLOOR.colour, fontsize=8, va="top")  # fmt: skip


def _leave_room_below(ax: Axes, energy: float, share: float = 0.22) -> None:
    """Let an axis begin so far below an energy that two lines of words have room there."""
    bottom, top = ax.get_ylim()
    ax.set_ylim(bottom=min(bottom, (energy - share * top) / (1 - share)))


def _caption(comparison: Comparison) -> str:
    """Say what the methods take at a level that all or some of them reach."""
    level = next((level for level in comparison.levels if level >= SEARCH_RESIDUAL), None)
    if level is None:
        level = comparison.levels[-1]
    least = {
        group.label: float(within(group.runs[0].between if group.by_gradient else group.median,
                                  [level])[0])
        for group in comparison.groups
    }  # fmt: skip
    known = {name: energy for name, energy in least.items() if np.isfinite(energy)}
    words = tip_words(level, comparison.task.plant.tip_unit)
    if not known:
        return f"No front comes within {words}"
    best = min(known, key=lambda name: known[name])
    rest = [f"{name} {energy:.3g} J" for name, energy in known.items() if name != best][:3]
    energies = ", ".join([f"{best} takes {known[best]:.3g} J", *rest])
    spans = spans_of_fronts([run.front for run in comparison.runs], level)
    return f"Within {words}, {energies}{spans}"


@interruptible
def draw_gaps(comparison: Comparison, ax: Axes | None = None) -> Axes:
    """Draw how far points are above the best of all filled fronts, residual logarithmic.

    Points rather than staircases: the steps of a coarse front would make it look bad between its
    points. Parameters, and what is returned, are those of `draw_comparison`.
    """
    ax = axes_or_new(ax)
    scale = tip_scale(comparison.task.plant.tip_unit)[1]
    for group, look_of_group, wider in drawn_groups(comparison):
        ax.plot(
            np.maximum(group.median[:, 0], _left(comparison)) * scale,
            100 * comparison.above_best(group.median), look_of_group.mark,
            color=look_of_group.colour,
            markersize=3.2 + wider, markeredgewidth=0,
            label=with_kind(group.label, group.by_gradient),
        )  # fmt: skip
    ax.set_yscale("symlog", linthresh=0.1, linscale=0.5)
    ax.yaxis.set_major_formatter("{x:g}")
    ax.set_ylim(-0.008, None)
    _logarithmic(ax, comparison, _right(comparison))
    ax.set_ylabel("energy above the best [%]")
    ax.set_title("each point above the best of all", **TITLE)
    return ax


def drawn_groups(comparison: Comparison) -> Iterator[tuple[RunsOfMethod, Look, float]]:
    """Every group, its look, and how much wider it is drawn, to be seen below the next ones."""
    last = len(comparison.groups) - 1
    meanings = ["plan" if group.by_gradient else "search" for group in comparison.groups]
    for place, (group, look) in enumerate(zip(comparison.groups, looks(meanings))):
        yield group, look, 0.35 * (last - place)


def up_to(points: Array, right: float) -> Array:
    """Return points up to a residual, and the last one's energy there."""
    inside = points[points[:, 0] <= right]
    return inside if not len(inside) else np.vstack([inside, [right, inside[-1, 1]]])


def _left(comparison: Comparison) -> float:
    # a logarithmic axis begins at this residual [m], or at this multiple of the least of all
    aside = 0.9
    return max(rest_of(comparison.task), aside * float(comparison.best_front[0, 0]))


def _right(comparison: Comparison) -> float:
    return 1.04 * max([*(group.best[-1, 0] for group in comparison.groups), *comparison.levels])


def _logarithmic(ax: Axes, comparison: Comparison, right: float) -> None:
    least_residual = _left(comparison)
    logarithmic(ax, [least_residual, right])
    tip_unit = comparison.task.plant.tip_unit
    scale = tip_scale(tip_unit)[1]
    ax.set_xlim(least_residual * scale, right * scale)
    ax.set_xlabel(f"{residual_label(tip_unit, comparison.task.residual_window)}, logarithmic")
    for level in comparison.levels:
        if least_residual <= level <= right:
            ax.axvline(level * scale, color=FAINT, linewidth=0.8, zorder=0)
