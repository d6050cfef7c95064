"""The objectives of a whole population, as every search sees them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import instance
from quietarm.ocp.objectives import peak_quantities, with_peaks_measured
from quietarm.ocp.simulation.evaluator import Evaluation, Evaluator
from quietarm.ocp.simulation.mesh import default_steps

CANDIDATE_STEPS = 24
"""Least steps of every search."""
ACCURACY = 5e-4
"""Residuals and energies of random candidates of all named problems are within this
share of those of much finer steps; docs/measures.md has what was measured."""
UNUSABLE = 1e30
"""A figure from here up counts as not finite. This value replaces it, because algorithms can sort
it: it comes last."""


def search_steps(task: PointToPoint, profile: JointProfile) -> int:
    """Steps at which every search sees a move, whether it runs here or in another library.

    Four for each coefficient, and at least `CANDIDATE_STEPS`, or 64 with limits.
    """
    least = 64 if task.limits else CANDIDATE_STEPS
    return default_steps(task, least=max(least, 4 * profile.size))


def search_evaluator(
    task: PointToPoint, profile: JointProfile, steps: int | None = None, threads: int = 1
) -> Evaluator:
    """The evaluator of every search, on so many steps or on those of `search_steps`."""
    steps = search_steps(task, profile) if steps is None else steps
    return Evaluator(task, profile, steps, threads=threads)


def objectives_of(evaluation: Evaluation) -> NDArray[np.float64]:
    """Largest residual of the scenarios [m], nominal energy [J], (candidates, 2)."""
    residual = evaluation.sampled_residual.max(axis=1)
    return np.column_stack([residual, evaluation.energy[:, 0]])


def measured_figures(
    evaluation: Evaluation, quantities: Sequence[str], limits: Sequence[str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Objectives with the peaks of these quantities, and violations of these limits, by name.

    The evaluation is of a task as of `with_peaks_measured`. Shapes are (candidates, objectives) and
    (candidates, limits).
    """
    peaks = [evaluation.limited_peaks[name] for name in quantities]
    names = [limit.name for limit in evaluation.evaluator.tasks[0].limits]
    places = [names.index(name) for name in limits]
    table = np.column_stack([objectives_of(evaluation), *peaks])
    return table, evaluation.violations[:, places]


def figures_of_motions(
    front: Front, coefficients: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Objectives of motions along a front's profile, and their violations of its limits.

    Shapes are (motions, objectives) and (motions, limits); by the steps of an `Evaluator`, with
    peaks by so many that their nodes miss at most 0.5 % in the boxes of the named problems.
    """
    finer = 192
    instance("task", front.task, PointToPoint)  # a front of a function has none
    quantities = peak_quantities(front.objectives)
    measured = with_peaks_measured(front.task, quantities)
    steps = max(default_steps(measured), finer) if quantities else None
    evaluation = Evaluator(measured, front.profile, steps)(coefficients)
    return measured_figures(evaluation, quantities, [limit.name for limit in front.task.limits])


def replace_failures(table: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Fill the rows of a table that are not finite with `UNUSABLE`; tells which these are."""
    usable = np.all(np.abs(table) < UNUSABLE, axis=1)  # NaN is not less, either
    failed = np.asarray(~usable, dtype=bool)
    table[failed] = UNUSABLE
    return failed
