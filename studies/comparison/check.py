"""Whether the figures of a front are those of its motions."""

from __future__ import annotations

import numpy as np

from ocp import Front
from studies.comparison.staircase import objective_of

SHARE = 1e-3
"""Largest relative difference of an energy or a residual: integrators differ by less."""
REST = 1e-6
"""Difference of residuals [m] that counts as none."""


def check_figures(front: Front, name: str) -> None:
    """Evaluate a few motions of a front again, and refuse it where the figures differ.

    The first point, the middle one and the last: a file that was edited or converted rarely keeps
    all three as they were.

    Parameters
    ----------
    front : Front
        The front; an empty one passes.
    name : str
        What to call it in a message.

    Raises
    ------
    ValueError
        When an energy differs by more than `SHARE`, or a residual by more than that and `REST`.
    """
    count = len(front.points)
    if not count:
        return
    places = sorted({0, count // 2, count - 1})
    coefficients = np.array([front.points[i].coefficients for i in places])
    values = objective_of(front.task, front.profile)(coefficients)
    for i, residual, energy in zip(places, values.residual, values.energy, strict=True):
        point = front.points[i]
        for quantity, unit, stated, found, least in (
            ("residual", "m", point.residual, residual, REST),
            ("energy", "J", point.energy, energy, 0.0),
        ):
            if not abs(stated - found) <= SHARE * abs(found) + least:
                raise ValueError(
                    f"{name}: point {i + 1} of {count} states {quantity} {stated:.4g} {unit}, but "
                    f"its coefficients give {found:.4g} {unit}; find the front again"
                )
