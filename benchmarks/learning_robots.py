"""Measure what a robot's moves leave in MuJoCo while its plan is learned from them.

    pip install "quietarm[robot]" mujoco example-robot-data
    python benchmarks/learning_robots.py [--robot ur5 panda] [--moves 5] [--output table.csv]

The UR5 with its bar and the Panda with its bar move in MuJoCo, which has the bar as twelve hinges
in each direction. The plan's model has springs whose frequency is 10 or 20 % wrong, and lacks a
compliance: a gear, or a base that rocks. Each move is recorded at 500 Hz with noise, by an
accelerometer at the tip or by the torques of all joints, as a controller logs them: with a clock in
whole milliseconds, lost rows and positions. `quietarm.learn` makes the next plan.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

from mujoco_robots import FlexibleRobot, Truth, motion_of
from robots import (
    BAR,
    PANDA_END,
    PANDA_START,
    PEDESTAL,
    STEEL_BAR,
    panda_with_bar,
    straight,
    ur5_with_bar,
    urdf_of,
)

import quietarm as qa
from quietarm.machine import RobotRecording
from quietarm.models.robot import Base, Measured

Array = NDArray[np.float64]
RESULTS = Path(__file__).parent / "results" / "learning_robots.csv"
AFTER = 2.2
"""Seconds that are recorded after arrival."""
BEFORE = 0.2
RATE = 500
NOISE = {"acceleration": 0.02, "torques": 0.05}
"""Standard deviations: of a cheap accelerometer [m/s^2], of an estimator of torques [N m]."""
DURATION = {"ur5": 1.0, "panda": 0.8}
"""Of the moves [s]."""
BASE = {"ur5": PEDESTAL, "panda": Base(stiffness=(2e5, 2e5), damping=(100.0, 100.0), height=0.5)}
"""A base that the model lacks: it rocks at 10 Hz under the UR5, at 15 under the Panda."""
GEAR = {"ur5": ("shoulder_lift_joint", 2e4, 20.0), "panda": ("panda_joint2", 3e4, 20.0)}
"""A gear that the model lacks: its joint, stiffness [N m/rad] and damping."""
COLUMNS = ("robot", "frequency", "lacks", "signal", "move", "left_mm", "predicted_mm", "energy_j",
           "stiffness")  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A robot, what its model has wrong, and what is recorded.

    Parameters
    ----------
    robot
        Its name.
    error
        Share by which the model's frequency is wrong.
    lacks
        What gives in MuJoCo and not in the model: "gear" or "base".
    signal
        What is recorded.
    """

    robot: str
    error: float
    lacks: str
    signal: str


@lru_cache
def right_plant(name: str) -> qa.models.Plant:
    """A robot whose bar alone gives, with the right frequency."""
    if name == "ur5":
        return ur5_with_bar().along(straight())
    robot = replace(panda_with_bar(), elastic_joints={})
    return robot.along(qa.GeometricPath.line(PANDA_START, PANDA_END))


def wrong_plant(case: Case) -> Any:
    """Return the right plant with a frequency that is wrong by a share."""
    plant: Any = right_plant(case.robot)
    end = tuple(plant.path(1.0).tolist())
    frequency = float(plant.robot.frequencies(end)[0]) * (1 + case.error)
    return replace(plant, robot=replace(plant.robot, measured=Measured(frequency, end)))


@lru_cache
def truth_of(robot: str, lacks: str) -> Truth:
    """The robot in MuJoCo, with a compliance that the model lacks."""
    urdf, at, bar = (
        ("ur5_robot.urdf", "tool0", BAR)
        if robot == "ur5"
        else ("panda.urdf", "panda_hand", STEEL_BAR)
    )
    flexible = FlexibleRobot(urdf_of(urdf))
    hinges = flexible.add_bar(at, **bar)
    if lacks == "gear":
        flexible.add_gear(*GEAR[robot])
    else:
        base = BASE[robot]
        flexible.add_base(base.stiffness[0], base.damping[0], base.height)
    plant: Any = right_plant(robot)
    truth = Truth(flexible, plant.robot.joints, bar["damping"], hinges, held=plant.robot.held)
    truth.tolerance = 1e-6  # as 1e-9 it says 10.09048 mm, in a third of the time
    return truth


@dataclass(frozen=True)
class Run:
    """A move in MuJoCo: signals from its start on at a rate, and what it leaves [m]."""

    time: Array
    positions: Array
    torques: Array
    acceleration: Array
    residual: float


