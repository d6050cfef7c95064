"""Fronts from elsewhere: coefficients of a file, evaluated here, beside what the file claims."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics import MoveFunction
from quietarm.metaheuristics.evaluation.population import UNUSABLE
from quietarm.metaheuristics.evaluation.stated_figures import agrees, always_agrees_within
from quietarm.ocp import (
    Front,
    JointProfile,
    JudgedMotion,
    PointToPoint,
    SolverFailedError,
    TermProfile,
)
from quietarm.ocp.checks import whole, with_article
from quietarm.ocp.figures import FIGURES
from quietarm.ocp.front.points import refuse_beyond_box
from quietarm.ocp.joint_words import passed_words
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.planning.plan import evaluate_coefficients
from quietarm.ocp.rest import rest_of
from quietarm.ocp.window import DefaultWindow
from quietarm.studies.answers.foreign import Found, read_found

Array = NDArray[np.float64]

_MOST_ROWS = 1_000_000
_JUDGED = 100
"""Motions that CVODES judges at most, of those whose stated figures differ from fixed steps."""
_NEAR = 1e-3
"""Motions that another beats by more than this share are not evaluated a second time; where
residuals are near rest, and a share says little, by `rest_of` the task as well."""


def import_front(
    file: Path,
    task: PointToPoint,
    family: type[TermProfile],
    terms: int | None = None,
    bound: float | None = None,
    evaluations: int | None = None,
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
) -> tuple[Front, list[str]]:
    """The front of a file's coefficients, and how what it states compares, in sentences."""
    imported = read_found(file)
    if imported.window is not None and isinstance(task.residual_window, DefaultWindow):
        task = replace(task, residual_window=imported.window)
    columns = imported.coefficients.shape[1]
    if terms is not None and family(terms).size != columns:
        raise ValueError(
            f"{file} has {columns} coefficients a motion, and {with_article(family(terms).label)} "
            f"takes {family(terms).size}; leave --terms out, or transpose the table"
        )
    try:
        front, notes = _evaluated(
            file, task, family.of_size(columns), imported, bound, evaluations, objectives
        )
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    if not notes:
        notes.append("the file states neither residual nor energy in numbers: nothing to compare "
                     "with")  # fmt: skip
    if imported.ignored:
        notes.append(f"ignored: {', '.join(imported.ignored)[:200]}")
    return front, notes


def _evaluated(
    file: Path,
    task: PointToPoint,
    profile: JointProfile,
    imported: Found,
    bound: float | None,
    evaluations: int | None,
    objectives_of_front: Sequence[str],
) -> tuple[Front, list[str]]:
    """The front, and how the claims compare."""
    table = imported.coefficients
    whole("number of motions", len(table), 1, _MOST_ROWS)
    if evaluations is not None:
        evaluations = whole("evaluations", evaluations, len(table))
    rows = np.array([_checked(i, row, profile, task) for i, row in enumerate(table, start=1)])
    refuse_beyond_box(profile, rows, bound)
    widest = max(float(np.abs(rows).max()), 1e-3)  # any box: the function needs one
    function = MoveFunction(task, profile, bound=min(widest, 1e6), objectives=objectives_of_front)
    objectives, violations = function(rows)
    failed = np.asarray((objectives >= UNUSABLE).any(axis=1))
    broken = ~failed & (violations > _NEAR).any(axis=1)
    usable = np.flatnonzero(~failed & ~broken)
    near = usable[_not_beaten(objectives[usable], task)]
    if not near.size:
        raise SolverFailedError(_why_none(rows, failed, violations, task, profile))
    front = Front.from_coefficients(
        task, rows[near], method=file.stem, profile=profile, bound=bound,
        settings={"imported": file.name}, evaluations=evaluations or len(rows),
        objectives=objectives_of_front,
    )  # fmt: skip
    front = replace(
        front,
        failed=int(failed.sum()) + front.failed,
        infeasible=int(broken.sum()) + front.infeasible,
    )
    if not front.points:
        raise SolverFailedError(front.why_empty())

    def judge(row: int) -> tuple[float, float]:
        """Residual and energy of a motion by CVODES."""
        plan = evaluate_coefficients(task, rows[row], profile=profile)
        return plan.residual, plan.energy

    return front, _claims(imported.claims, objectives[:, :2], judge, task)


