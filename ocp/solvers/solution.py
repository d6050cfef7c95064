"""What a solver gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import daqp
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.solvers.transcription import RESIDUAL

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
        Residual [m] and each limited quantity [SI units], at the nodes.
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
