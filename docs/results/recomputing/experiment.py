"""What was run: coefficients, budgets, kinds of energy, limits, and who is held against whom."""

from __future__ import annotations

TERMS = (2, 4, 6, 10, 16, 24)
CENTRE = 6
BUDGETS = (1_000, 10_000, 100_000)
KINDS = ("absolute", "copper", "stages", "motor-map", "integer")
LIMITS = ("torque-tight", "torque-loose", "jerk-tight", "jerk-loose")
CONTROL = "epsilon"
"""The gradient's front, against which all others are held."""
GRADIENT_FRONT = f"{CONTROL} points=50"
"""The same with the settings by which it stands in the map."""
DIFFERENCES = "slsqp"
"""What takes differences of values in place of the gradient."""
OF_MAP = ("centre", "crossing", "large")
"""Tables that have the runs of the map."""


def takes_slopes(label: str) -> bool:
    """Whether a method of candidates takes the gradient's steps, or differences."""
    return any(word in label for word in ("memetic", "+polish", DIFFERENCES))
