"""Moves one after another: each begins with what the last one left, after a wait that is chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from quietarm.ocp.checks import not_negative
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.plan.answer import Plan
from quietarm.ocp.plan.many import plan_moves
from quietarm.ocp.plan.robust import limit_of
from quietarm.ocp.plan.solver import plan_move
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.residual import slowest_swing
from quietarm.ocp.task import PointToPoint

_WAITS, _FINER, _ROUNDS = 17, 9, 2
"""Waits of the first grid, and of those between the best one's neighbours, so many times."""
_SAME = 1e-6
"""Energies that differ by less than this share are one: the shorter wait is chosen."""
Wait = float | tuple[float, float] | None
"""How long [s] to wait before a move, between which two times, or up to a period."""


class Waited(NamedTuple):
    """A plan, and the wait from the arrival before it to its start [s]."""

    wait: float
    plan: Plan


@one_at_a_time
def plan_after(
    earlier: Plan,
    task: PointToPoint,
    wait: Wait = None,
    profile: JointProfile | None = None,
    **settings: Any,
) -> Waited:
    """Plan a move that begins with what an earlier one left.

    Parameters
    ----------
    earlier : Plan
        The move before.
    task : PointToPoint
        The next move, of the same plant, from where the last one ended; what rings at its start is
        put in.
    wait : float, (float, float) or None
        From the arrival to the start [s]. Of two times, the wait between them with which the move
        takes least energy, the shortest of equals: on a grid, all of whose moves are solved at
        once, then on finer ones around the best. None is from 0 to a period of the slowest mode.
        Of an uncertain plant the assumed one counts.
    profile, **settings
        As for `plan_move`.

    Returns
    -------
    Waited
        The wait, and the plan of the move.

    Raises
    ------
    ValueError
        When the plants differ, the move begins elsewhere, or an argument is out of range.
    SolverFailedError
        As by `plan_move`.
    """
    if task.plant != earlier.task.plant:
        raise ValueError("the two moves have different plants; give the plant of the earlier one")
    if task.start != earlier.task.target:
        raise ValueError(
            f"the move starts at {task.start:g} rad and the earlier one ends at "
            f"{earlier.task.target:g} rad; start there"
        )
    if wait is None:
        wait = 0.0, slowest_swing(task.plant, task.start)
    if isinstance(wait, tuple):
        wait, guess = _least_energy(earlier, task, wait, profile, settings)
        settings = {"guess": guess, **settings}
    return Waited(wait, plan_move(_after(earlier, task, wait), profile, **settings))


@one_at_a_time
def plan_sequence(
    tasks: Sequence[PointToPoint],
    waits: Sequence[Wait] | None = None,
    profile: JointProfile | None = None,
    **settings: Any,
) -> tuple[Waited, ...]:
    """Plan moves one after another, each beginning with what the last one left.

    Waits are chosen one by one, each for the move after it alone.

    Parameters
    ----------
    tasks : sequence of PointToPoint
        The moves, each from where the last one ends.
    waits : sequence, optional
        Between each two of them [s], as for `plan_after`; all are chosen by default.
    profile, **settings
        As for `plan_move`, of every move.

    Returns
    -------
    tuple of Waited
        The plans with the waits before them; after Ctrl-C those until then.

    Raises
    ------
    ValueError
        When there is no move, or not a wait less than moves; else as by `plan_after`.
    """
    waits = [None] * (len(tasks) - 1) if waits is None else waits
    if len(waits) != len(tasks) - 1:
        raise ValueError(
            f"{len(waits)} waits are given for {len(tasks)} moves; give one between each two moves"
        )
    found = [Waited(0.0, plan_move(tasks[0], profile, **settings))]
    for task, wait in zip(tasks[1:], waits, strict=True):
        if not found[-1].plan.complete:
            break
        try:
            found.append(plan_after(found[-1].plan, task, wait, profile, **settings))
        except KeyboardInterrupt:
            break
    return tuple(found)


def _after(earlier: Plan, task: PointToPoint, wait: float) -> PointToPoint:
    return replace(task, initial=earlier.state_after(wait))


def _least_energy(
    earlier: Plan,
    task: PointToPoint,
    between: tuple[float, float],
    profile: JointProfile | None,
    settings: dict[str, Any],
) -> tuple[float, Sequence[float] | None]:
    """The wait with which a move takes least energy, and its coefficients."""
    low, high = (not_negative("wait", one, "s") for one in sorted(between))
    asked = {name: settings[name] for name in ("bound", "seed", "solver") if name in settings}
    asked["residual_limit"] = limit_of(task, settings.get("residual_limit"))
    best, least, guess = low, np.inf, None
    waits = np.linspace(low, high, _WAITS)
    for _ in range(1 + _ROUNDS):
        tasks = [_after(earlier, task.certain, one) for one in waits.tolist()]
        moves = plan_moves(tasks, profile, **asked)
        if not moves.complete:
            raise KeyboardInterrupt
        energy = np.nan_to_num(moves.energy, nan=np.inf)
        if energy.min() < least * (1 - _SAME):
            i = int(np.argmax(energy <= energy.min() * (1 + _SAME)))  # the first of equals
            best, least, guess = waits[i], energy[i], tuple(moves.coefficients[i].tolist())
        step = waits[1] - waits[0]
        waits = np.linspace(max(low, best - step), min(high, best + step), _FINER)
    return float(best), guess
