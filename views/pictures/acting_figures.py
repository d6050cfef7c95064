"""Times when a tool may act, over the band that it has to stay within, for a few motions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from quietarm.interrupts import interruptible
from quietarm.views.pictures.axes import axes_or_new, head, logarithmic, new_figure
from quietarm.views.pictures.grammar import LIMIT, looks
from quietarm.views.pictures.named_ends import NamedEnd, name_ends
from quietarm.views.tips import tip_scale, tip_words

if TYPE_CHECKING:
    from quietarm.studies.compare.compared_motions import ComparedMotion

MOST_CURVES = 5
"""In one picture: more cannot be told apart."""
_WIDEST = 100.0
_NARROWEST = 0.5
"""Bands that are drawn, as multiples of the one that was asked for."""
_BANDS = 25


@interruptible
def draw_acting(
    motions: Sequence[ComparedMotion], ax: Axes | None = None, tip_unit: str = "m"
) -> Axes:
    """Draw when the tool may act in the worst case, over the band that it has to stay within.

    Parameters
    ----------
    motions : sequence of ComparedMotion
        Motions that were judged by a band, with `compare_plans(..., band=...)`; at most the first
        five of them are drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    tip_unit : str
        Unit of the plant's tips, m or rad.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: the time to act [s] over the band, which narrows to the right. Each curve has its
        name at its end, and a dotted line is at the band that was asked for.
    """
    ax = axes_or_new(ax)
    judged = [motion for motion in motions if motion.acting is not None][:MOST_CURVES]
    shown, scale = tip_scale(tip_unit)
    ax.set(xlabel=f"the tip stays within [{shown}]", ylabel="it may act after [s]")
    if not judged:
        return ax
    found = [motion.acting for motion in judged if motion.acting is not None]
    band = found[0].band
    bands = np.geomspace(_WIDEST * band, _NARROWEST * band, _BANDS)
    times = [acting.latest_of(bands) for acting in found]
    bottom, top = _shown_times(times, [motion.duration or 0.0 for motion in judged])
    ends = list[NamedEnd]()
    for motion, how, of_one in zip(judged, looks([one.meaning for one in judged]), times):
        ax.plot(
            scale * bands, of_one, color=how.colour, linestyle=how.dash, linewidth=how.width,
            label=motion.name,
        )  # fmt: skip
        ends.append(_end_of(scale * bands, of_one, top, motion.name, how.colour))
    ax.axvline(scale * band, color=LIMIT.colour, linewidth=LIMIT.width, linestyle=LIMIT.dash)
    logarithmic(ax, scale * bands)
    ax.set_xlim(scale * bands[0], scale * bands[-1])
    ax.set_ylim(bottom, top)
    name_ends(ax, ends)
    return ax


def _shown_times(times: Sequence[np.ndarray], durations: Sequence[float]) -> tuple[float, float]:
    """The ends of the axis of times [s]: a motion that rings for long leaves it."""
    latest = max(float(of_one.max()) for of_one in times)
    earliest = min(float(of_one.min()) for of_one in times)
    most = min(1.3 * max(durations), latest)
    room = 0.08 * (most - earliest)
    return earliest - room, most + room


def _end_of(bands: np.ndarray, times: np.ndarray, top: float, name: str, colour: str) -> NamedEnd:
    """The last point of a curve below the end of the axis."""
    last = int(np.flatnonzero(times <= top)[-1]) if np.any(times <= top) else 0
    if last + 1 == len(bands):
        return NamedEnd(float(bands[-1]), float(times[-1]), name, colour)
    after = times[last + 1]
    share = 0.0 if math.isinf(after) else (top - times[last]) / (after - times[last])
    x = math.exp(float(np.interp(share, (0, 1), np.log(bands[last : last + 2]))))
    return NamedEnd(x, top, name, colour)


@interruptible
def acting_figure(motions: Sequence[ComparedMotion], title: str, tip_unit: str = "m") -> Figure:
    """Draw `draw_acting` below one line that answers who may act first."""
    figure = new_figure(6.4, 4.0)
    head(figure, title)
    ax = draw_acting(motions, figure.subplots(), tip_unit)
    acting = next((motion.acting for motion in motions if motion.acting is not None), None)
    if acting is not None:
        ranges = ", ".join(f"{name} ±{100 * size:g} %" for name, size in acting.ranges.items())
        ax.set_ylabel(f"it may act after [s], {ranges}")
        words = tip_words(acting.band, tip_unit)
        ax.annotate(
            words, (tip_scale(tip_unit)[1] * acting.band, 0.02), (-3, 0), fontsize=8, ha="right",
            xycoords=("data", "axes fraction"), textcoords="offset points", color=LIMIT.colour,
        )  # fmt: skip
    return figure