def run(truth: Truth, plan: qa.Plan) -> Run:
    """Execute a plan in MuJoCo, and see what a controller and an accelerometer see."""
    duration = plan.task.duration
    motion = still_after(motion_of(plan), duration)
    count = len(truth.sprung)
    time = np.arange(round((duration + AFTER) * RATE) + 1) / RATE
    begin = np.concatenate([truth.sag(motion(0.0)[0]), np.zeros(count)])
    moving = np.unique(np.append(time[time < duration], duration))
    states = truth.followed(motion, moving, begin)
    resting = np.append(duration, time[time > duration])
    later = truth.followed(motion, resting, states[:, -1])
    kept = states[:, : np.count_nonzero(time < duration)]
    states = np.hstack([kept, later[:, (1 if time[kept.shape[1]] > duration else 0) :]])
    positions, torques, acceleration = [], [], []
    for at, state in zip(time, states.T):
        q, v, a = motion(at)
        springs, torque = truth.accelerations(q, v, a, state[:count], state[count:])
        torques.append(torque)
        positions.append(q)
        acceleration.append(truth.felt(q, v, a, state[:count], state[count:], springs))
    end = motion(duration)[0]
    rest = truth.tip_at(end, truth.sag(end))
    away = [np.linalg.norm(truth.tip_at(end, s[:count]) - rest) for s in later.T]
    return Run(time, np.array(positions), np.array(torques), np.array(acceleration), max(away))


def still_after(motion: Callable[[float], Any], duration: float) -> Callable[[float], Any]:
    """A motion that rests after its end."""
    end = motion(duration)[0]
    still = (end, np.zeros_like(end), np.zeros_like(end))
    return lambda at: motion(at) if at < duration else still


def recorded(done: Run, signal: str, plant: Any, random: np.random.Generator) -> RobotRecording:
    """A run as it is logged: from before the move on, with noise, lost rows and whole ms."""
    before = round((BEFORE + random.uniform(0, 0.1)) * RATE)

    def seen(values: Array) -> Array:
        return np.concatenate([np.repeat(values[:1], before, axis=0), values])

    values = seen(done.torques if signal == "torques" else done.acceleration)
    if signal == "acceleration":
        values = values[:, list(plant.tables.directions)]
    values = values + random.normal(0, NOISE[signal], values.shape)
    time = np.arange(len(values)) / RATE
    kept = random.random(len(time)) > 0.05  # gaps of 2 to 6 ms
    stamps = np.round(1e3 * time[kept]) / 1e3
    positions = {"positions": seen(done.positions)[kept]} if signal == "torques" else {}
    return RobotRecording(stamps, **{signal: values[kept]}, **positions, name="run")


def course(case: Case, moves: int) -> Iterator[list[str]]:
    """A row of the table for each move, until there is nothing more to learn."""
    random = np.random.default_rng(0)
    plant = wrong_plant(case)
    task = qa.PointToPoint(plant, target=1.0, duration=DURATION[case.robot])
    plan = qa.plan_move(task, qa.CycloidPolynomial(10), starts=1)
    truth = truth_of(case.robot, case.lacks)
    said, stiffness = "", ""
    for number in range(moves + 1):
        done = run(truth, plan)
        yield [
            case.robot, f"{case.error:+.0%}", case.lacks, case.signal, str(number),
            f"{1e3 * done.residual:.3g}", said, f"{plan.energy:.4g}", stiffness,
        ]  # fmt: skip
        if number == moves:
            return
        learned = qa.learn(plan, [recorded(done, case.signal, plant, random)], dearer=0.1)
        for note in learned.notes:
            print("   ", note, file=sys.stderr)
        print(
            f"    left {1e3 * learned.left:.3g}, by springs {1e3 * learned.by_frequency:.3g}, "
            f"step {learned.step:.2f}, floor {1e3 * learned.floor:.2g}", file=sys.stderr,
        )  # fmt: skip
        if learned.is_done:
            return
        plan = learned.plan
        said = f"{1e3 * learned.next_at_most:.3g}"
        stiffness = f"{learned.changed['stiffness'][1]:.3f}" if learned.changed else ""


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", nargs="+", default=["ur5", "panda"], choices=["ur5", "panda"])
    parser.add_argument("--error", nargs="+", type=float, default=[-0.1, 0.1, -0.2, 0.2])
    parser.add_argument("--lacks", nargs="+", default=["gear", "base"], choices=["gear", "base"])
    parser.add_argument("--signal", nargs="+", default=["acceleration", "torques"])
    parser.add_argument("--moves", type=int, default=5)
    parser.add_argument("--output", type=Path, default=RESULTS)
    given = parser.parse_args(arguments)
    cases = [
        Case(robot, error, lacks, signal)
        for robot in given.robot
        for lacks in given.lacks
        for error in given.error
        for signal in given.signal
    ]
    with given.output.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for case in cases:
            for row in course(case, given.moves):
                writer.writerow(row)
                file.flush()
                print(*row, flush=True)


if __name__ == "__main__":
    main()
