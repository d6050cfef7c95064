"""Algorithms of pymoo 0.6.2 that draw random numbers without the seed, keep state, or fail.

With these, the seed of a search determines its result, and a population of failures is no error.
Nothing else is changed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.moo import cmopso, ctaea, mopso_cd, nsga3, spea2, unsga3
from pymoo.core.population import Population
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.util.archive import MultiObjectiveArchive, Truncation

Winners = NDArray[np.int64]


def _decided(pairs: Winners, first_less_second: NDArray[np.float64], random_state: Any) -> Winners:
    """The lesser of each pair, shape (pairs, 1); one at random where they are equal."""
    coins = random_state.integers(2, size=len(pairs))
    columns = np.where(first_less_second == 0, coins, first_less_second > 0)
    return pairs[np.arange(len(pairs)), columns.astype(int)][:, None]


def _difference(pop: Population, name: str, pairs: Winners) -> NDArray[np.float64]:
    """Return the sign of the first of each pair less the second."""
    values = np.asarray(pop.get(name), dtype=float).ravel()[pairs]
    return np.sign(values[:, 0] - values[:, 1])


def by_violation(pop: Population, pairs: Winners, random_state: Any, **options: Any) -> Winners:
    """The less infeasible of each pair; of two feasible or equal ones any."""
    return _decided(pairs, _difference(pop, "CV", pairs), random_state)


def by_niche(pop: Population, pairs: Winners, random_state: Any, **options: Any) -> Winners:
    """Compare as `by_violation` does; within a niche by rank, and then by distance."""
    decision = _difference(pop, "CV", pairs)
    feasible = np.asarray(pop.get("FEAS")).ravel()[pairs].all(axis=1)
    alike = np.zeros(len(pairs), dtype=bool)
    if feasible.any():  # the infeasible ones have no niche
        alike[feasible] = _difference(pop, "niche", pairs[feasible]) == 0
    for name in ("rank", "dist_to_niche"):
        open_still = alike & (decision == 0)
        if open_still.any():
            decision[open_still] = _difference(pop, name, pairs[open_still])
    return _decided(pairs, decision, random_state)


class NSGA3(nsga3.NSGA3):
    """NSGA-III; pymoo's compares infeasible individuals with unseeded random numbers."""

    def __init__(self, ref_dirs: NDArray[np.float64], **options: Any) -> None:
        super().__init__(
            ref_dirs,
            selection=TournamentSelection(by_violation),
            **options,
        )


class UNSGA3(unsga3.UNSGA3):
    """U-NSGA-III; pymoo's compares infeasible individuals with unseeded random numbers."""

    def __init__(self, ref_dirs: NDArray[np.float64], **options: Any) -> None:
        super().__init__(
            ref_dirs,
            selection=TournamentSelection(by_niche),
            **options,
        )


class SPEA2(spea2.SPEA2):
    """SPEA2; pymoo's keeps the scale of one run for the next."""

    def __init__(self, pop_size: int, normalize: bool, **options: Any) -> None:
        survival = spea2.SPEA2Survival(normalize=normalize)
        super().__init__(pop_size, survival=survival, **options)


class CTAEA(ctaea.CTAEA):
    """C-TAEA, whose pairs have one child each."""

    def __init__(self, ref_dirs: NDArray[np.float64], crossover: SBX, **options: Any) -> None:
        crossover.n_offsprings = 1
        super().__init__(ref_dirs, crossover=crossover, **options)


class MOPSO_CD(mopso_cd.MOPSO_CD):  # noqa: N801  # pymoo's name
    """MOPSO-CD; pymoo's evaluates a population at its start that it then throws away."""

    def _setup(self, problem: Any, **options: Any) -> None:
        lower, upper = problem.bounds()
        self.v_max = self.max_velocity_rate * (upper - lower)
        self.archive: Any = MultiObjectiveArchive(max_size=self.archive_size)


class _SeededTruncation(Truncation):
    """Drops what an archive has too much of, with the random numbers of an algorithm."""

    def __init__(self, algorithm: cmopso.CMOPSO) -> None:
        self._algorithm = algorithm
        self._survival = cmopso.CrowdingDistanceTournamentSurvival()

    def __call__(self, sols: Any, k: int) -> Any:
        algorithm = self._algorithm
        return self._survival.do(
            algorithm.problem, sols, n_survive=k, random_state=algorithm.random_state
        )


class CMOPSO(cmopso.CMOPSO):
    """CMOPSO; pymoo's thins its elites with unseeded random numbers."""

    def _setup(self, problem: Any, **options: Any) -> None:
        super()._setup(problem, **options)
        self.elites.truncation = _SeededTruncation(self)


def agemoea2(pop_size: int, **options: Any) -> Any:
    """AGE-MOEA-II; pymoo's divides by zero if all of its individuals have the same values."""
    from pymoo.algorithms.moo import age2  # not at the top: it needs numba

    algorithm: Any = age2.AGEMOEA2(pop_size, **options)
    distances_of_pymoo = algorithm.survival.pairwise_distances

    def pairwise_distances(front: NDArray[np.float64], p: float) -> NDArray[np.float64]:
        """Distances along the front; individuals at the ideal point have none."""
        if (front <= 0).all(axis=1).any():
            return np.zeros((len(front), len(front)))
        return distances_of_pymoo(front, p)

    algorithm.survival.pairwise_distances = pairwise_distances
    return algorithm
