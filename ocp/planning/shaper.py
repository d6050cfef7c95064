"""The shaper for a task's plant."""

from __future__ import annotations

from typing import Literal

import numpy as np

from quietarm.ocp.checks import takes
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.shaped_cycloid import ShapedCycloid
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.task import PointToPoint


@takes(task=PointToPoint)
def shaped_cycloid(
    task: PointToPoint, shaper: str, at: Literal["target", "average"] = "target"
) -> ShapedCycloid:
    """The cycloid through an input shaper for the modes of a task's plant.

    Parameters
    ----------
    task : PointToPoint
        The move; of an uncertain task the nominal plant counts.
    shaper : str
        ``"zv"``, ``"zvd"`` or ``"ei"``.
    at : str, optional
        Where the plant's frequencies and damping are taken: with the joint at the target, or as
        the average over time along the plain cycloid. They differ if the frequencies depend on
        the joint angle; docs/physics.md, 'Input shaping', compares the two.

    Returns
    -------
    ShapedCycloid
        The profile; it has no coefficients.

    Raises
    ------
    ValueError
        When the task's duration is too short for the shaper, an argument is not known, or the
        plant does not vibrate.
    """
    if at not in ("target", "average"):
        raise ValueError(f"at is {at!r}; give 'target' or 'average'")
    angles = [task.target] if at == "target" else _along(task)
    modes = [FreeVibration(task.plant, angle).modes for angle in angles]
    counts = {len(modes_there) for modes_there in modes}
    if not modes[0] or len(counts) > 1:
        raise ValueError(
            f"plant {task.plant.name!r} has modes that do not vibrate, for which there is "
            "no shaper; take another profile"
        )
    frequencies, damping_ratios = np.mean(modes, axis=0).T
    profile = ShapedCycloid(shaper, tuple(frequencies), tuple(damping_ratios))
    profile.checked([], task.duration)
    return profile


def _along(task: PointToPoint, samples: int = 200) -> list[float]:
    """Joint angles along the plain cycloid, at even times."""
    fractions = (np.arange(samples) + 0.5) / samples
    cycloid = CycloidPolynomial(0).path([], *task.move)
    return cycloid(fractions * task.duration).tolist()
