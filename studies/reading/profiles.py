"""The joint profiles by the names that a command knows them by."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pkgutil import iter_modules

from quietarm.ocp import JointProfile, PointToPoint, profiles, shaped_cycloid
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.profiles.cycloid import Cycloid

POLYNOMIAL = "polynomial"


def _families() -> dict[str, type[Cycloid]]:
    """The families that stand in the folder of profiles, the paper's first."""
    modules = (
        import_module(f"{profiles.__name__}.{it.name}") for it in iter_modules(profiles.__path__)
    )
    families = {
        kind.name.removeprefix("cycloid-"): kind
        for module in modules
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Cycloid) and hasattr(kind, "name")
    }
    return {POLYNOMIAL: families.pop(POLYNOMIAL), **dict(sorted(families.items()))}


FAMILIES: Mapping[str, type[Cycloid]] = _families()
"""Profiles with coefficients to choose; each takes a number of terms and has one by default."""
OTHERS: Mapping[str, Cycloid] = {
    "network": FAMILIES["network"](),
    "Gaussians": FAMILIES["gaussians"](),
    "spline": FAMILIES["spline"](),
}
"""What stands beside the polynomial in comparisons, by what tables call it, in its default size."""


def profile_of(name: str, task: PointToPoint, terms: int | None = None) -> JointProfile:
    """A profile by its name; a polynomial without a number of terms is the task's."""
    if chooses_terms(name, terms):
        return choose_profile(task)
    if name not in FAMILIES:
        return shaped_cycloid(task, name)
    family = FAMILIES[name]
    return family() if terms is None else family(terms)


def chooses_terms(name: str, terms: int | None) -> bool:
    """Whether the task settles the number of terms: of a polynomial, where none is given."""
    return name == POLYNOMIAL and terms is None
