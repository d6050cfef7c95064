"""Moves in the forms that controllers read, and films of them.

May import `sweep`, `figures` and `report`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
