"""Fronts in one picture: whole, the nearly still end, and how far above the best."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter
from numpy.typing import NDArray

from studies.comparison.measures import Comparison
from studies.comparison.staircase import within
from studies.methods import EPSILON, NSGA2, VEPSO, WEIGHTED
from studies.paper.points import PaperPoint

_COLOURS = {
    EPSILON: "#0072B2", NSGA2: "#D55E00", VEPSO: "#009E73", WEIGHTED: "#56B4E9",
    NSGA2.then_polished(): "#E69F00", VEPSO.then_polished(): "#CC79A7",
}  # fmt: skip
_SPARE = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#000000")
"""Okabe and Ito's colours, which colour-blind people can tell apart; their yellow is too pale."""
_DASHES = {
    WEIGHTED: (0, (1, 1)),
    NSGA2.then_polished(): "--",
    VEPSO.then_polished(): (0, (4, 1, 1, 1)),
}
_STILLEST = 1e-6
"""The logarithmic axes begin at this residual [m]: below it, differences do not matter."""
_TALLEST = 1.6
"""Panels end at this multiple of the energy of the best nearly still motion."""

BANDS = (
    "Several seeds: the line is what half of them reach\n"
    "(of two, the better one), the band best to worst"
)

Array = NDArray[np.float64]
Dash = str | tuple[int, tuple[int, ...]]


@dataclass(frozen=True)
class _Look:
    colour: str
    dash: Dash
    width: float


def looks(comparison: Comparison) -> dict[str, _Look]:
    """Colour and dashes of every group, by label; a method keeps its own where it can."""
    found: dict[str, _Look] = {}
    taken: set[str] = set()
    spare = cycle(_SPARE)
    for group in comparison.groups:
        colour = _COLOURS.get(group.method, "")
        if not colour or colour in taken:
            colour = next((c for c in _SPARE if c not in taken), None) or next(spare)
        dash = _DASHES.get(group.method, "-") if colour not in taken else ":"
        taken.add(colour)
        below = len(comparison.groups) - len(found) - 1  # wider, to be seen below those after it
        found[group.label] = _Look(colour, dash, 1.2 + 0.45 * below)
    return found


