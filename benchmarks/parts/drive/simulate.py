"""March many cases of a machine at once: exact steps of the linear part, set-valued dry friction.

Between two steps forces are constant, so that rotor, belt, carriage and modes move by a matrix
exponential. Dry friction is the constant force that stops its body by the end of the step, or the
largest that it can be where that is not enough: bodies stick and slide without a smooth stand-in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import expm

from .machines import Friction, Machine

TICKS = 4000
"""Ticks of the servo in a second."""
STEPS = 4
"""Steps of the plant in a tick; `benchmarks/README.md` has what twice as many change."""
_SWEEPS = 3
"""Sweeps over two bodies in friction, which a step couples by less than a hundredth."""


@dataclass(frozen=True)
class SetPoints:
    """Rows for a controller: time [s], place [m], speed [m/s] and acceleration [m/s^2]."""

    time: np.ndarray
    place: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray

    @property
    def duration(self) -> float:
        """Time from the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    def at(self, since: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Place (cubics through places and speeds), speed and acceleration (straight lines).

        The last place is held after the last row.
        """
        times = self.time - self.time[0]
        after = since > times[-1]
        within = np.minimum(since, times[-1])
        place = CubicHermiteSpline(times, self.place, self.speed)(within)
        speed = np.interp(within, times, self.speed)
        acceleration = np.interp(within, times, self.acceleration)
        return (
            np.where(after, self.place[-1], place),
            np.where(after, 0.0, speed),
            np.where(after, 0.0, acceleration),
        )


@dataclass(frozen=True)
class Runs:
    """Simulated cases: a row for every tick of the servo, a column for every case.

    Parameters
    ----------
    time
        Time since the command began, at the end of each tick [s].
    tool
        Place of the tool in space [m].
    motor
        Place of the motor [m].
    asked
        Place that the servo was given [m].
    force
        Force of the motor [N].
    work
        Mechanical work of the motor within the tick [J].
    friction_work
        Work of dry friction within the tick, negative or zero [J].
    states
        Places and then speeds of all coordinates at the end.
    """

    time: np.ndarray
    tool: np.ndarray
    motor: np.ndarray
    asked: np.ndarray
    force: np.ndarray
    work: np.ndarray
    friction_work: np.ndarray
    states: np.ndarray


@dataclass(frozen=True)
class _Step:
    """One step of a machine: state and forces in, state out; friction apart."""

    free: np.ndarray
    """Next state by state, motor force, push and force of the play."""
    friction: np.ndarray
    """Next state by the dry friction of each body."""
    bodies: tuple[int, ...]
    """Coordinates that rub."""
    tool: np.ndarray


@lru_cache(maxsize=256)
def _step(machine: Machine, steps: int) -> _Step:
    mass, damping, stiffness, tool = machine.matrices()
    n = len(mass)
    bodies = (0,) if machine.belt is None else (0, 1)
    unit = np.eye(n)
    play = np.zeros(n) if machine.belt is None else unit[0] - unit[1]
    forces = np.column_stack([unit[0], tool, play, *(unit[body] for body in bodies)])
    inverse = np.linalg.inv(mass)
    whole = np.zeros((2 * n + forces.shape[1],) * 2)
    whole[:n, n : 2 * n] = unit
    whole[n : 2 * n, :n] = -inverse @ stiffness
    whole[n : 2 * n, n : 2 * n] = -inverse @ damping
    whole[n : 2 * n, 2 * n :] = inverse @ forces
    marched = expm(whole / (TICKS * steps))[: 2 * n]
    return _Step(marched[:, : 2 * n + 3], marched[:, 2 * n + 3 :], bodies, tool)


def _rubbing(machine: Machine) -> list[Friction]:
    """Friction of each body that rubs; without a belt motor and carriage are one."""
    motor, guide = machine.motor_friction, machine.guide_friction
    if machine.belt is not None:
        return [motor, guide]
    sliding = motor.sliding + guide.sliding
    return [Friction(sliding, motor.breakaway + guide.breakaway, 0.0, motor.stribeck)]


class _Controllers:
    """The servos of all cases, a tick at a time."""

    def __init__(self, machines: Sequence[Machine], place: np.ndarray) -> None:
        servos = [machine.servo for machine in machines]
        self.quantum = np.array([servo.quantum for servo in servos])
        self.position_gain = np.array([servo.position_gain for servo in servos])
        self.inertia = np.array([machine.commissioned_mass for machine in machines])
        self.speed_gain = self.inertia * 2 * np.pi * np.array([s.speed_loop for s in servos])
        self.integral_share = np.array([1 / (TICKS * s.reset_time) for s in servos])
        self.smoothing = 1 - np.exp(-1 / (TICKS * np.array([s.filter_time for s in servos])))
        self.largest = np.array([servo.largest for servo in servos])
        delay = np.array([servo.delay for servo in servos])
        self._length = int(delay.max()) + 1
        self._waiting = np.zeros((self._length, len(servos)))
        self._cases = np.arange(len(servos))
        self._places = -delay
        self._tick = 0
        self.before = self.read(place)
        self.speed = np.zeros(len(servos))
        self.integral = np.zeros(len(servos))

    def read(self, place: np.ndarray) -> np.ndarray:
        """Return what the encoder says of a place."""
        return np.round(place / self.quantum) * self.quantum

    def force(self, place, asked, asked_speed, asked_acceleration) -> np.ndarray:
        """The motor's force until the next tick [N]."""
        measured = self.read(place)
        self.speed += self.smoothing * ((measured - self.before) * TICKS - self.speed)
        self.before = measured
        error = self.position_gain * (asked - measured) + asked_speed - self.speed
        wanted = self.inertia * asked_acceleration + self.speed_gain * (error + self.integral)
        given = np.clip(wanted, -self.largest, self.largest)
        self.integral += np.where(given == wanted, self.integral_share * error, 0.0)
        self._waiting[self._tick % self._length] = given
        sent = self._waiting[(self._tick + self._places) % self._length, self._cases]
        self._tick += 1
        return sent


class _Plants:
    """The structures, belts and guides of all cases, a step at a time."""

    def __init__(self, machines: Sequence[Machine], steps: int, start: np.ndarray) -> None:
        models = [_step(machine, steps) for machine in machines]
        self._free = np.stack([model.free for model in models])
        self._by_friction = np.stack([model.friction for model in models])
        self._tools = np.stack([model.tool for model in models])
        self._n = self._tools.shape[1]
        self._bodies = list(models[0].bodies)
        self._speeds = [self._n + body for body in self._bodies]
        self._gains = self._by_friction[:, self._speeds, :]
        rubbing = [_rubbing(machine) for machine in machines]
        self._sliding = np.array([[body.sliding for body in each] for each in rubbing])
        breakaway = np.array([[body.breakaway for body in each] for each in rubbing])
        self._extra = breakaway - self._sliding
        self._stribeck = np.array([[body.stribeck for body in each] for each in rubbing])
        self._half_play = np.array([machine.backlash / 2 for machine in machines])
        self._belt = np.array([machine.belt or 0.0 for machine in machines])
        self._belt_damping = np.array([machine.belt_damping for machine in machines])
        self._with_play = bool(self._half_play.any())
        self._rubs = np.zeros((len(machines), len(self._bodies)))
        # state, force of the motor, push at the tool, force of the play
        self._full = np.zeros((len(machines), 2 * self._n + 3))
        self.state = self._full[:, : 2 * self._n]
        self.state[:, : len(self._bodies)] = start[:, None]

    @property
    def motor(self) -> np.ndarray:
        """Places of the motors."""
        return self.state[:, 0]

    @property
    def tool(self) -> np.ndarray:
        """Places of the tools in space."""
        return np.einsum("ij,ij->i", self.state[:, : self._n], self._tools)

    def hold(self, force: np.ndarray, push: np.ndarray | float) -> None:
        """Set the forces of motor and push until they are set anew."""
        self._full[:, 2 * self._n] = force
        self._full[:, 2 * self._n + 1] = push

    def march(self) -> np.ndarray:
        """Go a step on; the work of dry friction within it, by case."""
        if self._with_play:
            self._full[:, 2 * self._n + 2] = self._play()
        now = self.state[:, self._speeds]
        places = self.state[:, self._bodies]
        following = np.matmul(self._free, self._full[:, :, None])[:, :, 0]
        free = following[:, self._speeds]
        halfway = (now + free + (self._gains @ self._rubs[:, :, None])[:, :, 0]) / 2
        most = self._sliding + self._extra * np.exp(-((halfway / self._stribeck) ** 2))
        self._rubs = _rub(free, self._gains, most, self._rubs)
        self.state[:] = following + (self._by_friction @ self._rubs[:, :, None])[:, :, 0]
        return (self._rubs * (self.state[:, self._bodies] - places)).sum(axis=1)

    def _play(self) -> np.ndarray:
        """Force that takes back what the belt's spring and damper would do within their play."""
        half = self._half_play
        stretch = self.state[:, 0] - self.state[:, 1]
        rate = self.state[:, self._n] - self.state[:, self._n + 1]
        damper = self._belt_damping * rate
        linear = self._belt * stretch + damper
        beyond = stretch - np.clip(stretch, -half, half)
        pulls = self._belt * beyond + np.where(beyond != 0, damper, 0.0)
        pulls = np.where(pulls * beyond > 0, pulls, 0.0)
        return np.where(half > 0, linear - pulls, 0.0)


def simulate(
    machines: Sequence[Machine],
    set_points: Sequence[SetPoints],
    *,
    rest: float = 3.0,
    steps: int = STEPS,
    push: np.ndarray | None = None,
) -> Runs:
    """Run every machine with its set points, and for `rest` seconds after the longest of them.

    Parameters
    ----------
    machines, set_points
        The cases. All machines have a belt, or none has one.
    rest
        Seconds after the longest move.
    steps
        Steps of the plant in a tick of the servo.
    push
        Force at the tool [N], a row for every tick and a column for every case.
    """
    count = round((max(each.duration for each in set_points) + rest) * TICKS)
    begins = np.arange(count) / TICKS
    asked = [np.column_stack(each) for each in zip(*(each.at(begins) for each in set_points))]
    start = np.array([each.place[0] for each in set_points])
    plants = _Plants(machines, steps, start)
    servos = _Controllers(machines, start)
    tool, motor, force, work, lost = (np.zeros((count, len(machines))) for _ in range(5))
    for tick in range(count):
        sent = servos.force(plants.motor, *(each[tick] for each in asked))
        plants.hold(sent, 0.0 if push is None else push[tick])
        begun = plants.motor.copy()
        for _ in range(steps):
            lost[tick] += plants.march()
        tool[tick] = plants.tool
        motor[tick] = plants.motor
        force[tick] = sent
        work[tick] = sent * (plants.motor - begun)
    return Runs(begins + 1 / TICKS, tool, motor, asked[0], force, work, lost, plants.state.copy())


def _rub(speeds, gains, most, guess) -> np.ndarray:
    """Dry friction of every body over a step: it stops the body, or is as large as it can be."""
    if speeds.shape[1] == 1:
        return np.clip(-speeds / gains[:, 0], -most, most)
    one, two = guess[:, 0], guess[:, 1]
    for _ in range(_SWEEPS):
        one = np.clip(
            -(speeds[:, 0] + gains[:, 0, 1] * two) / gains[:, 0, 0], -most[:, 0], most[:, 0]
        )
        two = np.clip(
            -(speeds[:, 1] + gains[:, 1, 0] * one) / gains[:, 1, 1], -most[:, 1], most[:, 1]
        )
    return np.column_stack([one, two])
