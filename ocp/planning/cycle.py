"""A move there and back, again and again: effort and energy of a cycle, and what builds up.

The modes are affine in their amplitudes, so that a move takes the state before it to the state
after it by a matrix and a column: two integrations a mode give both, and many cycles are algebra.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.models.joint_motion import MIXED
from quietarm.ocp.checks import finite, not_negative, quoted, whole
from quietarm.ocp.energy import CopperLoss
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.simulation.free_vibration import fastest_along, vibration_of
from quietarm.ocp.simulation.on_drive import run_on_drive, steps_a_second, tip_places
from quietarm.ocp.simulation.servo import Servo, as_held
from quietarm.ocp.simulation.set_points import SetPoints
from quietarm.ocp.task import ModalState, PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
MOST_CYCLES = 100_000
_STEPS = 4000
"""Least steps in a second of cycles on a drive."""
_MOST_STEPS = 200_000
"""Of cycles on a drive: they take some seconds."""
_USUAL_ERROR = {"frequency": 0.05}
"""Errors of a task that has none, at which it is shown what builds up."""


@dataclass(frozen=True)
class Shuttle:
    """There and back, again and again, with a dwell after each move.

    Parameters
    ----------
    dwell : float
        Time between arrival and the next start [s].
    repeat : int
        How many cycles, each of a move there and a move back.

    Raises
    ------
    ValueError
        When the dwell is negative, or there are no cycles or too many.
    """

    example: ClassVar[str] = "cycles, such as Shuttle(dwell=0.3, repeat=12)"

    dwell: float = 0.0
    repeat: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "dwell", not_negative("dwell", self.dwell, "s"))
        object.__setattr__(self, "repeat", whole("repeat", self.repeat, 1, MOST_CYCLES))


@dataclass(frozen=True, eq=False, repr=False)
class Cycle:
    """Cycles of a motion, and what they take and leave.

    Figures of effort and energy are those of one cycle from rest without errors; `left` follows the
    errors. Back the joint takes the same profile from the target to the start.

    Attributes
    ----------
    there : JudgedMotion
        The move; the way back follows from it.
    shuttle : Shuttle
        The dwell, and how many cycles.
    errors : mapping of str to float
        Relative errors of the plant's parameters.
    """

    there: JudgedMotion
    shuttle: Shuttle
    errors: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.errors, Mapping):
            raise TypeError(
                f"errors are {quoted(self.errors)}; give them by name, such as {{'frequency': 0.1}}"
            )
        known = {name: finite(f"error of {name}", size) for name, size in self.errors.items()}
        object.__setattr__(self, "errors", known)
        perturb_plant(self.there.task.plant, known)  # refuses what the plant does not have

    def __repr__(self) -> str:
        return (
            f"Cycle(time={self.time:.4g} s, energy={self.energy:.4g} J, "
            f"rms_torque={self.rms_torque:.4g}, left={self.left.max():.3g})"
        )

    @property
    def time(self) -> float:
        """Duration of a cycle [s]."""
        return 2 * (self.there.task.duration + self.shuttle.dwell)

    @cached_property
    def legs(self) -> tuple[JudgedMotion, JudgedMotion]:
        """The move there and the move back, from rest."""
        return self.there, _along(self.there, _returning(self.there.task))

    @property
    def motor_constant(self) -> float | None:
        """Motor constant of the drive, or of the task's copper loss [N m/W^0.5]; or None."""
        task = self.there.task
        if task.plant.drive is not None and task.plant.drive.motor_constant is not None:
            return task.plant.drive.motor_constant
        return task.energy.motor_constant if isinstance(task.energy, CopperLoss) else None

    @cached_property
    def rms_torques(self) -> tuple[float, ...]:
        """Root mean square of each joint's torque over a cycle, with the dwells [N m]."""
        squares = sum((np.array(leg.moving.torques) ** 2 @ leg.weights for leg in self.legs), 0.0)
        holding = sum(self.shuttle.dwell * np.array(self._held(leg)) ** 2 for leg in self.legs)
        return tuple(np.sqrt((squares + holding) / self.time).tolist())

    @property
    def rms_torque(self) -> float:
        """The largest of the joints' [N m]; no number where joints turn and slide."""
        mixed = self.there.task.plant.joint == MIXED
        return float("nan") if mixed else max(self.rms_torques)

    @staticmethod
    def _held(leg: JudgedMotion) -> list[float]:
        """Torques that hold the joints where a move ends [N m]."""
        return [float(torque[-1]) for torque in leg.sample([leg.task.duration]).sample.torques]

    @property
    def heat(self) -> float | None:
        """Copper loss of a cycle [J]; None where the motor constant is unknown."""
        constant = self.motor_constant
        if constant is None:
            return None
        return sum(torque**2 for torque in self.rms_torques) * self.time / constant**2

    @property
    def energy(self) -> float:
        """Energy of a cycle [J] where the DC link burns what the motor generates."""
        return sum(float(np.maximum(self._power(leg), 0.0) @ leg.weights) for leg in self.legs) + (
            self._heat_of_dwells
        )

    @property
    def energy_with_recovery(self) -> float:
        """Energy of a cycle [J] where the DC link gives back what the motor generates."""
        return sum(float(self._power(leg) @ leg.weights) for leg in self.legs) + (
            self._heat_of_dwells
        )

    @property
    def _heat_of_dwells(self) -> float:
        constant = self.motor_constant
        if constant is None:
            return 0.0
        held = sum(float((np.array(self._held(leg)) ** 2).sum()) for leg in self.legs)
        return self.shuttle.dwell * held / constant**2

    def _power(self, leg: JudgedMotion) -> Array:
        """Electrical power over the samples [W]: mechanical, and copper loss where it is known."""
        power = np.array(leg.moving.power)
        constant = self.motor_constant
        if constant is None:
            return power
        return power + (np.array(leg.moving.torques) ** 2).sum(axis=0) / constant**2

    @property
    def stated(self) -> dict[str, float]:
        """The figures that a plan's file states, by name."""
        figures = {
            "time": self.time,
            "rms_torque": self.rms_torque,
            "heat": self.heat,
            "energy": self.energy,
            "energy_with_recovery": self.energy_with_recovery,
            "left_after_first": float(self.left[0]),
            "left_after_last": float(self.left[-1]),
            "left_at_most": float(self.left.max()),
        }
        return {
            name: figure
            for name, figure in figures.items()
            if figure is not None and np.isfinite(figure)
        }

    @cached_property
    def left(self) -> Array:
        """Largest vibration after each move [m], within the residual window, without the next."""
        return self._builds_up(self.errors)

    def on_drive(self) -> Array | None:
        """Return the largest distance of a tip after each move [m], by a simulation of the drive.

        It is that within the dwell; after the last move within the residual window. None where no
        drive is stated whose loops are known, without a dwell, and of cycles that last too long.
        """
        drive = self.there.task.plant.drive
        task = self.there.task
        window = task.residual_window
        seconds = self.shuttle.repeat * self.time + window
        if drive is None or not drive.has_loops or not self.shuttle.dwell:
            return None
        servo = Servo(perturb_plant(as_held(task.plant, task.target), self.errors), task.start)
        fastest = fastest_along(task.plant, task.start, task.target)
        if seconds * steps_a_second(servo, fastest, _STEPS) > _MOST_STEPS:
            return None
        points = self._set_points()
        run = run_on_drive(servo, points, window, fastest, task.initial_state, _STEPS)
        length = task.duration + self.shuttle.dwell
        left = list[float]()
        for number in range(2 * self.shuttle.repeat):
            arrival = number * length + task.duration
            end = arrival + self.shuttle.dwell
            if number == 2 * self.shuttle.repeat - 1:
                end = arrival + window
            inside = (run.time >= arrival) & (run.time < end)
            target = self.legs[number % 2].task.target
            left.append(float(np.abs(tip_places(servo, run, target)[:, inside]).max()))
        return np.array(left)

    def _set_points(self) -> SetPoints:
        """Set points of all moves in turn; a dwell that is shorter than the servo takes cuts."""
        rate = 1000.0
        length = self.there.task.duration + self.shuttle.dwell
        rows = list[Array]()
        for number in range(2 * self.shuttle.repeat):
            points = self._rows_of_legs[number % 2]
            times = np.arange(0.0, length - 1e-9, 1 / rate)
            rows.append(np.vstack([times + number * length, points.at(times)]))
        return SetPoints(*np.hstack(rows))

    @cached_property
    def _rows_of_legs(self) -> tuple[SetPoints, SetPoints]:
        there, back = (leg.set_points(1000.0) for leg in self.legs)
        return there, back

    def with_errors(self, errors: Mapping[str, float]) -> Cycle:
        """Return these cycles on the plant with these relative errors."""
        return replace(self, errors=dict(errors))

    def worst(self) -> Cycle:
        """The cycles at the errors, of the task's corners, that leave most after some move.

        A task without errors has those of 5 % in frequency.
        """
        task = self.there.task
        named = [dict(zip(task.error_names, errors)) for errors in task.scenarios[1:]]
        if not named:
            named = [{name: sign * s for name, s in _USUAL_ERROR.items()} for sign in (-1, 1)]
        candidates = [self.with_errors(errors) for errors in named]
        return max(candidates, key=lambda cycle: float(cycle.left.max()))

    def _builds_up(self, errors: Mapping[str, float]) -> Array:
        """Peaks after each move, from the state that the moves before it leave."""
        there, back = (_LegMap(leg, errors) for leg in self.legs)
        state = np.array(there.leg.task.initial_state)
        peaks = list[float]()
        for leg in (there, back) * self.shuttle.repeat:
            state = leg.after(state)
            peaks.append(float(leg.vibration.peak(state)))
            (state,) = leg.vibration.states(state, [self.shuttle.dwell])
        return np.array(peaks)


