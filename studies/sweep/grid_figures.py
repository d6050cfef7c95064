"""Figures of moves over a grid."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from quietarm.ocp.rest import rest_of
from quietarm.studies.sweep.definition import STATES, STATUS
from quietarm.studies.sweep.move_grid import Axis
from quietarm.studies.sweep.store import Store
from quietarm.studies.sweep.sweep_rows import figure_spans
from quietarm.views.pictures.axes import (
    TITLE,
    head,
    logarithmic,
    name_objectives,
    new_figure,
    residual_label,
)
from quietarm.views.pictures.grammar import BROWN, FAINT, GREY, HEAT, PALE, PINK, PLAN, RED, SKY
from quietarm.views.report.captions import caption_of_cells
from quietarm.views.report.words import limit_words, moved
from quietarm.views.tips import tip_scale

Array = NDArray[np.float64]
_MOST_SLICES = 4
_LEAST_PRICE = 1e-6
"""Shadow prices of the residual below this [J by the tip's unit] are none."""


def grid_figure(store: Store) -> Figure:
    """Energy, residual, price of the residual and how cells ended, over the last two axes.

    A row of panels for each of the first values of the axes before; along one axis alone, lines.
    """
    axes = store.definition.grid.axes
    if len(axes) == 1:
        return _over_one(store, axes[0])
    places = [*np.ndindex(*store.definition.grid.shape[:-2])][:_MOST_SLICES]
    slices = [(place, _words(axes, place)) for place in places]
    all_variables = _variables(store)
    variables = [known for known in all_variables if (known[1] > known[2]).any()]
    variables = variables or all_variables[:1]
    several_states = len(np.unique(store.read(STATUS))) > 1
    count = len(variables) + several_states
    figure = new_figure(1.2 + 3.6 * count, 1.2 + 3.1 * len(slices))
    _head(figure, store)
    panels = figure.subplots(len(slices), count, squeeze=False, sharex=True, sharey=True)
    (x, x_name) = _shown(axes[-1])
    (y, y_name) = _shown(axes[-2])
    for column, (label, values, least) in enumerate(variables):
        norm = _norm(values)
        panels[0, column].set_title(label, **TITLE)
        for ax, (place, _) in zip(panels[:, column], slices):
            ax.patch.set(hatch="///", edgecolor=FAINT, facecolor="white")
            ax.pcolormesh(x, y, values[place], norm=norm, cmap=HEAT, shading="nearest")
            if not (values > least).any():
                words = f"at most {least:g}"
                ax.text(0.5, 0.5, words, transform=ax.transAxes, ha="center", color="white")
        if (values > least).any():
            ticks = _ticks_of(norm)
            bar = figure.colorbar(ScalarMappable(norm, HEAT), ax=list(panels[:, column]),
                                  ticks=ticks, format="{x:g}")  # fmt: skip
            bar.minorticks_off()
    if several_states:
        _states(figure, panels[:, -1], x, y, store, places)
    for row, (_, words) in zip(panels, slices):
        row[0].set_ylabel(f"{words}\n{y_name}" if words else y_name)
    for ax in panels[-1]:
        ax.set_xlabel(x_name)
    return figure


def fronts_figure(store: Store) -> Figure:
    """Fronts over the last axis, a panel for each of the first values of those before."""
    axes = store.definition.grid.axes
    residual = store.read("front_residual")
    energy = store.read("front_energy")
    tip_unit = store.definition.grid.task.plant.tip_unit
    places = [*np.ndindex(*residual.shape[:-2])][:_MOST_SLICES]
    figure = new_figure(1.8 + 4.0 * len(places), 4.2)
    _head(figure, store)
    panels = figure.subplots(1, len(places), squeeze=False, sharey=True)[0]
    values, name = _shown(axes[-1])
    norm = Normalize(float(values.min()), float(values.max()))
    colours = ScalarMappable(norm, HEAT)
    for ax, place in zip(panels, places):
        for k, value in enumerate(values):
            shown_residual = tip_scale(tip_unit)[1] * residual[(*place, k)]
            ax.plot(shown_residual, energy[(*place, k)], color=colours.to_rgba(value))
        ax.set_title(_words(axes, place), loc="left", fontsize=9)
        name_objectives(ax, tip_unit, store.definition.grid.task.residual_window)
        ax.grid(alpha=0.25)
        logarithmic(ax, energy.ravel(), "y")
    figure.colorbar(colours, ax=list(panels), label=name)
    return figure


def _head(figure: Figure, store: Store) -> None:
    """Write the heading of a grid: how many cells have a plan, its energies, what they leave."""
    task = store.definition.grid.task
    plant = ", ".join([moved(task), *limit_words(task)])
    spans = [f"{label} {words}" for label, words in figure_spans(store)]
    cells = caption_of_cells(store.read("energy"), store.read("residual"), task, spans)
    head(figure, cells, plant)


def _over_one(store: Store, axis: Axis) -> Figure:
    figure = new_figure(5.5, 8.0)
    _head(figure, store)
    variables = _variables(store)
    panels = figure.subplots(len(variables), 1, sharex=True)
    values, name = _shown(axis)
    without = np.isnan(store.read("energy"))
    for ax, (label, shown, _) in zip(panels, variables):
        ax.plot(values, shown, marker=PLAN.mark, color=PLAN.colour)
        if not (shown < 0).any():
            logarithmic(ax, shown, "y")
        ax.plot(values[without], np.full(without.sum(), 0.02), "x", color=RED,
                transform=ax.get_xaxis_transform())  # fmt: skip
        ax.set_ylabel(label)
        ax.grid(alpha=0.25)
    panels[-1].set_xlabel(name + (" (x: no plan)" if without.any() else ""))
    return figure


def _variables(store: Store) -> list[tuple[str, Array, float]]:
    """Return what is shown and known: labels, values no less than the least, the least."""
    task = store.definition.grid.task
    shown, scale = tip_scale(task.plant.tip_unit)
    residual = residual_label(task.plant.tip_unit, task.residual_window)
    variables = {
        "energy": ("energy [J]", 1.0, 0.0),
        "residual": (residual, scale, rest_of(task) * scale),
        "price_residual": (f"shadow price [J/{shown}]", 1 / scale, _LEAST_PRICE / scale),
    }
    for figure in store.figures:
        unit = figure.unit_on(task.plant)
        variables[figure.name] = f"{figure.label_on(task.plant)} [{unit or '-'}]", 1.0, -np.inf
    all_variables = [
        (label, np.maximum(factor * store.read(name), least), least)
        for name, (label, factor, least) in variables.items()
    ]
    return [
        variable for variable in all_variables if np.isfinite(variable[1]).any()
    ] or all_variables[:1]


def _words(axes: tuple[Axis, ...], place: tuple[int, ...]) -> str:
    return ", ".join(
        f"{axis.name} {axis.values[k]:.4g} {axis.unit}" for axis, k in zip(axes, place)
    )


def _norm(values: Array) -> Normalize:
    """Colours by the logarithm of what is known; by the values themselves if one is negative."""
    finite = values[np.isfinite(values)]
    if (finite < 0).any():
        return Normalize(float(finite.min()), float(finite.max()))
    known = finite[finite > 0]
    if not known.size:
        return Normalize(0.0, 1.0)
    least = float(known.min())
    most = float(known.max())
    return LogNorm(least, most) if most > 1.01 * least else LogNorm(least / 2, 2 * most)


def _ticks_of(norm: Normalize) -> LogLocator | None:
    """The ticks of a logarithmic scale of colours; None for matplotlib's own."""
    if not isinstance(norm, LogNorm) or norm.vmin is None or norm.vmax is None:
        return None
    few = norm.vmax < 1e3 * norm.vmin
    return LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,))


