"""Recordings and what an identified plant makes of them."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from quietarm.studies.figures.looks import BLUE, GREY
from quietarm.studies.identify import Identified, Recording
from quietarm.studies.identify.identification import fitted_parts

_MOST = 8
_UNITS = {"tip": "m, or as recorded", "acceleration": "m/s^2, or as recorded", "torque": "N m"}


def identification_figure(found: Identified, recordings: Sequence[Recording]) -> Figure:
    """Draw the fitted parts of recordings, a panel each.

    Parameters
    ----------
    found : Identified
        By `identify`.
    recordings : sequence of Recording
        Those that it was identified from.

    Returns
    -------
    matplotlib.figure.Figure
        Of up to eight parts, measured and fitted over time.
    """
    parts = list(zip(found.parts, fitted_parts(found, recordings), strict=True))[:_MOST]
    columns = min(2, len(parts))
    rows = -(-len(parts) // columns)
    figure = Figure(figsize=(4.6 * columns, 2.4 * rows), layout="constrained")
    quantity = next(iter(recordings[0].signals))
    panels = figure.subplots(rows, columns, squeeze=False).flat
    for ax, (part, (time, measured, fitted)) in zip(panels, parts, strict=False):
        ax.plot(time, measured[:, 0], color=GREY, linewidth=2.2, label="measured")
        ax.plot(time, fitted[:, 0], color=BLUE, linewidth=1.0, label="fitted")
        ax.set_title(f"{part.recording}: {part.misfit:.1%} left", loc="left", fontsize=8)
        ax.margins(x=0)
        ax.set(xlabel="time [s]", ylabel=f"{quantity} [{_UNITS[quantity]}]")
    for ax in list(panels):
        ax.remove()
    figure.axes[0].legend(fontsize=8, frameon=False)
    return figure
