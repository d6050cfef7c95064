"""The record of an answer: what was asked, by what it was found, and how it was checked."""

from __future__ import annotations

import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from quietarm import __version__
from quietarm.ocp.checks import (
    Count,
    CountFromOne,
    NotNegative,
    Positive,
    finite,
    positive,
    quoted,
    whole,
)

if TYPE_CHECKING:
    from quietarm.ocp.figures import Figures

Setting = str | bool | int | float | None

MOST_BOUND = 1e6
"""With larger coefficients the figures of a motion are rounding noise, and soon overflow."""
AGREEMENT = 1e-3
"""Largest share by which two integrators differ in a verified figure."""


def versions() -> dict[str, str]:
    """Versions of the software that computed an answer."""
    return {
        "quietarm": __version__,
        "casadi": ca.CasadiMeta.version(),
        "numpy": np.__version__,
        "python": platform.python_version(),
    }


@dataclass(frozen=True)
class Record:
    """Method, settings and effort behind an answer.

    Attributes
    ----------
    method : str
        ``"sqp"``, ``"epsilon"``, ``"given coefficients"``, the name of a metaheuristic, ...
    settings : mapping of str to str, bool, int, float or None
        The method's own settings by name.
    bound : float or None
        Largest absolute coefficient that was allowed.
    seed : int or None
        Seed of the random numbers.
    evaluations, iterations : int
        Candidates that a search evaluated; iterations of the gradient's solver in the solves
        that led to the answer.
    versions : mapping of str to str
        Versions of the software.
    seconds : float
        How long it took; not compared.

    Raises
    ------
    ValueError
        When the method has no name, the bound is not positive, or a setting is a number that no
        file could hold.
    """

    method: str
    settings: Mapping[str, Setting] = field(default_factory=dict, hash=False)
    bound: Positive | None = None
    seed: Count | None = None
    evaluations: Count = 0
    iterations: Count = 0
    versions: Mapping[str, str] = field(default_factory=versions, hash=False)
    seconds: NotNegative = field(default=0.0, compare=False)

    def __post_init__(self) -> None:
        if not self.method.strip():
            raise ValueError(f"method is {quoted(self.method)}; give the name of the method")
        longest = 300  # letters: a method may be called by a file, whose name has at most 255
        if len(self.method) > longest:
            raise ValueError(
                f"method has a name of {len(self.method)} letters; give at most {longest}"
            )
        for name, value in self.settings.items():
            if isinstance(value, float):
                finite(f"setting {name}", value)
        if self.bound is not None:
            object.__setattr__(self, "bound", coefficient_bound(self.bound))
        object.__setattr__(self, "settings", dict(self.settings))
        object.__setattr__(self, "versions", dict(self.versions))


def digits(number: float) -> str:
    """A number as text that gives it again: 1, 0.001, 0.30000000000000004."""
    return repr(float(number)).removesuffix(".0")


def number_of_starts(value: object) -> int:
    """A number of starts as an int."""
    return whole("starts", value, 1, 10_000, "each is a solve of a twentieth of a second")


def number_of_points(value: object) -> int:
    """Return the number of points that a front is to have as an int."""
    return whole("points", value, 2, 10_000, "50 show a front, and each takes some solves")


def coefficient_bound(value: object) -> float:
    """A bound on the coefficients as a float."""
    return positive("bound on the coefficients", value, "", MOST_BOUND, "a few tenths are usual")


@dataclass(frozen=True)
class Verification:
    """Differences between fixed steps and the independent integrator, CVODES.

    Attributes
    ----------
    steps : int
        Fixed steps.
    fixed_step_energy, fixed_step_residual, energy_difference, residual_difference : float
        Energy [J] and residual [m] by the fixed steps, and those less the independent integrator's.
    rest : float
        The difference of residuals [m] within which they always agree.
    """

    steps: CountFromOne
    fixed_step_energy: float
    fixed_step_residual: float
    energy_difference: float
    residual_difference: float
    rest: float = 0.0

    @property
    def energy_share(self) -> float:
        """Relative difference of the energies."""
        energy = abs(self.fixed_step_energy - self.energy_difference)
        return abs(self.energy_difference) / max(energy, sys.float_info.min)

    @property
    def agrees(self) -> bool:
        """Return whether the values count as verified: within `AGREEMENT`, or both at rest."""
        residual = abs(self.fixed_step_residual - self.residual_difference)
        close = abs(self.residual_difference) <= AGREEMENT * residual + self.rest
        return self.energy_share <= AGREEMENT and close

    @classmethod
    def between(
        cls, steps: int, energy: float, residual: float, motion: Figures, rest: float = 0.0
    ) -> Verification:
        """Compare values by fixed steps [J, m] with those of CVODES."""
        return cls(
            steps, energy, residual, energy - motion.energy, residual - motion.residual, rest
        )