def _states(
    figure: Figure, panels: NDArray[np.object_], x: Array, y: Array, store: Store,
    places: list[tuple[int, ...]],
) -> None:  # fmt: skip
    """Draw how cells ended, in colours of their own."""
    # how cells ended, in the order of `STATES`; told apart in print by their lightness as well
    colours = (PALE, PLAN.colour, SKY, RED, PINK, BROWN, GREY)
    status = store.read(STATUS)
    present = sorted({*np.unique(status).astype(int).tolist()})
    cmap = ListedColormap([colours[k] for k in present])
    numbers = np.searchsorted(present, status)
    norm = BoundaryNorm(np.arange(len(present) + 1) - 0.5, len(present))
    panels[0].set_title("how it ended", **TITLE)
    for ax, place in zip(panels, places):
        ax.pcolormesh(x, y, numbers[place], norm=norm, cmap=cmap, shading="nearest")
    bar = figure.colorbar(ScalarMappable(norm, cmap), ax=list(panels), ticks=range(len(present)))
    bar.ax.set_yticklabels([STATES[k] for k in present])


def _shown(axis: Axis) -> tuple[Array, str]:
    factor, unit = (np.degrees(1.0), "deg") if axis.unit == "rad" else (1.0, axis.unit)
    return factor * np.array(axis.values), f"{axis.name} [{unit}]"
