"""The derivative-free answer: the paper's VEPSO and NSGA-II, and any other of pymoo's."""

# ruff: noqa: I001  # ocp first: it finds a user's file that shadows models
import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]

from metaheuristics.ensemble import LostSeedsError, Spread, search_many
from metaheuristics.algorithms.nsga2 import PaperNSGA2
from metaheuristics.objective.population import PopulationObjective, PopulationValues
from metaheuristics.algorithms.presets import PAPER_BOX, PRESETS, Preset
from metaheuristics.objective.problem import MoveProblem
from metaheuristics.runs.run import SearchProgress
from metaheuristics.search import search
from metaheuristics.algorithms.velocity import CONSTRICTION, INERTIA_2002, PAPER_GROUP, VelocityRule
from metaheuristics.algorithms.vepso import VEPSO

__all__ = [
    "CONSTRICTION",
    "INERTIA_2002",
    "PAPER_BOX",
    "PAPER_GROUP",
    "PRESETS",
    "VEPSO",
    "LostSeedsError",
    "MoveProblem",
    "PaperNSGA2",
    "PopulationObjective",
    "PopulationValues",
    "Preset",
    "SearchProgress",
    "Spread",
    "VelocityRule",
    "search",
    "search_many",
]
