"""Iterative learning control of a set point, as papers do it: a rival that has no plan.

After each move the set point's acceleration is changed so that a linear model of the swing says
that what was measured after arrival goes away (norm-optimal, with the error seen after the move
alone: van de Wijdeven and Bosgra, 2008). Limits, energy and the arrival's exactness are not asked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from parts.drive.simulate import SetPoints
from scipy.interpolate import BSpline
from scipy.signal import cont2discrete, lfilter

Array = np.ndarray
SHAPES = 24
"""Functions by which a set point may change."""
WEIGHT = 1e-3
"""Of a change, as a share of the largest effect that one has."""


@dataclass(frozen=True)
class SetPointLearning:
    """Learning of a set point, by what a model says of its changes.

    Parameters
    ----------
    frequency
        Of the model [Hz].
    damping
        Its damping ratio.
    rate
        Rows of the set point in a second.
    periods
        That are seen after arrival.
    """

    frequency: float
    damping: float
    rate: float = 1000.0
    periods: float = 2.0

    def next(self, asked: SetPoints, swing: Array) -> SetPoints:
        """The next set point, by what swings after the end of this one [m], a row each."""
        shapes = self._shapes(asked.time)
        effects = self._effects(shapes, len(asked.time))
        seen = swing[: effects.shape[0]]
        weight = WEIGHT * np.linalg.norm(effects, 2) ** 2
        curvature = effects.T @ effects + weight * np.eye(shapes.shape[1])
        sizes = -np.linalg.solve(curvature, effects.T @ (seen - seen.mean()))
        change = shapes @ sizes
        speed = np.cumsum(change) / self.rate
        place = np.cumsum(speed) / self.rate
        return SetPoints(
            asked.time,
            asked.place + place,
            asked.speed + speed,
            asked.acceleration + change,
        )

    def _shapes(self, time: Array) -> Array:
        """Changes of the acceleration (rows, shapes) that end at rest where they began."""
        degree = 3
        knots = np.linspace(time[0], time[-1], SHAPES + degree + 1)
        bumps = np.nan_to_num(
            np.column_stack(
                [BSpline.basis_element(knots[k : k + 5], False)(time) for k in range(SHAPES)]
            )
        )
        speed = np.cumsum(bumps, axis=0) / self.rate
        ends = np.stack([speed[-1], np.sum(speed, axis=0) / self.rate])
        kept = np.linalg.svd(ends)[2][2:].T  # what changes neither the last speed nor the place
        return bumps @ kept

    def _effects(self, shapes: Array, rows: int) -> Array:
        """Return what each change does to the tool after the end (rows, shapes)."""
        omega = 2 * np.pi * self.frequency
        system = ([-1.0], [1.0, 2 * self.damping * omega, omega**2])
        tops, bottom, _ = cont2discrete(system, 1 / self.rate, "foh")
        after = round(self.periods * self.rate / self.frequency)
        padded = np.concatenate([shapes, np.zeros((after, shapes.shape[1]))])
        swings = lfilter(tops[0], bottom, padded, axis=0)[rows:]
        return swings - swings.mean(axis=0)
