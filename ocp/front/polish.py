"""Improve a front by the gradient, each point at its own residual."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ocp.answers.provenance import SolveSettings
from ocp.base.checks import finite
from ocp.base.workers import Say, Workers, death_of_process, number_of_workers
from ocp.front.answer import Front
from ocp.front.assembly import front_of
from ocp.front.checking import RESIDUAL_LIMIT, checked
from ocp.front.points import FailedPoint, FrontPoint
from ocp.front.sweep import Report, Sweep, no_report
from ocp.profiles.joint_profile import JointProfile
from ocp.task.point_to_point import PointToPoint


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


def polish_front(
    front: Front, *, steps: int | None = None, workers: int = 1, report: Report = no_report
) -> Polish:
    """Start the gradient from every point of a front, with the point's residual as the limit.

    Parameters
    ----------
    front : Front
        A front of any method; the bound among its settings is kept.
    steps : int, optional
        Steps of the solver's discretisation, as for `plan_move`.
    workers : int
        Processes that share the points; 1 stays in this one. What is found is the same.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    Polish
        The improved front, whose method is that of the front and ", polished". After Ctrl-C its
        points not yet done are as given, and it is not complete; those of a process that died are
        as given, too, and in its failures.

    Raises
    ------
    ValueError
        When the front has no point, or `workers` is below 1.
    """
    front.stillest()  # refuses an empty front
    workers = min(number_of_workers(workers), len(front.points))
    bound = front.settings.get("bound")
    settings = SolveSettings(
        bound=None if bound is None else finite("bound", bound),
        starts=1,
        seed=front.seed or 0,
        steps=steps,
    )
    sweep = Sweep(front.task, front.profile, settings)
    pieces = {i: front.points[i::workers] for i in range(workers)}
    done = dict.fromkeys(pieces, 0)

    def heard(piece: int, now: int) -> None:
        done[piece] = now
        report(sum(done.values()), len(front.points))

    if workers == 1:
        answers = {0: _polished(sweep, pieces[0], partial(heard, 0))}
    else:
        answers = _in_processes(sweep, pieces, heard)
    tried = {i + k * workers: one for i, piece in answers.items() for k, one in enumerate(piece)}
    untried = {
        i: _Tried([point], _no_gain(point, tried=False))
        for i, point in enumerate(front.points)
        if i not in tried
    }
    return _together(front, sweep, tried | untried, complete=front.complete and not untried)


class _Tried(NamedTuple):
    """The point or a better one, or the reason of a failure; and the gain."""

    found: Sequence[FrontPoint | FailedPoint]
    gain: Gain


_Pieces = Mapping[int, Sequence[FrontPoint]]


def _in_processes(
    sweep: Sweep, pieces: _Pieces, heard: Callable[[int, int], None]
) -> dict[int, list[_Tried]]:
    pool = Workers(partial(_one_piece, sweep.task, sweep.profile, sweep.settings), pieces, heard)
    pool.run(len(pieces))
    sweep.iterations += sum(iterations for _, iterations in pool.answers.values())
    lost = {
        i: [_failed(point, death_of_process(how)) for point in pieces[i]]
        for i, how in pool.lost.items()
    }
    return {i: tried for i, (tried, _) in pool.answers.items()} | lost


def _one_piece(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    points: Sequence[FrontPoint],
    say: Say,
) -> tuple[list[_Tried], int]:
    sweep = Sweep(task, profile, settings)
    return _polished(sweep, points, say), sweep.iterations


def _polished(
    sweep: Sweep, points: Sequence[FrontPoint], report: Callable[[int], None]
) -> list[_Tried]:
    """The points one after another; after Ctrl-C those that were done."""
    tried: list[_Tried] = []
    with suppress(KeyboardInterrupt):
        for point in points:
            tried.append(_one_polished(sweep, point))
            report(len(tried))
    return tried


def _one_polished(sweep: Sweep, point: FrontPoint) -> _Tried:
    solved = sweep.solve(np.array(point.coefficients), point.residual)
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


def _together(front: Front, sweep: Sweep, tried: Mapping[int, _Tried], complete: bool) -> Polish:
    """The improved front; points keep their order along the given one."""
    in_order = [tried[i] for i in range(len(front.points))]
    polished = front_of(
        sweep,
        f"{front.method}, polished",
        [found for one in in_order for found in one.found],
        len(front.points),
        iterations=front.iterations, complete=complete, seconds=front.seconds,
    )  # fmt: skip
    with_origin = replace(
        polished,
        settings={**front.settings, "steps": polished.settings["steps"]},
        seed=front.seed,
        reference=front.reference,
        evaluations=front.evaluations,
        history=front.history,
    )
    return Polish(with_origin, tuple(one.gain for one in in_order))
