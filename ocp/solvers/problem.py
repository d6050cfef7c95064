"""What a solver is given, a task on its steps with what is minimised and limited; what it gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import daqp
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.solvers.transcription import ENERGY, Transcription

LEAST_ENERGY = {ENERGY: 1.0}


class Scalarization(NamedTuple):
    """What is minimised, and what is limited: one objective made of energy, residual and peaks.

    Attributes
    ----------
    limits : tuple of Limit
        Of the residual, 0 for rest on arrival, and of quantities.
    bound : float or None
        Largest absolute coefficient, as the profile's `box` takes it.
    minimise : mapping of str to float
        Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is minimised.
    offset : ndarray, shape (scenarios, 2 * modes), or 0
        Added to the state on arrival of every scenario [m, m/s]: what the steps miss of it.
    """

    limits: tuple[Limit, ...]
    bound: float | None = None
    minimise: Mapping[str, float] = LEAST_ENERGY
    offset: NDArray[np.float64] | float = 0.0

    @property
    def peak(self) -> str | None:
        """The residual or quantity whose peak is minimised."""
        return next((name for name in self.minimise if name != ENERGY), None)

    def weights(self, energy_scale: float, peak_scale: float) -> tuple[float, float]:
        """Weights of the scaled energy and of the scaled peak, the larger of them 1."""
        of_energy = self.minimise.get(ENERGY, 0.0) * energy_scale
        of_peak = self.minimise[self.peak] * peak_scale if self.peak else 0.0
        largest = max(of_energy, of_peak)
        return of_energy / largest, of_peak / largest

    @property
    def residual_limit(self) -> float:
        """Largest residual [m]; infinite where it is not limited."""
        return max((one.size for one in self.limits if one.name == RESIDUAL), default=np.inf)

    @property
    def at_rest(self) -> bool:
        """Whether the state on arrival has to be the wanted one."""
        return self.residual_limit == 0 and self.peak != RESIDUAL

    @property
    def bounds_residual(self) -> bool:
        """Whether the residual stands in an inequality."""
        return self.peak == RESIDUAL or (np.isfinite(self.residual_limit) and not self.at_rest)


class Problem(NamedTuple):
    """A nonlinear program over a profile's coefficients."""

    transcription: Transcription
    scalarization: Scalarization

    @classmethod
    def of(
        cls,
        transcription: Transcription,
        residual_limit: float = np.inf,
        bound: float | None = None,
        minimise: Mapping[str, float] = LEAST_ENERGY,
    ) -> Problem:
        """Within a task's limits and one of the residual [m], the least energy or another sum."""
        limits = Limit.of_residual(residual_limit), *transcription.task.limits
        return cls(transcription, Scalarization(limits, bound, minimise))


_LITTLE = 1e-8
"""Curvature that makes a linear program a quadratic one."""


@dataclass(frozen=True)
class Solution:
    """What a solver gives for one start, in SI units and by its own steps.

    Attributes
    ----------
    coefficients : ndarray, shape (profile.size,)
        The profile's coefficients.
    energy : float
        F2 [J].
    peaks : mapping of str to float
        Residual [m] and each limited quantity [SI units] by name, as of `Limit.peak`, at the nodes.
    status : SolveStatus
        How it ended.
    iterations : int
        Iterations of the solver; `best_of_starts` adds those of the other starts.
    arrival : ndarray, shape (scenarios, 2 * modes)
        W [m] and then W' [m/s] on arrival in every scenario, with the scalarization's offset.
    shadow_prices : mapping of str to float
        By how much the least energy falls if a limit is widened [J by the limit's unit]; of the
        residual, too, where rest on arrival is asked for.
    reason : str
        How it ended, in the solver's own words.
    """

    coefficients: NDArray[np.float64]
    energy: float
    peaks: Mapping[str, float]
    status: SolveStatus
    iterations: int
    arrival: NDArray[np.float64]
    shadow_prices: Mapping[str, float] = field(default_factory=dict)
    reason: str = ""

    @property
    def residual(self) -> float:
        """F1 [m] at the sampled times of the residual window."""
        return self.peaks[RESIDUAL]

    @property
    def slope(self) -> float:
        """Change of the least energy with the residual limit [J/m], at most 0."""
        return -self.shadow_prices.get(RESIDUAL, 0.0)


def shadow_prices(
    asked: Scalarization,
    of_energy: float,
    bounded: Mapping[str, NDArray[np.float64]],
    of_arrival: NDArray[np.float64],
    tips: NDArray[np.float64],
) -> dict[str, float]:
    """What the least energy falls by if a limit is widened [J by its unit], from multipliers.

    Those of what is bounded, by name, and of the arrival are of SI units, and of an objective with
    the factor `of_energy` of the energy [1/J]. The tips are rows as of `price_of_rest`.
    """
    if of_energy == 0:
        return {}
    prices = {
        limit.name: limit.price(bounded[limit.name]) / of_energy
        for limit in asked.limits
        if limit.name in bounded and limit.name != asked.peak
    }
    if asked.at_rest:
        prices[RESIDUAL] = price_of_rest(of_arrival, tips) / of_energy
    return prices


def price_of_rest(multipliers: NDArray[np.float64], rows: NDArray[np.float64]) -> float:
    """The most that the objective falls by for a residual of 1 m, from the arrival's multipliers.

    The largest product of the multipliers, shape (2 * modes,), and a state on arrival whose
    residual is 1 m by the rows, shape (rows, 2 * modes): a linear program, with a little curvature
    for the solver of quadratic ones.
    """
    scale = np.abs(rows).max(axis=0)
    slope, table = multipliers / scale, rows / scale
    limit, steepest = np.ones(len(table)), np.abs(slope).max() or 1.0
    state, *_ = daqp.solve(_LITTLE * np.eye(len(slope)), -slope / steepest, table, limit, -limit)
    return float(slope @ np.asarray(state))
