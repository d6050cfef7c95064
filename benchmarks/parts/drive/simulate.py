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
    """What the cases did: a row for every tick of the servo, a column for every case.

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
        """What the encoder says of a place."""
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
    models = [_step(machine, steps) for machine in machines]
    free = np.stack([model.free for model in models])
    by_friction = np.stack([model.friction for model in models])
    tools = np.stack([model.tool for model in models])
    cases, n = tools.shape
    bodies = list(models[0].bodies)
    speeds = [n + body for body in bodies]
    gains = by_friction[:, speeds, :]
    rubbing = [_rubbing(machine) for machine in machines]
    sliding = np.array([[body.sliding for body in each] for each in rubbing])
    extra = np.array([[body.breakaway - body.sliding for body in each] for each in rubbing])
    stribeck = np.array([[body.stribeck for body in each] for each in rubbing])
    half_play = np.array([machine.backlash / 2 for machine in machines])
    belt = np.array([machine.belt or 0.0 for machine in machines])
    belt_damping = np.array([machine.belt_damping for machine in machines])
    with_play = bool(half_play.any())

    full = np.zeros((cases, 2 * n + 3))
    state = full[:, : 2 * n]
    start = np.array([each.place[0] for each in set_points])
    state[:, : len(bodies)] = start[:, None]
    servos = _Controllers(machines, state[:, 0])
    rubs = np.zeros((cases, len(bodies)))
    tool, motor, force, work, lost = (np.zeros((count, cases)) for _ in range(5))
    for tick in range(count):
        sent = servos.force(state[:, 0], *(each[tick] for each in asked))
        full[:, 2 * n] = sent
        if push is not None:
            full[:, 2 * n + 1] = push[tick]
        begun = state[:, 0].copy()
        for _ in range(steps):
            if with_play:
                full[:, 2 * n + 2] = _play(state, n, half_play, belt, belt_damping)
            now = state[:, speeds]
            places = state[:, bodies]
            following = np.matmul(free, full[:, :, None])[:, :, 0]
            free_speeds = following[:, speeds]
            halfway = (now + free_speeds + (gains @ rubs[:, :, None])[:, :, 0]) / 2
            most = sliding + extra * np.exp(-((halfway / stribeck) ** 2))
            rubs = _rub(free_speeds, gains, most, rubs)
            state[:] = following + (by_friction @ rubs[:, :, None])[:, :, 0]
            lost[tick] += (rubs * (state[:, bodies] - places)).sum(axis=1)
        tool[tick] = np.einsum("ij,ij->i", state[:, :n], tools)
        motor[tick] = state[:, 0]
        force[tick] = sent
        work[tick] = sent * (state[:, 0] - begun)
    return Runs(begins + 1 / TICKS, tool, motor, asked[0], force, work, lost, state.copy())


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


def _play(state, n, half, belt, damping) -> np.ndarray:
    """Force that takes back what the belt's spring and damper would do within their play."""
    stretch = state[:, 0] - state[:, 1]
    rate = state[:, n] - state[:, n + 1]
    linear = belt * stretch + damping * rate
    beyond = stretch - np.clip(stretch, -half, half)
    pulls = belt * beyond + np.where(beyond != 0, damping * rate, 0.0)
    pulls = np.where(pulls * beyond > 0, pulls, 0.0)
    return np.where(half > 0, linear - pulls, 0.0)
