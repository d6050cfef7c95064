"""What is asked of a program, and what a solver gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolveStatus

ENERGY, RESIDUAL = "energy", "residual"
LEAST_ENERGY = {ENERGY: 1.0}
STILL, STILL_SHARE = 1e-8, 1e-7
"""A motion counts as at rest on arrival up to this verified residual: in metres, or as a share of
the plain cycloid's residual, whichever is larger."""


class Scalarization(NamedTuple):
    """What is asked of a program.

    Attributes
    ----------
    limits : mapping of str to float
        Largest residual [m], 0 for rest on arrival, and peaks [SI units]; a quantity without an
        entry is free.
    bound : float or None
        Largest absolute coefficient, as the profile's `box` takes it.
    minimise : mapping of str to float
        Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is made least.
    offset : ndarray, shape (2 * modes,), or None
        What the steps miss of the state on arrival [m, m/s].
    """

    limits: Mapping[str, float]
    bound: float | None = None
    minimise: Mapping[str, float] = LEAST_ENERGY
    offset: NDArray[np.float64] | None = None

    @property
    def least(self) -> str | None:
        """The peak that is made least."""
        return next((name for name in self.minimise if name != ENERGY), None)

    @property
    def at_rest(self) -> bool:
        """Whether rest on arrival is asked for."""
        return self.limits.get(RESIDUAL, np.inf) == 0 and self.least != RESIDUAL


@dataclass(frozen=True)
class Solution:
    """What a solver gives for one start, in SI units and by its own discretisation.

    Attributes
    ----------
    coefficients : ndarray, shape (profile.size,)
        The profile's coefficients.
    energy : float
        F2 [J].
    peaks : dict of str to float
        Residual [m] and each limited quantity [SI units], at the nodes.
    status : SolveStatus
        How it ended.
    iterations : int
        Iterations of the solver that it took, those of other starts included.
    arrival : ndarray, shape (2 * modes,)
        W (m) and then W' (m/s) on arrival, corrected as asked.
    prices : dict of str to float
        By how much the least energy falls if a limit is widened [J by the limit's unit]; of the
        residual, too, where rest on arrival is asked for.
    reason : str
        How it ended, in the solver's own words.
    """

    coefficients: NDArray[np.float64]
    energy: float
    peaks: dict[str, float]
    status: SolveStatus
    iterations: int
    arrival: NDArray[np.float64]
    prices: dict[str, float] = field(default_factory=dict)
    reason: str = ""

    @property
    def residual(self) -> float:
        """F1 [m] at the sampled times of the residual window."""
        return self.peaks[RESIDUAL]

    @property
    def slope(self) -> float:
        """Change of the least energy with the residual limit [J/m], at most 0."""
        return -self.prices.get(RESIDUAL, 0.0)
