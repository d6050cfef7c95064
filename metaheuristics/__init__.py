"""The derivative-free answer: the paper's VEPSO and NSGA-II, and any other of pymoo's."""

# ruff: noqa: I001  # ocp first: it finds a user's file that shadows models
import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]

from metaheuristics.ensemble import LostSeedsError, Spread, search_many
from metaheuristics.nsga2 import PaperNSGA2
from metaheuristics.population import PopulationObjective, PopulationValues
from metaheuristics.presets import PAPER_BOX, PRESETS, Preset
from metaheuristics.problem import MoveProblem
from metaheuristics.run import SearchProgress
from metaheuristics.search import search
from metaheuristics.velocity import CONSTRICTION, INERTIA_2002, PAPER_GROUP, VelocityRule
from metaheuristics.vepso import VEPSO

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
