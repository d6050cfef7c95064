"""Answers compared: plans of one move beside baselines and under errors, fronts of one task.

May import `figures`, `report` and `reading`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
