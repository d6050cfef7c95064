"""Pictures of answers: motions, fronts, sweeps, comparisons, robustness.

Every ``draw_...`` draws on the matplotlib axes that it is given, or on new ones, and returns them;
every ``..._figure`` puts several together as the commands do. No picture is known to pyplot, so
none opens a window: save one with ``ax.figure.savefig("name.png")``. Each is loaded when it is
asked for.
"""

from quietarm.loading import attach
from quietarm.moved import MOVED_WITHIN

__getattr__, __dir__, __all__ = attach(__name__, __file__, MOVED_WITHIN["pictures"])
