"""Improve a front by the gradient, each point at its own residual."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, zip_longest

import numpy as np
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, checked
from quietarm.ocp.front.curve import front_of
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.sweep import Report, Sweep, no_report, sweep_of
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.solvers.solution import Solution


@dataclass(frozen=True)
class Gain:
    """What the gradient gained at one point of a front.

    Attributes
    ----------
    residual : float
        Residual of the point, which the improved one keeps [m].
    before, after : float
        Energy [J]; the same where nothing better was found.
    tried : bool
        False where Ctrl-C came before.
    """

    residual: float
    before: float
    after: float
    tried: bool = True

    @property
    def share(self) -> float:
        """Share of the energy that was saved."""
        return 1 - self.after / self.before


@dataclass(frozen=True)
class Polish:
    """An improved front and what each point gained.

    Attributes
    ----------
    front : Front
        The improved points; of those that could not be improved the given ones, with the reason in
        its `failures`.
    gains : tuple of Gain
        One for every point of the front that was given, in its order.
    """

    front: Front
    gains: tuple[Gain, ...]

    @property
    def complete(self) -> bool:
        """Whether no Ctrl-C ended the work early."""
        return self.front.complete


@one_at_a_time
def polish_front(front: Front, *, steps: int | None = None, report: Report = no_report) -> Polish:
    """Start the gradient from every point of a front, with the point's residual as the limit.

    Parameters
    ----------
    front : Front
        A front of any method; the bound among its settings is kept.
    steps : int, optional
        Steps of the solver's discretisation, as for `plan_move`.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    Polish
        The improved front, whose method is that of the front and ", polished". After Ctrl-C its
        points not yet done are as given, and it is not complete.

    Raises
    ------
    ValueError
        When the front has no point.
    """
    sweep = sweep_of(front, starts=1, steps=steps)
    tried = _polished(sweep, front.points, report)
    untried = front.points[len(tried) :]
    polished = front_of(
        sweep,
        f"{front.method}, polished",
        [*chain(*tried), *untried],
        len(front.points),
        complete=front.complete and not untried,
        between=front.excess is not None,
    )
    with_origin = replace(
        polished,
        settings={**front.settings, "steps": polished.settings["steps"]},
        seed=front.seed,
        reference=front.reference,
        evaluations=front.evaluations,
        iterations=front.iterations + polished.iterations,
        history=front.history,
        seconds=front.seconds + polished.seconds,
    )
    pairs = zip_longest(front.points, tried)
    return Polish(with_origin, tuple(_gain(*pair) for pair in pairs))


_Found = list[FrontPoint | FailedPoint]
"""The point or a better one; after the former the reason, if there is one."""


def _polished(sweep: Sweep, points: Sequence[FrontPoint], report: Report) -> list[_Found]:
    """All points at once, then their checks; after Ctrl-C those that were done."""
    tried: list[_Found] = []
    with suppress(KeyboardInterrupt):
        rows = [(np.array(point.coefficients), sweep.ask(point.residual)) for point in points]
        for point, solved in zip(points, sweep.solve(rows), strict=True):
            tried.append(_one_polished(sweep, point, solved))
            report(len(tried), len(points))
    return tried


def _one_polished(sweep: Sweep, point: FrontPoint, solved: Solution) -> _Found:
    asked = {RESIDUAL_LIMIT: point.residual}
    if not solved.status.solved:
        return [point, FailedPoint(asked, solved.status.text)]
    found = checked(sweep, solved, asked, point.residual)
    if isinstance(found, FailedPoint):
        return [point, found]
    return [found if found.energy < point.energy else point]


def _gain(point: FrontPoint, found: _Found | None) -> Gain:
    after = found[0] if found else point
    assert isinstance(after, FrontPoint)
    return Gain(point.residual, point.energy, after.energy, tried=found is not None)
