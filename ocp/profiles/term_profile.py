"""Families of profiles with a number of terms, as a polynomial has; the command line lists them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from inspect import isabstract
from pathlib import Path
from pkgutil import iter_modules
from typing import ClassVar, Self

from quietarm.ocp.checks import known, whole
from quietarm.ocp.profiles.joint_profile import JointProfile

MAX_TERMS = 32
"""Most terms of any family."""


@dataclass(frozen=True)
class TermProfile(JointProfile):
    """A family with one member for each number of terms: ``--profile NAME --terms 6``.

    A family has a `name` and an `angle`. Its coefficients are as many as its terms, unless it says
    otherwise.

    Parameters
    ----------
    terms : int
        How many terms, `least_terms` to `most_terms`.
    """

    term: ClassVar[str] = "term"
    least_terms: ClassVar[int] = 1
    most_terms: ClassVar[int] = MAX_TERMS
    fixed_coefficients: ClassVar[int] = 0
    """Coefficients that every member has, before those of its terms."""
    coefficients_of_term: ClassVar[int] = 1
    terms: int = 6

    def __post_init__(self) -> None:
        why = "beyond that double precision no longer distinguishes the terms"
        terms = whole("terms", self.terms, self.least_terms, self.most_terms, why)
        object.__setattr__(self, "terms", terms)

    @property
    def amount(self) -> str:
        """Size of the profile in words, such as 6 terms."""
        return f"{self.terms} {self.term}{'s' if self.terms != 1 else ''}"

    @classmethod
    def of_size(cls, size: int) -> Self:
        """The family's member that has so many coefficients; ValueError where none has."""
        terms, rest = divmod(size - cls.fixed_coefficients, cls.coefficients_of_term)
        if rest:
            raise ValueError(
                f"got {size} coefficients; {cls.name} has {cls.fixed_coefficients}, and "
                f"{cls.coefficients_of_term} for every {cls.term}; give so many numbers"
            )
        return cls(terms)

    @property
    def size(self) -> int:
        """Number of coefficients of the profile."""
        return self.fixed_coefficients + self.coefficients_of_term * self.terms


def known_term_profiles() -> Mapping[str, type[TermProfile]]:
    """The families by name: those of this folder, and of files that were loaded since."""
    import_profiles()
    return {name: family for name, family in known(TermProfile).items() if not isabstract(family)}


def import_profiles() -> None:
    """Import every module of this folder, so that its profiles are known by name."""
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")
