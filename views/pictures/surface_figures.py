"""Fronts of three objectives and more: a peak as colour, and every objective side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from quietarm.ocp import Front
from quietarm.ocp.checks import takes
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.objectives import Objective, objectives_on
from quietarm.ocp.rest import is_at_rest, rest_of
from quietarm.views.pictures.axes import LOGARITHMIC_FROM, axes_or_new, logarithmic, name_objectives
from quietarm.views.pictures.grammar import look
from quietarm.views.tips import tip_scale


@takes(fronts=[Front])
def draw_peak(fronts: Sequence[Front], ax: Axes | None = None, peak: int = 0) -> Axes:
    """Draw energy against residual, a mark a point, with a peak as its colour.

    Parameters
    ----------
    fronts : sequence of Front
        Of one task and the same objectives; each has marks of its own.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    peak : int
        Which of the peaks that are objectives, from 0.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with a scale of the colours beside them.

    Raises
    ------
    ValueError
        When the fronts have no such peak.
    """
    ax = axes_or_new(ax)
    first = fronts[0]
    residual, _, *peaks = objectives_on(first.task.plant, first.objectives)
    if not 0 <= peak < len(peaks):
        raise ValueError(f"peak is {peak}, and the front has {len(peaks)}; give one from 0")
    scale = tip_scale(residual.unit)[1]
    rest = rest_of(first.task)
    values = [front.objective_values for front in fronts]
    column = len(first.objectives) - len(peaks) + peak
    shown = [_shown(peaks[peak], table[:, column]) for table in values]
    together = np.concatenate(shown)
    limits: Any = {"vmin": float(together.min()), "vmax": float(together.max())}
    marks = None
    for i, (table, colours) in enumerate(zip(values, shown)):
        residuals = np.maximum(table[:, 0], rest) * scale
        marks = ax.scatter(
            residuals, table[:, 1], c=colours, cmap="viridis", s=16, marker=look(i).mark, **limits
        )
    logarithmic(
        ax,
        np.concatenate([np.maximum(table[:, 0], rest) for table in values]),
        least_span=LOGARITHMIC_FROM,
    )
    name_objectives(ax, residual.unit, first.task.residual_window)
    assert marks is not None
    ax.figure.colorbar(marks, ax=ax, label=_label(peaks[peak]))
    return ax


@takes(fronts=[Front])
def draw_parallel(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw every objective on an axis of its own, a line a point: parallel coordinates.

    Parameters
    ----------
    fronts : sequence of Front
        Of one task and the same objectives. Each has a colour; of a single front the colour is that
        of its residuals.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. Each objective goes from its least value below to its largest above.
    """
    ax = axes_or_new(ax)
    first = fronts[0]
    objectives = objectives_on(first.task.plant, first.objectives)
    values = [front.objective_values for front in fronts]
    together = np.vstack(values)
    least = together.min(axis=0)
    extent = np.ptp(together, axis=0)
    extent = np.where(extent > 0, extent, 1.0)
    places = np.arange(len(objectives))
    for i, table in enumerate(values):
        scaled = (table - least) / extent
        if len(fronts) == 1:
            by_residual = np.argsort(np.argsort(scaled[:, 0])) / max(len(scaled) - 1, 1)
            colours = _viridis(by_residual)
        else:
            colours = [look(i).colour] * len(scaled)
        for row, colour in zip(scaled, colours):
            ax.plot(places, row, color=colour, linewidth=0.6, alpha=0.6)
    names = ["\n".join([*objective.label.split(), _unit(objective)]) for objective in objectives]
    ax.set_xticks(places, names, fontsize=8)
    ax.set_yticks([])
    ax.set_ylabel("from the least to the largest [unit below]")
    for place, objective, low, size in zip(places, objectives, least, extent):
        at_rest = objective.name == RESIDUAL and is_at_rest(low, first.task)
        ends = [f"{end:.3g}" for end in _shown(objective, np.array([low, low + size]))]
        for height, end, side in ((0.0, "rest" if at_rest else ends[0], "top"),
                                  (1.0, ends[1], "bottom")):  # fmt: skip
            ax.annotate(
                end, (place, height), xytext=(0, -3 if side == "top" else 3),
                textcoords="offset points", ha="center", va=side, fontsize=8,
            )  # fmt: skip
    ax.set_ylim(-0.12, 1.12)
    ax.set_xlim(-0.4, len(objectives) - 0.6)
    return ax


def _viridis(shares: NDArray[np.float64]) -> list[tuple[float, ...]]:
    from matplotlib import colormaps

    return [tuple(colour) for colour in colormaps["viridis"](shares)]


def _shown(objective: Objective, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values in the unit that is shown."""
    return values * tip_scale(objective.unit)[1]


def _label(objective: Objective) -> str:
    return f"{objective.label} {_unit(objective)}"


def _unit(objective: Objective) -> str:
    return f"[{tip_scale(objective.unit)[0]}]"
