"""Recordings and what an identified plant makes of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from quietarm.interrupts import interruptible
from quietarm.machine import Recording
from quietarm.machine.identify import Identified, Part
from quietarm.machine.identify.fits.diagnosis import spectrum_of
from quietarm.machine.identify.identification import curve_of
from quietarm.models.dimensions import EFFORT, words_of
from quietarm.models.plant import FREQUENCY
from quietarm.views.pictures.axes import new_figure
from quietarm.views.pictures.grammar import BLUE, FAINT, GREY, INK, RED
from quietarm.views.report.words import span_words

_MOST = 6
"""Parts that are drawn; of more the first."""


@interruptible
def identification_figure(machine: Identified, recordings: Sequence[Recording]) -> Figure:
    """Draw the fitted parts of recordings, and the frequency over parts.

    Parameters
    ----------
    found : Identified
        By `identify`.
    recordings : sequence of Recording
        Those that it was identified from.

    Returns
    -------
    matplotlib.figure.Figure
        A row a part: measured and fitted over time, below it the residuals; beside them their
        spectrum. At the end, of several parts, the first parameter of each, and the
        intervals of the mean and of the next swing.
    """
    drawn = machine.parts[:_MOST]
    several = len(machine.parts) > 1 and machine.estimates
    figure = new_figure(9.0, 2.5 * len(drawn) + 2.6 * bool(several) + 0.3)
    rows = figure.subfigures(len(drawn) + bool(several), 1, squeeze=False)[:, 0]
    for row, part in zip(rows, drawn):
        _draw_part(row, machine, part, recordings)
    figure.axes[0].legend(
        fontsize=7, frameon=False, loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderpad=0
    )
    if several:
        _over_parts(rows[-1], machine)
    return figure


def _draw_part(row: Any, machine: Identified, part: Part, recordings: Sequence[Recording]) -> None:
    """Measured and fitted, the residuals, and their spectrum."""
    effort = EFFORT.of(machine.plant.joint)
    units = {"tip": "m, or as recorded", "acceleration": "m/s²", "torque": effort}
    grid = row.add_gridspec(2, 2, width_ratios=(2.2, 1), height_ratios=(2, 1))
    over = row.add_subplot(grid[0, 0])
    below = row.add_subplot(grid[1, 0], sharex=over)
    spectrum = row.add_subplot(grid[:, 1])
    recording = next(candidate for candidate in recordings if candidate.name == part.recording)
    model, signals = curve_of(machine, part, recordings)
    time = model.time
    fitted = signals[:, 0]
    residual = np.where(model.counts, model.values[:, 0] - fitted, np.nan)
    size = max(float(np.abs(fitted - fitted.mean()).max()), 1e-300)
    piece = recording.part(recording.rows(part.begin, part.end))
    over.plot(piece.time, piece.values[:, 0], color=GREY, linewidth=2.2, label="measured")
    over.plot(time, fitted, color=BLUE, linewidth=1.0, label="fitted")
    over.set_title(
        f"{part.recording}, {span_words(part.begin, part.end)}: misfit {part.misfit:.1%}, "
        f"noise {part.noise:.1%}", loc="left", fontsize=8,
    )  # fmt: skip
    quantity = next(iter(recording.signals))
    joint = machine.plant.joint
    label = words_of(quantity).of(joint)
    over.set_ylabel(f"{label}\n[{units[quantity]}]", fontsize=8)
    over.tick_params(labelbottom=False)
    gap = np.append(np.diff(time) > 3 * np.median(np.diff(time)), False)
    below.plot(time, np.where(gap, np.nan, 100 * residual / size), color=RED, linewidth=0.6)
    below.axhline(0, color=FAINT, linewidth=0.5)
    below.set_ylabel("residual [%]", fontsize=8)
    below.set_xlabel("time [s]", fontsize=8)
    at, amplitude = spectrum_of(time[model.counts], residual[model.counts, None])
    spectrum.loglog(at[1:], 100 * amplitude[1:] / size + 1e-9, color=RED, linewidth=0.7)
    for frequency in _frequencies(machine, part):
        spectrum.axvline(frequency, color=BLUE, linewidth=0.8, linestyle="--")
    for axis in (spectrum.xaxis, spectrum.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    spectrum.set_title("spectrum of the residuals", loc="left", fontsize=8)
    spectrum.set_xlabel("frequency [Hz]", fontsize=8)
    spectrum.set_ylabel("[% of the swing]", fontsize=8)
    for ax in (over, below, spectrum):
        ax.tick_params(labelsize=7)
        ax.margins(x=0)


def _frequencies(machine: Identified, part: Part) -> list[float]:
    kinds = machine.plant.parameter_kinds()
    return [value / (2 * pi) for name, value in part.values.items() if kinds[name] == FREQUENCY]


def _over_parts(row: Any, machine: Identified) -> None:
    """The identified parameters of every part, with both intervals."""
    axes = row.subplots(1, len(machine.estimates[:2]), squeeze=False)[0]
    units = machine.plant.units()
    kinds = machine.plant.parameter_kinds()
    number = np.arange(1, len(machine.parts) + 1)
    for ax, estimate in zip(axes, machine.estimates):
        hertz = kinds[estimate.parameter] == FREQUENCY
        size = 2 * pi if hertz else 1.0
        values = np.array([part.values[estimate.parameter] for part in machine.parts]) / size
        spread = (
            1.96 * np.array([part.deviations[estimate.parameter] for part in machine.parts]) / size
        )
        if estimate.next_low is not None and estimate.next_high is not None:
            ends = estimate.next_low / size, estimate.next_high / size
            ax.axhspan(*ends, color=GREY, alpha=0.35, linewidth=0, label="next swing, 95 %")
        ends = estimate.low / size, estimate.high / size
        ax.axhspan(*ends, color=BLUE, alpha=0.35, linewidth=0, label="mean, 95 %")
        ax.errorbar(number, values, spread, fmt="o", color=INK, markersize=3, linewidth=0.8)
        ax.set_xlabel("ring-down", fontsize=8)
        ax.set_ylabel(
            "frequency [Hz]" if hertz else f"{estimate.parameter} [{units[estimate.parameter]}]",
            fontsize=8,
        )
        ax.xaxis.get_major_locator().set_params(integer=True)
        ax.ticklabel_format(axis="y", useOffset=False)
        ax.tick_params(labelsize=7)
        ax.legend(fontsize=7, frameon=False, loc="lower right", bbox_to_anchor=(1, 1), ncols=2)
