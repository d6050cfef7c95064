"""Moves in the forms that controllers read, films of them, and a page to drag along a front.

May import `sweep`, `figures`, `report` and the paper's points of `reproduce`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
