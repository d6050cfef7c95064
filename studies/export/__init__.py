"""Moves in the forms that controllers read, films of them, and a page to drag along a front.

May import `sweep`, `figures`, `report` and the paper's points of `reproduce`.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
