"""Plants, which are symbolic equations of motion, and the door to CasADi (`compiled`)."""

import casadi

from quietarm.loading import attach
from quietarm.moved import MOVED_WITHIN

if not hasattr(casadi, "SX"):  # a script's own file of that name was imported in its place
    raise ImportError(f"{casadi.__file__} hides the library casadi; give that file another name")

__getattr__, __dir__, __all__ = attach(__name__, __file__, MOVED_WITHIN["models"])
