"""Recordings of a machine, and the plant that they tell of.

Rooms: `tables` reads files of numbers as other programs write them, `recordings` are what was
measured, mended, `identify` finds a plant's parameters from them, `held_robots` springs and load of
a robot whose joints are held, and `learn` the next plan from recordings of an executed one.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
