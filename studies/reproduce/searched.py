"""Results of the paper's searches for a move, seed by seed, judged at the paper's residual."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from quietarm.metaheuristics.spread import Spread, energies_at
from quietarm.ocp import CycloidPolynomial, Front, JointProfile, Plan, evaluate_coefficients
from quietarm.ocp.planning.named_profiles import OTHERS
from quietarm.studies.reproduce.paper import Case, residual_level

SIX_TERMS = 6
"""Terms of the polynomial: the paper's choice."""
OLD_CONSTANTS = "N = 6, constants of 2002"
"""Six terms, searched by VEPSO with other constants than the paper's searches here."""
Input = int | str
"""Input of the cycloid: a polynomial by its number of terms, or one of `OTHERS`."""


def profile_with(which: Input) -> JointProfile:
    """The cycloid with this input."""
    terms = which if isinstance(which, int) else SIX_TERMS
    return OTHERS.get(str(which)) or CycloidPolynomial(terms)


@dataclass(frozen=True)
class Searched:
    """Fronts of all seeds, judged within the residual [m] that the paper's coefficients leave.

    Those are the coefficients of as many terms; for other inputs of its six.
    """

    case: Case
    which: Input
    fronts: tuple[Front, ...]

    @cached_property
    def level(self) -> float:
        """Residual at which the searches are judged."""
        terms = self.which if isinstance(self.which, int) else SIX_TERMS
        return residual_level(self.case, min(terms, SIX_TERMS))

    @property
    def energies(self) -> Spread:
        """Quartiles of the least energies [J] within it; a seed without one counts as infinite."""
        return energies_at(self.fronts, self.level)

    @property
    def seconds(self) -> list[float]:
        """Seconds that each seed took."""
        return [front.record.seconds for front in self.fronts]

    @cached_property
    def middle(self) -> Plan | None:
        """The motion of the middle seed; None where that one did not come within the level.

        Of an even number of seeds the dearer one of the two in the middle.
        """
        energies = [front.least_energy(self.level) for front in self.fronts]
        place = np.argsort(energies, kind="stable")[len(energies) // 2]  # those without are last
        if np.isnan(energies[place]):
            return None
        front = self.fronts[place]
        point = front.cheapest(self.level)
        plan = evaluate_coefficients(
            self.case.task,
            point.coefficients,
            profile=front.profile,
        )
        return plan.restated(seconds=front.record.seconds)
