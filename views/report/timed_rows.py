"""A trajectory as it is timed in rows of a name and a value."""

from __future__ import annotations

import math

import numpy as np

from quietarm.models.dimensions import WAY, words_of
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.planning.as_timed import TimedAnswer
from quietarm.views.report.robot_rows import WARNING, Row

_ROUNDING = 1e-9
_MOVES = 1e-6
"""Speed [rad/s or m/s] from which on a trajectory does not end at rest."""


def timed_rows(answer: TimedAnswer) -> list[Row]:
    """Say what a trajectory takes and leaves, its peaks beside the limits, what makes it ring."""
    robot, motion = answer.robot, answer.motion
    points = len(motion.points)
    rows = [
        ("move", f"{robot.description.name}, as it is timed in {motion.duration:.4g} s"),
        ("path", f"{points} points of {len(motion.joints)} joints"),
        *(("path", words) for words in motion.remarks),
        *_ends_rows(answer),
        ("energy", f"{answer.energy:.4g} J"),
        ("residual", f"{1e3 * answer.residual:.3g} mm at the tip"),
        *(_peak_row(answer, name) for name in answer.peaks),
    ]
    rows += _step_rows(answer)
    swings = [
        f"{frequency / math.tau:.3g} Hz {1e3 * size:.2g} mm" for frequency, size in answer.swings
    ]
    rows.append(("swings on", ", ".join(swings[:_SHOWN])))
    rows.append(("what rings", answer.diagnosis))
    rows += [(WARNING, note.words) for note in robot.notes]
    return [*rows, ("verified", "by one integrator alone (CVODES), on the whole equations")]


_SHOWN = 4
"""Modes, the slowest."""


def _peak_row(answer: TimedAnswer, name: str) -> Row:
    """The peak of each joint, and which pass their limits."""
    robot = answer.robot
    quantity = QUANTITIES[name]
    peaks = dict(zip(robot.joints, answer.peaks[name].tolist()))
    units = {joint: quantity.unit.of(robot.kind_of(joint)) for joint in peaks}
    largest = ", ".join(f"{joint} {peak:.4g} {units[joint]}" for joint, peak in peaks.items())
    limits = robot.limits.get(name, {})
    broken = [
        f"{joint} {limits[joint]:.4g}"
        for joint, peak in peaks.items()
        if joint in limits and peak > limits[joint] * (1 + _ROUNDING)
    ]
    words = f" (beyond the limit of {', '.join(broken)})" if broken else ""
    return f"peak {words_of(name)}", f"{largest}{words}"


def _step_rows(answer: TimedAnswer) -> list[Row]:
    """The largest step of an acceleration, where there is one."""
    size, joint, time = answer.largest_step
    if size <= 1e-3 * answer.peaks["acceleration"].max():
        return []
    unit = QUANTITIES["acceleration"].unit.of(answer.robot.kind_of(joint))
    return [("step", f"the acceleration of {joint} jumps by {size:.3g} {unit} at {time:.3g} s")]


def _ends_rows(answer: TimedAnswer) -> list[Row]:
    """A warning where it does not begin or end at rest."""
    ends = answer.motion.at(np.array([0.0, 1.0]), 1)[[0, -1], [0, 1]]
    rows = list[Row]()
    for place, speeds in zip(("begin", "end"), ends):
        fastest = int(np.abs(speeds).argmax())
        if abs(speeds[fastest]) > _MOVES:
            joint = answer.motion.joints[fastest]
            unit = f"{WAY.of(answer.robot.kind_of(joint))}/s"
            rows.append(
                (
                    WARNING,
                    f"the trajectory does not {place} at rest: {joint} moves at "
                    f"{speeds[fastest]:.3g} {unit} there, and is taken to stand before and after",
                )
            )
    return rows
