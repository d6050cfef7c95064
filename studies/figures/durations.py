"""A move over its duration, as a picture."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from quietarm.ocp.front.durations import OverDuration
from quietarm.studies.figures.axes import logarithmic, new_figure
from quietarm.studies.figures.looks import BLUE, GREEN, GREY


def durations_figure(found: OverDuration) -> Figure:
    """Energies and residuals over the duration."""
    figure = new_figure(9.0, 3.8)
    energy, residual = figure.subplots(1, 2)
    times = [one.duration for one in found.points]
    plans = [one.plan for one in found.points]
    cycloids = [one.cycloid for one in found.points]
    # None becomes NaN
    spent = np.array([plan and plan.energy for plan in plans], float)
    left = np.array([plan and 1e3 * plan.residual for plan in plans], float)
    floors = np.array([one.floor for one in found.points], float)
    energy.plot(times, [one.energy for one in cycloids], "s-", color=GREY, label="plain cycloid")
    energy.plot(times, spent, "o-", color=BLUE, label="plan")
    energy.plot(times, floors, "--", color=GREEN, label="floor")
    energy.set(xlabel="duration [s]", ylabel="energy F2 [J]")
    shown = np.array([*spent, *floors, *(one.energy for one in cycloids)])
    logarithmic(energy, float(np.nanmax(shown) / np.nanmin(shown)), "y")
    residual.plot(times, [1e3 * one.residual for one in cycloids], "s-", color=GREY)
    residual.plot(times, left, "o-", color=BLUE)
    residual.set(xlabel="duration [s]", ylabel="residual F1 [mm]")
    energy.legend(frameon=False)
    for ax in (energy, residual):
        ax.grid(alpha=0.25)
    none = [one.duration for one in found.points if one.plan is None]
    if none:
        energy.axvspan(min(times), max(none), color="0.92", zorder=0)
        energy.text(max(none), 0.02, "no plan ", transform=energy.get_xaxis_transform(), ha="right")
    return figure
