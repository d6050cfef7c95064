"""The multiples of the floor as a picture: a band for each condition, dots for each method."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

from studies.methods import NSGA2, VEPSO
from studies.paper.printed import CONDITIONS
from studies.reproduction.floor_table import FREE, IN_BOX, PAPER, SERIES, Multiple, multiples
from studies.reproduction.recompute import Reproduction

_COLOURS = {
    PAPER: "black", VEPSO.label: "#009E73", NSGA2.label: "#CC79A7", IN_BOX: "#0072B2",
    FREE: "#D55E00",
}  # fmt: skip  # Okabe and Ito's, told apart by colour-blind people
_TICKS = (1.02, 1.05, 1.1, 1.2, 1.5, 2, 3, 4, 6, 10)
_MARGIN = 1.1
_BAND = len(SERIES) - 1 + 2 * _MARGIN


def floor_dots(result: Reproduction) -> Figure:
    """Draw every multiple as a dot with its number of terms in it.

    The distance above the floor is drawn on a logarithmic scale, which separates the dots near the
    floor; the axis is marked in multiples.

    Parameters
    ----------
    result : Reproduction
        What `recompute_paper` returned.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.
    """
    figure = Figure(figsize=(10, 10.4), layout="constrained")
    FigureCanvasAgg(figure)
    axis = figure.subplots()
    for place, condition in enumerate(CONDITIONS):
        top = place * _BAND
        if place % 2 == 0:
            axis.axhspan(top - _MARGIN, top - _MARGIN + _BAND, color="0.955", zorder=0)
        found = multiples(result, condition)
        for lane, series in enumerate(SERIES):
            _draw_lane(axis, top + lane, series, [m for m in found if m.series == series])
    middle = (len(SERIES) - 1) / 2
    names = [
        f"{c.task.plant.name}\n{c.label}\nfloor {result.floors[c].energy:.4g} J" for c in CONDITIONS
    ]
    axis.set_yticks([place * _BAND + middle for place in range(len(CONDITIONS))], names)
    axis.tick_params(axis="y", length=0)
    axis.set_ylim(len(CONDITIONS) * _BAND - _MARGIN, -_MARGIN)
    _mark_multiples(axis)
    axis.set_title(
        "Energy as a multiple of the least that any joint motion needs, at rest on arrival",
        loc="left",
        fontsize=11,
    )
    handles = [
        Line2D([], [], marker="o", color=_COLOURS[series], label=series, markersize=8)
        for series in SERIES
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(SERIES), frameon=False, fontsize=9
    )
    return figure


def _draw_lane(axis: Axes, height: float, series: str, found: list[Multiple]) -> None:
    above = [m for m in found if m.median > 1]
    axis.plot(
        [m.median - 1 for m in above],
        [height] * len(above),
        color=_COLOURS[series],
        linewidth=1.2,
        alpha=0.5,
        zorder=2,
    )
    for m in above:
        if m.upper > m.lower > 1:
            axis.plot(
                [m.lower - 1, m.upper - 1], [height] * 2,
                color=_COLOURS[series], linewidth=4, alpha=0.35, solid_capstyle="butt", zorder=2,
            )  # fmt: skip
        # The dot of the most terms lies uppermost where dots meet.
        axis.plot(
            m.median - 1, height, "o",
            color=_COLOURS[series], markersize=10.5, markeredgecolor="white", zorder=3 + m.terms,
        )  # fmt: skip
        axis.text(
            m.median - 1, height + 0.03, str(m.terms),
            color="white", fontsize=6.5, ha="center", va="center", zorder=3.5 + m.terms,
        )  # fmt: skip


def _mark_multiples(axis: Axes) -> None:
    axis.set_xscale("log")
    low, high = axis.get_xlim()
    shown = [tick for tick in _TICKS if low <= tick - 1 <= high]
    axis.xaxis.set_major_locator(FixedLocator([tick - 1 for tick in shown]))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xticklabels([f"{tick:g}" for tick in shown])
    axis.grid(axis="x", alpha=0.35)
    axis.set_xlabel(
        "times the floor (distance above it on a logarithmic scale); in the dots: terms N"
    )
