"""A plant on its drive: equations of servo, transmission and structure, and set points by them.

The motor is moved by a P position loop around a PI speed loop, with feed-forward. Belt or gear is
a spring between motor and load. A plant's own equations are used as they are: the torque is affine
in the joint's acceleration, so that they are solved for it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.models.drive import Drive
from quietarm.models.validation import eigenvalues_at_rest
from quietarm.ocp.errors import QuietarmError
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
_BELT_DAMPING = 0.05
"""Damping ratio of motor against load on a belt or gear, which few users know."""
STIFFEST = 2 * math.pi * 2000
"""A belt or gear on which motor and load swing faster [rad/s] counts as rigid."""


class Mode(NamedTuple):
    """A mode: angular frequency [rad/s] and damping ratio."""

    frequency: float
    damping: float


def driven_by(plant: Plant) -> Drive:
    """Return the plant's drive; ValueError where it has none, or one that cannot be simulated."""
    drive = plant.drive
    if drive is None or not drive.has_loops:
        raise ValueError(
            f"{plant.name} has no drive whose position_loop and speed_loop are known; give both"
        )
    return drive


@dataclass(frozen=True)
class Servo:
    """A plant with its drive, in numbers: what is unknown of a drive has its assumed value.

    Attributes
    ----------
    plant : Plant
        The structure, with its joint held.
    place : float
        Joint angle about which inertias are taken [rad].
    """

    plant: Plant
    place: float

    @property
    def drive(self) -> Drive:
        """The drive, whose loops are known."""
        return driven_by(self.plant)

    @property
    def inertia(self) -> float:
        """Inertia of all that moves [kg m^2], by which the servo is tuned."""
        still = [0.0] * self.plant.modes
        return self._torque(1.0, still) - self.holding

    @property
    def holding(self) -> float:
        """Torque that holds the joint at rest [N m]."""
        return self._torque(0.0, [0.0] * self.plant.modes)

    def _torque(self, acceleration: float, rates: list[float]) -> float:
        still = [0.0] * self.plant.modes
        path = JointMotion(self.place, 0.0, acceleration)
        return float(self.plant.torque(path, still, still, rates))

    @property
    def _accelerated(self) -> float:
        """Inertia that a sudden acceleration feels [kg m^2]: the structure swings freely."""
        still = [0.0] * self.plant.modes
        path = JointMotion(self.place, 0.0, 1.0)
        pushed = [float(rate) for rate in self.plant.modal_accelerations(path, still, still)]
        return self._torque(1.0, pushed) - self.holding

    @property
    def rotor(self) -> float:
        """Inertia before belt or gear [kg m^2]; 0 of a drive that is rigid."""
        return (self.drive.rotor or 0.0) if self.is_compliant else 0.0

    @property
    def load_inertia(self) -> float:
        """Inertia after belt or gear that a sudden acceleration feels [kg m^2]."""
        return self._accelerated - self.rotor

    @property
    def is_compliant(self) -> bool:
        """True if motor and load move apart; False if belt or rotor are unknown."""
        drive = self.drive
        if not (drive.compliance and drive.rotor):
            return False
        return self._belt_frequency < STIFFEST

    @property
    def _belt_frequency(self) -> float:
        rotor = self.drive.rotor or 0.0
        compliance = self.drive.compliance or 0.0
        load = self._accelerated - rotor
        return math.sqrt((1 / rotor + 1 / load) / compliance)

    @property
    def compliance(self) -> float:
        """Compliance of belt or gear [rad/(N m)]; 0 where it is rigid or unknown."""
        return (self.drive.compliance or 0.0) if self.is_compliant else 0.0

    @property
    def belt(self) -> tuple[float, float]:
        """Stiffness and damping of belt or gear; both 0 of a rigid one."""
        if not self.is_compliant:
            return 0.0, 0.0
        stiffness = 1 / self.compliance
        damping = 2 * _BELT_DAMPING * stiffness / self._belt_frequency
        return stiffness, damping

    @property
    def fastest(self) -> float:
        """Largest angular frequency of belt and speed loop on what is light [rad/s]."""
        loop = self.gain / (self.rotor or self.load_inertia)
        return max(loop, self._belt_frequency if self.is_compliant else 0.0)

    @property
    def gain(self) -> float:
        """Gain of the speed loop [N m s]: its bandwidth times the inertia."""
        return self.inertia * 2 * math.pi * (self.drive.speed_loop or 0.0)


class Moving(NamedTuple):
    """Symbols of a state of motor, load and modes."""

    motor: ca.SX
    motor_speed: ca.SX
    load: ca.SX
    load_speed: ca.SX
    W: ca.SX
    dW: ca.SX

    @classmethod
    def of(cls, state: ca.SX, servo: Servo) -> Moving:
        """Read a state: motor, a load of its own on a belt, amplitudes and their rates."""
        modes = servo.plant.modes
        motor, speed = state[0], state[1]
        bodies = 4 if servo.is_compliant else 2
        load, load_speed = state[bodies - 2], state[bodies - 1]
        W, dW = ca.vertsplit(state[bodies:], [0, modes, 2 * modes])
        return cls(motor, speed, load, load_speed, W, dW)


def state_size(servo: Servo) -> int:
    """Number of entries of the state of motor, load and modes."""
    return (4 if servo.is_compliant else 2) + 2 * servo.plant.modes


