"""Learn a robot's springs, and its swing at arrival, from recordings of moves along its path.

The springs first, all by one multiple, where the frequencies of the swing differ from the plan's;
what the robot lacks, such as a gear or a base that gives, is left to the state at arrival. Moves
of a robot that are repeated differ: by so much no plan leaves less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import Estimate, Identified
from quietarm.machine.learn.evidence import Evidence, history_with
from quietarm.machine.learn.reading.find_start import Start
from quietarm.machine.learn.refusals.check_clock import check_clock
from quietarm.machine.learn.refusals.check_columns import refuse_constant
from quietarm.machine.learn.robots.check_signals import check_signals
from quietarm.machine.learn.robots.joint_torques import SeenModes
from quietarm.machine.learn.robots.robot_start import find_robot_start
from quietarm.machine.learn.robots.robot_swing import (
    LEAST_PERIODS,
    SETTLES,
    RobotSwing,
    check_length,
    mode_name,
    read_robot_swing,
)
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models import Plant
from quietarm.models.robot import Measured, Robot, RobotOnPath
from quietarm.models.robot.dynamics.measured_fit import damping_ratios
from quietarm.ocp.checks import instance, not_negative, several
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.executed import MoveHistory
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.record import versions

Array = NDArray[np.float64]
STIFFNESS = "stiffness"
_DIFFER = 0.018
"""By what repeated moves of a robot differ, as a share of the swing that a plain move leaves: 69
published moves of a Franka with a beam."""
_LEAST_CHANGE = 1e-3
"""Share of a frequency, below which a difference from the plan is left to the arrival state."""
_OF_SMALL_SWINGS = 2e-3
"""Share of a frequency that the largest swing does not tell, and a smaller one as much less."""


@dataclass(frozen=True)
class ReadRobotMove:
    """When a move began in a recording [s], and what swung after it.

    And whether its torques go against the plan's during the move.
    """

    recording: RobotRecording
    start: float
    after: RobotSwing
    doubt: str = ""
    is_turned: bool = False


def robot_evidence(
    plan: Plan, recordings: Sequence[Any], delay: float | None
) -> tuple[RobotEvidence, list[ReadRobotMove], list[str]]:
    """Return what the moves of a robot's plan tell, how they were read, and remarks on them.

    Parameters
    ----------
    plan : Plan
        That was executed, of a plant along a path.
    recordings : sequence of RobotRecording
        Of it.
    delay : float, optional
        By how much what swings was recorded late [s], as by an estimator's filter.
    """
    if delay is not None:
        delay = not_negative("delay", delay, "s")
    checked = _checked(plan, recordings)
    plant = plan.task.plant
    read = [_read(plan, plant, recording, delay) for recording in checked]
    evidence = _evidence(plan, read)
    if evidence.changed:  # once more: springs that are right tell the start and the swing better
        read = [_read(plan, evidence.plant, recording, delay) for recording in checked]
        evidence = _evidence(plan, read)
    notes = [note for recording in checked for note in recording.notes]
    return evidence, read, [*notes, *evidence.remarks]


def _evidence(plan: Plan, read: Sequence[ReadRobotMove]) -> RobotEvidence:
    return RobotEvidence(plan, history_with(plan, [one.after.measured for one in read]), read)


def _read(
    plan: Plan, plant: Plant, recording: RobotRecording, delay: float | None
) -> ReadRobotMove:
    """The start and the swing of one recording, by the modes of a plant."""
    fastest = SeenModes(plant, plan.task.target, recording.swinging[0]).frequencies[-1]
    check_clock(recording.name, recording.time, plan.task.duration, float(fastest))
    if recording.positions is None and plant == plan.task.plant:
        plant = _as_it_ends(plan, recording)  # by springs that are wrong the start is, too
    modes = SeenModes(plant, plan.task.target, recording.swinging[0])
    start = find_robot_start(plan, recording, plant)
    is_turned = check_signals(plan, recording, start.time)
    arrival = start.time + plan.task.duration
    check_length(recording, arrival, modes)
    late = (delay or 0.0) if start.signal == "positions" else 0.0
    after = read_robot_swing(recording, arrival, modes, late, start.deviation)
    doubt = _doubt(recording, start, delay)
    return ReadRobotMove(recording, start.time, after, doubt, is_turned)


def _as_it_ends(plan: Plan, recording: RobotRecording) -> Plant:
    """The robot with the frequency by which a recording ends, wherever its move begins."""
    plant = plan.task.plant
    modes = SeenModes(plant, plan.task.target, recording.swinging[0])
    at_least = SETTLES + LEAST_PERIODS / float(modes.frequencies[0])
    begin = float(recording.time[-1]) - at_least
    if begin <= recording.time[0] or not isinstance(plant, RobotOnPath):
        return plant
    told = read_robot_swing(recording, begin, modes, 0.0, 0.0).measured
    shares = [
        told.values[mode_name(k)] / frequency
        for k, frequency in enumerate(modes.frequencies.tolist())
        if mode_name(k) in told.values
    ]
    if not shares or abs(np.mean(shares) - 1) < _LEAST_CHANGE:
        return plant
    return _with_frequency(plan, float(np.mean(shares)))


def refuse_delay(delay: float | None) -> None:
    """ValueError where a delay is given for a plant without a path."""
    if delay is not None:
        raise ValueError(
            "delay is that of a robot's joint torques, and the plan moves one joint; leave it out"
        )


def _checked(plan: Plan, recordings: Any) -> list[RobotRecording]:
    """The recordings of a robot, with as many columns as it has joints, or its tip axes."""
    plant = plan.task.plant
    checked = several("recordings", recordings, "recordings, such as [RobotRecording(time, ...)]")
    if not checked:
        raise ValueError("no recording is given; give one")
    for recording in checked:
        instance("a recording", recording, RobotRecording)
        wanted = {
            "torques": ("joints", len(plant.joint_names), plant.joint_names),
            "positions": ("joints", len(plant.joint_names), plant.joint_names),
            "acceleration": ("axes of its tip", plant.tips, plant.tip_names),
        }
        for name, (words, count, names) in wanted.items():
            values = getattr(recording, name)
            if values is not None and values.shape[1] != count:
                raise ValueError(
                    f"{recording.name} has {values.shape[1]} columns of {name}, and {plant.name} "
                    f"{count} {words}, {', '.join(names)}; give one of each, in this order"
                )
        if recording.swinging[0] == "tip":
            raise ValueError(
                f"{recording.name} has no torques and no acceleration, by which moves are learned; "
                "give one"
            )
        refuse_constant(recording.name, {name: getattr(recording, name) for name in wanted})
    return checked


def _doubt(recording: RobotRecording, start: Start, delay: float | None) -> str:
    """That a filter's lag is not known, or plays no part; empty where it is known."""
    if recording.swinging[0] == "acceleration":
        return ""
    if start.signal != "positions":
        return (
            f"{recording.name}: the start is found by the torques, to {1e3 * start.deviation:.1g} "
            "ms, and as late as they are; with the positions of the joints it is exact"
        )
    if delay is None:
        return (
            f"{recording.name}: by how much its torques are filtered late is not known, and is "
            "taken as 0; state it by --delay, if the controller's manual does"
        )
    return ""


