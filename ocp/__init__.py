"""What is asked, and the gradient answer.

What is asked: `task` with its limits, and how a joint may move, `profiles`. What a motion costs:
`simulation`, `robustness`. The gradient's answers: `solvers` solve, and `planning`, `front` and
`floor` ask it. An answer is `saved` with its `record`; `checks`, `errors` and `files` serve all.
What a user needs is here.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
