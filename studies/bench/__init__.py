"""Methods on problems from several seeds, held against the problems' reference fronts.

Runs are files in a folder; whatever is measured, tested and drawn is worked out from these alone.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
