"""Sentence and rows on what recordings of some moves tell of a dataset."""

from __future__ import annotations

from math import pi

import numpy as np

from quietarm.machine.identify.identified import is_frequency
from quietarm.models import Plant
from quietarm.models.joint_motion import LINEAR
from quietarm.studies.sweep.learn_set import LearnedSet
from quietarm.views.report.learning_rows import with_unit
from quietarm.views.report.words import counted

Row = tuple[str, str]


def set_sentence(learned: LearnedSet, plant: Plant) -> str:
    """Say what the recorded moves left, what of it changes, and how well others are predicted."""
    words = f"left {with_unit(max(learned.left), plant)} at most"
    rates = [
        f"{new / (2 * pi):.4g} Hz, model {model / (2 * pi):.4g} Hz"
        for name, (model, new) in learned.changed.items()
        if is_frequency(plant, name)
    ]
    words += f" ({'; '.join(rates)})" if rates else ""
    if not learned.left_out:
        return f"{words}; one move does not tell how well others are predicted: record another"
    median = with_unit(float(np.median(learned.left_out)), plant)
    most = with_unit(max(learned.left_out), plant)
    words += f"; cells without a recording: {median}, at most {most} (each move left out once)"
    limit = learned.definition.settings.residual_limit
    if limit == 0.0:
        return words
    return f"{words}, beside the {with_unit(limit, plant)} that each plan itself may leave"


def set_rows(learned: LearnedSet, plant: Plant) -> list[Row]:
    """The moves that were recorded: what each left, and what the others make of it."""
    recordings = sum(len(move.measured) for move in learned.moves)
    rows = [
        (
            "learned from",
            f"{counted(len(learned.moves), 'move')}, {counted(recordings, 'recording')}",
        )
    ]
    left_out = learned.left_out or (None,) * len(learned.moves)
    way, size = ("mm", 1e3) if plant.joint == LINEAR else ("deg", 180 / pi)
    for move, left, without in zip(learned.moves, learned.left, left_out):
        start, target, duration = move.move
        predicted = "" if without is None else f", by the others {with_unit(without, plant)}"
        rows.append(
            (
                f"{size * start:.4g} to {size * target:.4g} {way}, {duration:.4g} s",
                f"left {with_unit(left, plant)}{predicted}",
            )
        )
    return rows
