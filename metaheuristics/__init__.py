"""The derivative-free answer: the paper's VEPSO and NSGA-II, and any other of pymoo's.

`search` runs one, and `jobs` many methods on many problems, the gradient among them, each to a
file; the rooms below are `objective`, `problems` and `algorithms`. It may import `ocp` and
`models`.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
