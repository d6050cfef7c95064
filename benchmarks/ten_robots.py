"""Hold plans for ten robots against what is used in their place, judged by MuJoCo.

    pip install "quietarm[robot,ruckig,toppra]" mujoco example-robot-data
    pip install --no-deps pybullet
    python benchmarks/ten_robots.py [--only ur5 panda] [--output robots.csv]
    python benchmarks/ten_robots.py --page

Each robot makes one move within limits of torque, speed, acceleration and jerk: by the plan, and in
the same time by the plain cycloid, ruckig, toppra and the shaper ZVD over the cycloid. MuJoCo has
every bar as 24 hinges in each direction, nonlinear, and shares no code with quietarm. URDFs are
those of example-robot-data, and of pybullet for the iiwa; the SCARA and the gantry are written
here. The last two robots were held out: they were chosen before they were run, and run last.
"""

from __future__ import annotations

import argparse
import csv
import importlib.metadata
import io
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "helpers"))
RESULTS = HERE / "results" / "ten_robots.csv"
PAGE = HERE.parent / "docs" / "robots_evidence.md"
BAR = {
    "length": 0.8, "width": 0.008, "height": 0.012, "youngs_modulus": 70e9, "density": 2700.0,
    "tip_mass": 0.5, "damping": 0.005,
}  # fmt: skip
"""Of aluminium; one of steel is below, and a small one for weak arms."""
STEEL_BAR = {
    "length": 0.6, "width": 0.01, "height": 0.006, "youngs_modulus": 210e9, "density": 7850.0,
    "tip_mass": 0.4, "damping": 0.004,
}  # fmt: skip
SMALL_BAR = BAR | {"length": 0.5, "width": 0.006, "height": 0.008, "tip_mass": 0.15}
PANDA_GEARS = (3e4, 3e4, 2e4, 2e4, 8e3, 8e3, 8e3)
"""Of harmonic drives of its size [N m/rad]."""
HINGES = 24
"""Of a bar in MuJoCo, in each direction."""
NEGLIGIBLE = 1e-5
"""Residual by all equations [m] above which a plan is corrected by these as well."""


@dataclass(frozen=True)
class Case:
    """A robot, what of it bends, and its move.

    Parameters
    ----------
    urdf
        A file of a package, as "package: end of the path", or a text.
    joints
        The driven joints.
    start, target
        Their positions; the path is straight.
    duration
        Of the move [s].
    flange
        The link that carries a bar, or else the link that must come to rest.
    bar
        The bar; empty if there is none.
    gears
        Stiffness and damping of elastic gears by joint.
    rotors
        Inertias of the motors by joint, at the joint's side of the gear.
    held
        Positions of other joints.
    speeds
        Limits of the joints where the URDF's are not those of the robot [rad/s].
    acceleration, jerk
        Limits of every joint [rad/s^2, rad/s^3, or m/s^2, m/s^3]; URDFs have none.
    modes
        How many modes are followed.
    held_out
        True of a robot that was run last.
    """

    urdf: str
    joints: tuple[str, ...]
    start: tuple[float, ...]
    target: tuple[float, ...]
    duration: float
    flange: str
    bar: Mapping[str, float] = field(default_factory=dict)
    gears: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rotors: Mapping[str, float] = field(default_factory=dict)
    held: Mapping[str, float] = field(default_factory=dict)
    speeds: tuple[float, ...] = ()
    acceleration: float = 12.0
    jerk: float = 250.0
    modes: int = 2
    held_out: bool = False


def numbered(name: str, count: int) -> tuple[str, ...]:
    """Names of joints that end with their number."""
    return tuple(f"{name}{number}" for number in range(1, count + 1))


def _link(name: str, mass: float, centre: str, moments: str) -> str:
    ixx, iyy, izz = moments.split()
    return (
        f'<link name="{name}"><inertial><origin xyz="{centre}"/><mass value="{mass}"/>'
        f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _joint(name: str, kind: str, links: str, origin: str, axis: str, limit: str) -> str:
    parent, child = links.split()
    lower, upper, effort, velocity = limit.split()
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{origin}"/><axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}" '
        f'effort="{effort}" velocity="{velocity}"/></joint>'
    )


