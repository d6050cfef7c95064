"""What the paper's searches find, seed by seed: the middle one, and which one the paper ran."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from statistics import median
from typing import Any

import numpy as np
from quietarm.metaheuristics.ensemble import Spread, energies_at, energy_at
from quietarm.ocp import CycloidPolynomial, Front, JointProfile, Plan, evaluate_coefficients
from quietarm.studies.paper import (
    ARM_HALF,
    CONDITIONS,
    EARLIER,
    PAPER_SEARCH,
    SINGLE_LINK_SIXTH,
    Case,
    residual_level,
)
from quietarm.studies.registry.methods import Method
from quietarm.studies.registry.profiles import OTHERS

SEARCHES = tuple(PAPER_SEARCH.values())
"""The paper's two searches, in its order."""
COMPARED_TERMS = 6
"""Terms of the polynomial: the paper's choice."""
BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""

Input = int | str
"""Input of the cycloid: a polynomial by its number of terms, another by its name in `OTHERS`."""


def profile_with(which: Input) -> JointProfile:
    """The cycloid with this input."""
    return OTHERS[which] if isinstance(which, str) else CycloidPolynomial(which)


def input_name(which: Input) -> str:
    """What it is called in tables."""
    return which if isinstance(which, str) else f"N = {which}"


def earlier_input(case: Case) -> str:
    """What the earlier study of a move's plant moves the joint with."""
    return EARLIER[case.task.plant.name][1]


def own_search(case: Case) -> Method:
    """The paper's search for a move's plant."""
    return PAPER_SEARCH[case.task.plant.name]


LIKE_FOR_LIKE = tuple(
    dict.fromkeys(
        (own_search(case), case, which)
        for case, which in (
            *((case, earlier_input(case)) for case in CONDITIONS),
            *product(CONDITIONS, [COMPARED_TERMS]),
            *product(STUDIED, (2, 4, *BEYOND_SIX)),
        )
    )
)
"""The paper's experiment: its search for a plant, a move, and an input of the cycloid."""


@dataclass(frozen=True)
class Searched:
    """What a search's seeds found for a move; they are judged within a residual [m]."""

    case: Case
    level: float
    fronts: tuple[Front, ...]

    @classmethod
    def among(
        cls, answers: Mapping[Hashable, Any], method: Method, case: Case, which: Input, seeds: int
    ) -> Searched:
        """What a method found, among the answers of all pieces."""
        return cls.of(case, which, tuple(answers[method, case, which, s] for s in range(seeds)))

    @classmethod
    def of(cls, case: Case, which: Input, fronts: tuple[Front, ...]) -> Searched:
        """Judged as the paper's coefficients of as many terms are; other inputs as its six."""
        terms = min(which, COMPARED_TERMS) if isinstance(which, int) else COMPARED_TERMS
        return cls(case, residual_level(case, terms), fronts)

    @cached_property
    def energies(self) -> Spread:
        """Least energies [J] within the level."""
        return energies_at(self.fronts, self.level)

    @property
    def seconds(self) -> float:
        """What a seed takes, at the median."""
        return median(front.seconds for front in self.fronts)

    @cached_property
    def middle(self) -> Plan | None:
        """The motion of the middle seed; None where that one did not come within the level.

        Of an even number of seeds the dearer one of the two in the middle.
        """
        energies = [energy_at(front, self.level) for front in self.fronts]
        order = np.argsort(energies, kind="stable")  # those that did not are last
        place = order[len(order) // 2]
        if np.isnan(energies[place]):
            return None
        front = self.fronts[place]
        found = front.cheapest(self.level)
        plan = evaluate_coefficients(self.case.task, found.coefficients, profile=front.profile)
        return replace(plan, provenance=replace(plan.provenance, seconds=front.seconds))


Experiment = Mapping[tuple[Case, Input], Searched]
"""The paper's experiment: every move with every input, by the paper's own search."""
