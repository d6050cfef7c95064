"""The pictures of a contest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray
from quietarm.studies.comparison.staircase import objectives, within
from quietarm.studies.contest.measures import TARGETS, Arena, Outcome, quartiles
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.statistics import Ranking
from quietarm.studies.figures.axes import axes_or_new, new_figure
from quietarm.studies.figures.looks import Look, look

Array = NDArray[np.float64]
_LEAST = 1e-4
"""Shares below are drawn here: the exact front's own hypervolume is no better known."""
_GRID = 240


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
    """Draw the share of the exact hypervolume that is missing over evaluations."""
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


def attainment_figure(arena: Arena, looks: dict[str, Look]) -> Figure:
    """Median attainment surfaces over each other, and the best method's less each other's."""
    best = min(arena.alike, key=lambda one: one.middle)
    others = sorted((one for one in arena.outcomes if one is not best), key=lambda one: one.middle)
    panels = 1 + len(others)
    columns = min(panels, 3)
    rows = -(-panels // columns)
    figure = new_figure(3.9 * columns, 3.6 * rows)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    draw_surfaces(arena, looks, axes[0])
    for other, ax in zip(others, axes[1:], strict=False):
        draw_difference(arena, best, other, ax)
    for ax in axes[panels:]:
        ax.axis("off")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4,
                  frameon=False)  # fmt: skip
    return figure


def draw_surfaces(arena: Arena, looks: dict[str, Look], ax: Axes | None = None) -> Axes:
    """Draw what half of the runs of each method attain, and the exact front.

    Parameters, and what is returned, are those of `draw_evaluations`.
    """
    ax, (residuals, _) = axes_or_new(ax), _grid(arena)
    for field in arena.outcomes:
        own = looks[field.method]
        ax.plot(1e3 * residuals, quartiles(_stairs(field, residuals))[1], color=own.colour,
                linestyle=own.dash, label=label_of(field.method))  # fmt: skip
    _draw_exact(arena, ax)
    _of_a_front(ax, arena)
    ax.set_title("what half of the runs attain", loc="left", fontsize=10)
    return ax


def draw_difference(arena: Arena, one: Outcome, other: Outcome, ax: Axes | None = None) -> Axes:
    """Draw where more runs of one method than of another attain residual and energy."""
    ax, (residuals, energies) = axes_or_new(ax), _grid(arena)
    attained = [
        (_stairs(field, residuals)[:, :, None] <= energies).mean(axis=0) for field in (one, other)
    ]
    shares = (attained[0] - attained[1]).T
    mesh = ax.pcolormesh(1e3 * residuals, energies, shares, cmap="RdBu", vmin=-1, vmax=1,
                         rasterized=True, shading="nearest")  # fmt: skip
    _draw_exact(arena, ax)
    _of_a_front(ax, arena)
    figure = ax.figure
    figure.colorbar(mesh, ax=ax, ticks=(-1, 0, 1), shrink=0.8)
    ax.set_title(
        f"{label_of(one.method)} (blue)\n{label_of(other.method)} (red)", loc="left", fontsize=9
    )
    return ax


def _draw_exact(arena: Arena, ax: Axes) -> None:
    """Draw the exact front: motions between its points are on the lines that join them."""
    front = arena.yardstick.front
    ax.plot(1e3 * front.residuals, front.energies, color="black", linewidth=0.9, label="exact")


def _grid(arena: Arena) -> tuple[Array, Array]:
    """Residuals [m] and energies [J] over the exact front's extent and a little more."""
    (least, cheapest), (most, dearest) = arena.yardstick.scale.ideal, arena.yardstick.scale.nadir
    height = dearest - cheapest
    return (
        np.linspace(least, most, _GRID),
        np.linspace(cheapest - 0.02 * height, dearest + 0.3 * height, _GRID),
    )


def _stairs(field: Outcome, residuals: Array) -> Array:
    """Least energy [J] of every run within residuals, shape (runs, residuals)."""
    return np.array([within(objectives(run.front), residuals, np.inf) for run in field.runs])


def _of_a_front(ax: Axes, arena: Arena) -> None:
    residuals, energies = _grid(arena)
    ax.set_xlim(1e3 * residuals[0], 1e3 * residuals[-1])
    ax.set_ylim(energies[0], energies[-1])
    ax.set_xlabel("residual F1 [mm]")
    ax.set_ylabel("energy F2 [J]")


def ranks_figure(found: Ranking, title: str) -> Figure:
    """The critical-difference diagram alone."""
    figure = new_figure(7.2, 1.3 + 0.26 * len(found.methods))
    draw_ranks(found, figure.subplots())
    figure.suptitle(title, fontsize=10)
    return figure


def draw_ranks(found: Ranking, ax: Axes | None = None) -> Axes:
    """Draw mean ranks on a line; bars join methods that the tests do not tell apart."""
    ax = axes_or_new(ax)
    ax.grid(False)
    count = len(found.methods)
    bars, half = found.alike, (count + 1) // 2
    first = 0.5 + 0.35 * len(bars)
    for place, (method, rank) in enumerate(zip(found.methods, found.ranks, strict=True)):
        left = place < half
        depth = first + (place if left else count - 1 - place) + 0.5
        edge = 1 - 0.25 if left else count + 0.25
        ax.plot([rank, rank, edge], [0, depth, depth], color="0.35", linewidth=0.9)
        ax.text(edge, depth, f" {label_of(method)} ({rank:.2f}) ", va="center",
                ha="right" if left else "left", fontsize=9)  # fmt: skip
    for number, (begin, end) in enumerate(bars):
        depth = 0.35 * (number + 1)
        ax.plot([found.ranks[begin] - 0.04, found.ranks[end] + 0.04], [depth, depth],
                color="black", linewidth=3.5, solid_capstyle="butt")  # fmt: skip
    ax.plot([1, 1 + found.critical], [-1.0, -1.0], "|-", color="black", linewidth=1.2)
    ax.text(1 + found.critical, -1.0, f"  critical difference {found.critical:.2f}", va="center",
            fontsize=8)  # fmt: skip
    ax.set_xlim(1 - 0.25, count + 0.25)
    ax.set_ylim(first + half + 0.4, -1.5)
    ax.xaxis.tick_top()
    ax.set_xticks(range(1, count + 1))
    ax.yaxis.set_visible(False)
    ax.spines[["left", "right", "bottom"]].set_visible(False)
    ax.spines["top"].set_position(("data", 0.0))
    return ax
