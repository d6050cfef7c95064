"""Methods on problems from several seeds, held against the problems' reference fronts.

Runs are files in a folder; whatever is measured, tested and drawn is worked out from these alone.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
