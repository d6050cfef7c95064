"""Tasks that are asked for, and the gradient's answers.

What is asked: `task` with its limits, and how a joint may move, `profiles`. What a motion costs:
`simulation`, `robustness`. The gradient's answers: `solvers` solve, and `planning`, `front` and
`floor` ask it. An answer is `saved` with its `record`; `checks`, `errors` and `files` serve all.
What a user needs is here.
"""

from quietarm.loading import attach
from quietarm.moved import MOVED_WITHIN

__getattr__, __dir__, __all__ = attach(__name__, __file__, MOVED_WITHIN["ocp"])
