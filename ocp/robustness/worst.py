"""Where between its samples an uncertain plant leaves most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import NotNegative
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.robustness.population import ErrorPopulation
from quietarm.ocp.task import PointToPoint

_ALONG = {1: 201, 2: 41, 3: 15, 4: 9}
"""Errors along each side of the grid, by the number of ranges."""
_ZOOMS, _BESIDE = 3, (-1.0, -0.5, 0.0, 0.5, 1.0)
"""How often the grid around a peak is made finer, and its points in steps of the grid before."""


@dataclass(frozen=True)
class Worst:
    """The errors within an uncertain plant's ranges at which a motion leaves most.

    Attributes
    ----------
    errors : dict of str to float
        Relative errors by name.
    residual : float
        F1 there [m], by CVODES.
    """

    errors: Mapping[str, float] = field(hash=False)
    residual: NotNegative

    def __post_init__(self) -> None:
        object.__setattr__(self, "errors", dict(self.errors))


def peaks_between(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike, most: int = 1
) -> tuple[Worst, NDArray[np.float64]]:
    """The errors within an uncertain plant's ranges at which a motion leaves most.

    And of every peak, the largest first, the residual [m] and errors: looked for by fixed steps,
    valued by CVODES.
    """
    largest = np.array(list(task.ranges.values()))
    population = ErrorPopulation(task.certain, profile, coefficients, dict(task.ranges))
    along = _ALONG[len(largest)]
    shares = _grid(np.linspace(-1, 1, along), len(largest))
    residuals = population(shares * largest).residual
    tops = np.flatnonzero(_is_peak(residuals.reshape([along] * len(largest))))
    tops = tops[np.argsort(-residuals[tops])][:most]
    peaks = [_zoomed(population, largest, shares[i], 2 / (along - 1)).tolist() for i in tops]
    candidate = Candidate.of_profile(task, profile, coefficients)
    named = [dict(zip(task.error_names, errors, strict=True)) for errors in peaks]
    found = [Worst(errors, candidate.perturbed(errors).residual) for errors in named]
    found.sort(key=lambda one: -one.residual)
    return found[0], np.array([[one.residual, *one.errors.values()] for one in found])


def worst_of(task: PointToPoint, profile: JointProfile, coefficients: ArrayLike) -> Worst | None:
    """The largest of `peaks_between`; None where the plant is not uncertain."""
    if task.uncertainty is None:
        return None
    return peaks_between(task, profile, coefficients)[0]


def _grid(along: ArrayLike, ranges: int) -> NDArray[np.float64]:
    return np.stack(np.meshgrid(*[np.asarray(along)] * ranges), axis=-1).reshape(-1, ranges)


def _is_peak(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where a value of a grid is no smaller than its neighbours along every side."""
    peak = np.ones(values.shape, dtype=bool)
    for axis in range(values.ndim):
        rows, of = np.moveaxis(values, axis, 0), np.moveaxis(peak, axis, 0)
        of[1:] &= rows[1:] >= rows[:-1]
        of[:-1] &= rows[:-1] >= rows[1:]
    return peak


def _zoomed(
    population: ErrorPopulation,
    largest: NDArray[np.float64],
    peak: NDArray[np.float64],
    step: float,
) -> NDArray[np.float64]:
    """Errors of the largest residual beside a point of a grid."""
    for zoom in range(_ZOOMS):
        around = np.clip(peak + step / 2**zoom * _grid(_BESIDE, len(peak)), -1, 1)
        peak = around[int(np.argmax(population(around * largest).residual))]
    return peak * largest
