"""What a solver is given: a task on its steps, and what is minimised and limited."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.solvers.transcription import ENERGY, RESIDUAL, Transcription

LEAST_ENERGY = {ENERGY: 1.0}


class Scalarization(NamedTuple):
    """What is minimised, and what is limited: one objective made of energy, residual and peaks.

    Attributes
    ----------
    limits : mapping of str to float
        Largest residual [m], 0 for rest on arrival, and largest peaks [SI units]; a quantity
        without an entry is not limited.
    bound : float or None
        Largest absolute coefficient, as the profile's `box` takes it.
    minimise : mapping of str to float
        Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is minimised.
    offset : ndarray, shape (scenarios, 2 * modes), or None
        Added to the state on arrival of every scenario [m, m/s]: what the steps miss of it.
    """

    limits: Mapping[str, float]
    bound: float | None = None
    minimise: Mapping[str, float] = LEAST_ENERGY
    offset: NDArray[np.float64] | None = None

    @property
    def peak(self) -> str | None:
        """The residual or quantity whose peak is minimised."""
        return next((name for name in self.minimise if name != ENERGY), None)

    @property
    def residual_limit(self) -> float:
        """Largest residual [m]; infinite where it is not limited."""
        return self.limits.get(RESIDUAL, np.inf)

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
