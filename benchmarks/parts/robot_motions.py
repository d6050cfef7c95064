"""Motions of a robot's joints by plans and by what is used in their place, for another simulator.

A motion is a function of the time [s] that gives positions, speeds and accelerations of all joints.
`tests/helpers` has to be on the path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from mujoco_robots import motion_along, motion_of
from numpy.typing import NDArray

import quietarm as qa
from quietarm.ocp import JudgedMotion
from quietarm.studies.compare.baselines import baseline

Array = NDArray[np.float64]
Motion = Callable[[float], tuple[Array, Array, Array]]
RIVALS = ("cycloid", "ruckig", "toppra", "zvd")
"""Baselines of `quietarm compare` that are held against plans for robots."""
LIMITED = ("speed", "acceleration", "jerk")
"""Quantities of a motion whose peaks follow from the motion alone."""


def motion_of_answer(answer: Any) -> Motion:
    """Return the joints' motion of a plan, or of a motion that CVODES judged, by its path."""
    judged = getattr(answer, "candidate", answer)
    if judged.profile is not None:
        return motion_of(judged)
    return motion_along(judged.task.plant.path, _place_in_pieces(judged))


def _place_in_pieces(judged: JudgedMotion) -> Callable[[float], Array]:
    """Place, speed and acceleration on the path by the time, of a motion of constant jerks."""
    pieces = judged.path.arguments
    begins = np.append(0.0, np.cumsum(pieces[-1]))

    def along(at: float) -> Array:
        if at >= begins[-1]:
            return np.array([judged.task.target, 0.0, 0.0])
        piece = int(np.searchsorted(begins, at, side="right")) - 1
        since = at - begins[piece]
        place, speed, acceleration, jerk = pieces[:4, piece]
        gained = acceleration + jerk * since / 2
        return np.array([
            place + since * (speed + since * (acceleration / 2 + since * jerk / 6)),
            speed + since * gained,
            acceleration + since * jerk,
        ])  # fmt: skip

    return along


def rival(name: str, task: qa.PointToPoint) -> Motion:
    """Return the motion of a baseline in a task's duration, within its limits if it knows them.

    toppra knows no jerk: it stretches its fastest motion within the other limits.
    """
    if name == "toppra":
        task = replace(task, jerk_limit=None)
    return motion_of_answer(baseline(name, task))


def peaks_of(motion: Motion, duration: float, samples: int = 4001) -> dict[str, Array]:
    """Return the peaks of speed, acceleration and jerk of each joint, by samples of a motion.

    Jerks are differences of accelerations; where these jump, they are as large as the jump over the
    step.
    """
    times = np.linspace(0.0, duration, samples)
    rows = np.array([motion(at)[1:] for at in times])
    speeds, accelerations = rows[:, 0], rows[:, 1]
    jerks = np.diff(accelerations, axis=0) / (times[1] - times[0])
    peaks = (np.abs(values).max(axis=0) for values in (speeds, accelerations, jerks))
    return dict(zip(LIMITED, peaks))