def comparison_figure(
    comparison: Comparison, paper: Sequence[PaperPoint] = (), title: str = ""
) -> Figure:
    """Draw fronts over each other.

    Parameters
    ----------
    comparison : Comparison
        The fronts.
    paper : sequence of PaperPoint, optional
        The paper's own points.
    title : str, optional
        Title of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels: whole fronts; the nearly still end, residual logarithmic; points above the
        best of all. Of several seeds the median attainment surface, in a band from the best to
        the worst. The legend stands beside the third.
    """
    figure = Figure(figsize=(10, 7.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes: list[Axes] = list(figure.subplots(2, 2).flat)
    for axis, draw, letter in zip(axes, PANELS.values(), "abc", strict=False):
        draw(axis, comparison, paper)
        axis.set_title(f"({letter}) {axis.get_title(loc='left')}", fontsize=10, loc="left")
    axes[3].axis("off")
    several = any(len(group.runs) > 1 for group in comparison.groups)
    axes[3].legend(
        *_legend(axes), loc="center left", frameon=False, fontsize=10, alignment="left",
        title=BANDS if several else None,
    )  # fmt: skip
    if title:
        figure.suptitle(title, fontsize=12)
    return figure


def panel_figure(comparison: Comparison, panel: str, paper: Sequence[PaperPoint] = ()) -> Figure:
    """Draw one of `PANELS` alone, small enough for a phone, with the legend below it."""
    figure = Figure(figsize=(4.8, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    axis = figure.subplots()
    PANELS[panel](axis, comparison, paper)
    figure.legend(
        *_legend([axis]),
        loc="outside lower center",
        ncols=2,
        frameon=False,
        fontsize=8.5,
        markerscale=2 if panel == "gaps" else 1,
    )
    return figure


def _legend(axes: Sequence[Axes]) -> tuple[list[Artist], list[str]]:
    entries: dict[str, Artist] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    return list(entries.values()), list(entries)


def draw_whole(axis: Axes, comparison: Comparison, paper: Sequence[PaperPoint] = ()) -> None:
    """Draw energy against residual, both linear."""
    right = 1.04 * _right(comparison)
    _draw_fronts(axis, comparison, paper, right)
    axis.set_xlim(0, right * 1e3)
    axis.set_xlabel("residual F1 [mm]")
    axis.set_title("the whole fronts", fontsize=10, loc="left")


def draw_still(axis: Axes, comparison: Comparison, paper: Sequence[PaperPoint] = ()) -> None:
    """Draw energy against residual at the nearly still end, residual logarithmic."""
    right = max(comparison.levels)
    _draw_fronts(axis, comparison, paper, right)
    _logarithmic(axis, comparison, right)
    axis.set_title("the nearly still end", fontsize=10, loc="left")


def draw_gaps(axis: Axes, comparison: Comparison, paper: Sequence[PaperPoint] = ()) -> None:
    """Draw how far points are above the best of all filled fronts, residual logarithmic.

    Points rather than staircases: between its points a coarse front would look bad by its steps.
    """
    for group in comparison.groups:
        look = looks(comparison)[group.label]
        residuals, energies = group.median.T
        gap = 100 * (energies / within(comparison.best_front, residuals) - 1)
        axis.plot(
            np.maximum(residuals, _left(comparison)) * 1e3, gap, ".", color=look.colour,
            markersize=3.5 + 1.2 * look.width, markeredgewidth=0, label=group.label,
        )  # fmt: skip
    axis.set_yscale("symlog", linthresh=0.1, linscale=0.5)
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_ylim(-0.008, None)
    axis.set_ylabel("energy above the best [%]")
    _logarithmic(axis, comparison, _right(comparison))
    axis.set_title("each point above the best of all", fontsize=10, loc="left")


PANELS: dict[str, Callable[[Axes, Comparison, Sequence[PaperPoint]], None]] = {
    "whole": draw_whole,
    "still": draw_still,
    "gaps": draw_gaps,
}


def _draw_fronts(
    axis: Axes, comparison: Comparison, paper: Sequence[PaperPoint], right: float
) -> None:
    """Draw staircases up to a residual [m], the paper's points and the floor."""
    for group in comparison.groups:
        look = looks(comparison)[group.label]
        stairs = np.concatenate([group.best[:, 0], group.median[:, 0], group.worst[:, 0], [right]])
        stairs = np.unique(stairs[stairs <= right])
        best, median, worst = (within(s, stairs) for s in (group.best, group.median, group.worst))
        if len(group.runs) > 1:
            axis.fill_between(
                stairs * 1e3, best, worst, step="post", color=look.colour, alpha=0.2, linewidth=0
            )
        axis.plot(
            stairs * 1e3, median, color=look.colour, linestyle=look.dash, linewidth=look.width,
            drawstyle="steps-post", label=group.label,
        )  # fmt: skip
    marks = cycle("*Pv")
    for point in paper:
        if point.residual is None:
            axis.axhline(point.energy, color="black", lw=1, ls=":", label=point.label)
        else:
            axis.plot(
                point.residual * 1e3, point.energy, next(marks), color="black", markersize=11,
                markeredgecolor="white", linestyle="", label=point.label, zorder=5,
            )  # fmt: skip
    if comparison.floor is not None:
        label = "floor: any joint motion, at rest"
        axis.axhline(comparison.floor, color="0.45", linewidth=1.2, linestyle="-.", label=label)
    axis.set_ylim(*_energies_shown(comparison, paper, right))
    axis.set_ylabel("energy F2 [J]")
    axis.grid(alpha=0.25)


def _energies_shown(
    comparison: Comparison, paper: Sequence[PaperPoint], right: float
) -> tuple[float, float]:
    still = min(group.best[0, 1] for group in comparison.groups)
    top = min(max(group.median[0, 1] for group in comparison.groups), _TALLEST * still)
    marks = [point.energy for point in paper]
    marks += [] if comparison.floor is None else [comparison.floor]
    ends = [within(group.best, np.array([right]), np.inf)[0] for group in comparison.groups]
    low, high = min([*marks, *ends, still]), max([*marks, top])
    margin = 0.06 * ((high - low) or high)
    return low - margin, high + margin


def _left(comparison: Comparison) -> float:
    stillest = min(group.best[0, 0] for group in comparison.groups)
    return max(_STILLEST, min([stillest, *comparison.levels]))


def _right(comparison: Comparison) -> float:
    ends = [group.best[-1, 0] for group in comparison.groups]
    return max([*ends, *comparison.levels])


def _logarithmic(axis: Axes, comparison: Comparison, right: float) -> None:
    axis.set_xscale("log")
    axis.set_xlim(_left(comparison) * 1e3, right * 1e3)
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("residual F1 [mm], logarithmic")
    axis.grid(alpha=0.25)
    for level in comparison.levels:
        axis.axvline(level * 1e3, color="0.75", linewidth=0.8, zorder=0)
