"""Grids of moves: a certified plan a cell, in a Zarr store that a killed run goes on with."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
