"""Energies over a grid of moves."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from quietarm.studies.figures.axes import logarithmic, new_figure
from quietarm.studies.figures.looks import look
from quietarm.studies.sweep.grid import Axis
from quietarm.studies.sweep.store import Store

_MOST_PANELS = 6


def grid_figure(store: Store) -> Figure:
    """Energies over the last two axes, a panel for each of the first values of those before.

    Cells without a plan are hatched; along one axis alone it is a line.
    """
    axes, energy = store.grid.axes, store.read("energy")
    if len(axes) == 1:
        figure = new_figure(5.5, 3.6)
        ax, look_of = figure.subplots(), look(0)
        values, unit = _shown(axes[0])
        ax.plot(values, energy, look_of.mark + "-", color=look_of.colour)
        logarithmic(ax, float(np.nanmax(energy) / np.nanmin(energy)), "y")
        ax.set(xlabel=f"{axes[0].name} [{unit}]", ylabel="energy F2 [J]")
        return figure
    rows = energy.reshape(-1, *energy.shape[-2:])[:_MOST_PANELS]
    places = [*np.ndindex(*energy.shape[:-2])][:_MOST_PANELS]
    figure = new_figure(1.2 + 3.6 * min(len(rows), 3), 3.4 * -(-len(rows) // 3))
    panels = figure.subplots(-(-len(rows) // 3), min(len(rows), 3), squeeze=False, sharey=True)
    (x, x_unit), (y, y_unit) = _shown(axes[-1]), _shown(axes[-2])
    norm = LogNorm(float(np.nanmin(energy)), float(np.nanmax(energy)))
    for ax, one, place in zip(panels.flat, rows, places, strict=False):
        ax.patch.set(hatch="///", edgecolor="0.75", facecolor="white")
        ax.pcolormesh(x, y, one, norm=norm, cmap="viridis", shading="nearest")
        words = [f"{axis.name} {axis.values[k]:.4g} {axis.unit}"
                 for axis, k in zip(axes, place, strict=False)]  # fmt: skip
        ax.set_title(", ".join(words), loc="left", fontsize=9)
        ax.set_xlabel(f"{axes[-1].name} [{x_unit}]")
    panels[0, 0].set_ylabel(f"{axes[-2].name} [{y_unit}]")
    for ax in panels.flat[len(rows) :]:
        ax.remove()
    shown = [ax for ax in panels.flat if ax.figure is not None]
    ticks = LogLocator(subs=(1.0, 2.0, 5.0))
    bar = figure.colorbar(
        ScalarMappable(norm, "viridis"),
        ax=shown,
        label="energy F2 [J]",
        ticks=ticks,
        format="{x:g}",
    )
    bar.minorticks_off()
    return figure


def _shown(axis: Axis) -> tuple[np.ndarray, str]:
    values = np.array(axis.values)
    return (np.degrees(values), "deg") if axis.unit == "rad" else (values, axis.unit)
