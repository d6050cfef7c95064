"""Learn from a plan's executed move what the machine left, and plan the next, which leaves less."""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
