"""The multiples of the floor as a picture: a band for each condition, dots for each method."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator
from quietarm.studies.display.words import move_of
from quietarm.studies.figures.axes import axes_or_new, new_figure
from quietarm.studies.figures.looks import BLUE, GREEN, PINK, RED
from quietarm.studies.paper.printed import CONDITIONS
from quietarm.studies.registry.methods import NSGA2, VEPSO
from quietarm.studies.reproduction.floor_table import (
    FREE,
    IN_BOX,
    PAPER,
    SERIES,
    Multiple,
    multiples,
)
from quietarm.studies.reproduction.recompute import Reproduction

_COLOURS = {
    PAPER: "black", VEPSO.label: GREEN, NSGA2.label: PINK, IN_BOX: BLUE, FREE: RED,
}  # fmt: skip
_TICKS = (1.02, 1.05, 1.1, 1.2, 1.5, 2, 3, 4, 6, 10)
_MARGIN = 1.1
_BAND = len(SERIES) - 1 + 2 * _MARGIN


def floor_dots(result: Reproduction) -> Figure:
    """The picture of `quietarm reproduce`: `draw_floor_dots` with its legend."""
    figure = new_figure(10, 10.4)
    draw_floor_dots(result, figure.subplots())
    handles = [
        Line2D([], [], marker="o", color=_COLOURS[series], label=series, markersize=8)
        for series in SERIES
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(SERIES), frameon=False, fontsize=9
    )
    return figure


def draw_floor_dots(result: Reproduction, ax: Axes | None = None) -> Axes:
    """Draw every multiple of the floor as a dot with its number of terms in it.

    The distance above the floor is drawn on a logarithmic scale, which separates the dots near the
    floor; the axis is marked in multiples.
    """
    ax = axes_or_new(ax)
    ax.grid(visible=False, axis="y")
    for place, condition in enumerate(CONDITIONS):
        top = place * _BAND
        if place % 2 == 0:
            ax.axhspan(top - _MARGIN, top - _MARGIN + _BAND, color="0.955", zorder=0)
        found = multiples(result, condition)
        for lane, series in enumerate(SERIES):
            _draw_lane(ax, top + lane, series, [m for m in found if m.series == series])
    middle = (len(SERIES) - 1) / 2
    names = [
        f"{c.task.plant.name}\n{move_of(c.task)}\nfloor {result.floors[c].energy:.4g} J"
        for c in CONDITIONS
    ]
    ax.set_yticks([place * _BAND + middle for place in range(len(CONDITIONS))], names)
    ax.tick_params(axis="y", length=0)
    ax.set_ylim(len(CONDITIONS) * _BAND - _MARGIN, -_MARGIN)
    _mark_multiples(ax)
    ax.set_title(
        "Energy as a multiple of the least that any joint motion needs, at rest on arrival",
        loc="left",
        fontsize=11,
    )
    return ax


def _draw_lane(ax: Axes, height: float, series: str, found: list[Multiple]) -> None:
    above = [m for m in found if m.median > 1]
    ax.plot(
        [m.median - 1 for m in above],
        [height] * len(above),
        color=_COLOURS[series],
        linewidth=1.2,
        alpha=0.5,
        zorder=2,
    )
    for m in above:
        if m.upper > m.lower > 1:
            ax.plot(
                [m.lower - 1, m.upper - 1], [height] * 2,
                color=_COLOURS[series], linewidth=4, alpha=0.35, solid_capstyle="butt", zorder=2,
            )  # fmt: skip
        # The dot of the most terms lies uppermost where dots meet.
        ax.plot(
            m.median - 1, height, "o",
            color=_COLOURS[series], markersize=10.5, markeredgecolor="white", zorder=3 + m.terms,
        )  # fmt: skip
        ax.text(
            m.median - 1, height + 0.03, str(m.terms),
            color="white", fontsize=6.5, ha="center", va="center", zorder=3.5 + m.terms,
        )  # fmt: skip


def _mark_multiples(ax: Axes) -> None:
    ax.set_xscale("log")
    low, high = ax.get_xlim()
    shown = [tick for tick in _TICKS if low <= tick - 1 <= high]
    ax.xaxis.set_major_locator(FixedLocator([tick - 1 for tick in shown]))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_xticklabels([f"{tick:g}" for tick in shown])
    ax.grid(axis="x", alpha=0.35)
    ax.set_xlabel(
        "times the floor (distance above it on a logarithmic scale); in the dots: terms N"
    )
