"""The derivative-free answer: the paper's VEPSO and NSGA-II, and any other of pymoo's.

`search` and `search_many` are on top; the rooms below are `objective`, `problems` for other
libraries, `algorithms` and `runs`. It may import `ocp` and `models`.
"""

import lazy_loader
from quietarm.metaheuristics.search import search as search  # over the module of its name

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
