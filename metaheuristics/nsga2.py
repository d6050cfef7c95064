"""NSGA-II with the paper's settings, every operator stated."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.population import Population
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.sampling.rnd import FloatRandomSampling

CROSSOVER, MUTATION = 0.8, 0.01
_COLUMNS = ("X", "F", "G", "H", "rank", "crowding")


class PaperNSGA2(NSGA2):
    """NSGA-II as the paper sets it: crossover rate 0.8, mutation rate 0.01 a gene.

    pymoo's polynomial mutation has one probability for an individual and one for a gene; the
    paper's rate is read as that of a gene, so every individual is offered for mutation.

    Parameters
    ----------
    population : int
        Number of individuals, and of offspring a generation.

    Raises
    ------
    ValueError
        When the population is below 2: a pair is needed to cross.
    """

    def __init__(self, population: int = 200) -> None:
        if population < 2:
            raise ValueError(f"population is {population}; NSGA-II needs 2 or more to cross")
        super().__init__(
            pop_size=population,
            sampling=FloatRandomSampling(),
            crossover=SBX(prob=CROSSOVER, prob_var=0.5, eta=15),
            mutation=PM(prob=1.0, prob_var=MUTATION, eta=20),
        )

    @property
    def settings(self) -> dict[str, Any]:
        """What a state is of: the population."""
        return {"population": self.pop_size}

    def state(self) -> dict[str, Any]:
        """All that the run needs to go on after a complete generation: a nested plain dict."""
        individuals: Any = self.pop
        random: Any = self.random_state
        return {
            "iteration": int(self.n_iter or 1) - 1,
            "evaluations": self.evaluator.n_eval,
            # an infeasible individual has no rank and no crowding: NaN stands for None
            "population": {name: individuals.get(name).astype(float) for name in _COLUMNS},
            "random_state": random.bit_generator.state,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from a `state`, bit for bit; call it after `setup` with the settings of that run.

        Parameters
        ----------
        state : mapping
            What `state` returned.
        """
        columns = {name: np.asarray(values) for name, values in state["population"].items()}
        self.pop = Population.new(**columns)
        for individual in self.pop:
            for name in ("rank", "crowding"):
                if np.isnan(individual.get(name)):
                    individual.set(name, None)
        self.pop.apply(lambda individual: individual.evaluated.update({"F", "G", "H"}))
        random: Any = self.random_state
        random.bit_generator.state = state["random_state"]
        self.start_time, self.is_initialized = time.time(), True
        iteration: int = state["iteration"]
        self.n_iter = iteration
        self.evaluator.n_eval = state["evaluations"]
        self._set_optimum()
        termination: Any = self.termination
        termination.update(self)
        self.n_iter = iteration + 1
