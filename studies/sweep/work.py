"""Plan the chunks of a grid that are missing, each a piece of work."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import groupby

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.sharing.pieces import Done, InterruptedPiece, Listener, Piece, Say
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import PointToPoint, SolveSettings, evaluate_coefficients, plan_moves
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.studies.sweep.store import FIGURES, STATES, STATUS, Store

Array = NDArray[np.float64]
Found = dict[str, Array]
_PEAKS = [name for name in FIGURES if name.startswith("peak")]


def run_sweep(
    store: Store,
    profile: JointProfile,
    settings: SolveSettings,
    part: tuple[int, int],
    workers: Workers,
    begin: Callable[[str], None],
) -> Done:
    """Plan what is missing; every chunk is in the store as soon as it is done."""
    pieces = [
        Piece(number, f"chunk {number + 1} of {len(store.grid.chunks)}",
              partial(_planned, store.grid.tasks(store.grid.chunks[number]), profile, settings))
        for number in store.missing(part)
    ]  # fmt: skip
    kept = set[object]()

    def keep(number: int, found: Found) -> None:
        store.keep(number, found)
        kept.add(number)

    done = run_pieces(pieces, Listener(begin, ended=keep), workers=workers)
    with note_interrupts():
        for number, found in done.answers.items():
            if number not in kept:  # it was on its way when Ctrl-C came
                keep(int(str(number)), found)
    return done


def _planned(
    tasks: list[PointToPoint], profile: JointProfile, settings: SolveSettings, done: Done, say: Say
) -> Found:
    groups = [list(each) for _, each in groupby(tasks, key=lambda task: task.plant)]
    each = [_of_one_plant(group, profile, settings) for group in groups]
    return {name: np.concatenate([one[name] for one in each]) for name in each[0]}


def _of_one_plant(
    tasks: list[PointToPoint], profile: JointProfile, settings: SolveSettings
) -> Found:
    moves = plan_moves(
        tasks, profile, residual_limit=settings.residual_limit, bound=settings.bound,
        starts=settings.starts, seed=settings.seed, solver=settings.solver,
    )  # fmt: skip
    if not moves.complete:
        raise InterruptedPiece(None)
    found = {name: np.full(len(tasks), np.nan) for name in FIGURES}
    found["coefficients"], found["iterations"] = moves.coefficients, moves.iterations.astype(float)
    states = [STATES.index(status.value) for status in moves.status]
    found[STATUS] = np.array(states, np.int8)
    for k in np.flatnonzero(np.isfinite(moves.energy)):
        motion = evaluate_coefficients(tasks[k], moves.coefficients[k], profile=profile).motion
        for name in ("energy", "residual", *_PEAKS):
            found[name][k] = getattr(motion, name)
    return found
