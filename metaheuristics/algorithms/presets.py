"""The settings of the paper's two searches."""

from __future__ import annotations

from dataclasses import dataclass

PAPER_BOX: dict[str, float] = {"single-link": 0.2, "arm-on-flexible-link": 0.5}
"""Largest absolute coefficient in the paper's searches, by plant: eqs (12) and (17)."""


@dataclass(frozen=True)
class Preset:
    """Population (of each swarm, for VEPSO) and generations of a search."""

    population: int
    generations: int


PRESETS: dict[str, Preset] = {"vepso": Preset(100, 200), "nsga2": Preset(200, 500)}
"""Section 3.1: 100 particles a swarm, 200 iterations. Section 3.2: population 200, 500 generations,
crossover 0.8, mutation 0.01 (`metaheuristics.algorithms.nsga2`)."""
