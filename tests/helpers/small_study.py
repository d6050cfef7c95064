"""What the small study is asked for, and its methods in order."""

import types

from quietarm.studies.paper import ARM_HALF, SINGLE_LINK_SIXTH, Case
from quietarm.studies.study.work import StudySettings

QUICK = StudySettings(terms=2, points=3, runs=2, population=12, generations=8)
CASES = (Case(SINGLE_LINK_SIXTH.task), Case(ARM_HALF.task))
METHODS = ["epsilon", "weighted", "nsga2", "nsga2", "nsga2, polished", "vepso", "vepso",
           "vepso, polished"]  # fmt: skip
FLOOR = types.SimpleNamespace(energy=0.0165, complete=True)
"""In the place of a floor, which has tests of its own."""
