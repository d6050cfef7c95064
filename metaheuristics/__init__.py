"""The derivative-free answer: the paper's VEPSO and NSGA-II, and any other of pymoo's.

`search` and `search_many` are on top; the rooms below are `objective`, `problems` for other
libraries, `algorithms` and `runs`. It may import `ocp` and `models`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from quietarm.metaheuristics.algorithms.presets import PAPER_BOX, PRESETS, Preset
from quietarm.metaheuristics.algorithms.velocity import (
    CONSTRICTION,
    INERTIA_2002,
    PAPER_GROUP,
    VelocityRule,
)
from quietarm.metaheuristics.search import search

if TYPE_CHECKING:
    from quietarm.metaheuristics.algorithms.nsga2 import PaperNSGA2
    from quietarm.metaheuristics.algorithms.vepso import VEPSO
    from quietarm.metaheuristics.ensemble import LostSeedsError, Spread, search_many
    from quietarm.metaheuristics.objective.population import PopulationObjective, PopulationValues
    from quietarm.metaheuristics.objective.problem import MoveProblem
    from quietarm.metaheuristics.problems.catalogue import PROBLEMS, NamedProblem, problem_of
    from quietarm.metaheuristics.problems.function import MoveFunction
    from quietarm.metaheuristics.problems.pymoo_problem import ExactProblem
    from quietarm.metaheuristics.problems.recorded import RecordedFunction, RecordedRun
    from quietarm.metaheuristics.runs.progress import SearchProgress

__all__ = [
    "CONSTRICTION",
    "INERTIA_2002",
    "PAPER_BOX",
    "PAPER_GROUP",
    "PRESETS",
    "PROBLEMS",
    "VEPSO",
    "ExactProblem",
    "LostSeedsError",
    "MoveFunction",
    "MoveProblem",
    "NamedProblem",
    "PaperNSGA2",
    "PopulationObjective",
    "PopulationValues",
    "Preset",
    "RecordedFunction",
    "RecordedRun",
    "SearchProgress",
    "Spread",
    "VelocityRule",
    "problem_of",
    "search",
    "search_many",
]

_LATER = {
    "PROBLEMS": "problems.catalogue",
    "VEPSO": "algorithms.vepso",
    "ExactProblem": "problems.pymoo_problem",
    "LostSeedsError": "ensemble",
    "MoveFunction": "problems.function",
    "MoveProblem": "objective.problem",
    "NamedProblem": "problems.catalogue",
    "PaperNSGA2": "algorithms.nsga2",
    "PopulationObjective": "objective.population",
    "PopulationValues": "objective.population",
    "RecordedFunction": "problems.recorded",
    "RecordedRun": "problems.recorded",
    "SearchProgress": "runs.progress",
    "Spread": "ensemble",
    "problem_of": "problems.catalogue",
    "search_many": "ensemble",
}
"""What takes long to load, so that the names of the methods are there at once."""


def __getattr__(name: str) -> object:
    """Import what takes long to load when it is first asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"quietarm.metaheuristics.{_LATER[name]}"), name)
