"""A plant's parameters from recordings of the machine."""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
