"""NSGA-II with the paper's settings, every operator stated."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2, binary_tournament
from pymoo.core.duplicate import DuplicateElimination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.sampling.rnd import FloatRandomSampling
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding

from quietarm.ocp.checks import whole


class ExactDuplicates(DuplicateElimination):
    """Drops individuals whose coefficients equal another's to the last bit.

    pymoo's own compares all distances: an n x n matrix, 800 MB at a population of 10,000.
    """

    def _do(self, pop: Any, other: Any, is_duplicate: np.ndarray) -> np.ndarray:
        seen = set() if other is None else set(self._rows(other))
        for i, row in enumerate(self._rows(pop)):
            is_duplicate[i] = row in seen
            if other is None:
                seen.add(row)
        return is_duplicate

    def _rows(self, individuals: Any) -> list[bytes]:
        X = np.array([individual.X for individual in individuals], dtype=float)
        return [row.tobytes() for row in X + 0.0]  # -0.0 becomes 0.0, which it equals


class PaperNSGA2(NSGA2):
    """NSGA-II with the paper's settings: crossover rate 0.8, mutation rate 0.01 for each gene.

    pymoo's polynomial mutation has one probability for an individual and one for a gene; the
    paper's rate is taken as that of a gene, and any individual may mutate. What the paper does not
    state is as in pymoo, and written out here so that new defaults of pymoo change nothing.

    Parameters
    ----------
    population : int
        Number of individuals, and of offspring a generation.
    crossover, mutation : SBX, PM, optional
        Others than the paper's.

    Raises
    ------
    ValueError
        When the population is below 2: a pair is needed to cross.
    """

    def __init__(
        self, population: int = 200, crossover: SBX | None = None, mutation: PM | None = None
    ) -> None:
        # simulated binary crossover: the paper's rate for a pair; pymoo's defaults for a gene and
        # eta
        # polynomial mutation: any individual may mutate; the paper's rate is that of a gene
        tournament = "comp_by_dom_and_crowding"
        paper_mutation: dict[str, Any] = {"prob": 1.0, "prob_var": 0.01, "eta": 20}
        paper_crossover: dict[str, Any] = {"prob": 0.8, "prob_var": 0.5, "eta": 15}
        size = whole("population", population, 2)
        super().__init__(
            pop_size=size,
            n_offsprings=size,
            sampling=FloatRandomSampling(),
            selection=TournamentSelection(func_comp=binary_tournament, pressure=2),
            crossover=SBX(**paper_crossover) if crossover is None else crossover,
            mutation=PM(**paper_mutation) if mutation is None else mutation,
            survival=RankAndCrowding(crowding_func="cd"),
            eliminate_duplicates=ExactDuplicates(),
        )
        self.tournament_type = tournament
