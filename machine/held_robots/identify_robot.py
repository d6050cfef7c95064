"""A robot's springs, damping and load from ring-downs with its joints held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import tau
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.held_robots.held_load import load_at_rest, unfit_share
from quietarm.machine.held_robots.held_swings import HeldSwing, RingDown, read_ring_downs
from quietarm.machine.identify.combine import Group, estimate
from quietarm.machine.identify.identified import Estimate
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models.robot import Measured, Robot
from quietarm.models.robot.dynamics.measured_fit import MeasuredFit
from quietarm.ocp.checks import instance, several, takes

Array = NDArray[np.float64]
_SAME_POSTURE = 0.01
"""Positions of one posture differ by less [rad or m]: encoders and controllers flicker."""
_LEAST_WITHIN = 1e-3
"""Share within which a frequency is stated at best."""
_DAMPED_MODES = 2
"""The damping of these is met: that of faster ones is another, and soon over."""
BY_FREQUENCIES = "by the frequencies"
BY_TORQUES = "by the torques at rest"


@dataclass(frozen=True)
class HeldMode:
    """One mode at one posture, by all ring-downs of it.

    Attributes
    ----------
    posture : tuple of float
        Positions of the driven joints [rad or m].
    mode : int
        Its number; 1 is the slowest.
    frequency, damping : Estimate
        Its frequency [Hz] and damping ratio.
    misfit : float
        By what share the frequency is above that of the robot that was identified.
    recordings : tuple of str
        Names of those that tell it.
    """

    posture: tuple[float, ...]
    mode: int
    frequency: Estimate
    damping: Estimate
    misfit: float
    recordings: tuple[str, ...]


@dataclass(frozen=True)
class IdentifiedRobot:
    """A robot as its ring-downs tell it.

    Attributes
    ----------
    robot : Robot
        With what was measured, and the load that was told.
    modes : tuple of HeldMode
        By posture and mode.
    stiffness : Estimate
        Multiple of the stiffness of all springs in the robot's file.
    damping : float
        Multiple of the dampers, beside what keeps the damping ratio.
    payload : Estimate or None
        Mass at the end of the beam [kg]; None where nothing tells it.
    payload_by : str
        By what it is told, or why it is not.
    notes : tuple of str
        How ring-downs were read.
    unfit : float
        By what share the torques at rest are others than hold the robot at these postures,
        whatever its load; 0 where they fit, or tell nothing of the posture.
    """

    robot: Robot
    modes: tuple[HeldMode, ...]
    stiffness: Estimate
    damping: float
    payload: Estimate | None
    payload_by: str
    notes: tuple[str, ...]
    unfit: float = 0.0


@takes(robot=Robot)
def identify_robot(
    recordings: Sequence[RobotRecording],
    robot: Robot,
    postures: Sequence[Sequence[float] | None] = (),
    parts: Sequence[tuple[float, float]] = (),
) -> IdentifiedRobot:
    """Identify the springs, the damping and the load of a robot by ring-downs with held joints.

    The frequencies tell all springs by one multiple; the load as well where several modes or
    postures tell it from the springs, or else where the torques of the joints at rest do.

    Parameters
    ----------
    recordings : sequence of RobotRecording
        Torques of the joints, or the tip's acceleration or displacement.
    robot : Robot
        As its file has it. What was measured of it before is not used.
    postures : sequence of (sequence of float or None), optional
        Positions of the driven joints [rad or m] in each recording; None where they are recorded.
    parts : sequence of (float, float), optional
        Begin and end [s] of each ring-down, in every recording; found by default.

    Raises
    ------
    ValueError
        When nothing rings down, no posture is known, or frequencies contradict the robot.
    """
    checked = several("recordings", recordings, "recordings, as [RobotRecording(time, ...)]")
    if not checked:
        raise ValueError("no recording is given; give one")
    for recording in checked:
        instance("a recording", recording, RobotRecording)
    places = _postures(postures, len(checked))
    before = replace(robot, measured=None)
    ring_downs = [
        ring_down
        for recording, posture in zip(checked, places)
        for ring_down in read_ring_downs(before, recording, posture, parts)
    ]
    swings = _of_one_posture([swing for one in ring_downs for swing in one.swings])
    notes = [note for recording in checked for note in recording.notes]
    notes += [note for one in ring_downs for note in one.notes]
    if robot.measured is not None:
        notes.append("what the robot's file has as measured is not used: it is measured anew")
    return _identified(before, swings, ring_downs, notes)


def _postures(postures: Sequence[Any], count: int) -> list[Any]:
    """A posture of each recording: one counts for all."""
    given = list(postures)
    if len(given) == 1:
        return given * count
    if given and len(given) != count:
        raise ValueError(
            f"{len(given)} postures are given for {count} recordings; give one of each"
        )
    return given or [None] * count


def _of_one_posture(swings: Sequence[HeldSwing]) -> list[HeldSwing]:
    """The swings, each with the posture of the first that is the same within what flickers."""
    known = list[tuple[float, ...]]()
    same = list[HeldSwing]()
    for swing in swings:
        near = [one for one in known if np.allclose(one, swing.posture, rtol=0, atol=_SAME_POSTURE)]
        if not near:
            known.append(swing.posture)
        same.append(replace(swing, posture=near[0] if near else swing.posture))
    return same


def _identified(
    before: Robot,
    swings: Sequence[HeldSwing],
    ring_downs: Sequence[RingDown],
    notes: Sequence[str],
) -> IdentifiedRobot:
    groups = dict[tuple[tuple[float, ...], int], list[HeldSwing]]()
    for swing in swings:
        groups.setdefault((swing.posture, swing.mode), []).append(swing)
    order = sorted(groups, key=lambda one: [swing.posture for swing in swings].index(one[0]))
    told = [_mode(*key, groups[key]) for key in sorted(order, key=lambda one: (one[0], one[1]))]
    measured = tuple(map(_measured, told))
    damped = any(before.dynamics.mechanism.damping > 0)
    if not damped:
        measured = tuple(replace(one, damping=None) for one in measured)
        notes = [*notes, "the robot's file has no damping that could be scaled: give some"]
    scaled = replace(before, measured=measured)
    assert scaled.fit is not None
    robot, stiffness, payload, why = _with_load(scaled, scaled.fit, ring_downs)
    fit = robot.fit
    assert fit is not None
    held = _held(ring_downs)
    return IdentifiedRobot(
        robot=robot,
        modes=tuple(replace(one, misfit=misfit) for one, misfit in zip(told, fit.misfits)),
        stiffness=stiffness,
        damping=scaled.fit.damping,
        payload=payload,
        payload_by=why,
        notes=tuple(dict.fromkeys(notes)),
        unfit=unfit_share(robot, held) if held else 0.0,
    )


class _LoadedRobot(NamedTuple):
    """A robot with its load, the multiple of its springs, and by what the load is known."""

    robot: Robot
    stiffness: Estimate
    payload: Estimate | None
    why: str


def _with_load(robot: Robot, fit: MeasuredFit, ring_downs: Sequence[RingDown]) -> _LoadedRobot:
    """Return a robot, scaled to its frequencies, with the load that these or the torques tell."""
    unsure, share = fit.unsure
    if fit.tells_payload:
        mass = robot.payload
        stiffness = _estimate("stiffness", fit.stiffness, unsure * fit.stiffness)
        payload = _estimate("payload", mass, share * mass)
        return _LoadedRobot(_carrying(robot, mass), stiffness, payload, BY_FREQUENCIES)
    by_torques, why = _by_torques(robot, ring_downs)
    if by_torques is None:
        stiffness = _estimate("stiffness", fit.stiffness, unsure * fit.stiffness)
        return _LoadedRobot(robot, stiffness, None, why)
    loaded = _carrying(robot, by_torques.value)
    heavier = _carrying(robot, by_torques.high)
    assert loaded.fit is not None
    assert heavier.fit is not None
    factor = loaded.fit.stiffness
    unsure = float(np.hypot(unsure, heavier.fit.stiffness / factor - 1))
    return _LoadedRobot(loaded, _estimate("stiffness", factor, unsure * factor), by_torques, why)


def _carrying(robot: Robot, mass: float) -> Robot:
    """The robot with another mass at the end of its beam."""
    assert robot.beam is not None
    return replace(robot, beam=replace(robot.beam, tip_mass=mass))


def _by_torques(robot: Robot, ring_downs: Sequence[RingDown]) -> tuple[Estimate | None, str]:
    """The load by what holds the joints, or why that does not tell it."""
    if not robot.stated_payload:
        return None, (
            "the robot's file has no load: to seek one, give the beam a tip_mass, such as 0.1kg"
        )
    held = _held(ring_downs)
    if not held:
        return None, (
            "these frequencies do not tell it from the springs; record the torques of the joints, "
            "or a faster mode"
        )
    mass, deviation, why = load_at_rest(robot, held)
    if why or not 2 * deviation < mass:
        why = why or "the torques at rest tell it no better than within its own size"
        return None, f"these frequencies do not tell it from the springs, and {why}"
    return _estimate("payload", mass, 2 * deviation), BY_TORQUES


def _held(ring_downs: Sequence[RingDown]) -> list[tuple[tuple[float, ...], Array]]:
    """Postures, and the torques at rest there where they were recorded."""
    return [(one.posture, one.torques) for one in ring_downs if one.torques is not None]


def _estimate(name: str, value: float, half: float) -> Estimate:
    return Estimate(name, value, value - half, value + half)


def _mode(posture: tuple[float, ...], mode: int, swings: Sequence[HeldSwing]) -> HeldMode:
    """The mean of all ring-downs that show a mode at a posture, with its interval."""
    recordings = tuple(dict.fromkeys(swing.recording for swing in swings))

    def groups(value: str, deviation: str) -> list[Group]:
        return [
            Group(
                np.array([getattr(s, value) for s in swings if s.recording == name]),
                np.array([getattr(s, deviation) for s in swings if s.recording == name]) ** 2,
            )
            for name in recordings
        ]

    return HeldMode(
        posture=posture,
        mode=mode,
        frequency=estimate("frequency", groups("frequency", "of_frequency")),
        damping=estimate("damping", groups("damping", "of_damping")),
        misfit=0.0,
        recordings=recordings,
    )


def _measured(told: HeldMode) -> Measured:
    """An entry of the robot's file; its damping where that is known at all."""
    frequency, damping = told.frequency, told.damping
    half = (frequency.high - frequency.low) / 2 / frequency.value
    is_known = damping.low > 0 and told.mode <= _DAMPED_MODES
    return Measured(
        frequency=tau * frequency.value,
        at=told.posture,
        mode=told.mode,
        damping=damping.value if is_known else None,
        within=max(half, _LEAST_WITHIN),
    )