def state_rates(servo: Servo, state: ca.SX, effort: ca.SX, rubbing: ca.SX) -> ca.SX:
    """Time derivative of a state by the motor's effort and the friction of motor and load [N m].

    Friction is the force on the body, against its speed; without a belt both are of one body.
    """
    plant = servo.plant
    now = Moving.of(state, servo)
    W, dW = ca.vertsplit(now.W), ca.vertsplit(now.dW)

    def needed(acceleration: float | ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        path = JointMotion(now.load, now.load_speed, acceleration)
        ddW = [ca.SX(value) for value in plant.modal_accelerations(path, W, dW)]
        return ca.SX(plant.torque(path, W, dW, ddW)), ddW

    held, _ = needed(0.0)
    pushed, _ = needed(1.0)
    stiffness, damping = servo.belt
    if servo.is_compliant:
        pull = stiffness * (now.motor - now.load) + damping * (now.motor_speed - now.load_speed)
        motor = (effort - pull + rubbing[0]) / servo.rotor
        load = (pull + rubbing[1] - held) / (pushed - held - servo.rotor)
        bodies = [now.motor_speed, motor, now.load_speed, load]
    else:
        load = (effort + rubbing[0] + rubbing[1] - held) / (pushed - held)
        bodies = [now.load_speed, load]
    _, ddW = needed(load)
    return ca.vertcat(*bodies, now.dW, *ddW)


class SetPoint(NamedTuple):
    """Set point of a servo at one time: place, speed and acceleration."""

    place: ca.SX
    speed: ca.SX
    acceleration: ca.SX


def servo_law(
    servo: Servo, motor: ca.SX, speed: ca.SX, integral: ca.SX, asked: SetPoint
) -> tuple[ca.SX, ca.SX]:
    """Effort of the motor [N m], and the rate of the speed loop's integral."""
    drive = servo.drive
    forward = drive.feedforward
    error = (drive.position_loop or 0.0) * (asked.place - motor) - speed
    if forward != "none":
        error += asked.speed
    effort = servo.gain * (error + integral)
    if forward == "acceleration":
        effort += servo.inertia * asked.acceleration
    return effort, error / drive.assumed_reset_time


@lru_cache(maxsize=64)
def _modes_on_servo(servo: Servo) -> tuple[complex, ...]:
    """Eigenvalues of structure, transmission and servo, linear about rest, without friction."""
    size = state_size(servo)
    state = ca.SX.sym("state", size)
    integral = ca.SX.sym("integral")
    delayed = ca.SX.sym("delayed")
    now = Moving.of(state, servo)
    here = SetPoint(ca.SX(servo.place), ca.SX(0), ca.SX(0))
    effort, integrating = servo_law(servo, now.motor, now.motor_speed, integral, here)
    dead = servo.drive.dead_time or 0.0
    given, sending = effort, ca.SX(0)
    unknown = ca.vertcat(state, integral)
    if dead:  # as a rational function of the first order, (1 - s dead / 2) / (1 + s dead / 2)
        given = 2 * delayed - effort
        sending = (effort - delayed) * 2 / dead
        unknown = ca.vertcat(unknown, delayed)
    rates = ca.vertcat(state_rates(servo, state, given, ca.SX(2, 1)), integrating, sending)
    rates = rates[: unknown.numel()]
    slopes = Compiled(
        lambda: ca.Function("slopes", [unknown], [ca.densify(ca.jacobian(rates, unknown))])
    )
    rest = np.zeros(unknown.numel())
    rest[0] = rest[2 if servo.is_compliant else 0] = servo.place
    return tuple(np.linalg.eigvals(slopes(rest)[0]).tolist())


def grows(servo: Servo) -> bool:
    """Return whether structure and servo swing ever more, by their linear equations."""
    values = _modes_on_servo(servo)
    rounding = 1e-9 * max(map(abs, values))
    return max(value.real for value in values) > rounding


def held_mode(plant: Plant, place: float) -> Mode:
    """The slowest mode of a plant with its joint held at a place."""
    swinging = [value for value in eigenvalues_at_rest(plant, place) if value.imag > 0]
    return _mode(min(swinging, key=abs))


def mode_on_servo(plant: Plant, place: float) -> Mode:
    """The slowest mode of the structure on its servo, which gives way; without friction."""
    held = held_mode(plant, place)
    values = _modes_on_servo(Servo(plant, place))
    wanted = held.frequency * complex(-held.damping, math.sqrt(1 - held.damping**2))
    return _mode(min(values, key=lambda value: abs(value - wanted)))


def _mode(value: complex) -> Mode:
    return Mode(abs(value), -value.real / abs(value))


@lru_cache(maxsize=64)
def as_held(plant: Plant, place: float) -> Plant:
    """The structure with its joint held, of a plant whose modes were recorded on the servo.

    Frequency and damping are scaled so that its slowest mode on the servo is the plant's own.
    ValueError where no structure on that servo has it.
    """
    drive = driven_by(plant)
    if drive.recorded == "held":
        return plant
    wanted = held_mode(plant, place)
    frequency, damping = 1.0, 1.0
    rounds = 50
    try:
        for _ in range(rounds):
            errors = {"frequency": frequency - 1, "damping": damping - 1}
            held = perturb_plant(plant, errors)
            mode = mode_on_servo(held, place)
            if math.isclose(mode.frequency, wanted.frequency, rel_tol=1e-9):
                return held
            frequency *= wanted.frequency / mode.frequency
            missing = (wanted.damping - mode.damping) / wanted.damping if wanted.damping else 0.0
            damping = max(0.0, damping + missing)
    except QuietarmError:
        pass
    raise ValueError(
        f"no structure on this servo swings at {wanted.frequency / math.tau:.4g} Hz; give the "
        "loops as the drive has them, or recorded=held"
    )
