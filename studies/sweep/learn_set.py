"""`learn_set`: from a sweep's dataset and recordings of some of its moves, one that leaves less."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.machine.identify.identified import Estimate
from quietarm.machine.learn.learn import check_plan, read_move
from quietarm.machine.learn.learn_moves import MovesOfMachine
from quietarm.machine.learn.reading.read_swing import modal_names
from quietarm.machine.recordings.mending import without_glitches
from quietarm.machine.recordings.recording import Recording, checked_recordings
from quietarm.ocp.planning.executed import ExecutedMove, MoveHistory, RecordedArrival
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.sweep.definition import Definition
from quietarm.studies.sweep.learned_arrivals import LearnedArrivals
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.studies.sweep.move_grid import MoveGrid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LearnedSet:
    """A whole dataset corrected by recordings of some of its moves, and what these told.

    Attributes
    ----------
    definition : Definition
        The corrected dataset: `write` plans its cells.
    moves : tuple of ExecutedMove
        All that was learned from, also for earlier datasets.
    left : tuple of float
        What each of them left [m].
    left_out : tuple of float
        What each would leave if it were corrected by the recordings of the others [m]; empty where
        there is one move alone.
    changed : mapping of str to (float, float)
        Parameters that are changed: the model's value and the new one.
    estimates : tuple of Estimate
        What all recordings together tell of the plant's frequencies and dampings.
    notes : tuple of str
        What is to be known of the recordings.
    """

    definition: Definition
    moves: tuple[ExecutedMove, ...]
    left: tuple[float, ...]
    left_out: tuple[float, ...]
    changed: Mapping[str, tuple[float, float]]
    estimates: tuple[Estimate, ...]
    notes: tuple[str, ...] = ()

    def write(self, path: str | Path) -> MoveLibrary:
        """Plan all cells anew, and return the library of the dataset that has them.

        After an interruption the same call continues.
        """
        from quietarm.studies.sweep.run import run_sweep
        from quietarm.studies.sweep.store import Store

        run_sweep(Store.of(Path(path), self.definition))
        return MoveLibrary(path)


@interruptible
def learn_set(
    dataset: str | Path | MoveLibrary,
    executed: Sequence[tuple[Mapping[str, float], Recording]],
) -> LearnedSet:
    """Learn a whole dataset from recordings of some of its moves.

    Parameters
    ----------
    dataset : str, Path or MoveLibrary
        The dataset of `quietarm sweep`, or one that was learned before, which knows its moves.
    executed : sequence of (mapping of str to float, Recording)
        A value of every axis by its name [SI units], and a recording of that move as
        `plan_from` gives it. Several recordings may be of one move.

    Returns
    -------
    LearnedSet
        What changes, how well other cells are predicted, and the corrected dataset.

    Raises
    ------
    FileFormatError
        When there is no such dataset.
    ValueError
        When a recording tells nothing, or a dataset is of several plants, of fronts or of
        uncertain plants.
    """
    library = dataset if isinstance(dataset, MoveLibrary) else MoveLibrary(dataset)
    _check(library)
    grid = library.grid
    before = grid.arrivals
    recordings, notes = without_glitches(checked_recordings([one for _, one in executed]))
    moves = list(before.history.moves) if before else []
    for (at, _), recording in zip(executed, recordings):
        plan = library.plan(**at)
        check_plan(plan)
        read = read_move(plan, recording)
        if read.by_joint:
            raise ValueError(
                f"{recording.name}: it has no tip; a whole set is learned from a sensor at the "
                "tip: name its column by --tip or --acceleration"
            )
        notes += [note for note in (read.doubt, *read.after.notes) if note]
        now = ExecutedMove(plan.profile, plan.coefficients, plan.task.move, (read.after.measured,))
        _add(moves, now)
    span = _span(grid)
    told = MovesOfMachine(grid.task, moves)
    model = {name: getattr(grid.task.plant, name) for name in modal_names(grid.task.plant)}
    history = MoveHistory(tuple(moves), model=before.history.model if before else model)
    arrivals = LearnedArrivals(history, tuple(told.smooth(span)))
    learned_grid = MoveGrid(replace(grid.task, plant=told.plant), grid.axes, arrivals)
    left_out = told.left_out(span) if len(moves) > 1 else np.array([])
    return LearnedSet(
        definition=replace(library.store.definition, grid=learned_grid),
        moves=told.moves,
        left=tuple(np.abs(told.left).sum(axis=1).tolist()),
        left_out=tuple(left_out.tolist()),
        changed=told.changed,
        estimates=told.estimates,
        notes=tuple(notes),
    )


def _add(moves: list[ExecutedMove], now: ExecutedMove) -> None:
    """Add a move, or a recording of one that is there."""
    for number, known in enumerate(moves):
        if (known.coefficients, known.move) == (now.coefficients, now.move):
            measured: tuple[RecordedArrival, ...] = (*known.measured, *now.measured)
            moves[number] = replace(known, measured=measured)
            return
    moves.append(now)


def _check(library: MoveLibrary) -> None:
    """Refuse a dataset that is no set of moves of one plant."""
    definition = library.store.definition
    of_plant = [name for name in library.grid.names if name not in OF_MOVES]
    if of_plant:
        raise ValueError(
            f"{library.store.path} has an axis over {of_plant[0]}, and recordings are of one "
            "plant; sweep the moves of that plant alone"
        )
    if definition.front or library.grid.task.ranges:
        raise ValueError(
            f"{library.store.path} has {'fronts' if definition.front else 'robust plans'}, which "
            "are not learned; sweep plans without --front and --error"
        )


def _span(grid: MoveGrid) -> Array:
    """The least and the largest target, way and duration of a grid."""
    values = {axis.name: np.array(axis.values) for axis in grid.axes}
    task = grid.task
    start = values.get("start", np.array([task.start]))
    target = values.get("target", np.array([task.target]))
    duration = values.get("duration", np.array([task.duration]))
    way = target[:, None] - start
    return np.array([
        [target.min(), way.min(), duration.min()], [target.max(), way.max(), duration.max()]
    ])  # fmt: skip
