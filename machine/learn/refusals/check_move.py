"""Check that a recording is of a plan's own move, not of another that goes about the same way.

The start of a move is found by what is alike in all moves of one task. Once the frequency of the
swing is known as well, the plan explains nearly all of its own move's recording, and clearly less
of any other: the path of a joint but for what its servo does, of a tip the path and the swing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.diagnosis import saturated
from quietarm.machine.identify.identified import is_frequency
from quietarm.machine.learn.reading.find_start import Start, StartSearch, best_search, courses_of
from quietarm.machine.recordings.recording import Recording, noise_of
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_COURSES = {"angle": "served", "tip": "tip", "acceleration": "acceleration"}
_MOST_UNEXPLAINED = {"angle": 3e-5, "tip": 1e-4, "acceleration": 2e-2}
"""Share of a signal's power, beyond its noise, that the plan leaves unexplained of its own move.

Two machines that are not quietarm's model leave up to 1.2e-6, 2.3e-5 and 3.2e-3, and other plans of
the same task from 8e-5, 2.6e-4 and 4.9e-2 on."""
_OF_DISPLACEMENT = 0.1
"""The same share of a swing that is seen without the path."""
_SAME_SIZE = {"angle": 5e-3, "tip": 5e-3, "acceleration": 0.1}
"""Share by which the path may be larger or smaller in a signal than in the plan."""


def check_move(plan: Plan, recording: Recording, start: Start, told: Mapping[str, float]) -> float:
    """The start of a plan's move by the frequency that it has [s].

    With a wrong frequency the start by a tip or an accelerometer is some milliseconds off.

    Parameters
    ----------
    plan, recording : Plan, Recording
        The plan, and the recording that should be of its move.
    start : Start
        Where the move begins in it.
    told : mapping of str to float
        The plant's parameters, as far as the swing after the move tells them.

    Raises
    ------
    ValueError
        When the recording is of another move than the plan's.
    """
    signal = start.signal
    if signal not in _COURSES:
        return start.time
    values = recording.measured[signal].reshape(len(recording.time), -1)[:, 0]
    moving = recording.rows(start.time, start.time + plan.task.duration)
    if signal == "tip" and is_cut(values[moving]):
        return start.time  # a sensor that sees the tip near its target alone
    motion = _motion(plan, told)
    most = _MOST_UNEXPLAINED[signal]
    search = StartSearch(
        recording.time, values, courses_of(motion, _COURSES[signal]), plan.task.duration
    )
    place = start.time if signal == "angle" else search.best(1.0)[0]
    lag, explained = search.refined(place)
    if motion is plan.candidate and signal != "angle" and 1 - explained > most:
        search, place, _ = best_search(plan, recording.time, values, signal, enough=1 - most)
        lag, explained = search.refined(place)
    sizes = search.sizes(lag)
    power = float(values[moving].var())
    noise = float(noise_of(values)[0]) ** 2
    unseen_path = signal == "tip" and abs(sizes[0]) < _SAME_SIZE["tip"]
    most = _OF_DISPLACEMENT if unseen_path else most
    unexplained = 1 - explained
    if unexplained > most + noise / max(power, 1e-300):
        raise ValueError(
            f"{recording.name}: it is of another move: the plan leaves {unexplained:.2g} of the "
            f"power of its {_WORDS[signal]} unexplained, and of its own move at most {most:.2g}; "
            "give the recording of this plan's move"
        )
    _check_size(plan, recording, signal, sizes)
    return start.time if signal == "angle" else lag


_WORDS = {"angle": "joint", "tip": "tip", "acceleration": "accelerometer"}


def _check_size(plan: Plan, recording: Recording, signal: str, sizes: Array) -> None:
    """Refuse a path that is longer or shorter than the plan's, or goes the other way.

    Of a tip on an axis alone, where it shows the path as it is, or its swing without the path.
    """
    size, swing = float(sizes[0]), float(sizes[1])
    same = _SAME_SIZE[signal]
    if signal != "angle" and plan.task.plant.joint != LINEAR:
        return
    nearly = 3.0  # times the plant's swing
    if signal == "tip" and abs(size) < same:
        if 1 / nearly < swing < nearly:
            return
        words = f"its tip swings by {swing:.3g} times what the plan says"
    elif abs(size - 1) < same:
        return
    else:
        way, unit = size * plan.task.span, "m"
        if plan.task.plant.joint != LINEAR:
            way, unit = float(np.degrees(way)), "deg"
        words = f"its {_WORDS[signal]} goes {way:.4g} {unit}, {size - 1:+.1%} of the plan's way"
    raise ValueError(
        f"{recording.name}: it is of another move: {words}; give the recording of this plan's "
        "move, or its unit by --units"
    )


def is_cut(values: Array) -> bool:
    """Return whether a signal stays at its limit for a good part."""
    much = 0.05
    return bool(saturated(values[:, None]).mean() > much)


def _motion(plan: Plan, told: Mapping[str, float]) -> JudgedMotion:
    """The motion of a plan, whose plant swings as was told."""
    plant = plan.task.plant
    rates = {name: value for name, value in told.items() if is_frequency(plant, name)}
    if not rates:
        return plan.candidate
    task = replace(plan.task.certain, plant=replace(plant, **rates), final=None)
    return JudgedMotion.of_profile(task, plan.profile, plan.coefficients)
