"""The gradient's fronts as a picture: what was found, what failed, what polish gained."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ocp import Front, Polish
from ocp.front.checking import RESIDUAL_LIMIT
from studies.display.words import millimetres, plant_words
from studies.reports.search_figure import scale_residuals

_STAIRS = "steps-post"  # between two points the stiller one is the best there is


def sweep_figure(front: Front) -> Figure:
    """Draw a front by gradient, the limits that failed, and the gaps that no weight reaches.

    Parameters
    ----------
    front : Front
        The front, with a point at least.

    Returns
    -------
    matplotlib.figure.Figure
        Energy against residual.
    """
    figure, (axis,) = _panels(front, 1)
    _draw_gaps(axis, front)
    axis.plot(
        *_broken_at_gaps(front), ".-" if front.complete else ".--", color="tab:blue",
        markersize=5, linewidth=0.8, drawstyle=_STAIRS,
        label=front.method if front.complete else f"{front.method}, interrupted",
    )  # fmt: skip
    knee = front.knee()
    if len(front.points) > 2:
        axis.plot(
            knee.residual * 1e3, knee.energy, "o", color="tab:blue", fillstyle="none",
            label=f"knee: {knee.energy:.4g} J at {millimetres(knee.residual)}",
        )  # fmt: skip
    _draw_failures(axis, front)
    axis.legend(fontsize=8)
    return figure


def polish_figure(before: Front, polish: Polish) -> Figure:
    """Draw a front before and after polishing, and the share of the energy that was saved.

    Parameters
    ----------
    before : Front
        The front that was given.
    polish : Polish
        What became of it.

    Returns
    -------
    matplotlib.figure.Figure
        Energy, and energy saved [%], against residual.
    """
    figure, (fronts, saved) = _panels(polish.front, 2)
    styles = {"before": (before, "tab:orange"), "after": (polish.front, "tab:blue")}
    for label, (front, colour) in styles.items():
        fronts.plot(
            front.residuals * 1e3, front.energies, ".-", color=colour, markersize=4,
            linewidth=0.8, drawstyle=_STAIRS, label=label,
        )  # fmt: skip
    _draw_failures(fronts, polish.front)
    fronts.legend(fontsize=8)
    gains = [(1e3 * gain.residual, 100 * gain.share) for gain in polish.gains if gain.tried]
    saved.plot(*zip(*gains, strict=True), ".", color="tab:blue", markersize=4)
    saved.set_xlabel("residual F1 [mm]")
    saved.set_ylabel("energy saved [%]")
    saved.set_ylim(bottom=0)
    residuals = 1e3 * np.concatenate([before.residuals, polish.front.residuals])
    for axis in (fronts, saved):
        scale_residuals(axis, residuals.tolist())
    return figure


def _panels(front: Front, panels: int) -> tuple[Figure, list[Axes]]:
    """Panels beside each other, the first for energy against residual."""
    figure = Figure(figsize=(1.6 + 4.8 * panels, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes: list[Axes] = list(figure.subplots(1, panels, squeeze=False).flat)
    task = front.task
    figure.suptitle(
        f"{front.method}, {plant_words(task.plant)}, {np.degrees(task.start):.4g} to "
        f"{np.degrees(task.target):.4g} deg in {task.duration:g} s",
        fontsize=10,
    )
    axes[0].set_xlabel("residual F1 [mm]")
    axes[0].set_ylabel("energy F2 [J]")
    for axis in axes:
        axis.grid(alpha=0.25)
    return figure, axes


def _broken_at_gaps(front: Front) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Residuals [mm] and energies, with a NaN where a gap is."""
    middles = [(begin + end) / 2 for begin, end in front.gaps]
    places = np.searchsorted(front.residuals, middles)
    return np.insert(front.residuals * 1e3, places, np.nan), np.insert(
        front.energies, places, np.nan
    )


def _draw_gaps(axis: Axes, front: Front) -> None:
    label = "no weight reaches these"
    for begin, end in front.gaps:
        axis.axvspan(begin * 1e3, end * 1e3, color="0.5", alpha=0.15, linewidth=0, label=label)
        label = "_"  # once in the legend


def _draw_failures(axis: Axes, front: Front) -> None:
    """Draw a cross on the axis at every residual limit that failed; weights have no residual."""
    limits = [one.asked[RESIDUAL_LIMIT] for one in front.failures if RESIDUAL_LIMIT in one.asked]
    label = f"{len(front.failures)} not found"
    if limits:
        axis.plot(
            np.array(limits) * 1e3, np.full(len(limits), 0.03), "x", color="tab:red",
            transform=axis.get_xaxis_transform(), label=label,
        )  # fmt: skip
    elif front.failures:
        axis.plot([], [], "x", color="tab:red", label=label)