SCARA = "\n".join([
    '<robot name="scara"><link name="column"/>',
    _link("inner", 8.0, "0.17 0 0", "0.03 0.12 0.12"),
    _link("outer", 6.0, "0.12 0 0.05", "0.02 0.07 0.07"),
    _link("quill", 1.5, "0 0 -0.1", "0.02 0.02 0.001"),
    _link("flange", 2.0, "0.03 0 -0.05", "0.004 0.006 0.004"),
    _joint("shoulder", "revolute", "column inner", "0 0 0.4", "0 0 1", "-2.3 2.3 200 6.8"),
    _joint("elbow", "revolute", "inner outer", "0.35 0 0", "0 0 1", "-2.6 2.6 100 7.5"),
    _joint("lift", "prismatic", "outer quill", "0.25 0 0", "0 0 1", "-0.2 0 400 1.1"),
    _joint("wrist", "revolute", "quill flange", "0 0 -0.2", "0 0 1", "-6.2 6.2 10 15"),
    "</robot>",
])  # fmt: skip
"""Of the size of a SCARA with a reach of 600 mm that carries 2 kg."""
GANTRY = "\n".join([
    '<robot name="gantry"><link name="frame"/>',
    _link("bridge", 60.0, "0 0.6 0", "8 1 8"),
    _link("trolley", 20.0, "0 0 0", "0.4 0.4 0.4"),
    _link("ram", 8.0, "0 0 -0.3", "0.4 0.4 0.02"),
    '<link name="hook"/>',
    _joint("x", "prismatic", "frame bridge", "0 0 2", "1 0 0", "0 3 1500 1.5"),
    _joint("y", "prismatic", "bridge trolley", "0 0 0", "0 1 0", "0 1.2 600 1.5"),
    _joint("z", "prismatic", "trolley ram", "0 0 0", "0 0 1", "-0.5 0 400 1"),
    '<joint name="down" type="fixed"><parent link="ram"/><child link="hook"/>'
    '<origin xyz="0 0 -0.6" rpy="3.141592653589793 0 0"/></joint></robot>',
])  # fmt: skip
UR5_JOINTS = (
    "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
    "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
)  # fmt: skip
BAXTER_JOINTS = ("left_s0", "left_s1", "left_e0", "left_e1", "left_w0", "left_w1", "left_w2")
CASES = {
    "KUKA iiwa14": Case(
        "pybullet: kuka_iiwa/model.urdf", numbered("lbr_iiwa_joint_", 7),
        (-0.5, 0.3, 0.1, -1.4, 0.0, 0.9, 0.0), (0.5, 0.7, -0.2, -1.0, 0.3, 1.2, 0.4), 1.4,
        "lbr_iiwa_link_7", BAR, speeds=(1.48, 1.48, 1.75, 1.31, 2.27, 2.36, 2.36),
    ),
    "xArm7": Case(
        "example-robot-data: xarm7.urdf", numbered("joint", 7),
        (-0.6, -0.3, 0.1, 1.1, 0.1, 1.2, 0.0), (0.6, 0.2, -0.1, 1.3, -0.1, 1.0, 0.5), 1.1,
        "link7", BAR | {"tip_mass": 0.3},
    ),
    "Kinova j2s6s200": Case(
        "example-robot-data: kinova.urdf", numbered("j2s6s200_joint_", 6),
        (0.0, 3.2, 1.6, 0.5, 2.2, 0.2), (0.5, 3.5, 1.9, 0.8, 2.5, 0.6), 1.7,
        "j2s6s200_end_effector", SMALL_BAR | {"length": 0.7, "tip_mass": 0.2},
    ),
    "TIAGo": Case(
        "example-robot-data: tiago_no_hand.urdf",
        tuple(f"arm_{number}_joint" for number in range(1, 8)),
        (0.5, -0.6, -1.0, 1.4, 0.2, 0.3, 0.0), (1.5, -0.3, -1.2, 1.0, -0.2, 0.0, 0.4), 1.4,
        "arm_tool_link", SMALL_BAR, held={"torso_lift_joint": 0.15},
    ),
    "SCARA, elastic gears": Case(
        SCARA, ("shoulder", "elbow", "lift", "wrist"),
        (-0.9, 1.2, 0.0, 0.0), (0.8, 0.6, -0.1, 1.0), 0.6, "flange",
        gears={"shoulder": (1.5e4, 6.0), "elbow": (6e3, 2.0)},
        rotors={"shoulder": 0.6, "elbow": 0.25}, acceleration=40.0, jerk=1500.0,
    ),
    "gantry": Case(
        GANTRY, ("x", "y", "z"), (0.3, 0.2, -0.3), (1.5, 0.8, -0.1), 1.6, "hook",
        BAR | {"length": 1.0, "width": 0.01, "tip_mass": 2.0},
    ),
    "UR5": Case(
        "example-robot-data: ur5_robot.urdf", UR5_JOINTS,
        (0.0, -1.4, 1.7, -1.87, -1.57, 0.0), (1.4, -1.0, 1.2, -1.3, -1.2, 0.6), 1.0,
        "tool0", BAR,
    ),
    "Panda, elastic gears": Case(
        "example-robot-data: panda.urdf", numbered("panda_joint", 7),
        (-0.6, -0.5, 0.2, -2.0, 0.1, 1.6, 0.4), (0.6, 0.1, -0.1, -1.5, -0.2, 1.9, 0.8), 1.2,
        "panda_hand", STEEL_BAR,
        gears={name: (gear, 5.0) for name, gear in zip(numbered("panda_joint", 7), PANDA_GEARS)},
        held={"panda_finger_joint1": 0.01, "panda_finger_joint2": 0.01}, modes=4,
    ),
    "Baxter, left arm": Case(
        "example-robot-data: baxter.urdf", BAXTER_JOINTS,
        (-0.6, 0.2, 0.1, 1.2, 0.0, 0.6, 0.0), (0.5, 0.5, -0.1, 0.9, 0.2, 0.9, 0.5), 1.6,
        "left_hand_link", STEEL_BAR, held_out=True,
    ),
    "TALOS, left arm": Case(
        "example-robot-data: talos_left_arm.urdf",
        tuple(f"arm_left_{number}_joint" for number in range(2, 8)),
        (0.3, -0.4, -1.4, 0.2, 0.0, 0.0), (1.0, 0.3, -1.3, -0.2, 0.3, 0.3), 1.2,
        "wrist_left_ft_tool_link", SMALL_BAR, held_out=True,
    ),
}  # fmt: skip


