"""The points of a front that are named in a picture: its ends, its knee and 1 mm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from quietarm.metaheuristics.spread import SEARCH_RESIDUAL
from quietarm.ocp.front.points import has_knee, knee_of
from quietarm.ocp.rest import is_at_rest, rest_of
from quietarm.ocp.task import PointToPoint
from quietarm.views.pictures.grammar import INK
from quietarm.views.tips import tip_scale, tip_words

Array = NDArray[np.float64]


def mark_points(ax: Axes, front: Array, task: PointToPoint, corner: Sequence[float]) -> None:
    """Mark and name points of a front, shape (n, 2): residuals [tip's unit], rising, energies [J].

    The stillest, the cheapest, the knee if the front bends, and what 1 mm allows, each with its
    figures in the legend. The knee is by shares of the `corner`, a front's `reference`.
    """
    if not len(front):
        return
    tip_unit = task.plant.tip_unit
    named = {"stillest": ("<", front[0])}
    if len(front) > 1:
        named["cheapest"] = (">", front[-1])
    of_both = corner[: front.shape[1]]
    if has_knee(front, of_both):
        named["knee"] = ("o", front[knee_of(front, of_both)])
    if front[0, 0] < SEARCH_RESIDUAL < front[-1, 0]:
        energy = float(np.interp(SEARCH_RESIDUAL, front[:, 0], front[:, 1]))
        named[tip_words(SEARCH_RESIDUAL, tip_unit)] = ("|", np.array([SEARCH_RESIDUAL, energy]))
    scale = tip_scale(tip_unit)[1]
    for name, (mark, (residual, energy)) in named.items():
        label = f"{name}: {energy:.4g} J{_place(name, residual, task)}"
        ax.plot(scale * max(residual, rest_of(task)), energy, mark, color=INK, fillstyle="none",
                markersize=8, zorder=4, label=label)  # fmt: skip


def _place(name: str, residual: float, task: PointToPoint) -> str:
    """Say where a named point is, unless its name does."""
    words = tip_words(residual, task.plant.tip_unit)
    if is_at_rest(residual, task):
        words = "rest in the scenarios" if task.ranges else "rest"  # between them more may remain
    return "" if name == words else f" at {words}"
