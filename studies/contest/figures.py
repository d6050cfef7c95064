"""The pictures of a contest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from quietarm.studies.contest.measures import TARGETS, Arena, Field, quartiles
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.statistics import Ranking
from quietarm.studies.figures.axes import TITLE, logarithmic, name_objectives, new_figure
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
    for field in arena.own:
        # up to where the slowest run ends: beyond, some runs would stand still
        times = arena.times[arena.times <= field.seconds[:, -1].max() * (1 + 1e-9)]
        _band(left, field.evaluations, field.missing, field, looks)
        _band(right, times, field.after_times(times), field, looks)
    for ax, name in ((left, "evaluations"), (right, "processor time [s]")):
        for target in TARGETS:
            ax.axhline(100 * target, color="0.6", linewidth=0.8, linestyle=":")
        ax.grid(alpha=0.25)
        low, high = ax.dataLim.intervalx
        logarithmic(ax, high / low)
        logarithmic(ax, 1 / _LEAST, "y")
        ax.set_ylim(top=110)
        ax.set_xlabel(name)
    left.set_ylabel("hypervolume missing [% of the exact front's]")
    figure.legend(*left.get_legend_handles_labels(), loc="outside right center", frameon=False)
    return figure


def _band(
    ax: Axes, x: Array | NDArray[np.int64], missing: Array, field: Field, looks: dict[str, Look]
) -> None:
    """Draw the median of what is missing in a band of the quartiles."""
    lower, median, upper = 100 * np.maximum(quartiles(missing), _LEAST)
    colour = looks[field.method].colour
    ax.fill_between(x, lower, upper, step="post", color=colour, alpha=0.18, linewidth=0)
    ax.plot(x, median, drawstyle="steps-post", **_line(field, looks))


def _line(field: Field, looks: dict[str, Look]) -> dict[str, Any]:
    """How the line of a method is drawn."""
    own = looks[field.method]
    return {"color": own.colour, "linestyle": own.dash, "label": field.label}


def attainment_figure(arena: Arena, looks: dict[str, Look]) -> Figure:
    """Median attainment surfaces over each other, and the nearest method's less each other's."""
    best = arena.best
    others = sorted((one for one in arena.fields if one is not best), key=lambda one: one.middle)
    panels = 1 + len(others)
    columns = min(panels, 3)
    rows = -(-panels // columns)
    figure = new_figure(3.9 * columns, 3.6 * rows)
    surfaces, *axes = figure.subplots(rows, columns, squeeze=False).flat
    residuals, energies = _grid(arena)
    for field in arena.fields:
        median = quartiles(field.stairs(residuals))[1]
        surfaces.plot(1e3 * residuals, median, **_line(field, looks))
    surfaces.set_title("what half of the runs attain", **TITLE)
    for other, ax in zip(others, axes, strict=False):
        attained = [
            (field.stairs(residuals)[:, :, None] <= energies).mean(axis=0)
            for field in (best, other)
        ]
        mesh = ax.pcolormesh(
            1e3 * residuals, energies, (attained[0] - attained[1]).T, cmap="RdBu", vmin=-1, vmax=1,
            rasterized=True, shading="nearest",
        )  # fmt: skip
        figure.colorbar(mesh, ax=ax, ticks=(-1, 0, 1), shrink=0.8)
        ax.set_title(f"{best.label} (blue)\n{other.label} (red)", loc="left", fontsize=9)
    exact = arena.yardstick.front
    for ax in (surfaces, *axes[: len(others)]):
        # motions between the exact front's points are on the lines that join them
        ax.plot(1e3 * exact.residuals, exact.energies, color="black", linewidth=0.9, label="exact")
        ax.grid(alpha=0.25)
        ax.set_xlim(1e3 * residuals[0], 1e3 * residuals[-1])
        ax.set_ylim(energies[0], energies[-1])
        name_objectives(ax)
    for ax in axes[len(others) :]:
        ax.axis("off")
    entries = surfaces.get_legend_handles_labels()
    figure.legend(*entries, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _grid(arena: Arena) -> tuple[Array, Array]:
    """Residuals [m] and energies [J] over the exact front's extent and a little more."""
    (least, cheapest), (most, dearest) = arena.yardstick.scale.ideal, arena.yardstick.scale.nadir
    height = dearest - cheapest
    return (
        np.linspace(least, most, _GRID),
        np.linspace(cheapest - 0.02 * height, dearest + 0.3 * height, _GRID),
    )


def ranks_figure(found: Ranking) -> Figure:
    """Mean ranks on a line; bars join methods that the tests do not tell apart."""
    figure = new_figure(7.2, 1.3 + 0.26 * len(found.methods))
    figure.suptitle(found.on, fontsize=10)
    ax, count = figure.subplots(), len(found.methods)
    bars, half = found.alike, (count + 1) // 2
    first = 0.5 + 0.35 * len(bars)
    low, high = (1, count) if found.critical is not None else (found.ranks[0], found.ranks[-1])
    room = 0.12 * max(high - low, 1)
    for place, (method, rank) in enumerate(zip(found.methods, found.ranks, strict=True)):
        left = place < half
        depth = first + (place if left else count - 1 - place) + 0.5
        edge, side = (low - room, "right") if left else (high + room, "left")
        ax.plot([rank, rank, edge], [0, depth, depth], color="0.35", linewidth=0.9)
        name = f" {label_of(method)} ({rank:.2f}) "
        ax.text(edge, depth, name, va="center", ha=side, fontsize=9)
    for number, (begin, end) in enumerate(bars):
        beyond, depth = 0.16 * room, 0.35 * (number + 1)
        ends = found.ranks[begin] - beyond, found.ranks[end] + beyond
        ax.plot(ends, (depth, depth), color="black", linewidth=3.5, solid_capstyle="butt")
    if found.critical is not None:
        longest = 1 + found.critical
        ax.plot([1, longest], [-1.0, -1.0], "|-", color="black", linewidth=1.2)
        words = f"  critical difference {found.critical:.2f}"
        ax.text(longest, -1.0, words, va="center", fontsize=8)
        ax.set_xticks(range(1, count + 1))
    ax.set_xlim(low - room, high + room)
    ax.set_ylim(first + half + 0.4, -1.5)
    ax.xaxis.tick_top()
    ax.yaxis.set_visible(False)
    ax.spines[["left", "right", "bottom"]].set_visible(False)
    ax.spines["top"].set_position(("data", 0.0))
    return figure
