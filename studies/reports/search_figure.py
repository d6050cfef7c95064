"""Fronts of searches as a picture: energy against residual, hypervolume, spread over seeds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter

from metaheuristics.ensemble import STILL, energies_at, energy_at, hypervolumes
from ocp import Front
from studies.display.words import millimetres
from studies.reports.search import reached

_MOST_NAMED = 10
"""More seeds than this are drawn without a name."""
_LOGARITHMIC_FROM = 5.0
"""Residuals that span less than this factor are drawn on a linear axis."""
_LEAST_SPAN = 0.01
"""The axis of energies spans at least this share of their median: seeds that agree lie close."""


def front_figure(fronts: Sequence[Front], title: str = "") -> Figure:
    """Draw fronts of one method: a line for each seed, their hypervolume, and their spread.

    Parameters
    ----------
    fronts : sequence of Front
        One for every seed. Those of interrupted searches are drawn dashed, and count in no
        quartile.
    title : str, optional
        Title of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        Energy against residual; median hypervolume with its quartiles against candidates; for
        several seeds also the least energy of each with a residual of `STILL`, over its quartiles.
    """
    complete = [front for front in fronts if front.complete]
    panels = 3 if len(complete) > 1 else 2
    figure = Figure(figsize=(4.8 * panels, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes: list[Axes] = list(figure.subplots(1, panels, squeeze=False).flat)
    colours = {front.seed: f"C{i % 10}" for i, front in enumerate(fronts)}
    _draw_fronts(axes[0], fronts, colours)
    _draw_hypervolume(axes[1], complete or fronts)
    if panels == 3:
        _draw_energies(axes[2], complete, colours)
    for axis in axes:
        axis.grid(alpha=0.25)
        axis.title.set_fontsize(10)
    if title:
        figure.suptitle(title, fontsize=12)
    return figure


def _draw_fronts(axis: Axes, fronts: Sequence[Front], colours: dict[int | None, str]) -> None:
    for front in fronts:
        if front.points:
            axis.plot(
                front.residuals * 1e3, front.energies, ".-" if front.complete else ".--",
                color=colours[front.seed], markersize=3, linewidth=0.8, alpha=0.8,
                drawstyle="steps-post",  # between two points the stiller one is the best there is
                label=f"seed {front.seed}{'' if front.complete else ', interrupted'}",
            )  # fmt: skip
    scale_residuals(axis, [point.residual * 1e3 for front in fronts for point in front.points])
    axis.set_title("fronts" if len(fronts) > 1 else "front")
    axis.set_xlabel("residual F1 [mm]")
    axis.set_ylabel("energy F2 [J]")
    if 1 < len(fronts) <= _MOST_NAMED and axis.lines:
        axis.legend(fontsize=8)


def scale_residuals(axis: Axes, residuals: Sequence[float]) -> None:
    """Make the axis of residuals logarithmic, or linear where their range is narrow.

    Parameters
    ----------
    axis : matplotlib.axes.Axes
        The axes; residuals go to the right.
    residuals : sequence of float
        All that is drawn [mm].
    """
    positive = [residual for residual in residuals if residual > 0]
    span = max(positive) / min(positive) if positive else 1.0
    if not positive:
        axis.text(0.5, 0.5, "no point", transform=axis.transAxes, ha="center")
    if span < _LOGARITHMIC_FROM or len(positive) < len(residuals):
        axis.xaxis.set_major_locator(MaxNLocator(6))
        return
    axis.set_xscale("log")
    subs = (1.0, 2.0, 5.0) if span < 100 else (1.0,)
    axis.xaxis.set_major_locator(LogLocator(subs=subs, numticks=7))
    axis.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())


def _draw_hypervolume(axis: Axes, fronts: Sequence[Front]) -> None:
    histories = [front.history for front in fronts if front.history]
    axis.set_xlabel("candidates evaluated")
    axis.set_ylabel("share of the reference box")
    axis.xaxis.set_major_locator(MaxNLocator(5))
    if not histories:
        axis.set_title("hypervolume")
        return
    length = min(len(history) for history in histories)
    evaluations = [generation.evaluations for generation in histories[0][:length]]
    table = np.array([[g.hypervolume for g in history[:length]] for history in histories])
    low, middle, high = np.quantile(table, [0.25, 0.5, 0.75], axis=0)
    axis.plot(evaluations, middle, color="tab:blue", label="median")
    spread = hypervolumes(fronts)
    if len(histories) > 1:
        axis.fill_between(evaluations, low, high, alpha=0.3, label="quartiles")
        axis.legend(fontsize=8, loc="lower right")
        axis.set_title(
            f"hypervolume: {spread.median:.4f} ({spread.lower:.4f} to {spread.upper:.4f})"
        )
    else:
        axis.set_title(f"hypervolume: {spread.median:.4f}")


def _draw_energies(axis: Axes, fronts: Sequence[Front], colours: dict[int | None, str]) -> None:
    """The least energy of each seed at `STILL`, its median and quartiles; a cross for none."""
    spread = energies_at(fronts)
    for place, front in enumerate(fronts):
        energy = energy_at(front)
        if np.isfinite(energy):
            axis.plot(place, energy, "o", color=colours[front.seed], markersize=6)
        else:
            axis.plot(
                place, 0.02, "x", color=colours[front.seed], transform=axis.get_xaxis_transform()
            )
    marks = [f"x: never within {millimetres(STILL)}"] * (spread.count < spread.seeds)
    figures = ""
    if spread.count:
        axis.axhspan(spread.lower, spread.upper, alpha=0.2, color="tab:blue")
        axis.axhline(spread.median, color="tab:blue", linewidth=1.0)
        marks += ["line: median", "band: quartiles"]
        figures = f": {spread.median:.4g} J ({spread.lower:.4g} to {spread.upper:.4g})"
    else:
        axis.set_yticks([])
    axis.set_title(f"energy at {millimetres(STILL)}{figures}\n{reached(spread)}")
    axis.set_xlabel(f"seed ({', '.join(marks)})")
    axis.set_ylabel("energy F2 [J]")
    if len(fronts) <= 20:
        axis.set_xticks(range(len(fronts)), [str(front.seed) for front in fronts])
    axis.margins(x=0.1, y=0.2)
    axis.ticklabel_format(axis="y", useOffset=False)
    low, high = axis.get_ylim()
    more = _LEAST_SPAN * spread.median - (high - low)
    if more > 0:  # false where no seed has an energy
        axis.set_ylim(low - more / 2, high + more / 2)
