"""Read frequencies and dampings from the ring-downs of a robot whose joints are held."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.held_robots.held_modes import HeldModes
from quietarm.machine.identify.swings.ring_downs import find_ring_downs
from quietarm.machine.learn.robots.robot_swing import (
    LEAST_PERIODS,
    SETTLES,
    RobotSwing,
    mode_name,
    read_robot_swing,
)
from quietarm.machine.recordings.recording import Recording
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models.robot import Robot

Array = NDArray[np.float64]
_MOST_PERIODS = 20.0
"""Of the slowest mode, that are read of a ring-down: later ones are small."""
_MODES = 4
"""So many modes are sought at least: two of a bar are its first bending, two its second."""
_SAMPLES = 8.0
"""A period, of the fastest mode that is sought."""
_MOST_UNEXPLAINED = 0.4
"""Share of a swing, beyond which it is no free decay of the robot's modes."""
_LEAST_UNSURE = 2.5e-4
"""Share of a frequency that no ring-down tells: springs are not quite linear."""
_AXES: dict[int, tuple[tuple[int, ...], ...]] = {
    1: ((0,), (1,), (2,)),
    2: ((0, 1),),
    3: ((0, 1, 2),),
}
"""Axes of the tip that so many columns may be."""


@dataclass(frozen=True)
class HeldSwing:
    """A mode in one ring-down: its frequency [Hz], its damping ratio, and standard deviations."""

    recording: str
    begin: float
    posture: tuple[float, ...]
    mode: int
    frequency: float
    of_frequency: float
    damping: float
    of_damping: float


@dataclass(frozen=True)
class RingDown:
    """A ring-down of one recording: its modes, and the torques that hold the robot meanwhile."""

    posture: tuple[float, ...]
    swings: tuple[HeldSwing, ...]
    torques: Array | None
    notes: tuple[str, ...]


def read_ring_downs(
    robot: Robot,
    recording: RobotRecording,
    posture: Sequence[float] | None,
    parts: Sequence[tuple[float, float]],
) -> list[RingDown]:
    """Return what each ring-down of a recording tells.

    Parameters
    ----------
    robot : Robot
        As its file has it.
    recording : RobotRecording
        Of held joints.
    posture : sequence of float, optional
        Positions of the driven joints [rad or m]; those that were recorded by default.
    parts : sequence of (float, float)
        Begins and ends [s]; found where there are none.

    Raises
    ------
    ValueError
        When no posture is known, or nothing rings down.
    """
    _check(robot, recording, posture)
    spans = parts or _spans(robot, recording, posture)
    return [_read(robot, recording, posture, begin, end) for begin, end in spans]


def _check(robot: Robot, recording: RobotRecording, posture: Sequence[float] | None) -> None:
    """Refuse columns that are not those of the robot, and joints of which no place is known."""
    count = len(robot.joints)
    for signal in ("torques", "positions"):
        values = getattr(recording, signal)
        if values is not None and values.shape[1] != count:
            raise ValueError(
                f"{recording.name} has {values.shape[1]} columns of {signal}, and the robot "
                f"{count} joints, {', '.join(robot.joints)}; give one of each, in this order"
            )
    signal, values = recording.swinging
    if signal != "torques" and values.shape[1] not in _AXES:
        raise ValueError(
            f"{recording.name} has {values.shape[1]} columns of {signal}; give those along x, y "
            "and z of the tip's frame, or along x and y, or one"
        )
    if posture is None and recording.positions is None:
        raise ValueError(
            f"{recording.name} has no positions of the joints; give them by --posture, one of each "
            f"of {', '.join(robot.joints)}, or record them"
        )


def _posture(
    robot: Robot,
    recording: RobotRecording,
    posture: Sequence[float] | None,
    begin: float,
    end: float,
) -> Array:
    """The positions of the joints in a part of a recording, none of them in degrees."""
    q = _posture_at(recording, posture, begin, end)
    robot.check_posture(f"the posture of {recording.name}", q.tolist())
    return q


def _posture_at(
    recording: RobotRecording, posture: Sequence[float] | None, begin: float, end: float
) -> Array:
    if posture is not None:
        return np.asarray(posture, float)
    held = recording.part(begin, end).positions
    assert held is not None
    return np.asarray(np.median(held, axis=0), float)


