"""The residual limit of a task: the one that is stated, or the default."""

from __future__ import annotations

import math

from quietarm.ocp.checks import not_negative
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.simulation.free_vibration import vibration_of
from quietarm.ocp.task import PointToPoint


def checked_residual_limit(task: PointToPoint, stated: float | None) -> float:
    """The limit [m] that is stated, or the default.

    The default is the band over its margin, where the task has a band; else rest, or
    `quiet_residual` of an uncertain task, where this is only where the search for a limit begins.
    ValueError where it is negative, that of an uncertain task is 0, or no band can be kept.
    """
    refuse_beyond_band(task)
    if stated is not None:
        stated = not_negative("residual limit", stated, task.plant.tip_unit)
    else:
        stated = task.band_limit
    if task.uncertainty is None:
        return stated or 0.0
    size = quiet_residual(task) if stated is None else stated
    if size > 0:
        return size
    if stated is None:
        raise ValueError(
            "the plain cycloid does not bend this plant, so that 5 % of that is no limit; give "
            "a residual limit above 0"
        )
    raise ValueError(
        "residual limit is 0, but no motion arrives at rest in all scenarios; omit it "
        "(default: 5 % of the plain cycloid's largest deflection) or give one above 0"
    )


def band_words(task: PointToPoint, limit: float) -> str:
    """The band that a residual limit [m] follows from: "a band of 0.1 mm with a margin of 3".

    Empty where the limit is another.
    """
    if task.band is None or not math.isclose(limit, task.band / task.margin, rel_tol=1e-9):
        return ""
    return f"a band of {1e3 * task.band:g} mm with a margin of {task.margin:g}"


def refuse_beyond_band(task: PointToPoint) -> None:
    """Refuse a band that the vibration wanted on arrival leaves; ValueError says by how much."""
    if task.band is None or task.final is None:
        return
    vibration = vibration_of(task.plant, task.target, task.residual_window)
    wanted = float(vibration.peak(task.final_state))
    if wanted > task.band:
        raise ValueError(
            f"the state wanted on arrival vibrates by {wanted:.4g} m, beyond the band of "
            f"{task.band:g} m; give a wider band, or a smaller final state"
        )


def quiet_residual(task: PointToPoint) -> float:
    """The plain cycloid's peak deflection on the nominal plant [m], times `TOLERATED`.

    Over durations this has no zeros, unlike its residual.
    """
    cycloid = JudgedMotion.of_profile(task.certain, CycloidPolynomial(0), [])
    return TOLERATED * cycloid.motion.peak_deflection
