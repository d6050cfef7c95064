"""Finite-difference SLSQP: what is left of the gradient where an energy is a black box.

The energy is minimised within one residual limit after another, by derivatives that are forward
differences; every candidate that they take counts. The first has no limit, from a random start.
Those between zero and what the cheapest motion leaves fall, each from the motion of the next larger
one (continuation), or are drawn, each from a random start.

SLSQP ends on constraints, or beyond them by up to its tolerance, where a motion no longer counts.
So it is asked to keep some room (`Differences.over`): of a move's limits a share, since the
verification sees peaks between the steps of a search; of a user's own constraints the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]
TOLERANCE = 1e-6
"""Of SLSQP: at its end the violations may have this sum, and scaled energies this difference."""


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
        self._least: Array | float = np.inf

    def over(self, x: Array) -> Array:
        """Violations of a candidate with room: SLSQP is asked to have none that is positive.

        The room is a share of a move's limits, and `TOLERANCE` of a user's own constraints. Where
        these are kept it is no more than any candidate has left, for a function may return 0 there.
        """
        violations = self.values(x)[self.objectives :]
        left = np.where(violations > 0, np.inf, -self._least)
        return violations + np.maximum(self._function.kept_free, np.minimum(TOLERANCE, left))

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
        """Derivatives of the values, shape (values, variables)."""
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
        self._least = np.minimum(self._least, violations.min(axis=0))
        return np.hstack([objectives, violations])


def slsqp(
    function: Any, seed: int, budget: int, step: float = 1e-6, continuation: bool = True
) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function, seed, budget
        As of `SearchMethod.run`.
    step : float
        Of a difference, as a share of the box.
    continuation : bool
        Start at the motion of the next larger limit, else at random.
    """
    random = np.random.default_rng(seed)
    differences = Differences(function, step)
    limits = _falling_limits if continuation else _random_limits
    while True:
        with suppress(_LostError):
            limits(differences, function, random)


def _falling_limits(differences: Differences, function: Any, random: np.random.Generator) -> None:
    """Limits below that of the cheapest motion, each from the motion of the next larger one."""
    start = random.uniform(function.lower, function.upper)
    motions = {1.0: _least_energy(differences, function, start, np.inf, np.inf)}
    reach = _residual_left(differences, motions[1.0])
    for share in falling_shares():
        above = min(solved for solved in motions if solved > share)
        motions[share] = _least_energy(differences, function, motions[above], share * reach, reach)


def falling_shares() -> Iterator[float]:
    """A half, its half and so on to a thousandth, then middles of the widest gaps.

    They end with some 130 motions: another start tells more then.
    """
    shares = [2.0**-halvings for halvings in range(11)]
    yield from shares[1:]
    while True:
        gaps = -np.diff(shares)
        widest = int(np.argmax(gaps))
        if gaps[widest] < 1 / 64:
            return
        middle = (shares[widest] + shares[widest + 1]) / 2
        shares.insert(widest + 1, middle)
        yield middle


def _random_limits(differences: Differences, function: Any, random: np.random.Generator) -> None:
    """One random limit after another, each from a random start, until a start is lost."""
    start = random.uniform(function.lower, function.upper)
    cheapest = _least_energy(differences, function, start, np.inf, np.inf)
    reach = _residual_left(differences, cheapest)
    while True:
        limit = random.uniform(0.0, reach)
        start = random.uniform(function.lower, function.upper)
        _least_energy(differences, function, start, limit, reach)


def _residual_left(differences: Differences, cheapest: Array) -> float:
    """Residual of the cheapest motion, and more than nothing."""
    return max(float(differences.values(cheapest)[0]), 1e-12)


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
                "fun": lambda x: -differences.over(x),
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
        options={"ftol": TOLERANCE},
    )
    return result.x
