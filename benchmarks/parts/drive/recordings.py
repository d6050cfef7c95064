"""Ways to record a machine's swing, and what quietarm identifies from each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from quietarm import Recording, identify
from quietarm.models import LinearAxis

from .machines import Friction, Machine
from .moves import Move, shaper_over_ruckig
from .simulate import TICKS, SetPoints, simulate

EVERY = 4
"""Ticks of the servo between two samples of a recording."""
SPARSE = 4
"""Samples from one row of a recording's file to the next."""
SWINGS = 30
"""Periods that a recording lasts."""
OVERSHOOT = 1.5
"""Largest deflection of a plan over that of its largest acceleration at rest, about."""
LOCKED = Friction(1e9, 1e9, 0.0)
"""A brake on the motor."""

Signal = tuple[np.ndarray, np.ndarray, float]
"""Time [s], the tool's displacement [m], and half of its largest swing [m]."""


def push_on_the_brake(move: Move, machine: Machine) -> Signal:
    """Push the tool as far as the move bends it and let go, with the motor's brake closed."""
    return _pushed(move, replace(machine, motor_friction=LOCKED), 1.0)


def light_push(move: Move, machine: Machine) -> Signal:
    """Push the tool a tenth as far as the move bends it, with the servo holding the axis."""
    return _pushed(move, machine, 0.1)


def hard_push(move: Move, machine: Machine) -> Signal:
    """Push the tool as far as the move bends it, with the servo holding the axis."""
    return _pushed(move, machine, 1.0)


def after_a_hard_move(move: Move, machine: Machine) -> Signal:
    """Watch the tool after the fastest move within the limits, without a shaper."""
    task = move.task(1.0, 0.0, move.ruckig_duration * (1 + 1e-9))
    asked = shaper_over_ruckig(task)
    runs = simulate([machine], [asked], rest=_seconds(machine))
    return _from(asked.duration, runs.time, runs.tool[:, 0] - move.target)


def on_the_way(move: Move, machine: Machine) -> Signal:
    """Watch the tool against the motor while the axis moves at a constant speed.

    The axis starts at once with the largest acceleration, which makes the tool swing.
    """
    seconds = _seconds(machine)
    acceleration = move.limits["acceleration_limit"]
    rise = move.jog / acceleration
    time = np.arange(round((seconds + 2 * rise) * 1000) + 1) / 1000
    rising = np.minimum(time, rise)
    asked = SetPoints(
        time,
        acceleration * rising**2 / 2 + move.jog * (time - rising),
        acceleration * rising,
        np.where(time < rise, acceleration, 0.0),
    )
    runs = simulate([machine], [asked], rest=0.0)
    return _from(2 * rise, runs.time, runs.tool[:, 0] - runs.motor[:, 0])


WAYS: dict[str, Callable[[Move, Machine], Signal]] = {
    "brake": push_on_the_brake,
    "light push": light_push,
    "hard push": hard_push,
    "after a hard move": after_a_hard_move,
    "on the way": on_the_way,
}
"""The ways to record, by the names of the table."""


def save(way: str, move: Move, machine: Machine, path: Path) -> None:
    """Write a recording as a csv, as the laser sees the tool."""
    time, tool, _ = WAYS[way](move, machine)
    seen = tool + np.random.default_rng(0).normal(0, move.noise, len(tool))
    rows = zip(time[::SPARSE], 1e3 * seen[::SPARSE])
    lines = ["time_s,tool_mm", *(f"{seconds:.3f},{away:.3f}" for seconds, away in rows)]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


def identified(way: str, move: Move, machine: Machine) -> tuple[float, float, float]:
    """Frequency [Hz], damping and largest swing [m] that a recording of this way gives."""
    time, tool, swing = WAYS[way](move, machine)
    random = np.random.default_rng(0)
    seen = tool + random.normal(0, move.noise, len(tool))
    found = identify([Recording(time, tip=seen)], LinearAxis())
    plant = found.plant
    return float(plant.omega1 / (2 * np.pi)), float(plant.zeta1), swing


def _pushed(move: Move, machine: Machine, share: float) -> Signal:
    """Bend the tool by a share of what a move bends it, hold it for a period, and let go."""
    omega, shapes = (each[..., 0] for each in machine.actual_beam.modes(1))
    mass = machine.actual_beam.matrices()[0]
    participation = shapes @ mass[:, ::2].sum(axis=1)
    force = OVERSHOOT * share * move.limits["acceleration_limit"] * participation / shapes[-2]
    period = 2 * np.pi / omega
    held = 3 * period
    seconds = held + _seconds(machine)
    time = np.arange(round(seconds * TICKS)) / TICKS
    push = force * np.minimum(time / (2 * period), 1) * (time < held)
    still = SetPoints(np.array([0.0, 1.0]), *np.zeros((3, 2)))
    runs = simulate([machine], [still], rest=seconds - 1.0, push=push[:, None])
    return _from(held, runs.time, runs.tool[:, 0])


def _seconds(machine: Machine) -> float:
    (omega,), _ = machine.actual_beam.modes(1)
    return float(SWINGS * 2 * np.pi / omega)


def _from(begin: float, time: np.ndarray, tool: np.ndarray) -> Signal:
    """Samples from a time on, the first of them at zero."""
    part = tool[time > begin][::EVERY]
    first = part[: len(part) * 2 // SWINGS]
    return np.arange(len(part)) * EVERY / TICKS, part, float(np.ptp(first) / 2)
