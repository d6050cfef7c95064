"""Robots along a path, in MuJoCo: what a plan takes and leaves, beside what others do.

    pip install "quietarm[robot]" mujoco example-robot-data ruckig toppra
    python benchmarks/robot.py [table] [figures] [--only 2 8]

`table` moves the UR5 with its bar by a plan and by six rivals. `figures` measures what robots are
held to, one line each: what is asked for, what is found, the processor's seconds. MuJoCo integrates
every hinge of what bends, nonlinear; it shares no code with quietarm.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

from mujoco_robots import FlexibleRobot, Truth, motion_of
from parts.robot_motions import Array, Motion, rival
from robots import (
    BAR,
    END,
    PANDA_END,
    PANDA_START,
    PEDESTAL,
    START,
    STEEL_BAR,
    UR5_JOINTS,
    panda_with_bar,
    straight,
    ur5_with_bar,
    urdf_of,
)

import quietarm as qa
from quietarm.models import JointMotion, RobotOnPath

TOPPRA_LEAST = 0.707
"""Of the fastest move [s]: toppra refuses less than 0.7069 s."""
DURATION = 1.0
FASTEST = {
    "torque_limit": dict(zip(UR5_JOINTS, (150.0, 150.0, 150.0, 28.0, 28.0, 28.0))),
    "speed_limit": dict(zip(UR5_JOINTS, (3.15, 3.15, 3.15, 3.2, 3.2, 3.2))),
    "acceleration_limit": dict.fromkeys(UR5_JOINTS, 12.0),
    "jerk_limit": dict.fromkeys(UR5_JOINTS, 250.0),
}
RIVALS = {"speed_limit": 3.14, "acceleration_limit": 10.0}
"""Of ruckig, that of the jerk besides, and toppra."""
LIMITED = {
    "torque_limit": dict(zip(UR5_JOINTS, (16.0, 44.0, 18.5, 5.0, 5.0, 5.0))),
    "speed_limit": dict.fromkeys(UR5_JOINTS, 3.0),
    "acceleration_limit": dict.fromkeys(UR5_JOINTS, 14.0),
    "jerk_limit": dict.fromkeys(UR5_JOINTS, 300.0),
}


def move(**entries: object) -> qa.PointToPoint:
    """The move of the UR5 with its bar."""
    plant = ur5_with_bar().along(straight())
    return qa.PointToPoint(plant, **({"target": 1.0, "duration": DURATION} | entries))


@lru_cache
def planned() -> qa.Plan:
    """The plan of that move."""
    return qa.plan_move(move())


def truth_of(stiffness: float = 1.0) -> Truth:
    """The UR5 with its bar in MuJoCo, with so many times its stiffness."""
    robot = FlexibleRobot(urdf_of("ur5_robot.urdf"))
    hinges = robot.add_bar("tool0", **BAR)
    return Truth(robot, UR5_JOINTS, BAR["damping"], hinges, softened=stiffness)


def measured(plan: qa.Plan, truth: Truth) -> tuple[float, float, Array]:
    """Residual [mm], energy [J] and peaks of the torques [N m]."""
    residual, energy, torques = truth.residual_and_energy(motion_of(plan), plan.task.duration)
    return 1e3 * residual, energy, torques


def on_the_line(place_of: Callable[[float], tuple[float, float, float]]) -> Motion:
    """Joints by the place on the straight path, its speed and acceleration."""
    way = END - START

    def motion(at: float) -> tuple[Array, Array, Array]:
        place, speed, acceleration = place_of(at)
        return START + place * way, speed * way, acceleration * way

    return motion


def quintic(at: float) -> tuple[float, float, float]:
    """The polynomial of fifth degree from rest to rest."""
    x = at / DURATION
    return (
        x**3 * (10 - 15 * x + 6 * x**2),
        30 * x**2 * (1 - x) ** 2 / DURATION,
        60 * x * (1 - x) * (1 - 2 * x) / DURATION**2,
    )


def table() -> None:
    """Energy and residual of the plan and its rivals, in MuJoCo."""
    task = move()
    motions = {
        "plan": motion_of(planned()),
        "cycloid": rival("cycloid", task),
        "quintic": on_the_line(quintic),
        "ruckig, phase-synchronised": rival("ruckig", move(**RIVALS, jerk_limit=150.0)),
        "toppra, stretched to 1 s": rival("toppra", move(**RIVALS)),
    }
    for shaper in ("zv", "zvd"):
        motions[f"{shaper.upper()} on the cycloid"] = rival(shaper, task)
    truth = truth_of()
    print("| UR5 with a bar, 1 s, in MuJoCo | energy [J] | residual [mm] |")
    print("|---|---:|---:|")
    for name, motion in motions.items():
        residual, energy, _ = truth.residual_and_energy(motion, DURATION)
        print(f"| {name} | {energy:.3f} | {1e3 * residual:.3g} |", flush=True)
    print(f"claimed of the plan: {planned().energy:.4f} J, {1e3 * planned().residual:.2g} mm")


class Frozen(RobotOnPath):
    """A robot whose modes are those of one place everywhere."""

    name = "frozen-robot"
    frozen_at = 1.0

    def modal_accelerations(self, joint: JointMotion, W: list, dW: list) -> list:
        """Return modal accelerations as at that place of the path."""
        place = self.frozen_at + 0.0 * joint.angle
        return super().modal_accelerations(joint._replace(angle=place), W, dW)


class FrozenAtTheStart(Frozen):
    """Robot frozen as at the start of the path."""

    name = "robot-frozen-at-the-start"
    frozen_at = 0.0


class FrozenInTheMiddle(Frozen):
    """Robot frozen as in the middle of the path."""

    name = "robot-frozen-in-the-middle"
    frozen_at = 0.5


def figure_2() -> str:
    residual, energy, _ = measured(planned(), truth_of())
    whole = planned().candidate.in_full
    return (
        f"33.287 J within 1e-4, 0.05 mm: {planned().energy:.4f} J; MuJoCo {energy:.4f} J and "
        f"{residual:.3f} mm; CVODES in full {whole.energy:.4f} J and {1e3 * whole.residual:.3f} mm"
    )


def figure_3() -> str:
    words = list[str]()
    for kind in (FrozenAtTheStart, FrozenInTheMiddle, Frozen):
        plant = kind(robot=ur5_with_bar(), path=straight())
        wrong = qa.plan_move(qa.PointToPoint(plant, target=1.0, duration=DURATION))
        residual, _, _ = measured(wrong, truth_of())
        words.append(f"at s = {kind.frozen_at:g} {residual:.2f} mm")
    return f"modes frozen at arrival leave at least 20 mm: frozen {', '.join(words)}"


def figure_5() -> str:
    plan = qa.plan_move(move(**LIMITED))
    residual, _, torques = measured(plan, truth_of())
    shares = torques / np.array([*LIMITED["torque_limit"].values()])
    return (
        f"limits by joint, 38.0 J, peaks within 1.001: {plan.energy:.2f} J, {shares.max():.4f}, "
        f"{residual:.3f} mm"
    )


def figure_6() -> str:
    fastest = qa.fastest_move(move(**FASTEST), qa.CycloidPolynomial(12))
    residual, _, _ = measured(fastest.plan, truth_of())
    unjerked = {name: limit for name, limit in FASTEST.items() if name != "jerk_limit"}
    toppra = rival("toppra", move(**unjerked, duration=TOPPRA_LEAST))
    rung, _, _ = truth_of().residual_and_energy(toppra, TOPPRA_LEAST)
    return (
        f"fastest with 12 terms, 0.79 s: {fastest.duration:.4f} s, {residual:.3f} mm; toppra, "
        f"whose jerk has no limit, {TOPPRA_LEAST} s, {1e3 * rung:.1f} mm"
    )


def figure_7() -> str:
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), base=PEDESTAL, tip="wrist_3_link")
    plan = qa.plan_move(qa.PointToPoint(robot.along(straight()), target=1.0, duration=0.8))
    in_mujoco = FlexibleRobot(urdf_of("ur5_robot.urdf"), tip=("wrist_3_link", 0.0))
    in_mujoco.add_base(PEDESTAL.stiffness[0], PEDESTAL.damping[0], PEDESTAL.height)
    residual, _, _ = measured(plan, Truth(in_mujoco, UR5_JOINTS))
    return f"rocking pedestal, 0.001 mm: {residual:.6f} mm; {_six_waypoints()}"


def _six_waypoints() -> str:
    """A path with sharp turns, before and after the correction by the whole equations."""
    beside = np.random.default_rng(3).uniform(-0.15, 0.15, (4, 6))
    waypoints = START + np.linspace(0.0, 1.0, 6)[:, None] * (END - START)
    waypoints[1:-1] += beside
    plant = ur5_with_bar().along(qa.GeometricPath.through(waypoints))
    plan = qa.plan_move(qa.PointToPoint(plant, target=1.0, duration=DURATION))
    before, _, _ = measured(plan, truth_of())
    after, energy, _ = measured(qa.ocp.correct_in_full(plan), truth_of())
    return f"six waypoints, 0.1 mm: {before:.3f} mm, with --in-full {after:.3f} mm, {energy:.2f} J"


def figure_8() -> str:
    task = move(uncertainty=qa.Uncertainty({"frequency": 0.05}))
    plan = qa.plan_move(task, qa.CycloidPolynomial(8), residual_limit=1.2e-3)
    worst = max(measured(plan, truth_of(share**2))[0] for share in (0.95, 1.0, 1.05))
    return f"frequency +-5 %, 1.2 mm, at most 1.26 mm: {worst:.3f} mm, {plan.energy:.2f} J"


def figure_9() -> str:
    begin = time.process_time()
    fresh = ur5_with_bar.__wrapped__(gravity=(0.0, 0.0, -9.8066))
    _ = qa.plan_move(qa.PointToPoint(fresh.along(straight()), target=1.0, duration=DURATION))
    first = time.process_time() - begin
    robot = _second_plans(fresh.along(straight()))
    beam = _second_plans(qa.FlexibleBeam(mode_count=2))
    words = ", ".join(
        f"of {duration} duration {mine:.2f} s and {theirs:.2f} s, {mine / theirs:.2f} times"
        for duration, mine, theirs in zip(("another", "the same"), robot, beam)
    )
    return (
        f"first plan 8 s, second three times that of a beam of two modes on one joint: {first:.2f} "
        f"s; {words}"
    )


def _second_plans(plant: qa.Plant, rounds: int = 5) -> list[float]:
    """The processor's seconds of a plan after another: of another duration, and the same again.

    The latter is the median of some.
    """
    seconds = list[float]()
    for duration in (DURATION, *[1.02 * DURATION] * (1 + rounds)):
        begin = time.process_time()
        qa.plan_move(qa.PointToPoint(plant, target=1.0, duration=duration))
        seconds.append(time.process_time() - begin)
    return [seconds[1], float(np.median(seconds[2:]))]


def figure_10() -> str:
    robot = panda_with_bar(modes=4)
    plant = robot.along(qa.GeometricPath.line(PANDA_START, PANDA_END))
    task = qa.PointToPoint(plant, target=1.0, duration=1.2)
    plan = qa.plan_move(task, qa.CycloidPolynomial(10))
    in_mujoco = FlexibleRobot(urdf_of("panda.urdf"))
    hinges = in_mujoco.add_bar("panda_hand", **STEEL_BAR)
    for joint, gear in robot.elastic_joints.items():
        in_mujoco.add_gear(joint, gear.stiffness, gear.damping)
    truth = Truth(in_mujoco, robot.joints, STEEL_BAR["damping"], hinges, held=robot.held)
    residual, energy, _ = measured(plan, truth)
    return (
        f"Panda, elastic joints on all axes, 0.05 mm: {residual:.4f} mm, {plan.energy:.4f} J; "
        f"MuJoCo {energy:.4f} J"
    )


LOADS = (0.9, 0.95, 1.0, 1.05, 1.1)


def figure_11() -> str:
    task = move(uncertainty=qa.Uncertainty({"payload": 0.1}))

    def truth(load: float) -> Truth:
        robot = FlexibleRobot(urdf_of("ur5_robot.urdf"))
        hinges = robot.add_bar("tool0", **(BAR | {"tip_mass": load * BAR["tip_mass"]}))
        return Truth(robot, UR5_JOINTS, BAR["damping"], hinges)

    return f"UR5, {_with_loads(task, truth)}"


def figure_12() -> str:
    geared = panda_with_bar(modes=2)
    robot = qa.Robot(geared.urdf, geared.joints, geared.held, geared.beam, modes=2)
    path = qa.GeometricPath.line(PANDA_START, PANDA_END)
    uncertainty = qa.Uncertainty({"payload": 0.1})
    task = qa.PointToPoint(robot.along(path), target=1.0, duration=1.2, uncertainty=uncertainty)

    def truth(load: float) -> Truth:
        in_mujoco = FlexibleRobot(urdf_of("panda.urdf"))
        bar = STEEL_BAR | {"tip_mass": load * STEEL_BAR["tip_mass"]}
        hinges = in_mujoco.add_bar("panda_hand", **bar)
        return Truth(in_mujoco, robot.joints, bar["damping"], hinges, held=robot.held)

    # by default 0.11 mm, 5 % of the cycloid's largest deflection, which is 34 % of what the cycloid
    # leaves with 90 % of the load
    return f"Panda, {_with_loads(task, truth, residual_limit=0.08e-3)}"


def _with_loads(
    task: qa.PointToPoint, truth: Callable[[float], Truth], residual_limit: float | None = None
) -> str:
    """Say what a robust plan, a plan for one load, and the cycloid leave with other loads."""
    plans = {
        "plan with errors": qa.plan_move(
            task, qa.CycloidPolynomial(8), residual_limit=residual_limit
        ),
        "plan without": qa.plan_move(task.certain),
        "cycloid": qa.evaluate_coefficients(task.certain, []),
    }
    left = {
        name: [measured(plan, truth(load))[0] for load in LOADS] for name, plan in plans.items()
    }
    pairs = zip(left["plan with errors"], left["cycloid"])
    share = max(robust / cycloid for robust, cycloid in pairs)  # load by load
    words = [
        f"{name} ({plans[name].energy:.2f} J) {', '.join(f'{one:.3g}' for one in row)} mm"
        for name, row in left.items()
    ]
    return f"load +-10 %, at most a third of the cycloid's: {share:.2f}; {'; '.join(words)}"


FIGURES = {
    2: figure_2,
    3: figure_3,
    5: figure_5,
    6: figure_6,
    7: figure_7,
    8: figure_8,
    9: figure_9,
    10: figure_10,
    11: figure_11,
    12: figure_12,
}
"""By their numbers. 1 and 4 are tests: tests/ocp/test_golden_answers.py, tests/ocp/planning."""


def lines(numbers: list[int]) -> Iterator[str]:
    """A line for each figure, as it is measured."""
    for number in numbers:
        begin = time.process_time()
        words = FIGURES[number]()
        yield f"{number:2d}  {words}  [{time.process_time() - begin:.1f} s]"


def main() -> None:
    """Print what is named, or both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="*", choices=["all", "table", "figures"], default="all")
    parser.add_argument("--only", nargs="+", type=int, choices=FIGURES, default=list(FIGURES))
    options = parser.parse_args()
    if "all" in options.what or "table" in options.what:
        table()
    if "all" in options.what or "figures" in options.what:
        for line in lines(options.only):
            print(line, flush=True)


if __name__ == "__main__":
    main()
