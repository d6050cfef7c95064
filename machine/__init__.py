"""Recordings of a machine, and the plant that they tell of.

Rooms: `tables` reads files of numbers as other programs write them, `recordings` are what was
measured, mended, `identify` finds a plant's parameters from them, and `learn` the next plan from
those of an executed one.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
