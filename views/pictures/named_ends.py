"""Names of curves beside their ends, where a legend would send the eye to and fro."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import isotonic_regression


class NamedEnd(NamedTuple):
    """End of a curve, and the name that stands beside it."""

    x: float
    y: float
    name: str
    colour: str


def name_ends(ax: Axes, ends: Sequence[NamedEnd]) -> None:
    """Write a name at the end of each curve, where no two of them touch."""
    top = ax.get_ylim()[1]
    name_right([end for end in ends if end.y < top], ax)
    _name_above([end for end in ends if end.y >= top], ax)


def name_right(ends: Sequence[NamedEnd], ax: Axes) -> None:
    """Names right of the axes, each as high as its curve's end, or where there is room."""
    if not ends:
        return
    gap = 0.09  # of the height of the axes, where letters of 8 points do not touch
    bottom, top = ax.get_ylim()
    ordered = sorted(ends, key=lambda end: end.y)
    steps = gap * np.arange(len(ordered))
    wanted = np.array([(end.y - bottom) / (top - bottom) for end in ordered])
    places = isotonic_regression(wanted - steps).x.clip(0.0, 1.0 - steps[-1]) + steps
    for end, place in zip(ordered, places.tolist()):
        _name(ax, end, (1.04, place), "left", "center")


def _name_above(ends: Sequence[NamedEnd], ax: Axes) -> None:
    """Names above the axes, each left of the place where its curve leaves them."""
    letter = 0.027  # width of a letter of 8 points, as a share of narrow axes
    line = 0.08
    to_axes = ax.transData + ax.transAxes.inverted()
    taken = list[float]()
    for x, end in sorted((float(to_axes.transform((end.x, end.y))[0]), end) for end in ends):
        left = x - letter * len(end.name)
        level = next((k for k, right in enumerate(taken) if right < left), len(taken))
        taken[level : level + 1] = [x]
        _name(ax, end, (x, 1.02 + line * level), "right", "bottom")


def _name(ax: Axes, end: NamedEnd, place: tuple[float, float], ha: str, va: str) -> None:
    """A name at a place of the axes, with a thin line to the end of its curve."""
    ax.annotate(
        end.name, (end.x, end.y), place, xycoords="data", textcoords="axes fraction", ha=ha, va=va,
        fontsize=8, color=end.colour, annotation_clip=False,
        arrowprops={"arrowstyle": "-", "color": end.colour, "linewidth": 0.6, "shrinkA": 1,
                    "shrinkB": 0, "relpos": (0.0, 0.5) if ha == "left" else (1.0, 0.0)},
    )  # fmt: skip