def text_of(urdf: str) -> str:
    """Return the text of a URDF: itself, or a file of a package that is installed."""
    if urdf.startswith("<"):
        return urdf
    package, name = urdf.split(": ")
    for file in importlib.metadata.files(package) or []:
        if f"/{file}".endswith(f"/{name}"):
            return Path(str(file.locate())).read_text(encoding="utf-8")
    raise FileNotFoundError(f"{package} has no {name}")


@lru_cache
def task_of(name: str) -> Any:
    """The move of a robot, within its limits and those of all."""
    import quietarm as qa

    case = CASES[name]
    beam = qa.Beam(at=case.flange, **case.bar) if case.bar else None
    still = dict.fromkeys(case.joints, 0.0)
    robot = qa.Robot(
        text_of(case.urdf), case.joints, case.held, beam, case.gears,
        tip=None if beam else case.flange, rotor_inertia=case.rotors, friction=still,
        coulomb=still, modes=case.modes,
    )  # fmt: skip
    joints = robot.description.joints
    speeds = case.speeds or [joints[joint].velocity for joint in case.joints]
    return robot.task(
        qa.GeometricPath.line(case.start, case.target),
        case.duration,
        torque_limit={joint: joints[joint].effort for joint in case.joints},
        speed_limit=dict(zip(case.joints, speeds)),
        acceleration_limit=dict.fromkeys(case.joints, case.acceleration),
        jerk_limit=dict.fromkeys(case.joints, case.jerk),
    )


def truth_of(name: str) -> Any:
    """A robot in MuJoCo, whose other joints are held."""
    from mujoco_robots import FlexibleRobot, Truth

    case = CASES[name]
    twin = FlexibleRobot(io.StringIO(text_of(case.urdf)), tip=(case.flange, 0.0))
    drop_still_inertias(twin.root)
    moving = [
        joint.get("name")
        for joint in twin.root.findall("joint")
        if joint.get("type") in ("revolute", "continuous", "prismatic")
    ]
    held = {joint: case.held.get(joint, 0.0) for joint in moving if joint not in case.joints}
    hinges = twin.add_bar(case.flange, **case.bar, pieces=HINGES) if case.bar else ()
    for joint, gear in case.gears.items():
        twin.add_gear(joint, *gear)
    damping = case.bar.get("damping", 0.0)
    truth = Truth(twin, case.joints, damping, hinges, held=held)
    for joint, inertia in case.rotors.items():
        truth.model.dof_armature[truth.model.joint(joint).dofadr[0]] = inertia
    return truth


