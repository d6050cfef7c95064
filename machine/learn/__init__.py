"""What a machine left of a plan's executed move, and the next plan that leaves less."""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
