"""In words, what a motion leaves where its plant is wrong by the worst of given errors."""

from __future__ import annotations

from quietarm.ocp import Front, FrontPoint, Worst
from quietarm.ocp.robustness.worst import worst_of
from quietarm.studies.display.words import millimetres


def worst_in_words(worst: Worst) -> str:
    """The largest residual, and the errors that it comes with."""
    errors = ", ".join(f"{name} {100 * error:+.3g} %" for name, error in worst.errors.items())
    return f"{millimetres(worst.residual)} with {errors}"


def point_in_words(front: Front, point: FrontPoint) -> str:
    """Energy and residual of a point; of an uncertain plant also what it leaves at worst.

    A front's residual is the largest at the samples, and more is left between them.
    """
    words = f"{point.energy:.4g} J at {millimetres(point.residual)}"
    worst = worst_of(front.task, front.profile, point.coefficients)
    return words if worst is None else f"{words}; at worst {worst_in_words(worst)}"