def drop_still_inertias(root: Any) -> None:
    """Drop the inertias of what is fixed to the ground: MuJoCo refuses those that no body has."""
    joints = root.findall("joint")
    parents = {joint.find("child").get("link"): joint for joint in joints}
    for link in root.findall("link"):
        name = link.get("name")
        while name in parents and parents[name].get("type") == "fixed":
            name = parents[name].find("parent").get("link")
        inertial = link.find("inertial")
        if name not in parents and inertial is not None:
            link.remove(inertial)


def rows_of(name: str) -> Iterator[dict[str, object]]:
    """A row of the results for every motion of a robot."""
    from parts.robot_motions import RIVALS, motion_of_answer, rival

    import quietarm as qa

    task = task_of(name)
    plan = qa.plan_move(task)
    plans = {"plan": plan}
    if plan.candidate.in_full.residual > NEGLIGIBLE:
        plans["plan, in full"] = qa.ocp.correct_in_full(plan)
    truth = truth_of(name)
    for kind in (*plans, *RIVALS):
        row = {"robot": name, "held_out": CASES[name].held_out, "motion": kind}
        row["duration_s"] = task.duration
        try:
            motion = motion_of_answer(plans[kind]) if kind in plans else rival(kind, task)
        except ValueError as error:
            yield row | {"refused": str(error)}
            continue
        row |= measured(truth, motion, task)
        yield row | (stated(plans[kind]) if kind in plans else {})


def measured(truth: Any, motion: Any, task: Any) -> dict[str, object]:
    """Measure what a motion leaves and takes in MuJoCo, and the largest shares of the limits."""
    from parts.robot_motions import LIMITED, peaks_of

    residual, energy, torques = truth.residual_and_energy(motion, task.duration)
    row: dict[str, object] = {"residual_mm": f"{1e3 * residual:.3g}", "energy_j": f"{energy:.5g}"}
    peaks = {"torque": torques, **peaks_of(motion, task.duration)}
    for quantity in ("torque", *LIMITED):
        row |= share_of(quantity, dict(zip(task.plant.joint_names, peaks[quantity])), task)
    return row


def stated(plan: Any) -> dict[str, object]:
    """Return what quietarm says of a plan: by its modes, and in full with one hinge more."""
    in_full = plan.candidate.in_full
    return {
        "stated_mm": f"{1e3 * plan.residual:.2g}",
        "stated_j": f"{plan.energy:.5g}",
        "in_full_mm": f"{1e3 * in_full.residual:.3g}",
        "in_full_j": f"{in_full.energy:.5g}",
    }


def share_of(quantity: str, peaks: Mapping[str, float], task: Any) -> dict[str, object]:
    """The largest share of a limit that a motion takes; of torques its joint and size as well."""
    bounds = getattr(task, f"{quantity}_limit")
    shares = {joint: peak / float(bounds[joint]) for joint, peak in peaks.items()}
    joint = max(shares, key=lambda name: shares[name])
    row: dict[str, object] = {f"{quantity}_share": f"{shares[joint]:.4g}"}
    if quantity == "torque":
        row |= {"torque_joint": joint, "torque_peak": f"{peaks[joint]:.4g}"}
    return row


def main(arguments: Sequence[str] | None = None) -> None:
    """Run robots and write their rows, or the tables of those that were run into their page."""
    from parts.robots_table import COLUMNS, with_tables

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--output", type=Path, default=RESULTS)
    parser.add_argument("--page", action="store_true", help="write the tables of the results")
    given = parser.parse_args(arguments)
    if given.page:
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(with_tables(page, given.output), encoding="utf-8")
        return
    with given.output.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for name in given.only:
            for row in rows_of(name):
                writer.writerow(row)
                file.flush()
                print(row, flush=True)


if __name__ == "__main__":
    main()