class RobotEvidence(Evidence):
    """Evidence that all moves of a robot together give.

    Parameters
    ----------
    plan : Plan
        That was executed last.
    history : MoveHistory
        All moves, the last one with it.
    read : sequence of ReadRobotMove
        What was read of the last one.
    """

    def __init__(self, plan: Plan, history: MoveHistory, read: Sequence[ReadRobotMove]) -> None:
        self._moves = read
        self._before = TipModes(plan.task.plant, plan.task.target)
        super().__init__(plan, history, ())

    @property
    def by_joint(self) -> bool:
        """False: the swing is read after arrival."""
        return False

    @property
    def beyond(self) -> float:
        """Ringing of the tip beside its modes, where that is seen [m]."""
        return max(one.after.other for one in self._moves)

    @property
    def settling(self) -> float:
        """0: a robot's arm rings while it settles, which `beyond` has."""
        return 0.0

    # The springs

    @cached_property
    def frequencies(  # pyright: ignore[reportIncompatibleMethodOverride]
        self,
    ) -> dict[str, tuple[float, float]]:
        """Frequencies of every mode that moves told [Hz]: the plan's, and the moves' mean."""
        told = dict[str, tuple[float, float]]()
        for number, model in enumerate(self._before.frequencies):
            values, deviations = self._told_of(number)
            if len(values):
                weights = deviations**-2.0
                mean = float((weights * np.log(values)).sum() / weights.sum())
                told[mode_name(number)] = (float(model), float(np.exp(mean)))
        return told

    def _told_of(self, number: int) -> tuple[Array, Array]:
        """Frequencies of a mode by each recording [Hz], and their deviations as a share."""
        name = mode_name(number)
        values, deviations = list[float](), list[float]()
        for move in self.history.moves:
            for one in move.measured:
                if name not in one.values:
                    continue
                smaller = self._largest / max(one.swings[number].amplitude, 1e-300)
                values.append(one.values[name])
                share = one.deviations[name] / one.values[name]
                deviations.append(float(np.hypot(share, _OF_SMALL_SWINGS * smaller)))
        return np.array(values), np.array(deviations)

    @cached_property
    def _largest(self) -> float:
        """The largest swing of one mode that was recorded."""
        swings = [s for move in self.history.moves for one in move.measured for s in one.swings]
        return max(swing.amplitude for swing in swings)

    @cached_property
    def _faster(self) -> tuple[float, float]:
        """By what share the springs make the robot faster than the plan's, and its deviation."""
        shares, deviations = [np.zeros(0)], [np.zeros(0)]
        for number, model in enumerate(self._before.frequencies):
            values, of_values = self._told_of(number)
            shares.append(np.log(values / model))
            deviations.append(of_values)
        told, unsure = np.concatenate(shares), np.concatenate(deviations)
        if not len(told):
            return 0.0, np.inf
        weights = unsure**-2.0
        mean = float((weights * told).sum() / weights.sum())
        return float(np.expm1(mean)), float(weights.sum() ** -0.5)

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """The multiple of the stiffness of all springs."""
        share, deviation = self._faster
        if not isinstance(self._plan.task.plant, RobotOnPath) or not np.isfinite(deviation):
            return ()
        low, high = share - 2 * deviation, share + 2 * deviation
        return (Estimate(STIFFNESS, *((1 + f) ** 2 for f in (share, low, high))),)

    @cached_property
    def _as_it_swings(self) -> Plant | None:
        """The robot with springs as its frequencies tell; None where these are the plan's."""
        if not self.estimates:
            return None
        (estimate,) = self.estimates
        share, _ = self._faster
        if estimate.low <= 1 <= estimate.high or abs(share) < _LEAST_CHANGE:
            return None
        return _with_frequency(self._plan, 1 + share)

    @cached_property
    def changed(self) -> dict[str, tuple[float, float]]:
        """The stiffness of the plan's springs, 1, and how many times that the robot has.

        Where less of the last move is left to explain with it than without.
        """
        other = self._as_it_swings
        if other is None:
            return {}
        plants = (self._plan.task.plant, other)
        rest = [float(np.abs(self._left[-1] - self._told_by(plant)[-1]).sum()) for plant in plants]
        return {STIFFNESS: (1.0, self.estimates[0].value)} if rest[1] < rest[0] else {}

    @cached_property
    def plant(self) -> Plant:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The robot with the springs that it has."""
        other = self._as_it_swings
        return other if self.changed and other is not None else self._plan.task.plant

    def machine(self) -> Identified:
        """The robot with what was learned."""
        return Identified(self.plant, self.estimates, {}, (), {}, (), versions())

    def seen_share(  # pyright: ignore[reportIncompatibleVariableOverride]
        self, plant: Plant
    ) -> float | None:
        """None: how far the tip swings during the move is not seen."""
        return None

    @cached_property
    def step(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Share of the correction that is worth making, by the modes whose swing is seen."""
        if self.is_as_allowed:
            return 0.0
        left = np.abs(self._again)
        single = self._of_one[-1]
        if self._scatter is not None:
            single = np.hypot(single, self._scatter)
        seen = left > 2 * single
        if not self.changed and not seen.any():
            return 0.0
        unsure = np.array([m.deviation_of(t) for m, t in zip(self.maps, self._told[-1])])
        power = float((left[seen] ** 2).sum())
        return power / (power + 2 * float((unsure[seen] ** 2).sum())) if seen.any() else 1.0

    # How far the tip swings: its modes move it in several directions

    def _reach(self, amplitudes: NDArray[np.complex128]) -> float:
        """Return how far the tip gets from where it rests by swings of all modes [m]."""
        seconds = 4 / float(self.modes.frequencies[0])
        times = np.linspace(0, seconds, 800)
        swings: NDArray[np.complex128] = np.exp(np.outer(self.modes.values, times))
        tips = (self.modes.tips * amplitudes) @ swings
        return float(np.linalg.norm(tips.real, axis=0).max())

    @property
    def left(self) -> float:
        """Swing of the tip after the last move: the mean of its recordings."""
        return float(np.mean([self._reach(swings) for swings in self._swings[-1]]))

    @property
    def by_frequency(self) -> float:
        """Swing of the tip that follows from what the springs change."""
        return self._reach(self._frequency_share)

    @property
    def repeatable(self) -> float:
        """Swing of the tip beside what the springs change, and beside what was wanted."""
        return self._reach(self._left[-1] - self._frequency_share - self._wanted)

    # Moves that differ

    @cached_property
    def _scatter(self) -> Array | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Difference of moves by mode: as recordings of one tell, or as robots usually have."""
        return super()._scatter if self.is_repeated else self._usual_scatter

    @property
    def is_repeated(self) -> bool:
        """Return whether a move was recorded several times."""
        return any(len(move.measured) > 1 for move in self.history.moves)

    @cached_property
    def unsuppressed(self) -> float:
        """The swing that a plain move leaves in the same time along the same path [m]."""
        task = replace(self._plan.task.certain, plant=self.plant, final=None)
        return JudgedMotion.of_profile(task, CycloidPolynomial(0), ()).residual

    @property
    def _usual_scatter(self) -> Array:
        """Usual difference of robots' moves, shared by how each mode swings; halved, as parts."""
        swings = np.abs(self._left[-1])
        shares = swings / max(float(swings.sum()), 1e-300)
        usual: Array = shares * _DIFFER * self.unsuppressed / 2
        return usual

    @property
    def scatter(self) -> float | None:
        """Standard deviation of what is left, where a move was recorded several times."""
        return super().scatter if self.is_repeated else None

    @property
    def remarks(self) -> list[str]:
        """Remarks on springs, signs and moves that differ."""
        remarks = list[str]()
        if not self.is_repeated:
            remarks.append(
                f"moves of robots differ by {100 * _DIFFER:g} % of the swing that a plain move "
                f"leaves, here {1e3 * _DIFFER * self.unsuppressed:.2g} mm: that is taken as the "
                "floor; record the move several times to know it"
            )
        turned = self._turned
        if turned:
            remarks.append(turned)
        if self.changed and isinstance(self.plant, RobotOnPath):
            (measured,) = self.plant.robot.measurements  # by it the springs are scaled
            places = ", ".join(f"{place:.5g}" for place in measured.at)
            hertz = measured.frequency / (2 * np.pi)
            ratio = "" if measured.damping is None else f", damping: {measured.damping:.3g}"
            remarks.append(
                "for other moves, in the robot's file: measured: "
                f"{{frequency: {hertz:.4g}Hz, at: [{places}]{ratio}}}{self._load_told}"
            )
        return remarks

    @property
    def _load_told(self) -> str:
        """Words on the load of a robot whose measured frequencies told another than its file's."""
        plant = self._plan.task.plant
        assert isinstance(plant, RobotOnPath)
        robot = plant.robot
        if robot.payload == robot.stated_payload:
            return ""
        return f", and tip_mass: {robot.payload:.4g} of the beam"

    @property
    def _turned(self) -> str:
        """That torques go against the plan's, in the move or after it; empty where they do not."""
        told = self._told_by(self._as_it_swings or self.plant)[-1]
        left = self._left[-1]
        product = complex((told.conj() * left).sum())
        power = float((np.abs(told) * np.abs(left)).sum())
        large = 0.3  # share of what the plain move leaves, from which on a swing has a sign
        is_large = float(np.abs(told).sum()) >= large * self.unsuppressed
        swings_against = is_large and product.real <= -0.7 * power
        if not swings_against and not any(one.is_turned for one in self._moves):
            return ""
        return (
            "warning: the torques go against the plan's: those that act on the robot from "
            "outside, such as tau_ext, have the other sign; give it by --scale torque=-1"
        )


def _with_frequency(plan: Plan, factor: float) -> Plant:
    """The plant of a plan with all springs such that its frequencies are so many times as high.

    Its robot's springs are scaled, so that no multiple is beyond its tables.
    """
    plant: Any = plan.task.plant
    robot: Robot = plant.robot
    place = tuple(plant.path(plan.task.target).tolist())
    before = float(robot.frequencies(place)[0]) * plant.stiffness**0.5
    measured = Measured(before * factor, place, damping=_damping_told(robot, place))
    if robot.beam is not None and robot.payload != robot.stated_payload:
        robot = replace(robot, beam=replace(robot.beam, tip_mass=robot.payload))
    return replace(plant, robot=replace(robot, measured=measured), stiffness=1.0)


def _damping_told(robot: Robot, place: tuple[float, ...]) -> float | None:
    """Damping ratio of the first mode, where measurements told the robot's."""
    if all(one.damping is None for one in robot.measurements):
        return None
    return float(damping_ratios(robot.dynamics, np.array(place))[0])
