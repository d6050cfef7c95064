"""The joint profiles by the names that a command knows them by."""

from __future__ import annotations

from collections.abc import Mapping

from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidSpline,
    JointProfile,
    PointToPoint,
    TermProfile,
    shaped_cycloid,
)
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.profiles.term_profile import known_term_profiles

POLYNOMIAL = "polynomial"


def families() -> dict[str, type[TermProfile]]:
    """Profiles with a number of terms, by the names that a command takes, the paper's first.

    Each has terms by default. Those of a user's own file are there once it is loaded.
    """
    by_name = {
        name.removeprefix("cycloid-"): family for name, family in known_term_profiles().items()
    }
    return {POLYNOMIAL: by_name.pop(POLYNOMIAL), **dict(sorted(by_name.items()))}


OTHERS: Mapping[str, TermProfile] = {
    "network": CycloidNetwork(),
    "Gaussians": CycloidGaussians(),
    "spline": CycloidSpline(),
}
"""What stands beside the polynomial in comparisons, by what tables call it, in its default size."""


def profile_of(name: str, task: PointToPoint, terms: int | None = None) -> JointProfile:
    """A profile by its name; a polynomial without a number of terms is the task's."""
    if chooses_terms(name, terms):
        return choose_profile(task)
    family = families().get(name)
    if family is None:
        return shaped_cycloid(task, name)
    return family() if terms is None else family(terms)


def chooses_terms(name: str, terms: int | None) -> bool:
    """Return whether the task settles the number of terms: of a polynomial, if none is given."""
    return name == POLYNOMIAL and terms is None
