"""SLSQP with differences: what is left of the gradient where an energy is a black box.

The energy is minimised within one residual limit after another, each from a random start. The first
has no limit; the others are drawn between zero and what the cheapest motion leaves. Derivatives are
forward differences, and every candidate that they take counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]


class _LostError(Exception):
    """SLSQP asks for what is no number, and another start has to follow."""


class Differences:
    """A function of arrays at one candidate after another, with forward differences.

    Parameters
    ----------
    function : callable
        A problem's recorded function.
    step : float
        Of a difference, as a share of the box.
    """

    def __init__(self, function: Any, step: float) -> None:
        self._function = function
        self._lower = function.lower
        self._upper = function.upper
        self._step = step * (function.upper - function.lower)
        self._at: Array | None = None
        self._values: Array
        self._slopes: Array | None = None

    def values(self, x: Array) -> Array:
        """Objectives and then violations of a candidate, as one row."""
        if not np.isfinite(x).all():
            raise _LostError
        x = np.clip(x, self._lower, self._upper)
        if self._at is None or not np.array_equal(x, self._at):
            self._values = self._rows(x[None])[0]
            self._at = x
            self._slopes = None
        return self._values

    def slopes(self, x: Array) -> Array:
        """Derivatives of the same, shape (values, variables)."""
        values = self.values(x)
        x = np.clip(x, self._lower, self._upper)
        slopes = self._slopes
        if slopes is None:
            steps = np.where(x + self._step <= self._upper, self._step, -self._step)
            slopes = ((self._rows(x + np.diag(steps)) - values) / steps[:, None]).T
            self._slopes = slopes
        return slopes

    def _rows(self, candidates: Array) -> Array:
        objectives, violations = self._function(candidates)
        self.objectives = objectives.shape[1]
        return np.hstack([objectives, violations])


def slsqp(function: Any, seed: int, budget: int, step: float = 1e-6) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function : callable
        A problem's recorded function.
    seed : int
        Seed of the starts and limits.
    budget : int
        Candidates that count.
    step : float
        Of a difference, as a share of the box.
    """
    random = np.random.default_rng(seed)
    differences = Differences(function, step)
    reach = np.inf
    while True:
        limit = random.uniform(0.0, reach) if np.isfinite(reach) else np.inf
        start = random.uniform(function.lower, function.upper)
        try:
            cheapest = _least_energy(differences, function, start, limit, reach)
            if not np.isfinite(limit):
                reach = max(float(differences.values(cheapest)[0]), 1e-12)
        except _LostError:
            continue


def _least_energy(
    differences: Differences, function: Any, start: Array, limit: float, reach: float
) -> Array:
    """The end of SLSQP from a start: the energy is scaled by its size there, residuals by `reach`.

    Both residuals are infinite where there is no limit.
    """
    values = differences.values(start)
    energy_scale = 1.0 / max(abs(values[1]), 1e-12)
    first = differences.objectives
    constraints = list[dict[str, Any]]()
    if np.isfinite(limit):
        constraints.append(
            {
                "type": "ineq",
                "fun": lambda x: (limit - differences.values(x)[0]) / reach,
                "jac": lambda x: -differences.slopes(x)[0] / reach,
            }
        )
    if len(values) > first:
        constraints.append(
            {
                "type": "ineq",
                "fun": lambda x: -differences.values(x)[first:],
                "jac": lambda x: -differences.slopes(x)[first:],
            }
        )
    result = minimize(
        lambda x: energy_scale * differences.values(x)[1],
        start,
        jac=lambda x: energy_scale * differences.slopes(x)[1],
        bounds=list(zip(function.lower, function.upper)),
        constraints=constraints,
        method="SLSQP",
    )
    return result.x