class _LegMap:
    """A move as a map of the modes' state before it to that after it."""

    def __init__(self, leg: JudgedMotion, errors: Mapping[str, float]) -> None:
        self.leg = leg
        task = leg.task
        plant = perturb_plant(task.plant, errors)
        self.vibration = vibration_of(plant, task.target, task.residual_window)
        count = 2 * task.plant.modes
        # far enough from rest that rounding is nothing, near enough that all is finite
        size = 1e-3
        starts = [np.zeros(count), *(size * np.eye(count))]
        ends = [self._integrated(start, errors) for start in starts]
        self._forced = ends[0]
        self._matrix = np.column_stack([(end - ends[0]) / size for end in ends[1:]])

    def _integrated(self, start: Array, errors: Mapping[str, float]) -> Array:
        amplitudes, rates = np.split(start, 2)
        state = ModalState(tuple(amplitudes.tolist()), tuple(rates.tolist()))
        moved = _along(self.leg, replace(self.leg.task.certain, initial=state, final=None))
        return moved.perturbed(errors).arrival[0]

    def after(self, state: Array) -> Array:
        """The state on arrival by that at the start."""
        return self._matrix @ state + self._forced


def _returning(task: PointToPoint) -> PointToPoint:
    """The task of the way back, from rest."""
    return replace(task, start=task.target, target=task.start, initial=None, final=None)


def _along(motion: JudgedMotion, task: PointToPoint) -> JudgedMotion:
    """Another task of the same duration by a motion's profile and coefficients."""
    assert motion.profile is not None
    return JudgedMotion.of_profile(task, motion.profile, motion.coefficients)
