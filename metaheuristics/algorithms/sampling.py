"""Baselines that learn nothing: candidates drawn at random, or from latin hypercubes."""

from __future__ import annotations

from typing import Any

from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population
from pymoo.core.sampling import Sampling
from pymoo.operators.sampling.lhs import LHS
from pymoo.operators.sampling.rnd import FloatRandomSampling
from pymoo.util.display.multi import MultiObjectiveOutput


class RandomSearch(Algorithm):
    """Every generation is drawn anew, uniformly over the bounds; what none dominates is kept."""

    pop: Any  # for the type checker: pymoo declares these as optional
    opt: Any

    def __init__(self, population: int = 100, sampling: Sampling | None = None) -> None:
        output: Any = MultiObjectiveOutput()  # for the type checker: pymoo declares a str
        super().__init__(output=output)
        self.population = population
        self.sampling = FloatRandomSampling() if sampling is None else sampling

    def _infill(self) -> Population:
        return self.sampling.do(
            self.problem,
            self.population,
            random_state=self.random_state,
        )

    _initialize_infill = _infill

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.pop = infills if self.opt is None else Population.merge(self.opt, infills)

    _initialize_advance = _advance


class LatinHypercubes(RandomSearch):
    """Every generation is a latin hypercube over the bounds, the most even of some."""

    def __init__(self, population: int = 100) -> None:
        super().__init__(population, LHS())