def _spans(
    robot: Robot, recording: RobotRecording, posture: Sequence[float] | None
) -> list[tuple[float, float]]:
    """Begins and ends of the free decays that are long enough [s]."""
    last = float(recording.time[-1])
    q = _posture(robot, recording, posture, last - 0.2 * float(np.ptp(recording.time)), last)
    slowest = float(robot.frequencies(q)[0]) / (2 * np.pi)
    way = None
    if recording.positions is not None:
        way = np.linalg.norm(recording.positions - recording.positions[-1], axis=1)
    whole = Recording(
        recording.time, angle=way, acceleration=recording.swinging[1], name=recording.name
    )
    rows = find_ring_downs(whole, slowest)
    spans = [(float(whole.time[one.start]), float(whole.time[one.stop - 1])) for one in rows]
    least = SETTLES + LEAST_PERIODS / slowest
    long = [(begin, end) for begin, end in spans if end - begin >= 0.97 * least]
    if not long:
        raise ValueError(
            f"{recording.name}: nothing rings down for {least:.2g} s, two periods of the robot's "
            "first mode; record longer with the joints held, or say where by --part begin:end"
        )
    return long


def _read(
    robot: Robot,
    recording: RobotRecording,
    posture: Sequence[float] | None,
    begin: float,
    end: float,
) -> RingDown:
    """The modes of one ring-down."""
    part = recording.part(begin, end)
    if len(part.time) < 2:
        raise ValueError(f"{recording.name} has no rows from {begin:g} to {end:g} s; give others")
    q = _posture(robot, recording, posture, begin, end)
    found, modes = min(
        (_swing(robot, part, q, axes) for axes in _axes_of(part)),
        key=lambda one: one[0].unexplained,
    )
    if found.unexplained > _MOST_UNEXPLAINED:
        raise ValueError(
            f"{recording.name}, {begin:.3g} to {end:.3g} s: {found.unexplained:.0%} of it is no "
            "free decay of the robot's modes; select another part by --part begin:end"
        )
    swings = tuple(_told(found, modes, recording.name, begin, tuple(q.tolist())))
    if not swings:
        raise ValueError(
            f"{recording.name}, {begin:.3g} to {end:.3g} s: no mode stands out of the noise; push "
            "harder, or record longer"
        )
    torques = None if part.torques is None else part.torques.mean(axis=0)
    return RingDown(tuple(q.tolist()), swings, torques, found.notes)


def _axes_of(recording: RobotRecording) -> Sequence[tuple[int, ...]]:
    signal, values = recording.swinging
    return ((),) if signal == "torques" else _AXES[values.shape[1]]


def _swing(
    robot: Robot, part: RobotRecording, q: Array, axes: Sequence[int]
) -> tuple[RobotSwing, HeldModes]:
    """The swing of a ring-down, by the modes that its samples show."""
    frequencies = robot.frequencies(q) / (2 * np.pi)
    shown = int(np.count_nonzero(frequencies < 1 / (_SAMPLES * part.step)))
    followed = robot.modes if isinstance(robot.modes, int) else 0
    count = max(1, min(max(_MODES, followed), shown))
    modes = HeldModes(robot, q, part.swinging[0], axes, count)
    periods = min(_MOST_PERIODS, float(np.ptp(part.time)) * float(frequencies[0]) * 1.5)
    return read_robot_swing(part, float(part.time[0]), modes, 0.0, 0.0, periods), modes


def _told(
    found: RobotSwing, modes: HeldModes, name: str, begin: float, posture: tuple[float, ...]
) -> Iterator[HeldSwing]:
    """Yield the modes that stand out."""
    values, deviations = found.measured.values, found.measured.deviations
    for number in range(len(modes.values)):
        mode = mode_name(number)
        if mode not in values:
            continue
        together = [k for k in range(len(modes.values)) if values.get(mode_name(k)) == values[mode]]
        apart = float(np.ptp(np.log(modes.frequencies[together])))  # modes that beat
        share = deviations[mode] / values[mode]
        unsure = float(np.hypot(np.hypot(share, _LEAST_UNSURE), apart / 2))
        damping, of_damping = found.dampings[mode]
        yield HeldSwing(
            recording=name,
            begin=begin,
            posture=posture,
            mode=number + 1,
            frequency=values[mode],
            of_frequency=unsure * values[mode],
            damping=damping,
            of_damping=of_damping,
        )
