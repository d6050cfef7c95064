"""The algorithms that are known by name: the paper's two, with its settings.

pymoo is imported when one is built and not before: it takes longer to load than all of quietarm,
and a list of names does not need it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

PAPER_BOX: dict[str, float] = {"single-link": 0.2, "arm-on-flexible-link": 0.5}
"""Largest absolute coefficient in the paper's searches, by plant: eqs (12) and (17)."""


@dataclass(frozen=True)
class Preset:
    """An algorithm that is known by name.

    Attributes
    ----------
    name, label : str
        What it is called in a program and in a text.
    population, generations : int
        Individuals (particles of each swarm, for VEPSO) and generations by default.
    build : callable
        Makes a new one for a population.
    """

    name: str
    label: str
    population: int
    generations: int
    build: Callable[[int], Algorithm]


def _vepso(particles: int) -> Algorithm:
    from metaheuristics.algorithms.vepso import VEPSO

    return VEPSO(particles)


def _nsga2(population: int) -> Algorithm:
    from metaheuristics.algorithms.nsga2 import PaperNSGA2

    return PaperNSGA2(population)


PRESETS: Mapping[str, Preset] = {
    preset.name: preset
    for preset in (
        Preset("vepso", "VEPSO", population=100, generations=200, build=_vepso),
        Preset("nsga2", "NSGA-II", population=200, generations=500, build=_nsga2),
    )
}
"""By name. Section 3.1: 100 particles in a swarm, 200 iterations. Section 3.2: population 200, 500
generations, crossover 0.8, mutation 0.01 (`metaheuristics.algorithms.nsga2`)."""
