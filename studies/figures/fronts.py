"""Fronts as pictures: energy over residual, of one method seed by seed, or of several compared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL, energies_at, energy_at, hypervolumes
from quietarm.ocp import Front, task_difference
from quietarm.studies.figures.axes import (
    axes_or_new,
    draw_front,
    name_objectives,
    scale_residuals,
    side_by_side,
)
from quietarm.studies.figures.looks import BLUE, look
from quietarm.studies.registry.methods import Kind, method_of
from quietarm.studies.report.words import REST, millimetres, title_of

if TYPE_CHECKING:
    pass

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


def draw_fronts(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw energy against residual: a search's front as a staircase, one by gradient as a line.

    Parameters
    ----------
    fronts : sequence of Front
        Of one task, by any methods. Those that were interrupted are drawn dashed.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with a legend where there are a few fronts. Residuals below 0.001 mm, which count
        as rest, are drawn there.
    """
    ax = axes_or_new(ax)
    drawn = [np.maximum(front.residuals, REST) for front in fronts]  # rest has no logarithm
    for i, (front, name) in enumerate(zip(fronts, _names(fronts), strict=True)):
        if front.points:
            style, words = ("-", "") if front.complete else ("--", ", interrupted")
            draw_front(
                ax, drawn[i], front.energies,
                exact=method_of(front.method).kind is Kind.GRADIENT,
                color=look(i).colour, marker=look(i).mark, linestyle=style,
                markersize=3, alpha=0.8, label=f"{name}{words}",
            )  # fmt: skip
    scale_residuals(ax, [1e3 * residual for of in drawn for residual in of])
    ax.set_title("fronts" if len(fronts) > 1 else "front", fontsize=10)
    name_objectives(ax)
    if 1 < len(fronts) <= _MOST_NAMED and ax.lines:
        ax.legend(fontsize=8)
    return ax


def _names(fronts: Sequence[Front]) -> list[str]:
    """What to call every front: its method where there are several, its seed where that tells."""
    methods = [method_of(front.method).label for front in fronts]
    several, names = len(set(methods)) > 1, list[str]()
    for front, method in zip(fronts, methods, strict=True):
        runs = methods.count(method) > 1
        names.append(", ".join([method] * (several or not runs) + [f"seed {front.seed}"] * runs))
    return names


def draw_hypervolume(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw hypervolume against candidates: the median over the seeds, and the quartiles.

    Parameters
    ----------
    fronts : sequence of Front
        Of one method and task, one for every seed.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; the box that the hypervolume is a share of is named beside them.

    Raises
    ------
    ValueError
        When they are of several tasks.
    """
    _refuse_several_tasks(fronts)
    ax = axes_or_new(ax)
    residual, energy = fronts[0].reference
    ax.set_xlabel("candidates evaluated")
    ax.set_ylabel(f"share of the box\nup to {millimetres(residual)} and {energy:.4g} J")
    ax.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    histories = [front.history for front in fronts if front.history]
    if not histories:
        ax.text(0.5, 0.5, "no generation", transform=ax.transAxes, ha="center")
        return ax
    length = min(map(len, histories))
    evaluations = [generation.evaluations for generation in histories[0][:length]]
    table = np.array([[g.hypervolume for g in history[:length]] for history in histories])
    low, middle, high = np.quantile(table, [0.25, 0.5, 0.75], axis=0, method="inverted_cdf")
    mark = "o" if length == 1 else ""  # one generation makes no line
    ax.plot(evaluations, middle, color=BLUE, marker=mark, label="median")
    spread = hypervolumes(fronts)
    words = f"hypervolume: {spread.median:.4f}"
    if len(histories) > 1:
        width = 6 if length == 1 else 0
        ax.fill_between(
            evaluations, low, high, color=BLUE, alpha=0.3, linewidth=width, label="quartiles"
        )
        ax.legend(fontsize=8, loc="lower right")
        words += f" ({spread.lower:.4f} to {spread.upper:.4f})"
    ax.set_title(words, fontsize=10)
    return ax


def draw_seed_energies(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw every seed's least energy within 1 mm, with median and quartiles.

    Parameters
    ----------
    fronts, ax
        As for `draw_hypervolume`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; a seed that never reaches that residual is a cross.
    """
    _refuse_several_tasks(fronts)
    ax, spread, level = axes_or_new(ax), energies_at(fronts), millimetres(SEARCH_RESIDUAL)
    for place, front in enumerate(fronts):
        energy, colour = energy_at(front), look(place).colour
        if np.isfinite(energy):
            ax.plot(place, energy, "o", color=colour, markersize=6)
        else:
            ax.plot(place, 0.02, "x", color=colour, transform=ax.get_xaxis_transform())
    words = f"{spread.count} of {spread.seeds} seeds reach {level}"
    figures = ""
    if np.isfinite(spread.median):
        ax.axhline(spread.median, color=BLUE, linewidth=1.0)
        figures = f": {spread.median:.4g} J"
        if np.isfinite(spread.upper):
            ax.axhspan(spread.lower, spread.upper, alpha=0.2, color=BLUE)
            figures += f" ({spread.lower:.4g} to {spread.upper:.4g})"
    ax.set_title(f"energy at {level}{figures}\n{words}", fontsize=10)
    ax.set_xlabel(f"seed (line: median, band: quartiles, x: never within {level})")
    ax.set_ylabel("energy F2 [J]")
    if len(fronts) <= 2 * _MOST_NAMED:
        ax.set_xticks(range(len(fronts)), [str(front.seed) for front in fronts])
    ax.margins(x=0.1, y=0.2)
    ax.ticklabel_format(axis="y", useOffset=False)
    low, high = ax.get_ylim()
    more = _LEAST_SPAN * (low + high) / 2 - (high - low)
    if not spread.count:
        ax.set_yticks([])
    elif more > 0:
        ax.set_ylim(low - more / 2, high + more / 2)
    return ax


def front_figure(fronts: Sequence[Front], title: str | None = None) -> Figure:
    """Draw fronts of one method: a line for each seed, their hypervolume, and their spread.

    Parameters
    ----------
    fronts : sequence of Front
        One for every seed. Those of interrupted searches are drawn dashed, and count in no
        quartile.
    title : str, optional
        Title of the picture; method and task by default.

    Returns
    -------
    matplotlib.figure.Figure
        Energy against residual; median hypervolume with its quartiles against candidates; for
        several seeds also the least energy of each within 1 mm, over its quartiles.
    """
    complete = [front for front in fronts if front.complete]
    several = len(complete) > 1
    if title is None:
        title = f"{method_of(fronts[0].method).label}: {title_of(fronts[0].task)}"
    figure, axes = side_by_side(3 if several else 2, title)
    draw_fronts(fronts, axes[0])
    draw_hypervolume(complete or fronts, axes[1])
    if several:
        draw_seed_energies(complete, axes[2])
    return figure


def _refuse_several_tasks(fronts: Sequence[Front]) -> None:
    for i, front in enumerate(fronts, 1):
        if difference := task_difference(front.task, fronts[0].task):
            raise ValueError(
                f"front {i} is of another task than front 1: its {difference}; give fronts of one "
                "move"
            )


# Methods compared
