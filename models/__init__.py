"""What moves: plants as symbolic equations; and the door to CasADi's functions (`compiled`)."""

import casadi

from quietarm.loading import attach

if not hasattr(casadi, "SX"):  # a script's own file of that name was imported in its place
    raise ImportError(f"{casadi.__file__} hides the library casadi; give that file another name")

__getattr__, __dir__, __all__ = attach(__name__, __file__, {"joint_unit": "Unit"})
