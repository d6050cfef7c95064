"""Answers compared: plans of one move beside baselines and under errors, fronts of one task.

May import `figures`, `report` and `reading`.
"""

from quietarm.loading import attach
from quietarm.moved import MOVED_WITHIN

__getattr__, __dir__, __all__ = attach(__name__, __file__, MOVED_WITHIN["compare"])
