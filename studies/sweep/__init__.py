"""Grids of moves: a certified plan a cell, in a Zarr store that a killed run goes on with."""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
