"""What a front is made of: points, failures, generations; and which points stay."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from numbers import Real

import numpy as np
from quietarm.ocp.base.checks import listed, of_kind
from quietarm.ocp.base.ranges import Count, NotNegative, Share

LEVELS = (1e-4, 1e-3, 5e-3)
"""Residuals [m] at which the energies of fronts are compared; those that are compared have a point
at each, where they can."""


@dataclass(frozen=True)
class FrontPoint:
    """One motion on a front: its coefficients, residual F1 [m] and energy F2 [J].

    Any numbers will do, NumPy's as well. `Front` checks which points it may have.

    Raises
    ------
    ValueError
        When an entry is no number.
    """

    coefficients: tuple[float, ...]
    residual: NotNegative
    energy: NotNegative

    def __post_init__(self) -> None:
        try:
            coefficients = tuple(float(value) for value in self.coefficients)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(
                f"coefficients are {reprlib.repr(self.coefficients)}; give numbers"
            ) from None
        object.__setattr__(self, "coefficients", coefficients)
        for name in ("residual", "energy"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, Real):
                raise ValueError(f"{name} is {reprlib.repr(value)}; give a number")
            object.__setattr__(self, name, float(value))


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

    Raises
    ------
    ValueError
        When one is no point.
    """
    given = listed("points", points, "a list of FrontPoint")
    for i, point in enumerate(given, start=1):
        of_kind(f"point {i}", point, FrontPoint, "a FrontPoint")
    finite = [p for p in given if np.isfinite(p.residual) and np.isfinite(p.energy)]
    kept: list[FrontPoint] = []
    for point in sorted(finite, key=lambda p: (p.residual, p.energy)):
        if not kept or point.energy < kept[-1].energy:
            kept.append(point)
    return tuple(kept)
