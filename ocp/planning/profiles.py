"""Profiles that follow from a task: the number of terms it takes, and the shaper for its plant.

Without limits six terms are the paper's, and more only make the starts harder. Within the limits of
a drive they cost up to twice the least energy, or find no motion. Two terms more often save
nothing where four save a quarter, so the number is not looked for step by step: it follows from
the number of modes. `benchmarks/terms.py` measures how far from the floor that ends.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
from quietarm.ocp.checks import takes
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.planning.best_of_starts import best_of_starts, solver_of, start_coefficients
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.shaped_cycloid import ShapedCycloid
from quietarm.ocp.record import Setting, SolveSettings
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.solvers.problem import Problem, Solution, Transcription
from quietarm.ocp.task import PointToPoint

SIX = CycloidPolynomial()
FEW, MANY = 18, 24
"""Terms within limits: of plants with one mode, and with several. Where one mode swings for more
than seven periods 24 come 2 % nearer to the floor, but the solver may take minutes."""
_SAMPLES = 200
"""Joint angles along the plain cycloid, at even times, over which `average` is taken."""
CHOSEN, OF_SIX = "chosen_terms", "energy_of_six_terms"
"""What a plan's record says of them."""


def choose_profile(task: PointToPoint) -> CycloidPolynomial:
    """Six terms without limits, else more, by the number of modes."""
    if not task.limits:
        return SIX
    return CycloidPolynomial(FEW if task.plant.modes == 1 else MANY)


def plan_with_chosen_terms(
    task: PointToPoint,
    settings: SolveSettings,
    plan: Callable[[CycloidPolynomial, SolveSettings], Plan],
) -> Plan:
    """The plan of the chosen number of terms; its record states what six would cost.

    One start does, the plain cycloid; another is what six terms give, where it leads nowhere.
    """
    began, profile = time.perf_counter(), choose_profile(task)
    if profile == SIX:
        return plan(SIX, settings)
    six, asked = _solve_with_six(task, settings), replace(settings, starts=1)
    is_better = six.status.solved and task.uncertainty is None
    try:
        found = plan(profile, asked)
        is_better = is_better and six.energy < found.energy
    except SolverFailedError:
        if not six.status.solved:
            raise
        found, is_better = None, True
    if is_better:
        guess = np.pad(six.coefficients, (0, profile.size - SIX.size)).tolist()
        try:
            other = plan(profile, replace(asked, guess=tuple(guess)))
        except SolverFailedError:
            if found is None:
                raise
        else:
            found = other if found is None or other.energy < found.energy else found
    assert found is not None
    stated: dict[str, Setting] = {**found.record.settings, "starts": settings.starts}
    stated[CHOSEN] = found.profile.size
    stated.pop("guess", None)
    if six.status.solved and task.uncertainty is None:
        stated[OF_SIX] = six.energy
    spent = six.iterations + found.record.iterations
    return found.restated(settings=stated, iterations=spent, seconds=time.perf_counter() - began)


def _solve_with_six(task: PointToPoint, settings: SolveSettings) -> Solution:
    """What six terms give for the nominal plant, by the solver's own steps."""
    steps = Transcription.of(task.certain, SIX, settings.steps)
    problem = Problem.of(steps, settings.residual_limit, settings.bound)
    starts = start_coefficients(SIX, settings)
    (six,) = best_of_starts([problem], [starts], solver_of(settings))
    return six


@one_at_a_time
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
    if not modes[0] or len({len(each) for each in modes}) > 1:
        raise ValueError(
            f"plant {task.plant.name!r} has modes that do not vibrate, for which there is "
            "no shaper; take another profile"
        )
    frequencies, damping_ratios = np.mean(modes, axis=0).T
    profile = ShapedCycloid(shaper, tuple(frequencies), tuple(damping_ratios))
    profile.checked([], task.duration)
    return profile


def _along(task: PointToPoint) -> list[float]:
    times = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * task.duration
    return CycloidPolynomial(0).path([], *task.move)(times).tolist()
