"""A gantry and a picker: the figures of their structure, drive, friction and servo."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .beam import Beam, Lump, tuned


@dataclass(frozen=True)
class Friction:
    """Dry and viscous friction of a guide or of a motor with its transmission.

    Parameters
    ----------
    sliding
        Coulomb friction while it slides [N].
    breakaway
        Largest friction at standstill [N].
    viscous
        Friction per speed [N s/m].
    stribeck
        Speed over which breakaway falls to sliding [m/s].
    """

    sliding: float
    breakaway: float
    viscous: float
    stribeck: float = 0.01

    def times(self, factor: float) -> Friction:
        """Return this friction with its dry part multiplied; what is viscous stays."""
        return replace(self, sliding=factor * self.sliding, breakaway=factor * self.breakaway)


@dataclass(frozen=True)
class Servo:
    """A position loop (P) around a speed loop (PI), with both feed-forwards, at 4 kHz.

    Parameters
    ----------
    speed_loop
        Bandwidth of the speed loop [Hz].
    position_gain
        Gain of the position loop [1/s].
    reset_time
        Reset time of the speed loop's integral [s].
    quantum
        Step of the motor's encoder [m].
    filter_time
        Time constant of the low pass of the measured speed [s].
    delay
        Periods of the servo from measuring to the force.
    largest
        Force at which the drive saturates [N].
    """

    speed_loop: float
    position_gain: float
    reset_time: float
    quantum: float
    filter_time: float
    delay: int
    largest: float

    def with_bandwidth(self, hertz: float) -> Servo:
        """The servo with another speed loop, its other two constants in proportion."""
        factor = hertz / self.speed_loop
        return replace(
            self,
            speed_loop=hertz,
            position_gain=self.position_gain * factor,
            reset_time=self.reset_time / factor,
        )


@dataclass(frozen=True)
class Machine:
    """A beam on a carriage, its drive and its servo; all forces are those at the carriage.

    Parameters
    ----------
    name
        What it is called.
    beam
        The structure on the carriage.
    damping
        Damping ratios of its modes with the carriage held; their number is that of the modes kept.
    carriage
        Mass of the carriage without the beam [kg].
    rotor
        The motor's inertia as a mass at the carriage [kg].
    motor_friction, guide_friction
        Friction before and behind the belt.
    servo
        The controller.
    heat
        Square of the motor constant [N^2/W]: copper loss is force squared over it.
    belt
        Stiffness between motor and carriage [N/m]; None if they are one.
    belt_damping
        Damping of the belt [N s/m].
    backlash
        Play between motor and carriage, its whole width [m].
    frequency_error
        Share by which all frequencies of the structure are higher than stated.
    tool
        Factor of the tool's mass.
    """

    name: str
    beam: Beam
    damping: tuple[float, ...]
    carriage: float
    rotor: float
    motor_friction: Friction
    guide_friction: Friction
    servo: Servo
    heat: float
    belt: float | None = None
    belt_damping: float = 0.0
    backlash: float = 0.0
    frequency_error: float = 0.0
    tool: float = 1.0

    @property
    def actual_beam(self) -> Beam:
        """The beam with the errors of frequency and tool."""
        *others, tool = self.beam.lumps
        heavier = replace(tool, mass=tool.mass * self.tool)
        stiffer = self.beam.stiffness * (1 + self.frequency_error) ** 2
        return replace(self.beam, lumps=(*others, heavier), stiffness=stiffer)

    @property
    def commissioned_mass(self) -> float:
        """Mass of all that moves [kg], as the servo knows it: with the tool as stated."""
        beam = self.beam.length * self.beam.line_mass + sum(lump.mass for lump in self.beam.lumps)
        return self.rotor + self.carriage + beam

    def matrices(self) -> tuple[np.ndarray, ...]:
        """Mass, damping and stiffness matrix, the motor's place among the coordinates, the tool.

        The first coordinate is the motor's place, with a belt the second is the carriage's; then
        the modes follow.
        """
        mass, damping, stiffness, tool = self.actual_beam.reduced(len(self.damping), self.damping)
        mass[0, 0] += self.carriage
        damping[0, 0] += self.guide_friction.viscous
        if self.belt is None:
            mass[0, 0] += self.rotor
            damping[0, 0] += self.motor_friction.viscous
            return mass, damping, stiffness, tool
        mass, damping, stiffness = (np.pad(a, ((1, 0), (1, 0))) for a in (mass, damping, stiffness))
        mass[0, 0] = self.rotor
        damping[0, 0] = self.motor_friction.viscous
        spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
        stiffness[:2, :2] += self.belt * spring
        damping[:2, :2] += self.belt_damping * spring
        return mass, damping, stiffness, np.append(0.0, tool)


GANTRY = Machine(
    name="gantry",
    beam=tuned(
        4.5,
        Beam(
            length=1.4,
            stiffness=1.0,
            line_mass=5.5,
            lumps=(Lump(0.6, 5.0, 0.03), Lump(1.0, 7.0, 0.05)),
        ),
    ),
    damping=(0.006, 0.008, 0.012, 0.02),
    carriage=45.0,
    rotor=18.0,
    motor_friction=Friction(25.0, 32.0, 30.0),
    guide_friction=Friction(20.0, 28.0, 20.0),
    servo=Servo(40.0, 60.0, 0.03, 2e-6, 3e-4, 1, 900.0),
    heat=900.0,
    belt=6e6,
    belt_damping=2500.0,
)
"""A mast of 1.4 m with a box and a tool of 7 kg, on a carriage that a belt pulls; 4.5 Hz."""

PICKER = Machine(
    name="picker",
    beam=tuned(
        12.0,
        Beam(
            length=0.5,
            stiffness=1.0,
            line_mass=0.8,
            lumps=(Lump(0.5, 0.3, 0.0004), Lump(1.0, 0.8, 0.001)),
        ),
    ),
    damping=(0.004, 0.006, 0.01, 0.02),
    carriage=4.0,
    rotor=0.5,
    motor_friction=Friction(3.0, 4.0, 4.0),
    guide_friction=Friction(2.0, 2.5, 2.0),
    servo=Servo(60.0, 90.0, 0.02, 1e-6, 3e-4, 1, 180.0),
    heat=150.0,
)
"""A gripper of 0.5 m with 0.8 kg at its end, on a linear motor; 12 Hz."""

MACHINES = {machine.name: machine for machine in (GANTRY, PICKER)}
