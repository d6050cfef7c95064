"""What one run of the solver gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ocp.base.status import SolveStatus
from ocp.program.ipopt import Point
from ocp.program.transcription import RESIDUAL, Form

ENERGY = "energy"
LEAST_ENERGY = {ENERGY: 1.0}
_SAME = 1e-4
STILL, STILL_SHARE = 1e-8, 1e-7
"""A motion counts as at rest on arrival up to this verified residual: in metres, or as a share of
the plain cycloid's residual, whichever is larger."""


@dataclass(frozen=True)
class Solution:
    """What one run of the solver gives, in SI units and by its own discretisation.

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
    slope : float
        Change of the least energy with the residual limit [J/m], at most 0; 0 without a limit.
    iterations : int
        Iterations of the solver that it took, those of other starts included.
    arrival : ndarray, shape (2 * modes,)
        W (m) and then W' (m/s) on arrival, corrected as asked.
    form : Form
        The program whose solution it is.
    point : Point
        Where the solver stopped, to start a neighbouring solve from.
    settled : bool
        Whether the program of the resolved energy ended at its minimum.
    """

    coefficients: NDArray[np.float64]
    energy: float
    peaks: dict[str, float]
    status: SolveStatus
    slope: float
    iterations: int
    arrival: NDArray[np.float64]
    form: Form
    point: Point
    settled: bool = False

    @property
    def residual(self) -> float:
        """F1 [m] at the sampled times of the residual window."""
        return self.peaks[RESIDUAL]


def same_minimum(one: Solution, other: Solution) -> bool:
    """Whether the sampled program ended at the same place."""
    size = len(one.coefficients)
    here, there = one.point.unknowns[:size], other.point.unknowns[:size]
    return one.form == other.form and np.allclose(here, there, rtol=_SAME, atol=_SAME)
