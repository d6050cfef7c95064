"""Improve a front by the gradient, each point at its own residual."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from quietarm.ocp.checks import finite
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, checked
from quietarm.ocp.front.curve import front_of
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.sweep import Report, Sweep, no_report
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.program.solution import Solution
from quietarm.ocp.record import SolveSettings


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
    front.stillest()  # refuses an empty front
    bound = front.settings.get("bound")
    settings = SolveSettings(
        bound=None if bound is None else finite("bound", bound),
        starts=1,
        seed=front.seed or 0,
        steps=steps,
    )
    sweep = Sweep(front.task, front.profile, settings)
    tried = _polished(sweep, front.points, report)
    untried = [
        _Tried([point], _no_gain(point, tried=False)) for point in front.points[len(tried) :]
    ]
    return _together(front, sweep, tried + untried, complete=front.complete and not untried)


class _Tried(NamedTuple):
    """The point or a better one, or the reason of a failure; and the gain."""

    found: Sequence[FrontPoint | FailedPoint]
    gain: Gain


def _polished(sweep: Sweep, points: Sequence[FrontPoint], report: Report) -> list[_Tried]:
    """All points at once, then their checks; after Ctrl-C those that were done."""
    tried: list[_Tried] = []
    with suppress(KeyboardInterrupt):
        rows = [(np.array(point.coefficients), sweep.ask(point.residual)) for point in points]
        for point, solved in zip(points, sweep.solve(rows), strict=True):
            tried.append(_one_polished(sweep, point, solved))
            report(len(tried), len(points))
    return tried


def _one_polished(sweep: Sweep, point: FrontPoint, solved: Solution) -> _Tried:
    if not solved.status.solved:
        return _failed(point, solved.status.text)
    found = checked(sweep, solved, {RESIDUAL_LIMIT: point.residual}, point.residual)
    if isinstance(found, FailedPoint):
        return _failed(point, found.reason)
    if found.energy < point.energy:
        return _Tried([found], Gain(point.residual, point.energy, found.energy))
    return _Tried([point], _no_gain(point))


def _failed(point: FrontPoint, reason: str) -> _Tried:
    failure = FailedPoint({RESIDUAL_LIMIT: point.residual}, reason)
    return _Tried([point, failure], _no_gain(point))


def _no_gain(point: FrontPoint, tried: bool = True) -> Gain:
    return Gain(point.residual, point.energy, point.energy, tried)


def _together(front: Front, sweep: Sweep, tried: Sequence[_Tried], complete: bool) -> Polish:
    """The improved front; points keep their order along the given one."""
    polished = front_of(
        sweep,
        f"{front.method}, polished",
        [found for one in tried for found in one.found],
        len(front.points),
        iterations=front.iterations, complete=complete, seconds=front.seconds,
        between=front.excess is not None,
    )  # fmt: skip
    with_origin = replace(
        polished,
        settings={**front.settings, "steps": polished.settings["steps"]},
        seed=front.seed,
        reference=front.reference,
        evaluations=front.evaluations,
        history=front.history,
    )
    return Polish(with_origin, tuple(one.gain for one in tried))
