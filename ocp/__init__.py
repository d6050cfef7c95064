"""What is asked, and the gradient answer.

The rooms, each of which may import those before it: `base`, `task`, `profiles`, `simulation`,
`robustness`, `program` and `answers`, `plan`, `front` and `floor`. All of them may import
`models`; what a user needs is here.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
