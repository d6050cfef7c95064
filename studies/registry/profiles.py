"""The joint profiles by the names that a command knows them by."""

from __future__ import annotations

from collections.abc import Mapping

from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidPolynomial,
    CycloidSpline,
    JointProfile,
    PointToPoint,
    shaped_cycloid,
)
from quietarm.ocp.profiles.cycloid import Cycloid
from quietarm.ocp.profiles.shapers import SHAPERS

POLYNOMIAL = "polynomial"
FAMILIES: Mapping[str, type[Cycloid]] = {
    POLYNOMIAL: CycloidPolynomial,
    "gaussians": CycloidGaussians,
    "network": CycloidNetwork,
    "spline": CycloidSpline,
}
"""Profiles with coefficients to choose; each takes a number of terms and has one by default."""
PROFILES = (*FAMILIES, *SHAPERS)
OTHERS: Mapping[str, Cycloid] = {
    "network": CycloidNetwork(), "Gaussians": CycloidGaussians(), "spline": CycloidSpline(),
}  # fmt: skip
"""What stands beside the polynomial in comparisons, by what tables call it, in its default size."""


def profile_of(name: str, task: PointToPoint, terms: int | None = None) -> JointProfile:
    """A profile by its name."""
    if name not in FAMILIES:
        return shaped_cycloid(task, name)
    family = FAMILIES[name]
    return family() if terms is None else family(terms)
