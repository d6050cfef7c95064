"""Improve a front by the gradient, each point at its own residual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ocp.checks import finite
from ocp.front import FailedPoint, Front, FrontPoint
from ocp.provenance import SolveSettings
from ocp.sweep import RESIDUAL_LIMIT, Report, Sweep, no_report


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
    found: list[FrontPoint | FailedPoint] = []
    gains: list[Gain] = []
    complete = front.complete
    try:
        for i, point in enumerate(front.points, start=1):
            found += _polished(sweep, point, gains)
            report(i, len(front.points))
    except KeyboardInterrupt:
        complete = False
    left = front.points[len(gains) :]
    gains += [Gain(point.residual, point.energy, point.energy, tried=False) for point in left]
    polished = sweep.front(
        f"{front.method}, polished", [*found, *left], len(front.points),
        iterations=front.evaluations, complete=complete, seconds=front.seconds,
    )  # fmt: skip
    with_origin = replace(
        polished,
        settings={**front.settings, "steps": polished.settings["steps"]},
        seed=front.seed,
        reference=front.reference,
        history=front.history,
    )
    return Polish(with_origin, tuple(gains))


def _polished(
    sweep: Sweep, point: FrontPoint, gains: list[Gain]
) -> Sequence[FrontPoint | FailedPoint]:
    asked = {RESIDUAL_LIMIT: point.residual}
    solved = sweep.solve(np.array(point.coefficients), point.residual)
    checked = (
        sweep.checked(solved, asked)
        if solved.status.solved
        else FailedPoint(asked, solved.status.text)
    )
    if isinstance(checked, FrontPoint) and checked.energy < point.energy:
        gains.append(Gain(point.residual, point.energy, checked.energy))
        return [checked]
    gains.append(Gain(point.residual, point.energy, point.energy))
    return [point, checked] if isinstance(checked, FailedPoint) else [point]