def _checked(
    number: int, row: Array, profile: JointProfile, task: PointToPoint
) -> tuple[float, ...]:
    try:
        return profile.checked(row, task.duration)
    except ValueError as error:
        raise ValueError(f"motion {number}: {error}") from None


def _why_none(
    rows: Array,
    failed: NDArray[np.bool_],
    violations: Array,
    task: PointToPoint,
    profile: JointProfile,
) -> str:
    none = f"no motion of {len(rows)} can be used: "
    if failed.all():
        return (
            f"{none}with coefficients of up to {np.abs(rows).max():.4g} their figures overflow; "
            "give those of the profile, in radians"
        )
    nearest = violations[~failed].max(axis=1).argmin()
    passed = violations[~failed][nearest]
    limit = task.limits[int(passed.argmax())]
    motion = JudgedMotion.of_profile(task, profile, rows[~failed][nearest])
    return (
        f"{none}the {limit.label} of the one that keeps the limits best is "
        f"{passed_words(limit, motion)}; widen that limit, or give a longer duration"
    )


def _not_beaten(F: Array, task: PointToPoint) -> NDArray[np.bool_]:
    """Rows that no other is clearly better than."""
    import moocore  # not at the top: it takes long to load

    if not len(F):
        return np.zeros(0, dtype=bool)
    if F.shape[1] > len(RESIDUAL_AND_ENERGY):  # peaks at the nodes say little of near ones
        return np.asarray(moocore.is_nondominated(F, keep_weakly=True))
    best = F[moocore.is_nondominated(F)]
    best = best[np.argsort(best[:, 0])] * (1 + _NEAR) + np.array([rest_of(task), 0.0])
    # energies fall along the front: the last point within a residual has the least
    last = np.searchsorted(best[:, 0], F[:, 0], side="right") - 1
    return (last < 0) | (F[:, 1] < best[np.maximum(last, 0), 1])


def _claims(
    stated: Array, figures: Array, judge: Callable[[int], tuple[float, float]], task: PointToPoint
) -> list[str]:
    """Say how a file's figures compare; where fixed steps differ from them, CVODES decides."""
    objectives = [FIGURES[name] for name in RESIDUAL_AND_ENERGY]
    least = np.array([always_agrees_within(figure.name, task) for figure in objectives])
    differ = (~np.isnan(stated) & ~agrees(stated, figures, least)).any(axis=1)
    figures = figures.copy()
    for row in np.flatnonzero(differ)[:_JUDGED].tolist():
        figures[row] = judge(row)
    notes = list[str]()
    for theirs, ours, objective, tolerated in zip(stated.T, figures.T, objectives, least):
        figure = objective.name
        unit = objective.unit_on(task.plant)
        known = ~np.isnan(theirs)
        wrong = known & ~agrees(theirs, ours, tolerated)
        if not known.any():
            continue
        if not wrong.any():
            motions = "its motion" if known.sum() == 1 else f"all {known.sum()} motions"
            notes.append(f"the file's {figure} is right for {motions}")
            continue
        gaps = (np.abs(theirs - ours) - tolerated) / np.maximum(np.abs(ours), 1e-300)
        worst = int(np.argmax(np.where(wrong, gaps, -1.0)))
        telling = known & (ours > 100 * rest_of(task))
        hint = ""
        if telling.any() and abs(np.median(theirs[telling] / ours[telling]) / 1000 - 1) < 0.05:
            hint = f"; is it in m{unit}? name the column {figure}_m{unit}"
        notes.append(
            f"the file's {figure} is wrong for {wrong.sum()} of {known.sum()} motions, most for "
            f"motion {worst + 1}: {theirs[worst]:.4g} {unit} in the file, {ours[worst]:.4g} {unit} "
            f"by its coefficients{hint}"
        )
    return notes
