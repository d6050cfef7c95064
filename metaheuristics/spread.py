"""The spread of what several seeds of one method find."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quietarm.ocp import Front

SEARCH_RESIDUAL = 1e-3
"""Residual [m] at which the energies of searches are compared."""


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of a quantity over seeds; a missing value counts as infinite.

    Attributes
    ----------
    lower, median, upper : float
        Over all seeds: observed quartiles, and of an even number of seeds the mean of the two in
        the middle; infinite if they fall on a seed without a value.
    count, seeds : int
        How many seeds have a value, of how many.
    """

    lower: float
    median: float
    upper: float
    count: int
    seeds: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Return the quartiles over seeds; infinite if there are none."""
        known = (
            np.where(
                np.isfinite(values),
                values,
                np.inf,
            )
            if len(values)
            else [np.inf]
        )
        lower, upper = np.quantile(
            known,
            [0.25, 0.75],
            method="inverted_cdf",
        ).tolist()
        count = int(np.isfinite(values).sum())
        return cls(lower, float(np.median(known)), upper, count, seeds=len(values))


def hypervolumes(fronts: Sequence[Front]) -> Spread:
    """Quartiles of the final hypervolume, as a share of the area up to the reference."""
    from quietarm.metaheuristics.score import final_share_of_box  # loads moocore

    return Spread.of([final_share_of_box(front) for front in fronts])


def energies_at(fronts: Sequence[Front], residual_limit: float = SEARCH_RESIDUAL) -> Spread:
    """Quartiles of the least energy [J] with a residual within the limit [m]."""
    return Spread.of([front.least_energy(residual_limit) for front in fronts])
