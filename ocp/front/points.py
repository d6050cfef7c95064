"""What a front is made of: points, failures, generations; and which points stay."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from quietarm.ocp.base.ranges import Count, NotNegative, Share

LEVELS = (1e-4, 1e-3, 5e-3)
"""Residuals [m] at which the energies of fronts are compared; those that are compared have a point
at each, where they can."""


@dataclass(frozen=True)
class FrontPoint:
    """One motion on a front: its coefficients, residual F1 [m] and energy F2 [J].

    Any numbers will do, NumPy's as well. `Front` checks which points it may have.
    """

    coefficients: tuple[float, ...]
    residual: NotNegative
    energy: NotNegative

    def __post_init__(self) -> None:
        object.__setattr__(self, "coefficients", tuple(map(float, self.coefficients)))
        object.__setattr__(self, "residual", float(self.residual))
        object.__setattr__(self, "energy", float(self.energy))


@dataclass(frozen=True)
class FailedPoint:
    """A point that a sweep looked for and did not find.

    Attributes
    ----------
    asked : mapping of str to float
        What was asked for: a residual limit [m], or the weights of the objectives.
    reason : str
        Why there is none.
    """

    asked: Mapping[str, float] = field(hash=False)
    reason: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "asked", dict(self.asked))


@dataclass(frozen=True)
class Generation:
    """The state of a search after one generation.

    Attributes
    ----------
    evaluations : int
        Candidates evaluated so far.
    hypervolume : float
        Share of the reference box (`Front.reference`) that the points found dominate.
    """

    evaluations: Count
    hypervolume: Share


def non_dominated(points: Iterable[FrontPoint]) -> tuple[FrontPoint, ...]:
    """The points that no other beats in both objectives, in order of residual.

    Parameters
    ----------
    points : iterable of FrontPoint
        Any points; those that are not finite are left out, of equal ones the first is kept.

    Returns
    -------
    tuple of FrontPoint
        Sorted by residual; energies fall.
    """
    finite = [p for p in points if np.isfinite(p.residual) and np.isfinite(p.energy)]
    kept: list[FrontPoint] = []
    for point in sorted(finite, key=lambda p: (p.residual, p.energy)):
        if not kept or point.energy < kept[-1].energy:
            kept.append(point)
    return tuple(kept)
