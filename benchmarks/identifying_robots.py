"""Measure how well ring-downs of robots in MuJoCo tell their springs and their load.

    pip install "quietarm[robot]" mujoco example-robot-data
    python benchmarks/identifying_robots.py [--robot ur5 panda] [--output table.csv]

The UR5 with its bar and the Panda with elastic gears and a bar, whose bars have other springs and
another load than the file that quietarm is given. A force of some newtons bends the tip, and is let
go. What is logged has noise: the torques of all joints at 500 Hz, or an accelerometer at the tip at
1 kHz. The bar is twelve hinges in each direction, each nonlinear.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

from mujoco_robots import FlexibleRobot, Truth
from robots import (
    BAR,
    END,
    PANDA_END,
    PANDA_GEARS,
    PANDA_START,
    START,
    STEEL_BAR,
    panda_with_bar,
    ur5_with_bar,
    urdf_of,
)

from quietarm.machine import RobotRecording, identify_robot

Array = NDArray[np.float64]
RESULTS = Path(__file__).parent / "results" / "identifying_robots.csv"
SECONDS = 5.0
"""That are recorded after the tip is let go."""
PIECES = 12
RATE = {"torques": 500, "acceleration": 1000}
NOISE = {"torques": 0.05, "acceleration": 0.02}
"""Standard deviations: of an estimator of torques [N m], of a cheap accelerometer [m/s^2]."""
FORCE = np.array([3.0, 2.0, 4.0])
"""By which the tip is bent before it is let go [N]."""
POSTURES = {"ur5": (START, END), "panda": (PANDA_START, PANDA_END)}
COLUMNS = ("robot", "recorded", "postures", "stiffness", "payload_kg", "told_stiffness",
           "stiffness_low", "stiffness_high", "told_payload_kg", "payload_low", "payload_high",
           "payload_by", "frequency_off", "damping_off")  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A robot whose springs and load are other multiples of its file's, and what is recorded."""

    robot: str
    signal: str
    postures: int
    stiffness: float
    payload: float


def model_of(robot: str) -> Any:
    """The robot of the file."""
    return ur5_with_bar() if robot == "ur5" else panda_with_bar()


def truth_of(case: Case) -> Truth:
    """The robot in MuJoCo, with its own springs and load."""
    urdf, at, bar = (
        ("ur5_robot.urdf", "tool0", BAR)
        if case.robot == "ur5"
        else ("panda.urdf", "panda_hand", STEEL_BAR)
    )
    flexible = FlexibleRobot(urdf_of(urdf))
    carried = {
        "tip_mass": case.payload * bar["tip_mass"],
        "youngs_modulus": case.stiffness * bar["youngs_modulus"],
    }
    hinges = flexible.add_bar(at, **{**bar, **carried}, pieces=PIECES)
    model = model_of(case.robot)
    for joint, gear in zip(model.elastic_joints, PANDA_GEARS):
        flexible.add_gear(joint, case.stiffness * gear, 5.0)
    truth = Truth(flexible, model.joints, bar["damping"], hinges, held=model.held)
    truth.tolerance = 1e-7
    return truth


def recorded(truth: Truth, posture: Array, signal: str, random: Any, name: str) -> RobotRecording:
    """A ring-down as it is logged, with noise."""
    times = np.arange(round(SECONDS * RATE[signal])) / RATE[signal]
    torques, felt = truth.ring_down(posture, FORCE, times)
    values = torques if signal == "torques" else felt
    values = values + random.normal(0, NOISE[signal], values.shape)
    return RobotRecording(times, **{signal: values}, name=name)


def row_of(case: Case) -> list[str]:
    """A row of the table."""
    random = np.random.default_rng(0)
    truth = truth_of(case)
    postures = [*POSTURES[case.robot][: case.postures]]
    recordings = [
        recorded(truth, posture, case.signal, random, f"ring {number}")
        for number, posture in enumerate(postures)
    ]
    found = identify_robot(recordings, model_of(case.robot), [tuple(q.tolist()) for q in postures])
    off, damped = zip(*_errors(truth, found.modes))
    payload = found.payload
    told = ("", "", "") if payload is None else (payload.value, payload.low, payload.high)
    stiffness = found.stiffness
    mass = (BAR if case.robot == "ur5" else STEEL_BAR)["tip_mass"]
    return [
        case.robot, case.signal, str(case.postures), f"{case.stiffness:g}",
        f"{case.payload * mass:.4g}",
        *(f"{value:.4f}" for value in (stiffness.value, stiffness.low, stiffness.high)),
        *(value if value == "" else f"{value:.4f}" for value in told),
        found.payload_by.split(" the ")[-1] if payload else "not told",
        f"{max(off):.1e}", f"{max(damped):.1e}",
    ]  # fmt: skip


def _errors(truth: Truth, modes: Any) -> Iterator[tuple[float, float]]:
    """Yield how far frequency and damping of each mode are from MuJoCo's, as shares."""
    for mode in modes:
        frequencies, ratios = truth.held_modes(np.array(mode.posture))
        place = mode.mode - 1
        yield (
            abs(mode.frequency.value / frequencies[place] - 1),
            abs(mode.damping.value / ratios[place] - 1),
        )


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", nargs="+", default=["ur5", "panda"], choices=["ur5", "panda"])
    parser.add_argument("--output", type=Path, default=RESULTS)
    given = parser.parse_args(arguments)
    others = ((1.2, 1.1), (0.8, 0.8))
    cases = [
        Case(robot, signal, 1, *other)
        for robot in given.robot
        for signal in ("torques", "acceleration")
        for other in others
    ]
    if "ur5" in given.robot:
        cases.insert(4, Case("ur5", "acceleration", 2, *others[0]))
    with given.output.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for case in cases:
            row = row_of(case)
            writer.writerow(row)
            file.flush()
            print(*row, flush=True)


if __name__ == "__main__":
    main()
